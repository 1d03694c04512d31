#include "synth/scene/people_group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "synth/furniture/care.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/seats.h"
#include "synth/mesh/palette.h"
#include "synth/scene/contact_pair.h"
#include "synth/scene/fit_support.h"
#include "synth/scene/load.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Translation3f;

/// A posed person before their seat or bed is chosen.
struct Posed {
  GroupMember member;
  Posture posture = Posture::standing;
  std::optional<SeatFit> seat;  ///< seat of a person who sits on one
};

Posed pose_of(const PersonPlan& plan, int number) {
  Posed posed;
  posed.posture = plan.posture;
  posed.member.plan = number;
  posed.member.body = plan.poser->pose(plan.pose);
  posed.member.outline = outline_of(posed.member.body, plan.poser->mesh().stature_m);
  if (plan.posture == Posture::sitting) posed.seat = fit_seat(plan.poser->mesh(), posed.member.body);
  return posed;
}

void put(GroupMember& member, const Isometry3f& group_from_body) {
  member.group_from_body = group_from_body;
  member.outline = moved(std::move(member.outline), group_from_body);
}

bool keeps_clear(const PeopleGroup& group, const Furniture& piece) {
  return std::ranges::none_of(group.members,
                              [&](const GroupMember& member) { return sinks_in(member.outline, piece.solids); }) &&
         std::ranges::none_of(group.furniture, [&](const Furniture& other) {
           return std::ranges::any_of(other.solids, [&](const OrientedBox& a) {
             return std::ranges::any_of(piece.solids, [&](const OrientedBox& b) { return overlap(a, b, 0.005F); });
           });
         });
}

/// Adds a table in front of a sitting person, above the knees if there is room for them.
void add_table(const SeatFit& fit, PeopleGroup& group, Random& random) {
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    const bool high = chance(0.7, random);
    const float height = high ? fit.height_m + between(0.2, 0.34, random) : between(0.35, 0.5, random);
    const float depth = between(0.5, 0.9, random);
    const float near = high ? fit.depth_m * between(0.6, 1.0, random) : fit.depth_m + between(0.3, 0.5, random);
    Furniture table = make_table(between(0.6, 1.6, random), depth, height, random);
    move(table, fit.body_from_seat * Translation3f(between(-0.2, 0.2, random), 0.F, near + 0.5F * depth));
    if (!keeps_clear(group, table)) continue;
    group.furniture.push_back(std::move(table));
    return;
  }
}

/// Adds a desk or counter whose near side is `near_m` or more before `group_from_front`, where limbs leave room for it.
void add_desk(const Isometry3f& group_from_front, float near_m, float low_m, float high_m,
              Furniture (*make)(float height_m, Random& random), PeopleGroup& group, Random& random) {
  constexpr int kTries = 4;
  for (int i = 0; i < kTries; ++i) {
    const float height = between(low_m, high_m, random), aside = between(-0.3, 0.3, random);
    const float near = near_m + 0.12F * float(i) * between(0.5, 1.0, random);
    Furniture desk = make(height, random);
    move(desk, group_from_front * Translation3f(aside, 0.F, near));
    if (!keeps_clear(group, desk)) continue;
    group.furniture.push_back(std::move(desk));
    return;
  }
}

/// Draws how far cushions swell, or 0 for a hard seat or bed.
float draw_swell(const SceneOptions& options, Random& random) {
  return asked(options.soft_probability, random) ? options.soft_depth_m * between(0.25, 1.0, random) : 0.F;
}

/// Adds a blanket, which is no solid, to the furniture of a group. `group_from_place` is the frame of the place.
void add_blanket(const BlanketPlace& place, const Isometry3f& group_from_place, const GroupMember& member,
                 PeopleGroup& group, Random& random) {
  std::vector<Eigen::Vector3f> points = member.outline.points;
  const Isometry3f place_from_group = group_from_place.inverse();
  for (Eigen::Vector3f& p : points) p = place_from_group * p;
  Furniture blanket;
  blanket.mesh = drape_blanket(place, points, random);
  move(blanket, group_from_place);
  group.furniture.push_back(std::move(blanket));
}

