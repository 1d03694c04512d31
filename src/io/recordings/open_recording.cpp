#include "io/recordings/open_recording.h"

#include <fmt/format.h>

#include "io/files/data_file.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/recording_formats.h"
#include "vesalius/error.h"

namespace vesalius {

std::unique_ptr<Recording> open_recording(const std::string& path) {
  constexpr std::string_view kSqlite = "SQLite format 3";
  constexpr std::string_view kMatroska = "\x1A\x45\xDF\xA3";
  DataFile file(path);
  const std::string first = file.read(0, 16);
  if (first.starts_with(kMcapMagic)) return open_mcap(std::move(file));
  if (first.starts_with(kBagMagic)) return open_bag(std::move(file));
  if (first.starts_with(kSqlite)) return open_sqlite(path);
  if (first.starts_with(kMatroska)) return open_mkv(path);
  throw Error(fmt::format("{}: {}, expected MCAP, a ROS 1 bag of version 2.0, a ROS 2 bag in SQLite, or Matroska", path,
                          file.size() == 0 ? "empty" : "no recording that is known"));
}

}  // namespace vesalius
