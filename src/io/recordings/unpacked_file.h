#pragma once

#include "io/files/data_file.h"

namespace vesalius {

/// Unpacks a file of zstd, as rosbag2 leaves it that compresses whole files, into a temporary one (in TMPDIR) that is
/// gone when it is closed. In messages it has the name of the packed one. Throws Error naming that if it is damaged, if
/// it unpacks to far more than its size, or if there is no room.
DataFile unpack_file(const DataFile& packed);

}  // namespace vesalius
