#include "metrics/metric_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double ratio(double numerator, double denominator) { return denominator > 0.0 ? numerator / denominator : kNaN; }

/// Returns the mean of values. Those that are not known do not count.
double known_mean(const std::vector<double>& values) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    count += 1.0;
  }
  return ratio(sum, count);
}

/// Returns the mean of a family's members. Members that a resample lacks do not count in its mean.
Estimate mean_of(Metric metric, const std::vector<Estimate>& members) {
  Estimate mean{metric};
  for (const Estimate& member : members) mean.numerator += member.value;
  mean.denominator = double(members.size());
  mean.value = mean.numerator / mean.denominator;
  std::vector<double> values;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    values.clear();
    for (const Estimate& member : members) values.push_back(member.replicates[r]);
    mean.replicates.push_back(known_mean(values));
  }
  mean.interval = percentile_interval(mean.replicates);
  return mean;
}

/// Returns for each of `members` the root of its product with what `others` have of the same parameter, 0 if nothing.
std::vector<Estimate> roots(const std::vector<Estimate>& members, const std::vector<Estimate>& others) {
  std::vector<Estimate> values;
  for (const Estimate& member : members) {
    const Estimate* other = find_estimate(others, others.empty() ? Metric{} : others[0].id.metric, member.id.parameter);
    const auto value = [&](double first, double second) {
      if (std::isnan(first)) return kNaN;  // the resample has nobody
      return std::isnan(second) ? 0.0 : std::sqrt(first * second);
    };
    Estimate& result = values.emplace_back(Estimate{member.id});
    result.value = value(member.value, other != nullptr ? other->value : kNaN);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      result.replicates.push_back(value(member.replicates[r], other != nullptr ? other->replicates[r] : kNaN));
    }
  }
  return values;
}

Interval paired_interval(const Estimate& first, const Estimate& second) {
  std::vector<double> differences;
  const std::size_t count = std::min(first.replicates.size(), second.replicates.size());
  for (std::size_t r = 0; r < count; ++r) differences.push_back(second.replicates[r] - first.replicates[r]);
  return percentile_interval(std::move(differences));
}

Interval independent_interval(const Estimate& first, const Estimate& second, double difference) {
  const double down = std::hypot(second.value - second.interval.low, first.interval.high - first.value);
  const double up = std::hypot(second.interval.high - second.value, first.value - first.interval.low);
  return {difference - down, difference + up};
}

/// Returns whether a change is for the better; `up` says that it surely is one upwards.
bool is_better(const Comparison& change, bool up) {
  switch (info(change.id.metric).direction) {
    case MetricDirection::higher_is_better:
      return up;
    case MetricDirection::lower_is_better:
      return !up;
    default:
      return std::abs(change.second) < std::abs(change.first);
  }
}

}  // namespace

const Estimate* find_estimate(const std::vector<Estimate>& estimates, Metric metric, std::string_view parameter) {
  const auto found = std::ranges::find_if(
      estimates, [&](const Estimate& e) { return e.id.metric == metric && e.id.parameter == parameter; });
  return found == estimates.end() ? nullptr : &*found;
}

std::string text_with_interval(const Estimate& estimate) {
  const MetricUnit unit = info(estimate.id.metric).unit;
  const double scale = unit == MetricUnit::share ? 100.0 : 1.0;
  const int digits = metric_digits(estimate.id.metric);
  return fmt::format("{} ({:.{}f} to {:.{}f})", metric_text(estimate.id.metric, estimate.value),
                     scale * estimate.interval.low, digits, scale * estimate.interval.high, digits);
}

void MetricTable::add(std::uint64_t key, const MetricTerms& terms) {
  for (const MetricTerm& term : terms) {
    if (std::isfinite(term.numerator) && std::isfinite(term.denominator) && term.denominator >= 0.0) continue;
    throw Error(fmt::format("{}: {} of {}, expected finite numbers", term.id.name(), term.numerator, term.denominator));
  }
  frames_key_ += key * 0x9e3779b97f4a7c15ULL;  // a sum, so that the order does not matter
  const Weights weights = bootstrap_weights(key);
  for (const MetricTerm& term : terms) {
    const auto [found, is_new] = sums_.try_emplace({term.id.metric, term.id.parameter});
    Sums& sums = found->second;
    sums.place = is_new ? term.id.place : std::min(sums.place, term.id.place);
    sums.numerator += term.numerator;
    sums.denominator += term.denominator;
    for (std::size_t r = 0; r < kReplicates; ++r) {
      sums.numerators[r] += weights[r] * term.numerator;
      sums.denominators[r] += weights[r] * term.denominator;
    }
  }
}

Estimate MetricTable::estimate(MetricId id, const Sums& sums) {
  Estimate estimate{std::move(id)};
  estimate.numerator = sums.numerator;
  estimate.denominator = sums.denominator;
  estimate.value = ratio(sums.numerator, sums.denominator);
  for (std::size_t r = 0; r < kReplicates; ++r) {
    estimate.replicates.push_back(ratio(sums.numerators[r], sums.denominators[r]));
  }
  estimate.interval = info(estimate.id.metric).kind == MetricKind::trials ? wilson(sums.numerator, sums.denominator)
                                                                          : percentile_interval(estimate.replicates);
  return estimate;
}

