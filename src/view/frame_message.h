#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/detection.h"

namespace vesalius {

/// What the page shows of one frame.
struct ViewedFrame {
  int number = 0;     ///< of the frames that were detected, from 1
  double at_s = 0.0;  ///< its place in the source
  std::shared_ptr<const Frame> frame;
  std::vector<Person> people;
  StageTimes times;
  std::optional<Trace> trace;        ///< where somebody looks at the stages
  std::optional<double> latency_ms;  ///< from its arrival to its people
};

/// Returns the binary message of a frame (docs/formats.md): the length of a JSON text in four bytes, low ones first,
/// the text, and the pictures that the text lists, each packed: depth by RVL, colour as JPEG, labels as runs.
/// The stages are in it if `with_stages` is true and there is a trace.
std::string frame_message(const ViewedFrame& viewed, const BodyModel& body, bool with_stages);

}  // namespace vesalius
