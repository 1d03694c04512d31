#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Compares names such that numbers in them count as numbers: frame_2 comes before frame_10. The order is total: two
/// different names are never equal.
bool natural_less(std::string_view a, std::string_view b);

/// Returns the extension of a path in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// Returns the files in `folder` whose extension (lower case, with its dot) is one of `extensions`, in natural order.
/// Hidden files are left out. Throws Error naming the folder if it cannot be read.
std::vector<std::filesystem::path> list_files(const std::string& folder, const std::vector<std::string>& extensions);

/// What the name of a picture says. The words of depth and of colour in it do not count for which go together:
/// "frame-000000.depth" and "frame-000000.color", "depth_0000" and "rgb_0000".
struct PictureName {
  enum class Role { unknown, depth, colour } role = Role::unknown;
  std::string key;               ///< the name without that word
  std::optional<double> time_s;  ///< time since 1970, or a number with a fraction, that the name begins with
};
PictureName parse_picture_name(const std::string& stem);

/// Returns what a folder and those in it hold by kinds of files; those of these files are taken for depth and colour.
std::vector<SourceItem> items_of(const std::string& folder, const std::vector<std::string>& depths = {},
                                 const std::vector<std::string>& colours = {});

/// The file beside pictures that has accelerations (acceleration_file.h).
inline constexpr const char* kAccelerationFile = "imu.csv";

/// Returns seconds of a time that counts milliseconds, microseconds or nanoseconds since 1970, as its size tells; other
/// times as they are, in seconds.
double clock_seconds(double time);

}  // namespace vesalius
