#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vesalius/base/stage_times.h"

namespace vesalius::cli {

/// What is said of many times, milliseconds: nearest ranks, the longest of all, the mean.
struct Latency {
  double median = 0.0, p95 = 0.0, p99 = 0.0, longest = 0.0, mean = 0.0;
};

/// All zero for no times.
Latency summarise(std::vector<double> ms);
nlohmann::ordered_json latency_json(const Latency& latency);

/// Times of frames, stage by stage and as a whole.
class FrameTimes {
 public:
  /// `read_ms` and `write_ms`: getting the frame and writing what was found, below 0 where that was not done.
  void add(const StageTimes& stages, double read_ms, double write_ms);

  std::size_t frames() const { return detect_.size(); }
  /// From frame to people, without reading and writing.
  Latency detect() const { return summarise(detect_); }

  struct Row {
    std::string name;
    Latency latency;
  };
  /// "read", the detector's stages, "detect" (all of these stages), "write".
  std::vector<Row> rows() const;

 private:
  std::vector<StageTimes> stages_;
  std::vector<double> detect_, read_, write_;
};

/// A table for the terminal, a line for each row: median, 95 %, 99 %, longest; milliseconds.
std::string table(const FrameTimes& times);

}  // namespace vesalius::cli
