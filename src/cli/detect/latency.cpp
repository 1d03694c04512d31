#include "cli/detect/latency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vesalius::cli {

Latency summarise(std::vector<double> ms) {
  if (ms.empty()) return {};
  std::ranges::sort(ms);
  const auto count = double(ms.size());
  const auto rank = [&](double share) {
    return ms[static_cast<std::size_t>(std::max(1.0, std::ceil(share * count))) - 1];
  };
  return {rank(0.5), rank(0.95), rank(0.99), ms.back(), std::accumulate(ms.begin(), ms.end(), 0.0) / count};
}

nlohmann::ordered_json latency_json(const Latency& l) {
  const auto rounded = [](double value) { return std::round(value * 1e3) / 1e3; };
  return {{"median_ms", rounded(l.median)},
          {"p95_ms", rounded(l.p95)},
          {"p99_ms", rounded(l.p99)},
          {"longest_ms", rounded(l.longest)},
          {"mean_ms", rounded(l.mean)}};
}

void FrameTimes::add(const StageTimes& stages, double read_ms, double write_ms) {
  stages_.push_back(stages);
  detect_.push_back(stages.total());
  if (read_ms >= 0.0) read_.push_back(read_ms);
  if (write_ms >= 0.0) write_.push_back(write_ms);
}

std::vector<FrameTimes::Row> FrameTimes::rows() const {
  std::vector<Row> rows;
  if (!read_.empty()) rows.push_back({"read", summarise(read_)});
  for (std::size_t s = 0; s < kStageNames.size(); ++s) {
    std::vector<double> ms;
    for (const StageTimes& times : stages_) ms.push_back(times.ms[s]);
    rows.push_back({kStageNames[s], summarise(std::move(ms))});
  }
  rows.push_back({"detect", detect()});
  if (!track_.empty()) rows.push_back({"track", summarise(track_)});
  if (!write_.empty()) rows.push_back({"write", summarise(write_)});
  if (!latency_.empty()) rows.push_back({"latency", summarise(latency_)});
  return rows;
}

std::string table(const FrameTimes& times) {
  std::string text = fmt::format("{:<12}{:>9}{:>9}{:>9}{:>9}\n", "ms a frame", "median", "95 %", "99 %", "longest");
  for (const auto& [name, l] : times.rows()) {
    text += fmt::format("{:<12}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}\n", name, l.median, l.p95, l.p99, l.longest);
  }
  return text;
}

}  // namespace vesalius::cli
