#pragma once

#include <cstdint>

namespace vesalius {

/// The heading of a sample of the background, or of a person whose heading is not known.
inline constexpr std::uint8_t kNoHeading = 255;
/// Headings that samples tell apart: eighths of a turn, the first faces the camera (base/body_heading.h).
inline constexpr int kHeadings = 8;

/// A pixel from which a forest learns.
struct TrainingSample {
  std::uint32_t frame = 0;            ///< index in the set's FrameStore
  std::int16_t u = 0, v = 0;          ///< pixel
  std::uint16_t depth_mm = 0;         ///< its reading, never 0
  std::uint8_t label = 0;             ///< class of the forest: body part, or part_count for the background
  std::uint8_t heading = kNoHeading;  ///< the person's, below kHeadings
};

/// A person of a frame that no tree learns from: samples [begin, end) of a list.
struct PersonSamples {
  std::uint8_t heading = 0;
  std::uint32_t begin = 0, end = 0;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("heading", of.heading...)("begin", of.begin...)("end", of.end...);
  }
};

}  // namespace vesalius