/// Covers the legs of a person who sits from the lap to below the knees.
void add_lap_blanket(const SeatFit& fit, const GroupMember& member, PeopleGroup& group, Random& random) {
  const float half = fit.half_width_m + between(0.05, 0.2, random);
  const float from = between(0.15, 0.3, random), to = fit.depth_m + between(0.15, 0.35, random);
  add_blanket({.low = {-half, from},
               .high = {half, std::max(to, from + 0.2F)},
               .ground_m = fit.height_m,
               .edge_z = fit.depth_m,
               .top_m = fit.height_m + 0.28F},
              fit.body_from_seat, member, group, random);
}

/// Returns somebody on a wheelchair, a toilet or a bench, or nothing if none fits.
std::optional<PeopleGroup> care_group(const SceneOptions& options, const Posed& posed, Random& random) {
  std::optional<CareSeat> made = make_care_seat(*posed.seat, posed.member.outline, random);
  if (!made) return std::nullopt;
  PeopleGroup group;
  group.members.push_back(posed.member);
  put(group.members[0], Isometry3f(Translation3f(0.F, made->lift_m, 0.F)));
  group.furniture.push_back(std::move(made->seat));
  SeatFit fit = *posed.seat;
  fit.height_m += made->lift_m;
  if (chance(0.5 * options.table_probability, random)) add_table(fit, group, random);
  if (asked(options.blanket_probability, random)) add_lap_blanket(fit, group.members[0], group, random);
  return group;
}

std::optional<PeopleGroup> sitting_group(const SceneOptions& options, Posed posed, Random& random) {
  if (asked(options.care_probability, random)) {
    if (std::optional<PeopleGroup> group = care_group(options, posed, random)) return group;
  }
  const float swell = draw_swell(options, random);
  std::optional<Furniture> seat = make_fitting_seat(*posed.seat, posed.member.outline, swell, random);
  if (!seat) return std::nullopt;
  PeopleGroup group;
  group.furniture.push_back(std::move(*seat));
  const SeatFit fit = *posed.seat;
  group.members.push_back(std::move(posed.member));
  if (asked(options.desk_probability, random)) {
    add_desk(fit.body_from_seat, 0.6F * fit.depth_m, fit.height_m + 0.2F, fit.height_m + 0.36F, make_desk_before, group,
             random);
  } else if (chance(options.table_probability, random)) {
    add_table(fit, group, random);
  }
  if (asked(options.blanket_probability, random)) add_lap_blanket(fit, group.members[0], group, random);
  return group;
}

/// Returns a person who stands, perhaps behind a counter.
PeopleGroup standing_group(const SceneOptions& options, const std::vector<PersonPlan>& plans, Posed posed,
                           Random& random) {
  PeopleGroup group;
  const float stature = plans[posed.member.plan].poser->mesh().stature_m;
  group.members.push_back(std::move(posed.member));
  if (posed.posture == Posture::standing && asked(options.desk_probability, random)) {
    const Eigen::Vector3f& hips = group.members[0].body.joints[index(Bone::pelvis)];
    add_desk(Isometry3f(Translation3f(hips.x(), 0.F, hips.z())), 0.2F, 0.45F * stature, 0.72F * stature, make_counter,
             group, random);
  }
  if (posed.posture == Posture::standing && asked(options.load_probability, random)) {
    const GroupMember& member = group.members[0];
    std::optional<Furniture> load = make_load(member.body, member.outline, random);
    if (load && keeps_clear(group, *load)) group.furniture.push_back(std::move(*load));
  }
  return group;
}

/// Returns both people on one sofa in its frame, or nothing if they differ too much or are in each other's way.
std::optional<PeopleGroup> sofa_group(const Posed& left, const Posed& right, Random& random) {
  constexpr float kMaxDifference_m = 0.03F;
  const SeatFit &a = *left.seat, &b = *right.seat;
  if (std::abs(a.height_m - b.height_m) > kMaxDifference_m || std::abs(a.lean_rad - b.lean_rad) > 0.15F) {
    return std::nullopt;
  }
  SeatShape shape;
  shape.kind = SeatKind::sofa;
  shape.height_m = 0.5F * (a.height_m + b.height_m);
  shape.depth_m = std::min(a.depth_m, b.depth_m);
  shape.lean_rad = std::max(a.lean_rad, b.lean_rad);
  shape.back_m = std::min(a.back_m, b.back_m);
  const float apart = a.half_width_m + b.half_width_m + between(0.1, 0.3, random);
  shape.width_m = std::clamp(2.F * apart * between(0.95, 1.2, random), 1.3F, 2.4F);

  PeopleGroup group;
  for (const auto& [posed, x] : {std::pair{&left, 0.5F * apart}, std::pair{&right, -0.5F * apart}}) {
    const SeatFit& fit = *posed->seat;
    GroupMember member = posed->member;
    const Isometry3f seat_from_body = fit.body_from_seat.inverse();
    put(member, Translation3f(x, shape.height_m - fit.height_m, 0.F) * seat_from_body);
    group.members.push_back(std::move(member));
  }
  Furniture sofa = make_seat(shape, random);
  if (sinks_in(group.members[0].outline, group.members[1].outline) || !keeps_clear(group, sofa)) return std::nullopt;
  group.furniture.push_back(std::move(sofa));
  return group;
}

