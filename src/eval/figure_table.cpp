#include "eval/figure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Group {
  std::string_view prefix;
  std::string_view mean;
};
constexpr std::array<Group, 3> kGroups{{{"pixels.recall.", "pixels.mean_recall"},
                                        {"pixels.recall_inside.", "pixels.mean_recall_inside"},
                                        {"part.seen.", "part.mean_seen"}}};

double ratio(double numerator, double denominator) { return denominator > 0.0 ? numerator / denominator : kNaN; }

}  // namespace

FigureKind kind_of(std::string_view name) {
  FigureKind kind;
  kind.metres = name.ends_with("_m");
  kind.higher_is_better =
      !kind.metres && name != "people.false" && name != "frames.empty_with_person" && name != "pixels.body_on_empty";
  kind.trials = name == "people.found" || name == "frames.empty_with_person" || name.starts_with("posture.") ||
                name.starts_with("distance.") || name.starts_with("heading.") || name.starts_with("visible.") ||
                name.starts_with("motion.") || name.starts_with("part.seen.") ||
                (name.starts_with("joint.") && name.ends_with(".at_10cm"));
  return kind;
}

const Estimate* find_estimate(const std::vector<Estimate>& estimates, std::string_view name) {
  const auto found = std::ranges::find(estimates, name, &Estimate::name);
  return found == estimates.end() ? nullptr : &*found;
}

void FigureTable::add(std::uint64_t key, const FigureTerms& terms) {
  for (const FigureTerm& term : terms) {
    if (std::isfinite(term.numerator) && std::isfinite(term.denominator) && term.denominator >= 0.0) continue;
    throw Error(fmt::format("{}: {} of {}, expected finite numbers", term.name, term.numerator, term.denominator));
  }
  frames_key_ += key * 0x9e3779b97f4a7c15ULL;  // a sum, so that the order does not matter
  const Weights weights = bootstrap_weights(key);
  for (const FigureTerm& term : terms) {
    const auto [found, is_new] = index_.try_emplace(term.name, sums_.size());
    if (is_new) sums_.emplace_back().name = term.name;
    Sums& sums = sums_[found->second];
    sums.numerator += term.numerator;
    sums.denominator += term.denominator;
    for (std::size_t r = 0; r < kReplicates; ++r) {
      sums.numerators[r] += weights[r] * term.numerator;
      sums.denominators[r] += weights[r] * term.denominator;
    }
  }
}

Estimate FigureTable::estimate(const Sums& sums) {
  Estimate estimate;
  estimate.name = sums.name;
  estimate.numerator = sums.numerator;
  estimate.denominator = sums.denominator;
  estimate.value = ratio(sums.numerator, sums.denominator);
  for (std::size_t r = 0; r < kReplicates; ++r) {
    estimate.replicates.push_back(ratio(sums.numerators[r], sums.denominators[r]));
  }
  estimate.interval =
      kind_of(sums.name).trials ? wilson(sums.numerator, sums.denominator) : percentile_interval(estimate.replicates);
  return estimate;
}

/// Classes that a resample lacks do not count in its mean.
void FigureTable::add_group_mean(std::string_view group, std::string_view name,
                                 std::vector<Estimate>& estimates) const {
  std::vector<const Sums*> members;
  for (const Sums& sums : sums_) {
    if (sums.name.starts_with(group) && sums.denominator > 0.0) members.push_back(&sums);
  }
  if (members.empty()) return;
  Estimate mean;
  mean.name = name;
  for (const Sums* member : members) mean.numerator += ratio(member->numerator, member->denominator);
  mean.denominator = static_cast<double>(members.size());
  mean.value = mean.numerator / mean.denominator;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    double sum = 0.0;
    double count = 0.0;
    for (const Sums* member : members) {
      if (member->denominators[r] <= 0.0) continue;
      sum += member->numerators[r] / member->denominators[r];
      count += 1.0;
    }
    mean.replicates.push_back(ratio(sum, count));
  }
  mean.interval = percentile_interval(mean.replicates);
  estimates.push_back(std::move(mean));
}

std::vector<Estimate> FigureTable::estimates() const {
  std::vector<Estimate> estimates;
  for (const Sums& sums : sums_) {
    if (sums.denominator > 0.0) estimates.push_back(estimate(sums));
  }
  for (const Group& group : kGroups) add_group_mean(group.prefix, group.mean, estimates);
  return estimates;
}

}  // namespace vesalius
