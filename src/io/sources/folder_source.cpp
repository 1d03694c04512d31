#include "io/sources/folder_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <tuple>

#include "io/files/depth_picture.h"
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

using Role = PictureName::Role;

const std::vector<std::string> kColourExtensions{".png", ".jpg", ".jpeg", ".ppm"};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

Role role_of_word(std::string_view word) {
  if (word.starts_with("depth")) return Role::depth;
  for (const std::string_view colour : {"rgb", "color", "colour", "image", "img"}) {
    if (word == colour || (colour.size() > 3 && word.starts_with(colour))) return Role::colour;
  }
  return Role::unknown;
}

/// Returns the folder in `root` whose name says most clearly what it has; nothing if none does.
std::optional<fs::path> child_of_role(const fs::path& root, Role role) {
  const std::vector<std::string> usual =
      role == Role::depth ? std::vector<std::string>{"depth"}
                          : std::vector<std::string>{"rgb", "color", "colour", "image", "images", "img"};
  std::vector<std::tuple<std::ptrdiff_t, std::string, fs::path>> found;
  std::error_code error;
  for (fs::directory_iterator it(root, error), end; !error && it != end; it.increment(error)) {
    const std::string name = lower(it->path().filename().string());
    const auto rank = std::ranges::find(usual, name) - usual.begin();
    const bool shown = name.find("vis") != name.npos || name.find("preview") != name.npos;  // depth in colours
    const auto& extensions = role == Role::depth ? depth_extensions() : kColourExtensions;
    const bool fits =
        rank < std::ssize(usual) || (!shown && parse_picture_name(name).role == role && is_folder(it->path()) &&
                                     !list_files(it->path().string(), extensions).empty());
    if (fits && name.front() != '.' && is_folder(it->path())) found.emplace_back(rank, name, it->path());
  }
  if (found.empty()) return std::nullopt;
  return std::get<2>(*std::ranges::min_element(found));
}

/// A picture by what its name says.
struct Picture {
  fs::path path;
  std::string stem;
  PictureName name;
};

std::vector<Picture> pictures_in(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<Picture> pictures;
  for (const fs::path& path : list_files(folder.string(), extensions)) {
    pictures.push_back({path, path.stem().string(), parse_picture_name(path.stem().string())});
  }
  return pictures;
}

/// Keeps the pictures for which `wanted` holds, if it does for one.
template <class Wanted>
void prefer(std::vector<Picture>& pictures, Wanted wanted) {
  if (std::ranges::any_of(pictures, wanted)) std::erase_if(pictures, [&](const Picture& p) { return !wanted(p); });
}

/// Returns the pictures of depth in a folder: all, if it `is_for_depth`; else those that say so, if some do; else those
/// that do not say that they are of colour. All are of one kind of file.
std::vector<Picture> depths_in(const fs::path& folder, bool is_for_depth) {
  std::vector<Picture> depths = pictures_in(folder, depth_extensions());
  if (!is_for_depth) {
    prefer(depths, [](const Picture& p) { return p.name.role == Role::depth; });
    prefer(depths, [](const Picture& p) { return p.name.role != Role::colour; });
  }
  for (const std::string& extension : depth_extensions()) {
    const auto of_kind = [&](const Picture& p) { return lower_extension(p.path) == extension; };
    if (std::ranges::none_of(depths, of_kind)) continue;
    prefer(depths, of_kind);
    break;
  }
  return depths;
}

/// Returns the pictures of colour: those of a folder for them, else those beside depth that say so or are JPEG.
std::vector<Picture> colours_of(const fs::path& root, const std::optional<fs::path>& depth_folder) {
  std::vector<Picture> colours;
  if (depth_folder) {
    if (const auto folder = child_of_role(root, Role::colour)) colours = pictures_in(*folder, kColourExtensions);
  } else {
    colours = pictures_in(root, kColourExtensions);
    std::erase_if(colours, [](const Picture& p) {
      const std::string extension = lower_extension(p.path);
      return p.name.role == Role::depth ||
             (p.name.role == Role::unknown && extension != ".jpg" && extension != ".jpeg");
    });
  }
  // A PNG takes precedence over a JPEG of the same name.
  std::ranges::stable_sort(colours, {}, [](const Picture& p) { return lower_extension(p.path) != ".png"; });
  return colours;
}

