#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"
#include "vesalius/person.h"
#include "vesalius/stage_times.h"
#include "vesalius/trace.h"

namespace vesalius {

/// What the page shows of one frame.
struct ViewedFrame {
  int number = 0;     ///< number of the frames that were detected, from 1
  double at_s = 0.0;  ///< its place in the source
  std::shared_ptr<const Frame> frame;
  TrackedFrame people;
  std::vector<Plane> planes;  ///< large flat surfaces
  StageTimes times;
  double track_ms = 0.0;             ///< time to follow people, beside the stages
  std::optional<Trace> trace;        ///< where somebody looks at the stages
  std::optional<double> latency_ms;  ///< from its arrival to its people
};

/// The messages of a frame, as pages want more or less of it.
struct FrameMessages {
  std::string plain;
  std::string with_stages;  ///< empty where there is no trace
};

/// Returns the binary messages of a frame (docs/formats.md): the length of a JSON text in four bytes, low ones first,
/// the text, and the pictures that the text lists, each packed: depth by RVL, colour as JPEG, labels as runs.
FrameMessages frame_messages(const ViewedFrame& viewed, const BodyModel& body);

/// Packs a picture as runs of equal values in row-major order: each is the value in one byte and the number of pixels
/// in base 128, low digits first, the highest bit set in all bytes but the last. Label pictures get a hundred times
/// smaller.
std::string pack_runs(const Image<std::uint8_t>& image);

}  // namespace vesalius
