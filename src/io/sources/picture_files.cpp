#include "io/sources/picture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <system_error>

#include "io/files/depth_picture.h"
#include "io/files/plain_text.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Role = PictureName::Role;

/// Returns the digits at `at` without leading zeros, and moves `at` past them.
std::string_view number_at(std::string_view text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

Role role_of_word(std::string_view word) {
  if (word.starts_with("depth")) return Role::depth;
  for (const std::string_view colour : {"rgb", "color", "colour", "image", "img"}) {
    if (word == colour || (colour.size() > 3 && word.starts_with(colour))) return Role::colour;
  }
  return Role::unknown;
}

/// Returns the time that a name is or begins with: seconds, milliseconds, microseconds or nanoseconds since 1970,
/// seconds and their fraction also with another sign between, or any number with a fraction of three digits or more.
std::optional<double> time_in(const std::string& name) {
  const std::size_t begin = std::min(name.find_first_of("0123456789"), name.size());
  const std::size_t point = std::min(name.find_first_not_of("0123456789", begin), name.size());
  const std::size_t end = std::min(name.find_first_not_of("0123456789", point + 1), name.size());
  if (begin == name.size() || (begin > 0 && name[begin - 1] == '.')) return std::nullopt;
  constexpr std::size_t kSecondsDigits = 10, kFewestDecimals = 3;
  const std::size_t whole = point - begin, decimals = end - std::min(point + 1, end);
  const bool dotted = point < name.size() && name[point] == '.' && decimals > 0;
  const bool fraction = dotted || (whole == kSecondsDigits && (decimals == 6 || decimals == 9));
  std::string text = name.substr(begin, (fraction ? end : point) - begin);
  if (fraction) text[whole] = '.';
  double time = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), time);
  const double seconds = clock_seconds(time);
  constexpr double kSince1998_s = 9e8, kUntil2128_s = 5e9;
  const bool clock = seconds > kSince1998_s && seconds < kUntil2128_s;
  const bool short_time = dotted && decimals >= kFewestDecimals && begin == 0 && end == name.size();
  return clock || short_time ? std::optional(seconds) : std::nullopt;
}

/// Returns the kind of a file as a pattern, or the file itself where it is no picture: "rgb/*.png", "meta.json".
std::string kind_of(const fs::path& path, const fs::path& root) {
  const fs::path folder = path.parent_path() == root ? fs::path() : path.parent_path().filename();
  const Role role = parse_picture_name(path.stem().string()).role;
  const std::string word = role == Role::depth ? "*depth*" : role == Role::colour ? "*color*" : "*";
  const std::string extension = lower_extension(path);
  const bool text = extension == ".json" || extension == ".txt" || extension.starts_with(".y") ||
                    path.filename() == kAccelerationFile;
  return (folder / (text ? path.filename().string() : word + extension)).string();
}

/// Returns the files of a folder and of those in it, as far as anybody wants to know of them.
std::vector<std::string> files_in(const std::string& folder) {
  constexpr std::size_t kMostFiles = 100'000;
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it.depth() > 0) it.disable_recursion_pending();
    std::error_code ignored;
    if (it->is_directory(ignored) || it->path().filename().string().front() == '.') continue;
    files.push_back(it->path().string());
    if (files.size() == kMostFiles) break;
  }
  return files;
}

}  // namespace

double clock_seconds(double time) {
  constexpr double kFirst_s = 9e8, kLast_s = 5e9;  // 1998 to 2128
  for (const double by : {1e3, 1e6, 1e9}) {
    if (time > kFirst_s * by && time < kLast_s * by) return time / by;
  }
  return time;
}

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

std::string lower_extension(const fs::path& path) { return lower(path.extension().string()); }

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

PictureName parse_picture_name(const std::string& stem) {
  PictureName name{Role::unknown, stem, {}};
  const std::string text = lower(stem);
  for (std::size_t begin = 0, end = 0; begin < text.size() && name.role == Role::unknown; begin = end + 1) {
    end = begin;
    while (end < text.size() && is_letter(text[end])) ++end;
    name.role = role_of_word(std::string_view(text).substr(begin, end - begin));
    // libfreenect and NYU: d-1294886360.208451-2996770081.pgm and r-...ppm.
    const bool one_letter =
        begin == 0 && end == 1 && end + 1 < text.size() && text[end] == '-' && is_digit(text[end + 1]);
    if (one_letter && text[0] == 'd') name.role = Role::depth;
    if (one_letter && text[0] == 'r') name.role = Role::colour;
    if (name.role == Role::unknown) continue;
    if (begin > 0 && !is_digit(text[begin - 1])) {
      --begin;
    } else if (end < text.size() && !is_digit(text[end])) {
      ++end;
    }
    name.key.erase(begin, end - begin);
  }
  // ZED: the left picture is that of depth.
  constexpr std::size_t kLeft = 4;
  if (name.role == Role::unknown && text.starts_with("left") && (text.size() == kLeft || !is_letter(text[kLeft]))) {
    name.role = Role::colour;
    name.key.erase(0, text.find_first_not_of("_-. ", kLeft));
  }
  name.time_s = time_in(name.key);
  return name;
}

std::vector<SourceItem> items_of(const std::string& folder, const std::vector<std::string>& depths,
                                 const std::vector<std::string>& colours) {
  std::map<std::string, SourceItem> items;
  const auto item_of = [&](const fs::path& path) -> SourceItem& {
    const std::string kind = kind_of(path, folder);
    SourceItem& item = items[kind];
    if (item.name.empty())
      item = {kind, lower_extension(path).substr(lower_extension(path).empty() ? 0 : 1), 0, "", ""};
    return item;
  };
  for (const std::string& file : files_in(folder)) ++item_of(file).count;
  for (const std::string& file : depths) item_of(file).use = "depth";
  for (const std::string& file : colours) item_of(file).use = "colour";
  std::vector<SourceItem> all;
  for (auto& [kind, item] : items) {
    const std::string extension = "." + item.holds;
    const auto& unread = unread_depth_extensions();
    if (item.use.empty() && std::ranges::find(unread, extension) != unread.end()) item.why = unread_advice(extension);
    if (extension == ".depth") item.why = "Record3D packs it by LZFSE; export PNG, or EXR + JPG";
    const bool elsewhere = depths.empty() && kind.find("/*depth*") != kind.npos;
    if (elsewhere && item.why.empty()) item.why = "give that folder as the source";
    const bool jpeg_of_depth = extension.starts_with(".jp") && kind.find("epth") != kind.npos;
    if (item.use.empty() && item.why.empty() && jpeg_of_depth) item.why = "JPEG loses depth, expected PNG of 16 bits";
    all.push_back(std::move(item));
  }
  return all;
}

}  // namespace vesalius
