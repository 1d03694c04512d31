#pragma once

#include <memory>

#include "io/files/data_file.h"
#include "io/recordings/recording.h"

namespace vesalius {

/// Opens an MCAP file. The data section alone is read, so that one without an end, as a process leaves it that was
/// killed, gives its whole messages. Throws Error naming the file.
std::unique_ptr<Recording> open_mcap(DataFile file);

}  // namespace vesalius