/// Returns the whole number that a name ends with.
std::string last_number(const std::string& name) {
  std::size_t begin = name.size();
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  const std::size_t first = std::min(name.find_first_not_of('0', begin), name.size() - 1);
  return begin == name.size() ? "" : name.substr(first);
}

/// Returns the whole number that comes first in a name.
std::string first_number(const std::string& name) {
  const std::size_t begin = name.find_first_of("0123456789");
  if (begin == name.npos) return {};
  return last_number(name.substr(0, name.find_first_not_of("0123456789", begin)));
}

/// Gives each frame the colour that `of` names alike, unless it does not tell depth pictures apart. Returns how many
/// got one.
template <class Of>
std::size_t pair_by(std::vector<FrameFiles>& frames, const std::vector<Picture>& depths,
                    const std::vector<Picture>& colours, Of of) {
  std::map<std::string, std::string> paths;
  for (const Picture& colour : colours) paths.emplace(of(colour), colour.path.string());
  std::set<std::string> names;
  for (const Picture& depth : depths) names.insert(of(depth));
  if (names.size() != depths.size()) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const std::string name = of(depths[i]);
    const auto found = name.empty() ? paths.end() : paths.find(name);
    if (found == paths.end()) continue;
    frames[i].colour = found->second;
    ++count;
  }
  return count;
}

std::vector<TumEntry> entries_of(const std::vector<Picture>& pictures) {
  std::vector<TumEntry> entries;
  for (const Picture& p : pictures) {
    if (p.name.time_s) entries.push_back({*p.name.time_s, p.stem, p.path.string()});
  }
  std::ranges::stable_sort(entries, {}, &TumEntry::time_s);
  return entries;
}

/// Gives each frame the colour that goes with it by name. Depth must be in the order of its times, if it has some.
void add_colours(FrameList& list, const std::vector<Picture>& depths, const std::vector<Picture>& colours) {
  if (pair_by(list.frames, depths, colours, [](const Picture& p) { return p.stem; }) != 0) return;
  if (pair_by(list.frames, depths, colours, [](const Picture& p) { return p.name.key; }) != 0) return;
  const std::vector<TumEntry> depth = entries_of(depths), colour = entries_of(colours);
  if (depth.size() == depths.size() && !colour.empty()) {
    const std::vector<int> partners = associate(depth, colour, kMaxTimeDifferenceS);
    for (std::size_t i = 0; i < partners.size(); ++i) {
      if (partners[i] >= 0) list.frames[i].colour = colour[std::size_t(partners[i])].file;
    }
    return;
  }
  if (pair_by(list.frames, depths, colours, [](const Picture& p) { return last_number(p.stem); }) != 0) return;
  // Redwood: the picture's number, then its camera's time.
  if (pair_by(list.frames, depths, colours, [](const Picture& p) { return first_number(p.stem); }) != 0) return;
  if (depths.size() == 1 && colours.size() == 1) list.frames.front().colour = colours.front().path.string();
}

void note_missing_colours(FrameList& list, std::size_t colours) {
  const std::size_t with = std::count_if(list.frames.begin(), list.frames.end(),
                                         [](const FrameFiles& files) { return !files.colour.empty(); });
  if (colours != 0 && with != list.frames.size()) {
    list.notes.push_back(
        fmt::format("{}: {} of {} frames have no colour", list.place, list.frames.size() - with, list.frames.size()));
  }
  if (with != colours) {
    list.notes.push_back(fmt::format("{}: {} colour pictures have no depth picture of their name{}", list.place,
                                     colours - with, list.frames.front().time_s ? " or time" : ""));
  }
}

/// Returns the number that a whole name is; nothing for other names and for numbers that a double does not hold.
std::optional<double> whole_number(const std::string& name) {
  constexpr std::size_t kMostDigits = 15;
  if (name.empty() || name.size() > kMostDigits || !std::all_of(name.begin(), name.end(), is_digit))
    return std::nullopt;
  return std::stod(name);
}