/// Returns the chest of a lying person as the far end of a blanket in the bed's frame, whose feet are at -z.
BlanketPlace draw_cover(const BedFit& fit, float ground_m, Random& random) {
  const float half = 0.5F * fit.width_m + between(0.05, 0.25, random), length = 0.5F * fit.length_m;
  return {.low = {-half, -length - between(0.02, 0.1, random)},
          .high = {half, length - between(0.25, 0.75, random)},
          .ground_m = ground_m,
          .top_m = ground_m + 0.7F};
}

/// As draw_cover(), but up to the neck of somebody between the rails of a bed.
BlanketPlace draw_high_cover(const BedFit& fit, const PosedBody& body, float bed_m, float ground_m, Random& random) {
  BlanketPlace cover = draw_cover(fit, ground_m, random);
  const float neck = (fit.body_from_bed.inverse() * body.joints[index(Bone::neck)]).z();
  cover.high = {std::min(cover.high.x(), 0.5F * bed_m), neck + between(-0.1, 0.06, random)};
  cover.low = {-cover.high.x(), std::max(cover.low.y(), -0.5F * fit.length_m - 0.04F)};
  return cover;
}

/// Returns a sofa below a body that lies along it at a height, in the body's frame, or nothing if it is too wide.
std::optional<Furniture> make_lying_sofa(const BedFit& fit, float height_m, float swell_m, Random& random) {
  constexpr float kWidest_m = 0.85F;
  if (fit.width_m > kWidest_m) return std::nullopt;
  SeatShape shape;
  shape.kind = SeatKind::sofa;
  shape.height_m = height_m;
  shape.width_m = fit.length_m + between(0.06, 0.3, random);
  shape.depth_m = std::max(between(0.55, 0.7, random), fit.width_m + 0.02F);
  shape.back_m = between(0.3, 0.5, random);
  shape.lean_rad = between(0.0, 0.3, random);
  Furniture sofa = make_seat(shape, random);
  if (swell_m > 0.F) add_seat_cushions(shape, swell_m, sofa, random);
  const float side = chance(0.5, random) ? 1.F : -1.F;  // which end the head is at
  move(sofa, fit.body_from_bed * Eigen::AngleAxisf(side * 1.5707963F, Eigen::Vector3f::UnitY()) *
                 Translation3f(0.F, 0.F, -0.5F * fit.width_m - 0.02F));
  return sofa;
}

/// A bed or sofa under somebody.
struct Bed {
  Furniture piece;
  GroupMember raised;  ///< who lies or sits on it
  float height_m = 0.F, width_m = 0.F;
  bool care = false;  ///< whether it is one with rails
};

/// Returns a bed, or for who lies perhaps a sofa, or nothing if limbs are in the way of all that were tried.
std::optional<Bed> put_bed_under(const SceneOptions& options, const Posed& posed, const BedFit& fit, Random& random) {
  Bed bed;
  bed.height_m = between(0.25, 0.6, random);
  bed.raised = posed.member;
  put(bed.raised, Isometry3f(Translation3f(0.F, bed.height_m - kCushion_m, 0.F)));
  bed.care = asked(options.care_probability, random);
  const float swell = draw_swell(options, random);
  if (posed.posture == Posture::lying && !bed.care && asked(options.lying_sofa_probability, random)) {
    std::optional<Furniture> sofa = make_lying_sofa(fit, bed.height_m, swell, random);
    if (sofa && !sinks_in(bed.raised.outline, sofa->solids)) {
      bed.piece = std::move(*sofa);
      return bed;
    }
  }
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    bed.width_m = std::max(between(0.8, 1.8, random), fit.width_m + 0.05F);
    const float length = std::max(between(1.9, 2.1, random), fit.length_m + 0.1F);
    bed.piece = (bed.care ? make_care_bed : make_bed)(bed.width_m, length, bed.height_m, random);
    if (swell > 0.F) add_soft_mattress(bed.width_m, length, bed.height_m, swell, bed.piece, random);
    move(bed.piece, fit.body_from_bed);
    if (!sinks_in(bed.raised.outline, bed.piece.solids)) return bed;
  }
  return std::nullopt;
}

