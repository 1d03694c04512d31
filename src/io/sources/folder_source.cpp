#include "io/sources/folder_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns the digits at `at` without leading zeros, and moves `at` past them.
std::string_view number_at(std::string_view text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

/// Returns the colour pictures of the folder `root` by stem. A PNG takes precedence over a JPEG of the same name.
std::map<std::string, std::string> list_colours(const fs::path& root) {
  std::map<std::string, std::string> by_stem;
  for (const char* name : {"rgb", "color", "colour"}) {
    if (!is_folder(root / name)) continue;
    for (const fs::path& path : list_files((root / name).string(), {".png", ".jpg", ".jpeg"})) {
      std::string& partner = by_stem[path.stem().string()];
      if (partner.empty() || lower_extension(path) == ".png") partner = path.string();
    }
    break;
  }
  return by_stem;
}

void note_missing_colours(FrameList& list, std::size_t colours) {
  const std::size_t with = std::count_if(list.frames.begin(), list.frames.end(),
                                         [](const FrameFiles& files) { return !files.colour.empty(); });
  if (colours != 0 && with != list.frames.size()) {
    list.notes.push_back(
        fmt::format("{}: {} of {} frames have no colour", list.place, list.frames.size() - with, list.frames.size()));
  }
  if (with != colours) {
    list.notes.push_back(
        fmt::format("{}: {} colour pictures have no depth picture of their name", list.place, colours - with));
  }
}

/// Returns the number that a whole name is; nothing for other names and for numbers that a double does not hold.
std::optional<double> whole_number(const std::string& name) {
  constexpr std::size_t kMostDigits = 15;
  if (name.empty() || name.size() > kMostDigits || !std::all_of(name.begin(), name.end(), is_digit))
    return std::nullopt;
  return std::stod(name);
}

/// Gives the frames the times that follow from their rate.
void add_times(FrameList& list, double rate_hz) {
  std::vector<double> numbers;
  for (const FrameFiles& files : list.frames) {
    const auto number = whole_number(files.name);
    if (!number || (!numbers.empty() && *number <= numbers.back())) break;
    numbers.push_back(*number);
  }
  const bool named = numbers.size() == list.frames.size();
  for (std::size_t i = 0; i < list.frames.size(); ++i) {
    list.frames[i].time_s = (named ? numbers[i] : double(i)) / rate_hz;
  }
}

/// Returns the folders that may describe the camera of the pictures in `folder`: itself and, for DIR/depth, DIR.
std::vector<std::string> camera_folders(const fs::path& folder) {
  std::vector<std::string> folders{folder.string()};
  std::error_code ignored;
  const fs::path absolute = fs::absolute(folder, ignored).lexically_normal();
  const fs::path named = absolute.has_filename() ? absolute : absolute.parent_path();
  if (named.filename() == "depth") folders.push_back((folder / "..").string());
  return folders;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = number_at(a, i);
      const std::string_view y = number_at(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // decides between 01 and 1
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::vector<fs::path> list_files(const std::string& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    const bool wanted = std::find(extensions.begin(), extensions.end(), lower_extension(path)) != extensions.end();
    if (wanted && path.filename().string().front() != '.') files.push_back(path);
  }
  if (error) throw Error(folder + ": folder cannot be read: " + error.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

FrameList list_folder(const std::string& folder, const SourceOptions& options) {
  const bool has_depth_folder = is_folder(fs::path(folder) / "depth");
  const std::string depth_folder = has_depth_folder ? (fs::path(folder) / "depth").string() : folder;
  FrameList list;
  list.place = folder;
  const auto colours = has_depth_folder ? list_colours(folder) : std::map<std::string, std::string>{};
  for (const fs::path& path : list_files(depth_folder, {".png"})) {
    const std::string stem = path.stem().string();
    const auto partner = colours.find(stem);
    list.frames.push_back({stem, {}, path.string(), partner == colours.end() ? "" : partner->second});
  }
  if (list.frames.empty()) throw Error(depth_folder + ": no frames, expected 16-bit depth PNG files");
  note_missing_colours(list, colours.size());
  list.facts = find_camera_facts(options, has_depth_folder ? std::vector<std::string>{folder} : camera_folders(folder));
  if (list.facts.rate_hz) add_times(list, *list.facts.rate_hz);
  return list;
}

FrameList list_single_png(const std::string& path, const SourceOptions& options) {
  const fs::path file(path);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  FrameList list;
  list.place = path;
  std::string colour = options.colour_file;
  if (colour.empty() && camera_folders(folder).size() > 1) {
    const auto colours = list_colours(folder / "..");
    if (const auto partner = colours.find(file.stem().string()); partner != colours.end()) colour = partner->second;
  }
  list.frames.push_back({file.stem().string(), {}, path, colour});
  list.facts = find_camera_facts(options, {folder.string(), (folder / "..").string()});
  return list;
}

}  // namespace vesalius
