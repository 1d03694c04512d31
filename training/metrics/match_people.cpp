#include "metrics/match_people.h"

#include <algorithm>
#include <cstddef>

namespace vesalius {
namespace {

/// The pixels with a reading of each true person, and how many of them a mask has.
struct Areas {
  std::vector<long> of_person;
  std::vector<long> shared;
  long of_mask = 0;
};

Areas areas(const Mask& mask, const Image<std::uint8_t>& person, const DepthImage& depth, std::size_t people) {
  Areas areas{std::vector<long>(people, 0), std::vector<long>(people, 0), 0};
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const std::size_t who = person[i];
    if (mask[i] != 0) ++areas.of_mask;
    if (who >= people) continue;
    ++areas.of_person[who];
    if (mask[i] != 0) ++areas.shared[who];
  }
  return areas;
}

Match match_by_iou(const Proposal& proposal, const FrameTruth& truth, const DepthImage& depth,
                   std::vector<bool>& taken) {
  const Areas a = areas(*proposal.mask, truth.person, depth, taken.size());
  int best_person = -1;
  double best = kMatchIou;
  for (std::size_t who = 0; who < taken.size(); ++who) {
    const long either = a.of_mask + a.of_person[who] - a.shared[who];
    const double iou = either > 0 ? double(a.shared[who]) / double(either) : 0.0;
    if (taken[who] || iou < best) continue;
    best = iou;
    best_person = int(who);
  }
  if (best_person < 0) return {};
  taken[best_person] = true;
  return {best_person < truth.people ? Match::Kind::person : Match::Kind::ignored, best_person};
}

bool lies_on(const Mask& found, const Mask& truth, const DepthImage& depth) {
  long pixels = 0;
  long true_pixels = 0;
  long inside = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    pixels += found[i] != 0 ? 1 : 0;
    true_pixels += truth[i] != 0 ? 1 : 0;
    inside += found[i] != 0 && truth[i] != 0 ? 1 : 0;
  }
  return inside > 0 && double(inside) >= kShareOnMask * double(std::min(pixels, true_pixels));
}

/// Returns the number of people of whom more is known than their pixels.
std::size_t person_count(const FrameTruth& truth) { return std::max(truth.parts.size(), truth.joints.size()); }

/// Puts a list of people, if there is one, into another order.
template <class T>
void reorder(std::vector<T>& list, const std::vector<std::size_t>& order) {
  if (list.empty()) return;
  std::vector<T> sorted;
  for (const std::size_t from : order) sorted.push_back(std::move(list[from]));
  list = std::move(sorted);
}

/// Returns the visible area, perpendicular to the viewing direction, of each person.
std::vector<double> visible_areas_cm2(const TrueFrame& frame) {
  const Camera& camera = frame.frame.camera;
  const double scale = 1e-2 / (double(camera.fx) * double(camera.fy));  // mm^2 to cm^2
  std::vector<double> areas(person_count(frame.truth), 0.0);
  for (std::size_t i = 0; i < frame.frame.depth.size(); ++i) {
    const std::size_t who = frame.truth.person[i];
    const double depth_mm = frame.frame.depth[i];
    if (who < areas.size()) areas[who] += depth_mm * depth_mm * scale;
  }
  return areas;
}

}  // namespace

void put_visible_people_first(TrueFrame& frame) {
  FrameTruth& truth = frame.truth;
  if (truth.person.empty()) return;
  const std::vector<double> area_cm2 = visible_areas_cm2(frame);
  std::vector<std::size_t> order;
  for (std::size_t who = 0; who < area_cm2.size(); ++who) {
    if (area_cm2[who] >= kVisiblePerson_cm2) order.push_back(who);
  }
  truth.people = int(order.size());
  for (std::size_t who = 0; who < area_cm2.size(); ++who) {
    if (area_cm2[who] < kVisiblePerson_cm2) order.push_back(who);
  }
  std::vector<std::uint8_t> new_index(area_cm2.size());
  for (std::size_t to = 0; to < order.size(); ++to) new_index[order[to]] = static_cast<std::uint8_t>(to);
  reorder(truth.parts, order);
  reorder(truth.joints, order);
  reorder(truth.postures, order);
  reorder(truth.statures_m, order);
  reorder(truth.ids, order);
  for (std::uint8_t& who : truth.person) who = who < new_index.size() ? new_index[who] : kBackground;
}

int expected_people(const FrameTruth& truth) { return truth.people < 0 ? 1 : truth.people; }

std::vector<Match> match_people(const std::vector<Proposal>& proposals, const FrameTruth& truth,
                                const DepthImage& depth) {
  const int expected = expected_people(truth);
  const Match surplus{truth.people < 0 ? Match::Kind::ignored : Match::Kind::nobody, -1};
  std::vector<bool> taken(person_count(truth), false);
  std::vector<Match> matches;
  int right = 0;
  for (const Proposal& proposal : proposals) {
    if (!truth.person.empty()) {
      matches.push_back(match_by_iou(proposal, truth, depth, taken));
    } else if (!truth.mask.empty() && !lies_on(*proposal.mask, truth.mask, depth)) {
      matches.push_back({Match::Kind::nobody, -1});
    } else if (right < expected) {
      matches.push_back({Match::Kind::person, right++});
    } else {
      matches.push_back(surplus);
    }
  }
  return matches;
}

std::vector<Proposal> distinct_proposals(const Trace& trace, float max_overlap) {
  std::vector<Proposal> proposals;
  if (trace.candidates.empty()) return proposals;
  Mask taken(trace.candidates.front().grown.width(), trace.candidates.front().grown.height(), 0);
  for (const Trace::Candidate& candidate : trace.candidates) {
    if (candidate.refined.found == 0) continue;
    long pixels = 0;
    long shared = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      pixels += candidate.grown[i] != 0 ? 1 : 0;
      shared += candidate.grown[i] != 0 && taken[i] != 0 ? 1 : 0;
    }
    if (float(shared) > max_overlap * float(pixels)) continue;
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] |= candidate.grown[i];
    proposals.push_back({&candidate.grown, &candidate.refined, candidate.score});
  }
  return proposals;
}

std::vector<Proposal> accepted_proposals(const std::vector<Person>& people) {
  std::vector<Proposal> proposals;
  for (const Person& person : people) proposals.push_back({&person.mask, &person.skeleton, person.score});
  return proposals;
}

}  // namespace vesalius
