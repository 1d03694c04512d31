#include "metrics/metric.h"

#include <fmt/format.h>

namespace vesalius {

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
