#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "console/text_sink.h"
#include "film/video.h"
#include "io/net/udp_sender.h"
#include "stream/osc_messages.h"
#include "vesalius/detect.h"
#include "vesalius/detect_stream.h"
#include "vesalius/person_json.h"

namespace vesalius::cli {

/// The outputs that `vesalius detect` writes.
struct OutputRequest {
  std::string json;    ///< path; "-" means standard output, empty means none
  std::string folder;  ///< folder for pictures; empty means none
  JsonOptions json_options;
  std::string udp, osc;  ///< addresses to which people are sent; empty means none
  OscOptions osc_options;
  std::vector<std::string> save;  ///< words of kSaveKinds; if empty and there is a folder, overlays
  double video_rate = 30.0;       ///< frames per second
  bool quiet = false;             ///< print no lines of text

  /// Returns whether each frame prints a line of text on standard output. It does so only if no other output is
  /// requested.
  bool lines() const { return !quiet && json.empty() && folder.empty() && udp.empty() && osc.empty(); }
};

inline const std::set<std::string> kSaveKinds = {"overlay", "parts", "labels", "mask", "cloud", "colour", "video"};

/// Throws UsageError for an invalid request.
void check(const OutputRequest& request);

/// Writes the outputs of each frame. Pictures appear one by one; JSON and video appear at `finish`, and without that
/// call they never do.
class DetectOutputs {
 public:
  /// Creates the folders. Throws Error if it cannot create them or cannot open a file.
  DetectOutputs(OutputRequest request, const BodyModel& body);
  /// Takes a frame without error, followed or not.
  void write(const FoundFrame& found);
  /// Completes JSON and video. `why_not_all` says why frames are missing and is repeated in the JSON; it is empty if
  /// none are.
  void finish(const std::string& why_not_all);
  /// Returns a line for each address to which something could not be sent.
  std::vector<std::string> losses() const;

 private:
  bool wants(const std::string& kind) const { return kinds_.contains(kind); }
  std::string path(const char* kind, const Frame& frame, const char* extension) const;
  void write_pictures(const Frame& frame, const TrackedFrame& found);
  void send(const TrackedFrame& people, const std::string& json);

  OutputRequest request_;
  std::set<std::string> kinds_;
  std::set<std::string> names_;  ///< names of frames with pictures
  const BodyModel& body_;
  std::optional<TextSink> json_;
  int frames_ = 0;  ///< number of frames written
  std::optional<VideoWriter> video_;
  std::optional<UdpSender> udp_, osc_;
};

/// Returns a line such as "0172: 2 people: 23 parts at 2.31 m (score 0.87), ...", or of people who are followed "0172:
/// 2 people: 1 tracked at 2.31 m (score 0.87), 2 hidden at 3.02 m"; the number before the state is the id.
std::string describe(const Frame& frame, const TrackedFrame& people);

}  // namespace vesalius::cli
