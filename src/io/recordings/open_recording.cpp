#include "io/recordings/open_recording.h"

#include <fmt/format.h>

#include "io/files/data_file.h"
#include "io/files/known_kind.h"
#include "io/recordings/mcap_writer.h"
#include "io/recordings/recording_formats.h"
#include "io/recordings/unpacked_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kSqlite = "SQLite format 3";
constexpr std::string_view kMatroska = "\x1A\x45\xDF\xA3";
constexpr std::string_view kPacked = "\x28\xB5\x2F\xFD";

std::unique_ptr<Recording> open_recording_in(DataFile file) {
  const std::string path = file.path();
  const std::string first = file.read(0, kKindBytes);
  if (first.starts_with(kMcapMagic)) return open_mcap(std::move(file));
  if (first.starts_with(kBagMagic)) return open_bag(std::move(file));
  if (first.starts_with(kSqlite)) return open_sqlite(std::move(file));
  if (first.starts_with(kMatroska) && file.has_name()) return open_mkv(path);
  throw Error(fmt::format("{}: {}, expected MCAP, a ROS 1 bag of version 2.0, a ROS 2 bag in SQLite, or Matroska", path,
                          file.size() == 0 ? "empty" : kind_or(first, "no recording that is known")));
}

}  // namespace

bool is_recording(std::string_view first) {
  return first.starts_with(kMcapMagic) || first.starts_with(kBagMagic) || first.starts_with(kSqlite) ||
         first.starts_with(kMatroska) || first.starts_with(kPacked);
}

std::unique_ptr<Recording> open_recording(const std::string& path) {
  DataFile file(path);
  const bool packed = file.read(0, kPacked.size()) == kPacked;
  return open_recording_in(packed ? unpack_file(file) : std::move(file));
}

}  // namespace vesalius