/// Returns the cover of somebody who sits up in bed: over the legs up to the hips.
BlanketPlace up_to_hips(BlanketPlace cover, const BedFit& fit, const PosedBody& body) {
  const float hips = (fit.body_from_bed.inverse() * body.joints[index(Bone::pelvis)]).z();
  cover.high.y() = std::max(hips - 0.1F, cover.low.y() + 0.2F);
  cover.top_m = cover.ground_m + 0.28F;  // who bends forward stays above
  return cover;
}

/// Returns somebody who lies, or sits with the legs along a bed, on a bed or on the floor, perhaps below a blanket.
PeopleGroup lying_group(const SceneOptions& options, Posed posed, bool on_bed, Random& random) {
  PeopleGroup group;
  const BedFit fit = fit_bed(posed.member.body);
  std::optional<Bed> bed = on_bed ? put_bed_under(options, posed, fit, random) : std::nullopt;
  const float ground = bed ? bed->height_m : 0.F;
  const bool sits = posed.posture != Posture::lying, care = bed && bed->care;
  if (bed) group.furniture.push_back(std::move(bed->piece));
  group.members.push_back(bed ? std::move(bed->raised) : std::move(posed.member));
  const bool high = care && chance(0.6, random);
  if (high || asked(options.blanket_probability, random)) {
    const PosedBody& body = group.members[0].body;
    const BlanketPlace cover =
        high ? draw_high_cover(fit, body, bed->width_m, ground, random) : draw_cover(fit, ground, random);
    add_blanket(sits ? up_to_hips(cover, fit, body) : cover, fit.body_from_bed, group.members[0], group, random);
  }
  return group;
}

/// Returns whether somebody sits on the floor with the legs stretched out, as people sit in bed.
bool sits_along(const Posed& posed) {
  if (posed.posture != Posture::sitting || posed.seat) return false;
  const auto at = [&](Bone bone) -> const Eigen::Vector3f& { return posed.member.body.joints[index(bone)]; };
  const Eigen::Vector3f& hips = at(Bone::pelvis);
  const Eigen::Vector3f feet = 0.5F * (at(Bone::l_foot) + at(Bone::r_foot));
  constexpr float kStretched_m = 0.5F;
  return Eigen::Vector2f(feet.x() - hips.x(), feet.z() - hips.z()).norm() > kStretched_m;
}

/// Returns two people side by side who look in about the same direction, as close as arms and clothes allow or a hand's
/// breadth apart. Returns nothing if their limbs keep them further apart.
std::optional<PeopleGroup> standing_pair(const Posed& one, const Posed& other, Random& random) {
  constexpr float kNearest_m = 0.25F, kFurthest_m = 0.9F, kStep_m = 0.02F;
  const float side = chance(0.5, random) ? 1.F : -1.F;
  const float ahead = between(-0.12, 0.12, random);
  const float gap = std::max(0.F, between(-0.1, 0.12, random));
  const Isometry3f turned = standing_at(0.F, 0.F, 0.F, between(-0.6, 0.6, random));
  const auto place = [&](float apart) -> Isometry3f { return Translation3f(side * apart, 0.F, ahead) * turned; };
  const auto clear = [&](float apart) {
    return !sinks_in(one.member.outline, moved(other.member.outline, place(apart)));
  };
  for (float apart = kNearest_m; apart <= kFurthest_m; apart += kStep_m) {
    if (!clear(apart)) continue;
    GroupMember beside = other.member;
    put(beside, place(clear(apart + gap) ? apart + gap : apart));  // avoids an outstretched arm
    return PeopleGroup{{one.member, std::move(beside)}, {}};
  }
  return std::nullopt;
}