/// Puts pictures whose names are times in their order; without all of these, takes the times away.
void sort_by_time(std::vector<Picture>& pictures) {
  if (std::ranges::all_of(pictures, [](const Picture& p) { return p.name.time_s.has_value(); })) {
    std::ranges::stable_sort(pictures, {}, [](const Picture& p) { return *p.name.time_s; });
  } else {
    for (Picture& p : pictures) p.name.time_s.reset();
  }
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
  if (parse_picture_name(named.filename().string()).role == Role::depth) folders.push_back((folder / "..").string());
  return folders;
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
  const bool text = extension == ".json" || extension == ".txt" || extension.starts_with(".y");
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

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
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
  name.time_s = time_in(name.key);
  return name;
}

std::string with_items(const std::string& message, const std::vector<SourceItem>& items) {
  std::string text = message + "\n" + to_text(items);
  text.pop_back();
  return text;
}

std::vector<SourceItem> items_of(const std::string& folder, const std::vector<FrameFiles>& frames) {
  std::map<std::string, SourceItem> items;
  const auto item_of = [&](const fs::path& path) -> SourceItem& {
    const std::string kind = kind_of(path, folder);
    SourceItem& item = items[kind];
    if (item.name.empty())
      item = {kind, lower_extension(path).substr(lower_extension(path).empty() ? 0 : 1), 0, "", ""};
    return item;
  };
  for (const std::string& file : files_in(folder)) ++item_of(file).count;
  for (const FrameFiles& files : frames) {
    item_of(files.depth).use = "depth";
    if (!files.colour.empty()) item_of(files.colour).use = "colour";
  }
  std::vector<SourceItem> all;
  for (auto& [kind, item] : items) {
    const std::string extension = "." + item.holds;
    const auto& unread = unread_depth_extensions();
    if (item.use.empty() && std::ranges::find(unread, extension) != unread.end()) item.why = unread_advice(extension);
    if (frames.empty() && kind.find("/*depth*") != kind.npos) item.why = "give that folder as the source";
    const bool jpeg_of_depth = extension.starts_with(".jp") && kind.find("epth") != kind.npos;
    if (item.use.empty() && jpeg_of_depth) item.why = "JPEG loses depth, expected PNG of 16 bits";
    all.push_back(std::move(item));
  }
  return all;
}

bool has_depth_folder(const std::string& folder) { return child_of_role(folder, Role::depth).has_value(); }

FrameList list_folder(const std::string& folder, const SourceOptions& options) {
  const std::optional<fs::path> depth_folder = child_of_role(folder, Role::depth);
  const fs::path place = depth_folder.value_or(folder);
  FrameList list;
  list.place = folder;
  std::vector<Picture> depths = depths_in(place, camera_folders(place).size() > 1);
  if (depths.empty()) {
    throw Error(with_items(place.string() + ": no frames, expected 16-bit depth PNG files", items_of(folder, {})));
  }
  sort_by_time(depths);
  for (const Picture& p : depths) list.frames.push_back({p.stem, p.name.time_s, p.path.string(), ""});
  const std::vector<Picture> colours = colours_of(folder, depth_folder);
  add_colours(list, depths, colours);
  std::set<std::string> names;
  for (const Picture& p : colours) names.insert(p.stem);
  note_missing_colours(list, names.size());
  std::vector<std::string> folders = depth_folder ? std::vector<std::string>{folder} : camera_folders(folder);
  folders.push_back((fs::path(folder) / "intrinsic").string());  // ScanNet
  list.facts = find_camera_facts(options, folders);
  if (list.facts.rate_hz && !list.frames.front().time_s) add_times(list, *list.facts.rate_hz);
  list.items = items_of(folder, list.frames);
  return list;
}

FrameList list_single_picture(const std::string& path, const SourceOptions& options) {
  const fs::path file(path);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  FrameList list;
  list.place = path;
  list.frames.push_back({file.stem().string(), {}, path, options.colour_file});
  const Picture depth{file, file.stem().string(), parse_picture_name(file.stem().string())};
  if (options.colour_file.empty()) {
    const bool in_depth_folder = camera_folders(folder).size() > 1;
    std::vector<Picture> colours = in_depth_folder ? colours_of(folder / "..", folder) : std::vector<Picture>();
    if (!in_depth_folder && depth.name.role == Role::depth) colours = colours_of(folder, {});
    add_colours(list, {depth}, colours);
  }
  list.facts = find_camera_facts(options, {folder.string(), (folder / "..").string()});
  return list;
}

}  // namespace vesalius
