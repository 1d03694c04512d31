#include "io/sources/folder_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <tuple>

#include "io/files/depth_picture.h"
#include "io/files/plain_text.h"
#include "io/sources/source_items.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

using Role = PictureName::Role;

const std::vector<std::string> kColourExtensions{".png", ".jpg", ".jpeg", ".ppm", ".webp", ".tif", ".tiff", ".bmp"};

/// Returns what a folder is for: "kinectdepth" too, where names of pictures begin with the word.
Role role_of_folder(const std::string& name) {
  const Role role = parse_picture_name(name).role;
  if (role != Role::unknown) return role;
  if (name.ends_with("depth")) return Role::depth;
  return name.ends_with("color") || name.ends_with("rgb") || name.ends_with("wide") ? Role::colour : role;
}

/// Returns the folder in `root` whose name says most clearly what it has; nothing if none does.
std::optional<fs::path> child_of_role(const fs::path& root, Role role) {
  const std::vector<std::string> usual =
      role == Role::depth ? std::vector<std::string>{"depth"}
                          : std::vector<std::string>{"rgb", "color", "colour", "image", "images", "img"};
  std::vector<std::tuple<bool, std::ptrdiff_t, std::string, fs::path>> found;
  std::error_code error;
  for (fs::directory_iterator it(root, error), end; !error && it != end; it.increment(error)) {
    const std::string name = lower(it->path().filename().string());
    const auto rank = std::ranges::find(usual, name) - usual.begin() + (name.starts_with("left") ? 1 : 0);
    const bool shown = name.find("vis") != name.npos || name.find("preview") != name.npos ||
                       name.find("conf") != name.npos;  // depth in colours
    const bool is_usual = rank < std::ssize(usual);
    if (name.front() == '.' || !is_folder(it->path()) || (!is_usual && (shown || role_of_folder(name) != role)))
      continue;
    const auto files = list_files(it->path().string(), role == Role::depth ? depth_extensions() : kColourExtensions);
    const bool is_it = !files.empty() && (role == Role::colour || may_be_depth(files.front().string()));
    if (is_usual || !files.empty()) found.emplace_back(!is_it, rank, name, it->path());
  }
  if (found.empty()) return std::nullopt;
  return std::get<3>(*std::ranges::min_element(found));
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

/// Returns whether a name is that of pictures about those of depth: "0_depth_mask.npy" beside "0_depth.npy".
bool says_no_depth(const std::string& name) {
  const auto has = [&](const char* word) { return name.find(word) != name.npos; };
  return std::ranges::any_of(std::array{"mask", "seg", "label", "conf", "normal", "vis"}, has);
}

/// Returns whether a name is that of pictures that are shown for something else than what the camera saw.
bool says_other(const std::string& name) {
  return says_no_depth(name) || name.find("depth") != name.npos || name.find("ir") != name.npos;
}

/// Keeps the pictures for which `wanted` holds, if it does for one.
template <class Wanted>
void prefer(std::vector<Picture>& pictures, Wanted wanted) {
  if (std::ranges::any_of(pictures, wanted)) std::erase_if(pictures, [&](const Picture& p) { return !wanted(p); });
}

/// Keeps the pictures that can be depth, if one can, by the first of those whose names differ by digits alone.
void prefer_depths(std::vector<Picture>& pictures) {
  std::map<std::string, bool> kinds;
  prefer(pictures, [&](const Picture& p) {
    std::string kind = p.path.filename().string();
    std::erase_if(kind, is_digit);
    const auto [known, is_new] = kinds.try_emplace(kind);
    if (is_new) known->second = may_be_depth(p.path.string());
    return known->second;
  });
}

/// Returns the pictures of depth in a folder: of those that can be, all if it `is_for_depth` and none says so, else
/// those that say so, if some do; else those that do not say that they are of colour. All are of one kind of file.
std::vector<Picture> depths_in(const fs::path& folder, bool is_for_depth) {
  std::vector<Picture> depths = pictures_in(folder, depth_extensions());
  prefer_depths(depths);
  prefer(depths, [](const Picture& p) { return !says_no_depth(lower(p.stem)); });
  const auto says_depth = [](const Picture& p) { return p.name.role == Role::depth; };
  const bool is_said = std::ranges::any_of(depths, says_depth);
  if (!is_for_depth) prefer(depths, says_depth);
  if (!is_for_depth || is_said) prefer(depths, [](const Picture& p) { return p.name.role != Role::colour; });
  for (const std::string& extension : depth_extensions()) {
    const auto of_kind = [&](const Picture& p) { return lower_extension(p.path) == extension; };
    if (std::ranges::none_of(depths, of_kind)) continue;
    prefer(depths, of_kind);
    break;
  }
  return depths;
}

/// Returns the pictures of colour: those of a folder for them, else those beside depth that say so, are JPEG, or have
/// the names of `depths` without the word.
std::vector<Picture> colours_of(const fs::path& root, const std::optional<fs::path>& depth_folder,
                                const std::vector<Picture>& depths) {
  std::vector<Picture> colours;
  if (depth_folder) {
    if (const auto folder = child_of_role(root, Role::colour)) colours = pictures_in(*folder, kColourExtensions);
  } else {
    colours = pictures_in(root, kColourExtensions);
    std::set<std::string> names;
    for (const Picture& depth : depths) names.insert(depth.name.role == Role::depth ? depth.name.key : "");
    std::erase_if(colours, [&](const Picture& p) {
      const bool is_colour = lower_extension(p.path).starts_with(".jp") || names.contains(p.stem);
      return p.name.role == Role::depth || (p.name.role == Role::unknown && !is_colour);
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

constexpr const char* kNoName = "its name does not say colour, expected rgb, color or image";

/// Returns why what looks like colour is not taken; nothing of other files.
std::string why_no_colour(const SourceItem& item, std::size_t frames) {
  const fs::path name(item.name);
  const std::string folder = lower(name.parent_path().string());
  const auto is_one_of = [&](const std::vector<std::string>& all) { return std::ranges::count(all, item.holds) != 0; };
  const bool is_named =
      role_of_folder(folder) == Role::colour || parse_picture_name(name.stem().string()).role == Role::colour;
  if (is_named && is_one_of({"mp4", "mov", "avi", "mkv", "webm", "m4v"})) {
    return "films are not read; ffmpeg -i FILM -start_number 0 rgb/%06d.jpg makes pictures of one";
  }
  if (is_named && is_one_of({"bmp", "gif", "heic", "heif", "jp2", "raw", "yuv"}))
    return "not read, expected PNG or JPEG";
  const bool is_jpeg = is_one_of({"jpg", "jpeg"}) && !folder.empty() && item.count >= long(frames);
  return !is_named && is_jpeg && !says_other(folder) ? kNoName : "";
}

void note_colour_not_taken(FrameList& list) {
  for (SourceItem& item : list.items) {
    if (!item.use.empty() || !item.why.empty()) continue;
    item.why = why_no_colour(item, list.frames.size());
    if (item.why.empty()) continue;
    list.notes.push_back(fmt::format("{}: no colour: {}: {}", list.place, item.name, item.why));
    return;
  }
  if (fs::path(list.frames.front().depth).parent_path() != fs::path(list.place)) return;
  for (const Picture& p : pictures_in(list.place, {".png"})) {  // beside depth
    if (may_be_depth(p.path.string()) || says_other(lower(p.stem))) continue;
    list.notes.push_back(fmt::format("{}: no colour: {}: {}", list.place, p.path.filename().string(), kNoName));
    return;
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

}  // namespace

bool has_depth_folder(const std::string& folder) { return child_of_role(folder, Role::depth).has_value(); }

FrameList list_folder(const std::string& folder, const SourceOptions& options) {
  const std::optional<fs::path> depth_folder = child_of_role(folder, Role::depth);
  const fs::path place = depth_folder.value_or(folder);
  FrameList list;
  list.place = folder;
  std::vector<Picture> depths = depths_in(place, camera_folders(place).size() > 1);
  if (depths.empty()) {
    throw Error(with_items(place.string() + ": no frames, expected 16-bit depth PNG files", items_of(folder)));
  }
  sort_by_time(depths);
  for (const Picture& p : depths) list.frames.push_back({p.stem, p.name.time_s, p.path.string(), ""});
  const std::vector<Picture> colours = colours_of(folder, depth_folder, depths);
  add_colours(list, depths, colours);
  std::set<std::string> names;
  for (const Picture& p : colours) names.insert(p.stem);
  note_missing_colours(list, names.size());
  const std::vector<std::string> folders = depth_folder ? std::vector<std::string>{folder} : camera_folders(folder);
  list.facts = find_camera_facts(options, folders);
  for (const char* above : {"..", "../.."}) {  // Replica: the pictures are two folders below their calibration
    if (list.facts.has_focal() || !list.facts.sensor.empty() || !list.facts.lacks.empty()) break;
    const CameraFacts found = find_camera_facts({}, {(fs::path(folder) / above).string()});
    if (!found.has_focal()) continue;
    list.facts.fill_from(found);
    list.notes.push_back(fmt::format("{}: no calibration beside the pictures; taken from {}", folder, found.origin));
  }
  if (list.facts.rate_hz && !list.frames.front().time_s) add_times(list, *list.facts.rate_hz);
  add_items(list);
  add_up(list, folders);
  if (colours.empty()) note_colour_not_taken(list);
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
    std::vector<Picture> colours = in_depth_folder ? colours_of(folder / "..", folder, {}) : std::vector<Picture>();
    if (colours.empty() && depth.name.role == Role::depth) colours = colours_of(folder, {}, {depth});
    add_colours(list, {depth}, colours);
  }
  list.facts = find_camera_facts(options, {folder.string(), (folder / "..").string()});
  return list;
}

}  // namespace vesalius