/// Returns the next person after `people[first]` who has a seat as well, or has the same posture without a seat; -1 if
/// there is none.
int partner_of(const std::vector<std::optional<Posed>>& people, std::size_t first) {
  const Posed& one = *people[first];
  for (std::size_t i = first + 1; i < people.size(); ++i) {
    if (!people[i]) continue;
    if (one.seat ? people[i]->seat.has_value() : people[i]->posture == one.posture) return int(i);
  }
  return -1;
}

/// Returns the probability that a person is placed together with another of the same posture. Returns nothing if the
/// option is off: then no random number is drawn, so scenes are the same as before the option existed.
std::optional<double> probability_of_company(const SceneOptions& options, const Posed& posed) {
  if (posed.seat) return options.sofa_probability;
  if (posed.posture != Posture::standing || options.beside_probability == 0.F) return std::nullopt;
  return options.beside_probability;
}

bool is_low(const Posed& posed) {
  return posed.posture == Posture::kneeling || (posed.posture == Posture::sitting && !posed.seat);
}

/// Returns the next person after `people[first]` with whom a contact is possible: both stand, or one of them does and
/// the other is low; -1 if there is none.
int contact_of(const std::vector<std::optional<Posed>>& people, std::size_t first) {
  const auto stands = [](const Posed& posed) { return posed.posture == Posture::standing; };
  for (std::size_t i = first + 1; i < people.size(); ++i) {
    if (!people[i]) continue;
    const Posed &one = *people[first], &other = *people[i];
    if ((stands(one) && (stands(other) || is_low(other))) || (is_low(one) && stands(other))) return int(i);
  }
  return -1;
}

/// Returns two people who touch in one of the ways that their postures allow, or nothing if they cannot.
std::optional<PeopleGroup> contact_group(const std::vector<PersonPlan>& plans, const Posed& one, const Posed& other,
                                         Random& random) {
  constexpr int kTries = 4;
  constexpr std::array kUpright = {Contact::embrace, Contact::handing, Contact::arm_around, Contact::hand_in_hand};
  const bool helps = is_low(one) || is_low(other);
  const int first = is_low(one) ? other.member.plan : one.member.plan;
  const int second = is_low(one) ? one.member.plan : other.member.plan;
  for (int i = 0; i < kTries; ++i) {
    const Contact contact = kUpright[random.below(kUpright.size())];
    auto pair =
        touching_pair(helps ? Contact::helping_up : contact, plans[first], first, plans[second], second, random);
    if (pair) return pair;
  }
  return std::nullopt;
}

}  // namespace

std::vector<PeopleGroup> make_groups(const SceneOptions& options, const std::vector<PersonPlan>& plans,
                                     Random& random) {
  std::vector<std::optional<Posed>> people;
  for (std::size_t i = 0; i < plans.size(); ++i) people.emplace_back(pose_of(plans[i], int(i)));
  std::vector<PeopleGroup> groups;
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (!people[i]) continue;
    Posed& posed = *people[i];
    std::optional<PeopleGroup> group;
    int partner = asked(options.contact_probability, random) ? contact_of(people, i) : -1;
    if (partner >= 0) group = contact_group(plans, posed, *people[partner], random);
    if (!group) {
      const std::optional<double> together = probability_of_company(options, posed);
      partner = together && chance(*together, random) ? partner_of(people, i) : -1;
    }
    if (!group && partner >= 0) {
      const Posed& other = *people[partner];
      group = posed.seat ? sofa_group(posed, other, random) : standing_pair(posed, other, random);
    }
    if (group) {
      people[partner].reset();
    } else if (posed.seat) {
      group = sitting_group(options, std::move(posed), random);
    } else if (posed.posture == Posture::lying) {
      const bool on_bed = chance(options.bed_probability, random);
      group = lying_group(options, std::move(posed), on_bed, random);
    } else if (options.care_probability > 0.F && sits_along(posed) && chance(options.bed_probability, random)) {
      group = lying_group(options, std::move(posed), true, random);
    } else {
      group = standing_group(options, plans, std::move(posed), random);
    }
    if (group) groups.push_back(std::move(*group));
  }
  return groups;
}

}  // namespace vesalius::synth
