#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vesalius/stage_times.h"

namespace vesalius::cli {

/// A summary of many times in milliseconds: percentiles by nearest rank, the longest time and the mean.
struct Latency {
  double median = 0.0, p95 = 0.0, p99 = 0.0, longest = 0.0, mean = 0.0;
};

/// Summarises times; without times all numbers are zero.
Latency summarise(std::vector<double> ms);
nlohmann::ordered_json latency_json(const Latency& latency);

/// Collects the times of frames by stage and as a whole.
class FrameTimes {
 public:
  /// `read_ms` is the time to read the frame and `write_ms` that to write the people; both are negative if that was not
  /// done.
  void add(const StageTimes& stages, double read_ms, double write_ms);
  /// Adds the time to follow a frame's people.
  void add_tracking(double ms) { track_.push_back(ms); }
  /// Adds the time from a frame's arrival to its people.
  void add_latency(double ms) { latency_.push_back(ms); }

  std::size_t frames() const { return detect_.size(); }
  /// Returns the times of detection, without reading, following and writing.
  Latency detect() const { return summarise(detect_); }
  /// Returns the mean time to find and follow the people of a frame.
  double mean_people_ms() const { return detect().mean + summarise(track_).mean; }

  struct Row {
    std::string name;
    Latency latency;
  };
  /// Returns the rows "read", the detector's stages, "detect" (the sum of these stages), "track", "write" and
  /// "latency"; those without times are left out.
  std::vector<Row> rows() const;

 private:
  std::vector<StageTimes> stages_;
  std::vector<double> detect_, track_, read_, write_, latency_;
};

/// Returns a table for the terminal. Each row has the median, 95 %, 99 % and longest time in milliseconds.
std::string table(const FrameTimes& times);

}  // namespace vesalius::cli
