#include "view/source_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "io/sensors/sensor_drivers.h"
#include "io/sources/frames_inside.h"
#include "io/sources/recording_files.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostListed = 1000;  // entries of a folder; each folder among them is looked into

/// Returns whether a folder can be opened as it is: one with several recordings cannot.
bool opens_as_source(const std::string& folder) {
  try {
    return has_frames(folder) && (!has_recordings(folder) || !list_recording(folder).empty());
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::vector<SensorInfo> plugged_in_cameras() {
  std::vector<SensorInfo> all;
  for (const SensorDriver& driver : sensor_drivers()) {
    if (!driver.built) continue;
    try {
      for (const SensorInfo& camera : driver.list()) all.push_back({source_of(driver.scheme, camera.id), camera.name});
    } catch (const Error&) {  // a driver that is not installed has no cameras
    }
  }
  return all;
}

SourceChoice::SourceChoice(const std::string& folder, ListCameras cameras) : cameras_(std::move(cameras)) {
  std::error_code error;
  root_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(root_, error)) {
    throw Error(folder + ": no such folder, expected one below which the page may open sources");
  }
}

bool SourceChoice::is_below(const fs::path& real) const {
  return std::mismatch(root_.begin(), root_.end(), real.begin(), real.end()).first == root_.end();
}

bool SourceChoice::leads_out(const fs::directory_entry& entry) const {
  std::error_code error;
  if (!entry.is_symlink(error)) return false;
  const fs::path real = fs::canonical(entry.path(), error);
  return !error && !is_below(real);
}

fs::path SourceChoice::inside(const std::string& path) const {
  const fs::path asked(path);
  const auto refuse = [&](const std::string& why) {
    throw Error(fmt::format("{}: {}, expected what lies below {}", path, why, root_.string()));
  };
  if (asked.is_absolute()) refuse("an absolute path");
  if (std::ranges::find(asked, fs::path("..")) != asked.end()) refuse("a path with \"..\"");
  std::error_code error;
  fs::path real = fs::canonical(root_ / asked, error);
  if (error) refuse(error.message());
  if (!is_below(real)) refuse("a link that leads out");
  return real;
}

std::optional<ChoiceEntry> SourceChoice::entry_of(const fs::directory_entry& found) const {
  ChoiceEntry entry{.name = found.path().filename().string()};
  if (entry.name.starts_with('.') || leads_out(found)) return std::nullopt;
  std::error_code error;
  entry.is_folder = found.is_directory(error);
  if (entry.is_folder) {
    entry.opens = opens_as_source(found.path().string());
    return entry;
  }
  if (!has_recording_name(entry.name) || !found.is_regular_file(error)) return std::nullopt;
  entry.opens = true;
  entry.bytes = found.file_size(error);
  return entry;
}

ChoiceList SourceChoice::list(const std::string& folder) const {
  const fs::path real = inside(folder);
  ChoiceList list{.folder = folder};
  std::error_code error;
  fs::directory_iterator it(real, error);
  for (std::size_t looked_at = 0; !error && it != fs::directory_iterator(); it.increment(error)) {
    if (++looked_at > kMostListed) {
      ++list.left_out;
    } else if (auto entry = entry_of(*it)) {
      list.entries.push_back(std::move(*entry));
    }
  }
  if (error) throw Error(fmt::format("{}: {}, expected a folder", folder, error.message()));
  std::ranges::sort(list.entries, {}, &ChoiceEntry::name);
  return list;
}

std::string SourceChoice::source(const std::string& wish) const {
  if (is_camera(wish)) {
    const std::vector<SensorInfo> there = cameras_();
    if (std::ranges::find(there, wish, &SensorInfo::id) != there.end()) return wish;
    throw Error(wish + ": not plugged in, expected a camera that `vesalius cameras` lists");
  }
  const fs::path real = inside(wish);
  std::error_code error;
  if (!fs::is_directory(real, error)) return real.string();
  fs::recursive_directory_iterator it(real, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (!leads_out(*it)) continue;
    const std::string link = it->path().lexically_relative(root_).string();
    throw Error(fmt::format("{}: a link that leads out, expected what lies below {}", link, root_.string()));
  }
  return real.string();
}

}  // namespace vesalius