std::vector<Estimate> MetricTable::estimates_of(Metric metric) const {
  std::vector<Estimate> estimates;
  for (const auto& [key, sums] : sums_) {
    if (key.first != metric || sums.denominator <= 0.0) continue;
    estimates.push_back(estimate({metric, sums.place, key.second}, sums));
  }
  std::ranges::stable_sort(estimates, {}, [](const Estimate& e) { return e.id.place; });
  return estimates;
}

std::vector<Estimate> MetricTable::estimates() const {
  std::vector<Estimate> all;
  for (const MetricInfo& metric : kMetrics) {
    std::vector<Estimate> some = estimates_of(metric.mean_of.value_or(metric.metric));
    if (metric.times) some = roots(estimates_of(*metric.times), some);
    if (metric.mean_of && !some.empty()) some = {mean_of(metric.metric, some)};
    std::ranges::move(some, std::back_inserter(all));
  }
  return all;
}

Comparison compare(const Estimate& first, const Estimate& second, bool paired) {
  Comparison result{first.id};
  result.first = first.value;
  result.second = second.value;
  result.difference = second.value - first.value;
  result.interval = paired ? paired_interval(first, second) : independent_interval(first, second, result.difference);
  const bool up = result.interval.low > 0.0;
  const bool down = result.interval.high < 0.0;
  if (up || down) {
    result.verdict = is_better(result, up) ? Comparison::Verdict::better : Comparison::Verdict::worse;
  }
  return result;
}

std::vector<Comparison> compare_common(const std::vector<Estimate>& first, const std::vector<Estimate>& second,
                                       bool paired) {
  std::vector<Comparison> all;
  for (const Estimate& estimate : first) {
    const Estimate* other = find_estimate(second, estimate.id.metric, estimate.id.parameter);
    if (other != nullptr) all.push_back(compare(estimate, *other, paired));
  }
  std::ranges::stable_sort(all, {}, [](const Comparison& c) { return c.id.metric; });
  return all;
}

const char* verdict_word(Comparison::Verdict verdict) {
  return verdict == Comparison::Verdict::better ? "better" : verdict == Comparison::Verdict::worse ? "worse" : "same";
}

std::string MetricId::name() const {
  std::string name(info(metric).name);
  if (info(metric).is_family()) name.replace(name.find('*'), 1, parameter);
  return name;
}

std::optional<MetricId> parse_metric(std::string_view name) {
  for (const MetricInfo& metric : kMetrics) {
    if (!metric.is_family()) {
      if (name == metric.name) return MetricId(metric.metric);
      continue;
    }
    const std::string_view before = metric.name.substr(0, metric.name.find('*'));
    const std::string_view behind = metric.name.substr(before.size() + 1);
    if (name.size() <= before.size() + behind.size() || !name.starts_with(before) || !name.ends_with(behind)) continue;
    name.remove_prefix(before.size());
    name.remove_suffix(behind.size());
    return MetricId(metric.metric, 0, std::string(name));
  }
  return std::nullopt;
}

const char* better_word(Metric metric) {
  switch (info(metric).direction) {
    case MetricDirection::higher_is_better:
      return "higher";
    case MetricDirection::lower_is_better:
      return "lower";
    default:
      return "zero";
  }
}

std::string metric_text(Metric metric, double value) {
  switch (info(metric).unit) {
    case MetricUnit::metres:
      return fmt::format("{:.3f} m", value);
    case MetricUnit::per_frame:
      return fmt::format("{:.3f} a frame", value);
    case MetricUnit::per_person:
      return fmt::format("{:.2f} a person", value);
    case MetricUnit::millimetres:
      return fmt::format("{:+.0f} mm", value);
    case MetricUnit::mm_per_s2:
      return fmt::format("{:.0f} mm/s^2", value);
    default:
      return fmt::format("{:.2f} %", 100.0 * value);
  }
}

std::string metric_difference_text(Metric metric, double difference) {
  switch (info(metric).unit) {
    case MetricUnit::metres:
      return fmt::format("{:+.3f} m", difference);
    case MetricUnit::per_frame:
      return fmt::format("{:+.3f}", difference);
    case MetricUnit::per_person:
      return fmt::format("{:+.2f}", difference);
    case MetricUnit::millimetres:
      return fmt::format("{:+.0f} mm", difference);
    case MetricUnit::mm_per_s2:
      return fmt::format("{:+.0f} mm/s^2", difference);
    default:
      return fmt::format("{:+.2f} %", 100.0 * difference);
  }
}

int metric_digits(Metric metric) {
  switch (info(metric).unit) {
    case MetricUnit::share:
    case MetricUnit::per_person:
      return 2;
    case MetricUnit::metres:
    case MetricUnit::per_frame:
      return 3;
    default:
      return 0;
  }
}

}  // namespace vesalius
