#include "synth/scene/contact_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/mesh/palette.h"
#include "synth/pose/joint_angles.h"
#include "synth/pose/judge_pose.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFlesh_m = 0.07F;  ///< how far arms press into another's clothes and flesh

/// One of two people, who faces +z in the own frame.
struct Partner {
  const PersonPlan* plan;
  int number;
  Pose pose;
  PosedBody body;
  Isometry3f group_from_body = Isometry3f::Identity();

  Partner(const PersonPlan& of, int its_number)
      : plan(&of), number(its_number), pose(of.pose), body(of.poser->pose(of.pose)) {}

  float stature_m() const { return plan->poser->mesh().stature_m; }
  Vector3f joint(Bone bone) const { return group_from_body * body.joints[index(bone)]; }
  Vector3f shoulder(bool left) const { return joint(left ? Bone::l_upper_arm : Bone::r_upper_arm); }
  Vector3f front() const { return group_from_body.linear() * Vector3f::UnitZ(); }
  Vector3f to_left() const { return group_from_body.linear() * Vector3f::UnitX(); }
  BodyOutline outline() const { return moved(outline_of(body, stature_m()), group_from_body); }
};

bool is_arm(std::size_t bone) {
  return (bone >= index(Bone::l_clavicle) && bone <= index(Bone::l_hand)) ||
         (bone >= index(Bone::r_clavicle) && bone <= index(Bone::r_hand));
}

BodyOutline without_arms(BodyOutline outline) {
  constexpr float kNothing = -10.F;
  for (std::size_t b = 0; b < outline.bones.size(); ++b) {
    if (is_arm(b)) outline.bones[b].radius_m = kNothing;
  }
  return outline;
}

BodyOutline softened(BodyOutline outline) {
  for (Capsule& bone : outline.bones) bone.radius_m -= 0.5F * kFlesh_m;
  return outline;
}

/// Takes a wrist to a point of the group, or as near as the arm reaches. The elbow points in a direction of the group.
void reach_point(Partner& who, bool left, const Vector3f& point, const Vector3f& elbow_towards) {
  const Bone upper = left ? Bone::l_upper_arm : Bone::r_upper_arm, fore = left ? Bone::l_forearm : Bone::r_forearm;
  const Bone hand = left ? Bone::l_hand : Bone::r_hand;
  const auto at = [&](Bone bone) -> const Vector3f& { return who.body.joints[index(bone)]; };
  const float arm_m = (at(fore) - at(upper)).norm() + (at(hand) - at(fore)).norm();
  const float scale = (bone_length_m(upper) + bone_length_m(fore)) / std::max(arm_m, 0.05F);
  const Isometry3f body_from_group = who.group_from_body.inverse();
  const Vector3f way = body_from_group * point - at(upper);
  reach(who.pose, left, stick_figure(who.pose).head_of(upper) + scale * way, body_from_group.linear() * elbow_towards);
  who.body = who.plan->poser->pose(who.pose);
}

/// Places the other from near to far along a direction until trunks, heads and legs keep apart, and then `gap_m` more.
bool place_apart(const Partner& one, Partner& other, const Vector3f& direction, float heading_rad, float gap_m) {
  constexpr float kNearest_m = 0.15F, kFurthest_m = 1.F, kStep_m = 0.02F;
  const BodyOutline first = without_arms(one.outline());
  const BodyOutline second = without_arms(outline_of(other.body, other.stature_m()));
  const auto placed = [&](float apart) {
    const Vector3f at = apart * direction;
    return standing_at(at.x(), 0.F, at.z(), heading_rad);
  };
  for (float apart = kNearest_m; apart <= kFurthest_m; apart += kStep_m) {
    if (sinks_in(first, moved(second, placed(apart)))) continue;
    other.group_from_body = placed(apart + gap_m);
    return true;
  }
  return false;
}

/// Puts the arms of one around the other's back, at the height of the shoulder blades or the small of the back.
void put_arms_around(Partner& who, const Partner& other, bool high, Random& random) {
  const Vector3f spine = other.joint(high ? Bone::chest : Bone::spine);
  const float thick = 0.085F * other.stature_m() + 0.03F;
  for (const bool left : {true, false}) {
    const float side = left ? 1.F : -1.F;
    const Vector3f back =
        spine - thick * other.front() + side * between(0.07, 0.17, random) * who.to_left() + Vector3f(0.F, 0.05F, 0.F);
    reach_point(who, left, back, side * who.to_left() - 0.5F * Vector3f::UnitY());
  }
}

void embrace(Partner& one, Partner& other, Random& random) {
  const bool one_high = one.stature_m() > other.stature_m();
  put_arms_around(one, other, one_high, random);
  put_arms_around(other, one, !one_high, random);
}

/// Takes a hand of each to one place between them.
void meet(Partner& one, bool one_left, Partner& other, bool other_left, const Vector3f& place) {
  const Vector3f down = -Vector3f::UnitY();
  const auto elbow = [&](const Partner& who, bool left) -> Vector3f {
    return down + (left ? 0.3F : -0.3F) * who.to_left() - 0.3F * who.front();
  };
  reach_point(one, one_left, place, elbow(one, one_left));
  reach_point(other, other_left, place, elbow(other, other_left));
}

void hand_over(Partner& one, Partner& other, Random& random) {
  const bool left = chance(0.3, random);
  Vector3f place = 0.5F * (one.shoulder(left) + other.shoulder(left));
  place.y() = std::min(one.shoulder(left).y(), other.shoulder(left).y()) - between(0.15, 0.4, random);
  meet(one, left, other, left, place);
}

