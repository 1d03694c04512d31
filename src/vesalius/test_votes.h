#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "vesalius/base/body_heading.h"
#include "vesalius/base/random.h"
#include "vesalius/body_model.h"
#include "vesalius/labeller.h"

namespace vesalius::test {

/// Returns the mean of a true person's parts.
inline Eigen::Vector3f true_middle(const LabelledFrame& truth, std::size_t who) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& centre : truth.parts[who]) sum += centre;
  return sum / float(truth.parts[who].size());
}

/// A labeller that knows the truth of a frame: parts, and votes for the middles of its people that are off by
/// `noise_m` along each axis. What `labels` calls a part and `person` nobody's votes for places all around.
class VotingLabeller : public Labeller {
 public:
  VotingLabeller(LabelledFrame truth, float noise_m) : truth_(std::move(truth)), noise_m_(noise_m) {
    for (const auto& parts : truth_.parts) yaws_.push_back(body_yaw(parts, paper_body()).value_or(0.F));
  }

  void label_into(const Frame& frame, float /*gate*/, Posteriors& out) const override {
    const int parts = paper_body().part_count();
    out = {frame.camera.width, frame.camera.height, parts + 1, 255, {}};
    out.sums.assign(frame.depth.size() * static_cast<std::size_t>(out.classes), 0);
    for (int v = 0; v < out.height; ++v) {
      for (int u = 0; u < out.width; ++u) {
        const int label = truth_.labels(u, v);
        if (frame.depth(u, v) != 0) out.at(u, v)[label == kBackground ? parts : label] = 255;
      }
    }
    Random random(5);
    out.votes = Image<PersonVote>((out.width + kVoteStep - 1) / kVoteStep, (out.height + kVoteStep - 1) / kVoteStep);
    for (int row = 0; row < out.votes.height(); ++row) {
      for (int column = 0; column < out.votes.width(); ++column) {
        out.votes(column, row) = vote_at(frame, column * kVoteStep, row * kVoteStep, random);
      }
    }
  }

 private:
  PersonVote vote_at(const Frame& frame, int u, int v, Random& random) const {
    PersonVote vote;
    const int who = truth_.person(u, v);
    Eigen::Vector3f way = Eigen::Vector3f::Zero();
    if (who != kBackground) way = true_middle(truth_, who) - point_at(frame.camera, frame.depth, u, v);
    for (int axis = 0; axis < 3; ++axis) {
      const float off = who != kBackground ? noise_m_ * float(random.normal()) : 2.F * float(random.uniform()) - 1.F;
      vote.middle_mm[axis] = std::int16_t(std::lround(1e3F * (way[axis] + off)));
    }
    const float yaw = who != kBackground ? yaws_[who] : 6.3F * float(random.uniform());
    vote.heading = {std::int16_t(std::lround(8192.F * std::cos(yaw))),
                    std::int16_t(std::lround(8192.F * std::sin(yaw)))};
    return vote;
  }

  LabelledFrame truth_;
  float noise_m_;
  std::vector<float> yaws_;
};

}  // namespace vesalius::test
