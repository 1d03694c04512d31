#include "metrics/track_sample.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "metrics/heading.h"
#include "metrics/match_people.h"
#include "metrics/pixel_metrics.h"

namespace vesalius {
namespace {

constexpr std::array kTrunkWords{"shoulder", "hip", "spine", "torso", "pelvis"};

bool is_of_trunk(const std::string& joint) {
  return std::ranges::any_of(kTrunkWords, [&](const char* word) { return joint.find(word) != std::string::npos; });
}

std::optional<Eigen::Vector3f> known_mean(const std::vector<Eigen::Vector3f>& points) {
  if (std::ranges::all_of(points, [](const auto& point) { return point.hasNaN(); })) return std::nullopt;
  return mean_known(points);
}

double trunk_similarity(const FrameTruth& truth, std::size_t person, const TrackedPerson& found) {
  const auto trunk = true_trunk(truth, person);
  if (!trunk || !found.position.allFinite()) return 0.0;
  return std::max(0.0, 1.0 - double((*trunk - found.position).norm()) / kTrunkReach_m);
}

/// Returns what is known of one found person by itself.
Match::Kind alone(const TrackedPerson& found, const TrueFrame& frame) {
  const Proposal proposal{&found.person.mask, &found.person.skeleton, found.person.score};
  return match_people({proposal}, frame.truth, frame.frame.depth).front().kind;
}

/// The pixels with a reading of each true person.
std::vector<Mask> masks_of(const FrameTruth& truth, std::size_t people) {
  std::vector<Mask> masks(people, Mask(truth.person.width(), truth.person.height(), 0));
  for (std::size_t i = 0; i < truth.person.size(); ++i) {
    if (truth.person[i] < people) masks[truth.person[i]][i] = 1;
  }
  return masks;
}

bool is_blank(const Mask& mask) {
  return std::ranges::all_of(mask, [](std::uint8_t pixel) { return pixel == 0; });
}

void fill_similarity(const TrueFrame& frame, TrackPeople& people) {
  const FrameTruth& truth = frame.truth;
  const SimilarityKind kind = similarity_kind(truth);
  const auto most = std::ranges::max_element(people.truth);
  const std::size_t persons = most == people.truth.end() ? 0 : *most + 1;
  const std::vector<Mask> masks = kind == SimilarityKind::masks ? masks_of(truth, persons) : std::vector<Mask>{};
  people.sample.similarity.resize(static_cast<Eigen::Index>(people.truth.size()),
                                  static_cast<Eigen::Index>(people.found.size()));
  for (std::size_t t = 0; t < people.truth.size(); ++t) {
    for (std::size_t f = 0; f < people.found.size(); ++f) {
      const TrackedPerson& found = *people.found[f];
      const std::size_t who = people.truth[t];
      double similarity = 0.0;
      if (kind == SimilarityKind::masks && has_pixels(found) && !is_blank(masks[who])) {
        similarity = mask_iou(found.person.mask, masks[who], frame.frame.depth);
      } else if (kind == SimilarityKind::counts && has_pixels(found)) {
        similarity = alone(found, frame) == Match::Kind::person ? 1.0 : 0.0;
      } else if (kind != SimilarityKind::counts) {
        similarity = trunk_similarity(truth, who, found);
      }
      people.sample.similarity(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(f)) = similarity;
    }
  }
}

/// Returns the found people with pixels who are right or false, and with `hidden` all others who are not lost.
std::vector<const TrackedPerson*> taking_part(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden) {
  std::vector<const TrackedPerson*> visible, people;
  for (const TrackedPerson& person : tracked.people) {
    if (person.state == TrackState::lost) continue;
    if (has_pixels(person)) visible.push_back(&person);
    if (hidden && !has_pixels(person)) people.push_back(&person);
  }
  // Only where each true person's pixels are known can all be told from nobody.
  const bool all_count = hidden && similarity_kind(frame.truth) == SimilarityKind::masks;
  std::ranges::stable_sort(visible, std::ranges::greater{}, [](const auto* person) { return person->person.score; });
  std::vector<Proposal> proposals;
  for (const TrackedPerson* person : visible) {
    proposals.push_back({&person->person.mask, &person->person.skeleton, person->person.score});
  }
  const std::vector<Match> matches = match_people(proposals, frame.truth, frame.frame.depth);
  for (std::size_t i = 0; i < visible.size(); ++i) {
    if (all_count || matches[i].kind != Match::Kind::ignored) people.push_back(visible[i]);
  }
  std::ranges::sort(people, {}, &TrackedPerson::id);
  return people;
}

}  // namespace

bool has_pixels(const TrackedPerson& person) { return !is_blank(person.person.mask); }

SimilarityKind similarity_kind(const FrameTruth& truth) {
  if (!truth.person.empty()) return SimilarityKind::masks;
  return truth.joints.empty() && truth.parts.empty() ? SimilarityKind::counts : SimilarityKind::trunks;
}

std::optional<Eigen::Vector3f> true_trunk(const FrameTruth& truth, std::size_t person) {
  if (person < truth.joints.size()) {
    std::vector<Eigen::Vector3f> trunk;
    for (std::size_t j = 0; j < truth.joint_names.size(); ++j) {
      if (is_of_trunk(truth.joint_names[j])) trunk.push_back(truth.joints[person][j]);
    }
    if (const auto mean = known_mean(trunk)) return mean;
    if (const auto mean = known_mean(truth.joints[person])) return mean;
  }
  return person < truth.parts.size() ? known_mean(truth.parts[person]) : std::nullopt;
}

std::optional<TrackPeople> track_people_of(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden) {
  const FrameTruth& truth = frame.truth;
  const auto expected = static_cast<std::size_t>(expected_people(truth));
  if (truth.ids.size() < expected) return std::nullopt;
  TrackPeople people;
  const std::size_t count = hidden ? truth.ids.size() : expected;
  for (std::size_t who = 0; who < count; ++who) {
    people.truth.push_back(who);
    people.sample.truth.push_back(truth.ids[who]);
  }
  people.found = taking_part(frame, tracked, hidden);
  for (const TrackedPerson* person : people.found) people.sample.found.push_back(person->id);
  fill_similarity(frame, people);
  return people;
}

}  // namespace vesalius
