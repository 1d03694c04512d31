#include "synth/generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <mutex>

#include "synth/cast.h"
#include "synth/mesh/palette.h"
#include "synth/photographer.h"
#include "synth/pose/make_movements.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kKeptClips = 8;
constexpr std::uint64_t kMostClips = std::uint64_t{1} << 31U;

float leg_length_m(const BodyMesh& mesh) {
  const auto bones = rest_bones(mesh);
  const auto length = [&](Bone bone) { return (bones[index(bone)].tail - bones[index(bone)].head).norm(); };
  return length(Bone::l_thigh) + length(Bone::l_shin);
}

/// Keeps the clips that were used last. Each is made once, however many threads ask for it.
class ClipStore {
 public:
  template <class Make>
  std::shared_ptr<const ClipScene> get(std::uint64_t clip, const Make& make) {
    const std::shared_ptr<Entry> entry = find(clip);
    std::call_once(entry->made, [&] { entry->scene = std::make_shared<const ClipScene>(make()); });
    return entry->scene;
  }

 private:
  struct Entry {
    std::uint64_t clip = 0;
    std::once_flag made;
    std::shared_ptr<const ClipScene> scene;
  };

  std::shared_ptr<Entry> find(std::uint64_t clip) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(entries_, [&](const auto& entry) { return entry->clip == clip; });
    if (found != entries_.end()) {
      entries_.splice(entries_.begin(), entries_, found);
      return entries_.front();
    }
    entries_.push_front(std::make_shared<Entry>());
    entries_.front()->clip = clip;
    if (entries_.size() > kKeptClips) entries_.pop_back();
    return entries_.front();
  }

  std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< the one used last first
};

/// What all frames of a recipe and a seed have in common.
struct Studio {
  Recipe recipe;
  BodiesAndMotions assets;
  BodyModel body;
  std::uint64_t seed = 0;
  Cast cast;
  Photographer photographer;

  Studio(const Recipe& the_recipe, BodiesAndMotions the_assets, BodyModel the_body, std::uint64_t the_seed)
      : recipe(checked(the_recipe)),
        assets(std::move(the_assets)),
        body(std::move(the_body)),
        seed(the_seed),
        cast(recipe, assets.makehuman, assets.captured, body, seed),
        photographer(recipe, seed) {}
};

}  // namespace

struct Generator::State : Studio {
  using Studio::Studio;
};

Generator::Generator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed)
    : state_(std::make_unique<State>(recipe, std::move(assets), body, seed)) {}

Generator::~Generator() = default;

BuiltScene Generator::scene(std::uint64_t index) const {
  const State& s = *state_;
  Random plan_random = random_for(s.seed, Purpose::plan, index);
  std::vector<PersonPlan> plans(s.cast.draw_count(plan_random));
  for (PersonPlan& plan : plans) plan = s.cast.draw_person(plan_random);
  return build_scene(s.recipe.scene, s.recipe.camera, s.photographer.camera(), plans,
                     random_for(s.seed, Purpose::scene, index));
}

const Poser& Generator::body(std::size_t k) const { return state_->cast.body(k); }

SampledPose Generator::draw_pose(Random& random) const { return state_->cast.draw_pose(random); }

LabelledFrame Generator::frame(std::uint64_t index) const {
  return state_->photographer.take(scene(index), {.frame = index, .camera = index}, fmt::format("{:08}", index));
}

int ClipTiming::frames() const { return std::max(1, int(std::lround(seconds * rate_hz))); }

void check(const ClipTiming& timing) {
  if (!(timing.seconds > 0.F && timing.seconds <= kMaxClip_s)) {
    throw UsageError(
        fmt::format("clips of {} seconds, expected more than 0 and at most {}", timing.seconds, kMaxClip_s));
  }
  if (!(timing.rate_hz >= kMinRate_hz && timing.rate_hz <= kMaxRate_hz)) {
    throw UsageError(fmt::format("{} frames a second, expected {} to {}", timing.rate_hz, kMinRate_hz, kMaxRate_hz));
  }
}

struct ClipGenerator::State : Studio {
  ClipTiming timing;
  ClipStore clips;

  State(const Recipe& the_recipe, BodiesAndMotions the_assets, const BodyModel& the_body, std::uint64_t the_seed,
        const ClipTiming& the_timing)
      : Studio(the_recipe, std::move(the_assets), the_body, the_seed), timing(the_timing) {}

  bool captured(Random& random) const { return !assets.movements.empty() && random.uniform() < recipe.pose.captured; }
  bool mirrors(Random& random) const { return random.uniform() < recipe.pose.mirrored; }

  template <class T>
  T drawn_from(const std::vector<T>& all, Random& random) const {
    T drawn = all[random.below(static_cast<std::uint32_t>(all.size()))];
    return mirrors(random) ? mirrored(std::move(drawn)) : drawn;
  }

  Gait draw_gait(Random& random) const {
    if (captured(random) && !assets.movements.gaits.empty()) return drawn_from(assets.movements.gaits, random);
    Gait gait = sample_gait(random);
    return mirrors(random) ? mirrored(std::move(gait)) : gait;
  }

