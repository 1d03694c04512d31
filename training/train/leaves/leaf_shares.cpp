#include "train/leaves/leaf_shares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vesalius {
namespace {

/// Returns integers in proportion to `factors`. The largest is 2^24 and none is 0.
std::vector<std::uint64_t> fixed_point(const std::vector<double>& factors) {
  constexpr double kLargest = 16777216.0;
  const double largest = factors.empty() ? 1.0 : *std::ranges::max_element(factors);
  std::vector<std::uint64_t> weights;
  for (const double factor : factors) {
    weights.push_back(static_cast<std::uint64_t>(std::max(1.0, std::round(kLargest * factor / largest))));
  }
  return weights;
}

}  // namespace

LeafShares::LeafShares(const SampleCounts& counts, int parts, const LeafOptions& options) {
  const std::vector<std::int64_t>& sampled = counts.samples;
  std::vector<double> factors(sampled.size(), 0.0);
  for (std::size_t c = 0; c < factors.size(); ++c) {
    if (sampled[c] == 0) continue;
    const double pixels = std::max<double>(double(counts.pixels[c]), 1.0);
    factors[c] = std::pow(pixels / double(sampled[c]), double(options.prior_correction));
  }
  weights_ = fixed_point(factors);
  if (options.part_balance == 0.F) return;
  factors.resize(parts);
  for (std::size_t c = 0; c < factors.size(); ++c) {
    if (sampled[c] == 0) continue;
    factors[c] *= std::pow(double(sampled[c]), -double(options.part_balance));
  }
  balance_ = fixed_point(factors);
}

/// Distributes the parts' total share anew.
void LeafShares::balance_parts(const std::int64_t* counts, std::vector<std::uint64_t>& shares) const {
  std::uint64_t before = 0;
  std::uint64_t after = 0;
  for (std::size_t c = 0; c < balance_.size(); ++c) {
    before += shares[c];
    after += static_cast<std::uint64_t>(counts[c]) * balance_[c];
  }
  if (after == 0) return;
  const double scale = double(before) / double(after);
  for (std::size_t c = 0; c < balance_.size(); ++c) {
    shares[c] = static_cast<std::uint64_t>(scale * double(counts[c]) * double(balance_[c]));
  }
}

TreeLeaf LeafShares::leaf(const std::int64_t* counts) const {
  std::vector<std::uint64_t> shares(weights_.size());
  for (std::size_t c = 0; c < shares.size(); ++c) shares[c] = static_cast<std::uint64_t>(counts[c]) * weights_[c];
  if (!balance_.empty()) balance_parts(counts, shares);
  const std::uint64_t total = std::accumulate(shares.begin(), shares.end(), std::uint64_t{0});
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t kept = std::min<std::size_t>(TreeLeaf::kClasses, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
      [&](std::size_t a, std::size_t b) { return shares[a] != shares[b] ? shares[a] > shares[b] : a < b; });
  TreeLeaf leaf;
  for (std::size_t k = 0; k < kept; ++k) {
    const std::uint64_t share = shares[order[k]] * 255 / total;
    if (share == 0) break;
    leaf.label[k] = static_cast<std::uint8_t>(order[k]);
    leaf.probability[k] = static_cast<std::uint8_t>(share);
  }
  return leaf;
}

}  // namespace vesalius
