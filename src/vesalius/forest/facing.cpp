#include "vesalius/forest/facing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Least probability of a heading that a pixel can tell: what less is depends on chance.
constexpr float kLeastShare = 0.003F;
/// A pixel does not count for parts of less than this posterior, which saves time.
constexpr double kLeastShareOfPart = 0.01;
/// Parts with less of a person's pixels than this tell nothing of the heading.
constexpr double kLeastPart = 0.002;

/// The logarithm of every share in 1/65535, at least that of kLeastShare.
const std::vector<float>& logs_of_shares() {
  static const std::vector<float> kLogs = [] {
    std::vector<float> logs(65536);
    for (std::size_t i = 0; i < logs.size(); ++i) {
      logs[i] = std::log(std::max(float(i) / 65535.F, kLeastShare));
    }
    return logs;
  }();
  return kLogs;
}

bool has_turns(const Posteriors& posteriors, int u, int v) {
  return posteriors.settled.empty() || posteriors.settled(u, v) == 0;
}

}  // namespace

FacingEvidence::FacingEvidence(int parts, int headings)
    : parts_(parts),
      headings_(headings),
      logs_(static_cast<std::size_t>(parts) * headings, 0.0),
      shares_(parts, 0.0),
      of_pixel_(headings) {}

void FacingEvidence::add(const std::uint16_t* posteriors, const std::uint16_t* turns) {
  const int body = std::accumulate(posteriors, posteriors + parts_, 0);
  if (body == 0) return;
  const std::vector<float>& logs = logs_of_shares();
  float mean = 0.F;
  for (int h = 0; h < headings_; ++h) {
    const int share = turns[h] + turns[headings_ + h] + turns[2 * headings_ + h];
    of_pixel_[h] = logs[std::min(share, 65535)];
    mean += of_pixel_[h] / float(headings_);
  }
  const auto least = int(std::ceil(kLeastShareOfPart * body));
  for (int p = 0; p < parts_; ++p) {
    if (posteriors[p] < least) continue;
    const double share = double(posteriors[p]) / body;
    shares_[p] += share;
    for (int h = 0; h < headings_; ++h) {
      logs_[p * headings_ + h] += share * double(of_pixel_[h] - mean);
    }
  }
  pixels_ += 1.0;
}

Eigen::VectorXf FacingEvidence::features() const {
  Eigen::VectorXf features = Eigen::VectorXf::Zero(parts_ * headings_ + parts_ + 1);
  features[features.size() - 1] = 1.F;
  if (pixels_ == 0.0) return features;
  for (int p = 0; p < parts_; ++p) {
    features[parts_ * headings_ + p] = float(shares_[p] / pixels_);
    if (shares_[p] < kLeastPart * pixels_) continue;
    for (int h = 0; h < headings_; ++h) {
      features[p * headings_ + h] = float(logs_[p * headings_ + h] / shares_[p]);
    }
  }
  return features;
}

Eigen::VectorXf facing_features(const Posteriors& posteriors, int parts, const Mask& person, const Box& box) {
  FacingEvidence evidence(parts, posteriors.headings);
  for (int v = box.v; v < box.v + box.height; ++v) {
    for (int u = box.u; u < box.u + box.width; ++u) {
      if (person(u, v) == 0 || !has_turns(posteriors, u, v)) continue;
      evidence.add(posteriors.at(u, v), posteriors.turns_at(u, v));
    }
  }
  return evidence.features();
}

Eigen::VectorXf facing(const FacingModel& model, const Eigen::VectorXf& features) {
  const int headings = model.headings;
  if (model.empty()) return Eigen::VectorXf::Constant(headings, 1.F / float(headings));
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> weights(
      model.weights.data(), headings, static_cast<Eigen::Index>(model.features()));
  Eigen::VectorXf logits = weights * features;
  logits = (logits.array() - logits.maxCoeff()).exp();
  return logits / logits.sum();
}

YawEstimate estimate_yaw(const Eigen::VectorXf& facing) {
  const auto headings = int(facing.size());
  int best = 0;
  facing.maxCoeff(&best);
  YawEstimate estimate;
  float ahead = 0.F, aside = 0.F;
  for (const int h : {best - 1, best, best + 1}) {
    const float share = facing[(h + headings) % headings];
    const float yaw = 2.F * std::numbers::pi_v<float> * float(h) / float(headings);
    ahead += share * std::cos(yaw);
    aside += share * std::sin(yaw);
    estimate.confidence += share;
  }
  estimate.yaw_rad = std::atan2(aside, ahead);
  return estimate;
}

void turn_posteriors(const Posteriors& posteriors, const std::vector<std::uint8_t>& sides,
                     const Eigen::VectorXf& facing, const Box& box, Posteriors& out) {
  const auto parts = int(sides.size());
  const int headings = posteriors.headings;
  out.width = box.width;
  out.height = box.height;
  out.classes = posteriors.classes;
  out.whole = posteriors.whole;
  out.settled = posteriors.settled.empty() ? Mask{} : crop(posteriors.settled, box);
  out.sums.resize(static_cast<std::size_t>(box.width) * box.height * out.classes);
  parallel_ranges(box.height, kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < box.width; ++u) {
        const std::uint16_t* from = posteriors.at(box.u + u, box.v + v);
        std::uint16_t* to = out.at(u, v);
        std::copy_n(from, out.classes, to);
        if (!has_turns(posteriors, box.u + u, box.v + v)) continue;
        const std::uint16_t* turns = posteriors.turns_at(box.u + u, box.v + v);
        std::array<float, kSides> before{}, after{};
        for (int h = 0; h < headings; ++h) {
          float all = 0.F;
          for (int s = 0; s < kSides; ++s) all += float(turns[s * headings + h]);
          if (all == 0.F) continue;
          for (int s = 0; s < kSides; ++s) {
            const auto share = float(turns[s * headings + h]);
            before[s] += share;
            after[s] += facing[h] * share / all;
          }
        }
        const float total = before[0] + before[1] + before[2];
        std::array<float, kSides> scale{};
        for (int s = 0; s < kSides; ++s) scale[s] = before[s] > 0.F ? after[s] * total / before[s] : 0.F;
        for (int p = 0; p < parts; ++p) {
          to[p] = static_cast<std::uint16_t>(std::min(65535.F, float(from[p]) * scale[sides[p]] + 0.5F));
        }
      }
    }
  });
}

}  // namespace vesalius