  /// Draws poses of a posture without files.
  std::vector<Pose> draw_poses(Posture posture, int count, Random& random) const {
    constexpr int kTries = 40;
    std::vector<Pose> poses;
    for (int i = 0; i < kTries && int(poses.size()) < count; ++i) {
      const SampledPose drawn = sample_pose(recipe.pose.sampler, random, touch_m(recipe.pose));
      if (drawn.posture == posture) poses.push_back(mirrors(random) ? mirrored(drawn.pose) : drawn.pose);
    }
    return poses;
  }

  Movement draw_stay(Random& random) const {
    if (captured(random) && !assets.movements.stays.empty()) return drawn_from(assets.movements.stays, random);
    const std::vector<Pose> others = draw_poses(Posture::standing, 4, random);
    const auto seconds = float(random.uniform(3.0, 7.0));
    return fidget(sample_pose(only(&PoseSamplerOptions::idle), random).pose, others, seconds, random);
  }

  ClipPersonPlan draw_person(Random& random) const {
    constexpr int kStays = 3;
    ClipPersonPlan plan;
    plan.person = cast.draw_person(random);
    plan.can.leg_m = leg_length_m(plan.person.poser->mesh());
    plan.can.gait = draw_gait(random);
    for (int i = 0; i < kStays; ++i) plan.can.stays.push_back(draw_stay(random));
    if (asked(recipe.clip.falling_share, random)) {
      const Pose standing = sample_pose(only(&PoseSamplerOptions::idle), random).pose;
      plan.lies_down = fall_down(standing, sample_pose(only(&PoseSamplerOptions::lying), random).pose, random);
      return plan;
    }
    plan.walks = random.uniform() < recipe.clip.walking_share;
    if (plan.walks || plan.person.posture == Posture::standing) return plan;
    if (plan.person.posture == Posture::lying && captured(random) && !assets.movements.lie_downs.empty()) {
      plan.lies_down = drawn_from(assets.movements.lie_downs, random);
      return plan;
    }
    plan.stays_put = true;
    const std::vector<Pose> others = draw_poses(plan.person.posture, 4, random);
    plan.fidget = fidget(plan.person.pose, others, timing.seconds, random);
    if (plan.person.posture == Posture::sitting && asked(recipe.clip.seating_share, random)) {
      const Pose standing = sample_pose(only(&PoseSamplerOptions::idle), random).pose;
      plan.sits_down = sit_down(standing, plan.person.pose, random);
    }
    return plan;
  }

  /// Makes a clip. What finds no room is drawn anew a few times; the fullest is taken.
  ClipScene make(std::uint64_t clip) const {
    constexpr std::uint32_t kAttempts = 6;
    Random count_random = random_for(seed, Purpose::plan, clip_stream(clip, kWholeClip));
    const std::size_t count = cast.draw_count(count_random);
    ClipScene best;
    for (std::uint32_t attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t stream = clip_stream(clip, kWholeClip + 1 + attempt);
      Random random = random_for(seed, Purpose::plan, stream);
      std::vector<ClipPersonPlan> plans;
      for (std::size_t i = 0; i < count; ++i) plans.push_back(draw_person(random));
      ClipScene made = build_clip(recipe.clip, recipe.scene, recipe.camera, photographer.camera(), plans,
                                  timing.seconds, random_for(seed, Purpose::scene, stream));
      if (attempt == 0 || made.people.size() > best.people.size()) best = std::move(made);
      if (best.people.size() == count) break;
    }
    return best;
  }
};

ClipGenerator::ClipGenerator(const Recipe& recipe, BodiesAndMotions assets, const BodyModel& body, std::uint64_t seed,
                             const ClipTiming& timing) {
  check(timing);
  state_ = std::make_unique<State>(recipe, std::move(assets), body, seed, timing);
}

ClipGenerator::~ClipGenerator() = default;

int ClipGenerator::frames_per_clip() const { return state_->timing.frames(); }

std::shared_ptr<const ClipScene> ClipGenerator::clip(std::uint64_t clip) const {
  if (clip >= kMostClips) throw Error(fmt::format("clip {}, expected one below {}", clip, kMostClips));
  return state_->clips.get(clip, [&] { return state_->make(clip); });
}

LabelledFrame ClipGenerator::frame(std::uint64_t clip_number, int k) const {
  const State& s = *state_;
  if (k < 0 || k >= frames_per_clip()) {
    throw Error(fmt::format("frame {} of a clip, expected one below {}", k, frames_per_clip()));
  }
  const std::shared_ptr<const ClipScene> scene = clip(clip_number);
  const double time_s = k / s.timing.rate_hz;
  const BuiltScene built = scene_at(*scene, s.photographer.camera(), s.recipe.scene.detail_px, float(time_s));
  // Another camera has errors of its own.
  const auto camera = static_cast<std::uint32_t>(s.recipe.clip.seen_from);
  const PictureStreams streams{.frame = clip_stream(clip_number, camera << 24U | static_cast<std::uint32_t>(k)),
                               .camera = clip_stream(clip_number, kWholeClip + 16U * camera),
                               .is_clip = true};
  LabelledFrame frame = s.photographer.take(built, streams, fmt::format("{:04}_{:06}", clip_number, k));
  frame.frame.time_s = time_s;
  return frame;
}

LabelledFrame ClipGenerator::frame(std::uint64_t index) const {
  const auto count = static_cast<std::uint64_t>(frames_per_clip());
  return frame(index / count, int(index % count));
}

}  // namespace vesalius::synth
