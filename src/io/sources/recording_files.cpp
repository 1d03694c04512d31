#include "io/sources/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>

#include "io/sources/folder_source.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

/// Removes what stands behind the kind of a recording: "x.db3.zstd" becomes "x.db3".
fs::path without_state(const fs::path& path) {
  const std::string last = lower_extension(path);
  return last == ".active" || last == ".zstd" || last == ".zst" ? path.parent_path() / path.stem() : path;
}

/// Returns the number at the end of "x_12.bag".
std::optional<std::uint64_t> part_number(const std::string& path) {
  const std::string stem = without_state(path).stem().string();
  const std::size_t begin = stem.rfind('_') + 1;  // 0 where there is none
  std::uint64_t number = 0;
  const char* const end = stem.data() + stem.size();
  const auto [stop, error] = std::from_chars(stem.data() + begin, end, number);
  if (begin == 0 || error != std::errc() || stop != end) return std::nullopt;
  return number;
}

bool are_parts(const std::vector<std::string>& files) {
  std::set<std::optional<std::uint64_t>> numbers;
  for (const std::string& file : files) numbers.insert(part_number(file));
  return numbers.size() == files.size() && !numbers.contains(std::nullopt);
}

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code none;
  for (const fs::path& file : list_files(folder, {".mcap", ".bag", ".db3", ".mkv", ".active", ".zstd", ".zst"})) {
    const fs::path plain = without_state(file);
    const bool is_double = plain != file && fs::exists(plain, none);  // `ros2 bag play` leaves what it unpacked
    if (has_recording_name(file.string()) && !is_double) files.push_back(file.string());
  }
  return files;
}

}  // namespace

bool has_recording_name(const std::string& path) {
  constexpr std::array<std::string_view, 4> kRecorded{".mcap", ".bag", ".db3", ".mkv"};
  return std::ranges::find(kRecorded, lower_extension(without_state(path))) != kRecorded.end();
}

bool has_recordings(const std::string& folder) { return !recordings_in(folder).empty(); }

std::vector<std::string> list_recording(const std::string& folder) {
  std::vector<std::string> files = recordings_in(folder);
  std::error_code none;
  if (files.size() < 2 || fs::exists(fs::path(folder) / "metadata.yaml", none)) return files;
  if (!are_parts(files)) {
    throw Error(fmt::format(
        "{}: {} recordings, such as {} and {}: expected one of them, or parts of one (x_0.bag, x_1.bag)", folder,
        files.size(), fs::path(files[0]).filename().string(), fs::path(files[1]).filename().string()));
  }
  std::ranges::sort(files, {}, part_number);
  return files;
}

}  // namespace vesalius
