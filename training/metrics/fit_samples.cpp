#include "metrics/fit_samples.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "metrics/joint_metrics.h"
#include "metrics/match_people.h"
#include "vesalius/base/blended_depth.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/random.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/label_scene.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

std::uint64_t seed_of(const std::string& name) {
  std::uint64_t seed = 14695981039346656037ULL;  // FNV-1a, so that it is the same everywhere
  for (const char c : name) seed = (seed ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
  return seed;
}

/// The overlap of a candidate with people, in units of what a match needs.
struct Likeness {
  double as_person = 0.0;  ///< IoU with one person, or the larger share for the mask of all people
  double on_people = 0.0;  ///< share of its pixels on people
};

Likeness likeness(const Mask& mask, const FrameTruth& truth, const DepthImage& depth) {
  std::array<long, 256> of_person{};
  std::array<long, 256> shared{};
  long pixels = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const std::size_t who = !truth.person.empty() ? truth.person[i] : truth.mask[i] != 0 ? 0 : kBackground;
    ++of_person[who];
    if (mask[i] == 0) continue;
    ++shared[who];
    ++pixels;
  }
  if (pixels == 0) return {};
  const double on_people = double(pixels - shared[kBackground]) / double(pixels) / kShareOnMask;
  if (truth.person.empty()) {
    const double smaller = double(std::max(1L, std::min(pixels, of_person[0])));
    return {double(shared[0]) / smaller / kShareOnMask, on_people};
  }
  double best = 0.0;
  for (std::size_t who = 0; who < kBackground; ++who) {
    const auto either = double(of_person[who] + pixels - shared[who]);
    best = std::max(best, double(shared[who]) / either);
  }
  return {best / kMatchIou, on_people};
}

}  // namespace

std::vector<BoostSample> context_samples(const TrueFrame& frame, const Model& model, const DetectOptions& options) {
  if (frame.truth.labels.empty()) return {};
  const SceneLabeller scenes(model, {options.label, options.smooth, options.grow.plane});
  const std::optional<DepthImage> cleared = without_blended(frame.frame.depth, options.blend);
  const auto sample = [&](const Frame& grid, int step) {
    StageClock clock(nullptr);
    const SceneLabels scene = scenes.label_scene(grid, clock);
    const BodySurroundings around(scene.posteriors(), grid.depth, grid.camera, model.body);
    const int apart = step * around.step();
    Random random(seed_of(frame.frame.name));
    std::vector<BoostSample> samples;
    for (int row = 0; row < around.rows(); ++row) {
      for (int column = 0; column < around.columns(); ++column) {
        if (!around.is_open(column, row) || random.below(kContextEvery) != 0) continue;
        BoostSample& cell = samples.emplace_back();
        cell.features.resize(BodySurroundings::feature_count(model.body));
        around.features(column, row, cell.features.data());
        cell.positive = frame.truth.labels(column * apart, row * apart) != kBackground;
      }
    }
    return samples;
  };
  return on_grid(frame.frame, cleared ? *cleared : frame.frame.depth, options.grid, nullptr, sample,
                 [](const GridGuide&, const std::vector<BoostSample>&) {});
}

void add_trust_samples(const TrackedPerson& found, const std::vector<JointSet>& sets, const JointSet& set,
                       const std::vector<std::string>& names, const std::vector<Eigen::Vector3f>& truth,
                       std::vector<TrustSample>& samples) {
  if (!found.body) return;
  const std::vector<Joint>& joints = found.person.joints.at(static_cast<std::size_t>(&set - sets.data()));
  for (std::size_t n = 0; n < names.size(); ++n) {
    const FleshJoint* place = find_flesh_joint(builtin_flesh_joints(), set.name, names[n]);
    const auto defined = std::ranges::find(set.joints, names[n], &JointDefinition::name);
    if (place == nullptr || defined == set.joints.end() || !truth[n].allFinite()) continue;
    const Joint& joint = joints.at(static_cast<std::size_t>(defined - set.joints.begin()));
    if (joint.state == State::none) continue;
    const FittedBone& bone = found.body->bones.at(static_cast<std::size_t>(place->bone));
    const double error_m = double((joint.position - truth[n]).norm());
    samples.push_back({source_of(*found.body, bone), signals_of(*place, *found.body), error_m < kJointTolerance_m});
  }
}

std::vector<BoostSample> judge_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth) {
  std::vector<BoostSample> samples;
  const bool known = !truth.person.empty() || !truth.mask.empty();
  if (truth.people != 0 && !known) return samples;
  for (const Trace::Candidate& candidate : trace.candidates) {
    if (candidate.refined.found == 0 && candidate.group < 0) continue;  // the detector refuses it
    const Likeness like = truth.people == 0 ? Likeness{} : likeness(candidate.grown, truth, depth);
    const bool person = like.as_person >= 1.0;
    if (person || std::max(like.as_person, like.on_people) < 0.5) {
      samples.push_back({judge_features(candidate.evidence), person});
    }
  }
  return samples;
}

}  // namespace vesalius
