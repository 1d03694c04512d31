#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vesalius/base/image.h"

namespace vesalius {

/// How OpenNI packs the 16-bit values of a picture in its recordings.
enum class OniPacking {
  differences,       ///< "16zP": values
  table_differences  ///< "16zT": indices into a table of the values that occur, which comes first
};

/// Unpacks a picture of 16-bit values. The first is stored as it is, the others as steps down from the one before: two
/// of -6 ... 6 in the halves of a byte, 2 to 30 pixels without a step in one, steps to 63 and new values behind an
/// escape. Throws Error naming `name` if there are not exactly `width` x `height` values.
Image<std::uint16_t> unpack_oni(std::string_view packed, OniPacking packing, int width, int height,
                                const std::string& name);

}  // namespace vesalius
