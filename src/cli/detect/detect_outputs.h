#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/text_sink.h"
#include "io/files/video.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// What `vesalius detect` is to write, and where.
struct OutputRequest {
  std::string json;               ///< file, "-" = standard output, empty = none
  std::string folder;             ///< empty = no pictures
  std::vector<std::string> save;  ///< of kSaveKinds; empty with a folder = overlay
  double video_rate = 30.0;       ///< frames per second
  bool quiet = false;             ///< no lines of text

  /// Returns whether a line of text per frame goes to standard output: where nothing else is asked for.
  bool lines() const { return !quiet && json.empty() && folder.empty(); }
};

inline const std::set<std::string> kSaveKinds = {"overlay", "parts", "labels", "mask", "cloud", "video"};

/// Throws UsageError for a request that cannot be meant.
void check(const OutputRequest& request);

/// Everything written per frame. Pictures appear one by one, JSON and video at `finish`. Whoever does not call it
/// leaves neither.
class DetectOutputs {
 public:
  /// Makes the folders; throws Error when it cannot, or cannot open a file.
  DetectOutputs(OutputRequest request, const BodyModel& body);
  void write(const Frame& frame, const std::vector<Person>& people);
  /// Ends JSON and video. `why_not_all` says why frames are missing, which the JSON repeats; empty where none are.
  void finish(const std::string& why_not_all);

 private:
  bool wants(const std::string& kind) const { return kinds_.contains(kind); }
  std::string path(const char* kind, const Frame& frame, const char* extension) const;
  void write_pictures(const Frame& frame, const std::vector<Person>& people);

  OutputRequest request_;
  std::set<std::string> kinds_;
  std::set<std::string> names_;  ///< of frames with pictures
  const BodyModel& body_;
  std::optional<TextSink> json_;
  int frames_ = 0;  ///< written
  std::optional<VideoWriter> video_;
};

/// "0172: 2 people: 23 parts at 2.31 m (score 0.87), ...".
std::string describe(const Frame& frame, const std::vector<Person>& people);

}  // namespace vesalius::cli
