#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "vesalius/network/network.h"

namespace vesalius {

/// Where a picture inside a network lies, pixel after pixel, row after row. Narrow ones have a border of one pixel all
/// around, room for a multiple of kChannelStep channels, and behind the last row kReadAhead pixels that may be read.
struct PictureView {
  std::uint8_t* first = nullptr;  ///< pixel (0, 0)
  std::ptrdiff_t pixel_bytes = 0;
  std::ptrdiff_t row_bytes = 0;
  int width = 0;
  int height = 0;
  bool wide = false;

  std::uint8_t* at(int x, int y) const { return first + y * row_bytes + x * pixel_bytes; }
};
inline constexpr int kChannelStep = 4;
inline constexpr int kReadAhead = 20;

/// A convolution, arranged for one instruction set. Objects may be used from several threads at once.
class Convolver {
 public:
  /// For the best instruction set of this processor.
  static std::unique_ptr<const Convolver> make(const Convolution& convolution);

  virtual ~Convolver() = default;
  /// Bytes of a narrow value in memory, 1 or 2.
  virtual int narrow_bytes() const = 0;
  /// Writes rows `begin` to `end` - 1 of `out` and leaves its border alone. `added` is null where nothing is added.
  virtual void run(const PictureView& in, const PictureView* added, int begin, int end,
                   const PictureView& out) const = 0;
};

}  // namespace vesalius
