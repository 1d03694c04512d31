#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

/// How much frame_json tells of each person.
struct JsonOptions {
  std::string joints;  ///< name of the joint set; empty = all
  /// Leaves out what long lines are made of: body parts, fitted bodies, smoothed joints, and of joints pixels and why
  /// they are not observed.
  bool brief = false;
};

/// Returns one line of JSON, without its end, about a frame (docs/formats.md): its name, its time, its camera and the
/// people with their fields (stream/person_fields.h), parts and joints. Points are given in metres in the optical frame
/// (xyz_m) and in pixels of the depth picture (px). A frame that a live source got also has the time of its arrival
/// and, if `latency_ms` is given, how long its people took from then on; one that knows up has that. Every part and
/// joint is listed; where the state is "none" xyz_m and px are null, and where it is not "observed" unseen says why.
/// Where people are followed (docs/tracking.md) the frame has the floor and what happened. Throws UsageError if the
/// body has no such joint set.
std::string frame_json(const Frame& frame, const TrackedFrame& people, const BodyModel& body,
                       std::optional<double> latency_ms = {}, const JsonOptions& options = {});

/// Returns a frame's line as datagrams of at most `most` bytes: the line itself if it fits, otherwise a line for each
/// person with that one alone in `people`, and with `part` and `parts`: which of how many it is.
std::vector<std::string> json_datagrams(const std::string& line, std::size_t most);

/// Returns the line that closes a file of such lines: whether all frames of the source are in it, how many lines there
/// are, and where some are missing why. A file without it was cut.
std::string closing_json(int lines, bool complete, const std::string& why = "");

/// Returns the table that goes with label pictures: number, name, colour and mirror partner of each part.
std::string part_table_json(const BodyModel& body);

}  // namespace vesalius
