#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/lens/lens.h"
#include "vesalius/image.h"

namespace vesalius {

/// Turns pictures of a camera with a lens into those of a pinhole camera in its place. Where each pixel comes from is
/// worked out once.
class Rectification {
 public:
  /// `to` may differ from `from` in size, focal length and principal point. Throws Error if one has no size.
  Rectification(const LensCamera& from, const Camera& to);

  /// Returns the nearest reading to each pixel, so that no depths are mixed; 0 where the lens does not see.
  DepthImage depth(const DepthImage& picture) const;
  /// Returns colour between the four nearest pixels; black where the lens does not see.
  ColourImage colour(const ColourImage& picture) const;

 private:
  /// A place in the picture in 256ths of a pixel.
  struct Place {
    std::int32_t u = 0, v = 0;
  };
  int width_, height_;  ///< of the pictures that go in
  Camera to_;
  std::vector<Place> places_;  ///< of each pixel that comes out; outside of the picture where the lens does not see
};

/// Returns what turns pictures of a camera that distorts into those of `to`; nothing if there is none. A camera without
/// a size has that of `to`.
std::optional<Rectification> make_rectification(std::optional<LensCamera> distorted, const Camera& to);

}  // namespace vesalius