/// Takes the hand of one that is beside the other around their back to the far side of the waist or shoulders.
void put_arm_around(Partner& one, bool left, const Partner& other, Random& random) {
  const bool high = one.stature_m() > 0.93F * other.stature_m() && chance(0.6, random);
  const Vector3f spine = other.joint(high ? Bone::neck : Bone::spine);
  const float away = left ? 1.F : -1.F;
  const Vector3f back =
      spine - 0.08F * other.stature_m() * other.front() + away * between(0.02, 0.12, random) * other.to_left();
  reach_point(one, left, back, -one.front() - 0.5F * Vector3f::UnitY());
}

void hold_hands(Partner& one, bool left, Partner& other) {
  const Vector3f high = one.shoulder(left), low = other.shoulder(!left);
  Vector3f place = 0.5F * (high + low);
  place.y() = std::max(std::min(high.y(), low.y()) - 0.33F * std::min(one.stature_m(), other.stature_m()),
                       high.y() - 0.34F * one.stature_m());
  meet(one, left, other, !left, place);
}

void help_up(Partner& one, Partner& other, Random& random) {
  for (const bool left : {true, false}) {
    const Vector3f from = one.shoulder(left), to = other.shoulder(!left);
    const Vector3f place = from + between(0.45, 0.6, random) * (to - from) - Vector3f(0.F, 0.05F, 0.F);
    meet(one, left, other, !left, place);
  }
}

/// Returns whether hands are where they should be: at a hand of the other, or at the other's trunk.
bool arms_reach(Contact contact, const Partner& one, const Partner& other) {
  constexpr std::array kHands = {Bone::l_hand, Bone::r_hand};
  constexpr std::array kTrunk = {Bone::spine, Bone::chest, Bone::neck};
  const auto reach = [&](const auto& goals, float far_m) {
    return std::ranges::any_of(kHands, [&](Bone mine) {
      return std::ranges::any_of(goals,
                                 [&](Bone theirs) { return (one.joint(mine) - other.joint(theirs)).norm() < far_m; });
    });
  };
  const bool around = contact == Contact::embrace || contact == Contact::arm_around;
  return around ? reach(kTrunk, 0.25F) : reach(kHands, 0.1F);
}

/// Returns whether people who embrace are close enough for it: each has a hand behind the other.
bool embraces(const Partner& one, const Partner& other) {
  constexpr float kFurthest_m = 0.5F;
  const Vector3f way = other.joint(Bone::chest) - one.joint(Bone::chest);
  const float apart = way.norm();
  const auto beyond = [&](const Partner& who, Bone hand, float sign) {
    return sign * (who.joint(hand) - one.joint(Bone::chest)).dot(way.normalized()) > (sign > 0.F ? apart : 0.F);
  };
  return apart < kFurthest_m && (beyond(one, Bone::l_hand, 1.F) || beyond(one, Bone::r_hand, 1.F)) &&
         (beyond(other, Bone::l_hand, -1.F) || beyond(other, Bone::r_hand, -1.F));
}

bool possible(Contact contact, const Partner& one, const Partner& other) {
  const auto fine = [](const Partner& who) {
    return arm_in_range(arm_angles(who.pose, true)) && arm_in_range(arm_angles(who.pose, false)) &&
           !intersects_itself(who.pose);
  };
  return fine(one) && fine(other) && arms_reach(contact, one, other) &&
         (contact != Contact::embrace || embraces(one, other)) &&
         !sinks_in(softened(one.outline()), softened(other.outline()));
}

bool upright(const Partner& who) {
  const Vector3f trunk = who.body.joints[index(Bone::neck)] - who.body.joints[index(Bone::pelvis)];
  return trunk.normalized().y() > 0.9F;
}

GroupMember member_of(const Partner& who) {
  return {.plan = who.number, .body = who.body, .group_from_body = who.group_from_body, .outline = who.outline()};
}

/// Places the other as a contact asks. Returns whether they fit.
bool place(Contact contact, const Partner& one, Partner& other, bool left, Random& random) {
  const float aside = between(-0.08, 0.08, random), turn = between(-0.25, 0.25, random);
  const Vector3f ahead = Vector3f(aside, 0.F, 1.F).normalized(), beside{left ? 1.F : -1.F, 0.F, 0.F};
  switch (contact) {
    case Contact::embrace:
      return place_apart(one, other, ahead, kPi + 0.5F * turn, 0.F);
    case Contact::handing:
      return place_apart(one, other, ahead, kPi + turn, between(0.3, 0.7, random));
    case Contact::helping_up:
      return place_apart(one, other, ahead, kPi + turn, between(0.F, 0.15F, random));
    case Contact::arm_around:
      return place_apart(one, other, beside, 0.5F * turn, between(0.0, 0.05, random));
    case Contact::hand_in_hand:
      return place_apart(one, other, beside, turn, between(0.05, 0.25, random));
  }
  return false;
}

}  // namespace

std::optional<PeopleGroup> touching_pair(Contact contact, const PersonPlan& one_plan, int number,
                                         const PersonPlan& other_plan, int other_number, Random& random) {
  Partner one(one_plan, number), other(other_plan, other_number);
  const bool left = chance(0.5, random);
  const bool fits = contact == Contact::helping_up || (upright(one) && upright(other));
  if (!fits || !place(contact, one, other, left, random)) return std::nullopt;
  switch (contact) {
    case Contact::embrace:
      embrace(one, other, random);
      break;
    case Contact::handing:
      hand_over(one, other, random);
      break;
    case Contact::helping_up:
      help_up(one, other, random);
      break;
    case Contact::arm_around:
      put_arm_around(one, left, other, random);
      break;
    case Contact::hand_in_hand:
      hold_hands(one, left, other);
      break;
  }
  if (!possible(contact, one, other)) return std::nullopt;
  return PeopleGroup{{member_of(one), member_of(other)}, {}};
}

}  // namespace vesalius::synth
