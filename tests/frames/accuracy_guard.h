#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// The accepted value of a metric of docs/metrics.md, and its tolerance.
struct AcceptedMetric {
  std::string name;
  double value = 0.0;
  double tolerance = 0.0;
};

/// The accepted metrics of one model on one source: an entry of data/accuracy.toml.
struct AcceptedSet {
  std::string model;                ///< path relative to the project
  std::string source;               ///< path likewise; "shared:real/room" is in the developers' folder of real frames
  int step = 1;                     ///< only the first of every `step` frames counts
  std::vector<std::string> missed;  ///< frames in which a person was missed
  std::vector<std::string> false_people;  ///< frames with a false person
  std::vector<AcceptedMetric> metrics;

  bool shared() const { return source.starts_with("shared:"); }
};

/// The present metrics of such a set.
struct MeasuredSet {
  int frames = 0;
  std::vector<std::string> missed;
  std::vector<std::string> false_people;
  std::map<std::string, double> metrics;
};

/// Reads data/accuracy.toml. Throws Error with the line for unknown or missing keys.
std::vector<AcceptedSet> parse_accuracy(std::string_view toml, const std::string& name);

/// Measures the detection of people in a source's frames, with the joints of data/joints/evaluation.toml. `source` is
/// the path of the frames.
MeasuredSet measure(const AcceptedSet& set, const std::string& project, const std::string& source);

/// Returns a line for each metric that is missing or worse than accepted by more than its tolerance. If there is any,
/// lines for each kind of frames that changed follow. The list is empty if the set is as good as accepted.
std::vector<std::string> what_got_worse(const AcceptedSet& accepted, const MeasuredSet& now);

/// Returns the present metrics as an entry for data/accuracy.toml, with the accepted tolerances.
std::string accuracy_toml(const AcceptedSet& accepted, const MeasuredSet& now);

}  // namespace vesalius
