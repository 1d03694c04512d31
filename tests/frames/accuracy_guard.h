#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// A metric of docs/metrics.md that was accepted once, and by how much it may be worse.
struct AcceptedMetric {
  std::string name;
  double value = 0.0;
  double tolerance = 0.0;
};

/// What was accepted of one model on one source: an entry of data/accuracy.toml.
struct AcceptedSet {
  std::string model;                      ///< file, relative to the project
  std::string source;                     ///< the same; "shared:real/room" is in the developers' folder of real frames
  int step = 1;                           ///< the first of every so many frames counts
  std::vector<std::string> missed;        ///< frames in which somebody was not found
  std::vector<std::string> false_people;  ///< frames in which somebody was found who is nobody
  std::vector<AcceptedMetric> metrics;

  bool shared() const { return source.starts_with("shared:"); }
};

/// What such a set comes to now.
struct MeasuredSet {
  int frames = 0;
  std::vector<std::string> missed;
  std::vector<std::string> false_people;
  std::map<std::string, double> metrics;
};

/// Reads data/accuracy.toml. Throws Error with the line for unknown or missing keys.
std::vector<AcceptedSet> parse_accuracy(std::string_view toml, const std::string& name);

/// Detects the people in a source's frames, with joints of data/joints/evaluation.toml. `source`: path of the set.
MeasuredSet measure(const AcceptedSet& set, const std::string& project, const std::string& source);

/// A line for each metric that is worse than accepted by more than its tolerance or gone, and if there is any, a line
/// for each kind of frames that changed. Empty: as good as before.
std::vector<std::string> what_got_worse(const AcceptedSet& accepted, const MeasuredSet& now);

/// The set as it is now, as an entry for data/accuracy.toml with the tolerances that were accepted.
std::string accuracy_toml(const AcceptedSet& accepted, const MeasuredSet& now);

}  // namespace vesalius
