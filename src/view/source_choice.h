#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/sensors/sensor.h"

namespace vesalius {

/// Something that lies in a folder, as a page lists it.
struct ChoiceEntry {
  std::string name = {};
  bool is_folder = false;
  bool opens = false;                        ///< whether it seems to be a recording or a folder of frames
  std::optional<std::uintmax_t> bytes = {};  ///< size of a recording's file
};

/// What lies in a folder.
struct ChoiceList {
  std::string folder = {};                ///< below the choice's own, which is ""
  std::vector<ChoiceEntry> entries = {};  ///< by name: folders, and files that are recordings by their names
  int left_out = 0;                       ///< more there are, which nobody looked at
};

/// Returns the cameras that are plugged in, by the drivers that start, with their sources as ids.
std::vector<SensorInfo> plugged_in_cameras();

/// Which sources pages may open: recordings and folders of frames below one folder, and cameras that are plugged in.
class SourceChoice {
 public:
  using ListCameras = std::function<std::vector<SensorInfo>()>;

  /// Throws Error if there is no such folder.
  explicit SourceChoice(const std::string& folder, ListCameras cameras = plugged_in_cameras);

  /// Returns the folder's absolute path without symbolic links.
  std::string folder() const { return root_.string(); }
  std::vector<SensorInfo> cameras() const { return cameras_(); }

  /// Returns what lies in a folder below this one. Names that begin with a dot and links that lead out are left out.
  /// Throws Error as `source`.
  ChoiceList list(const std::string& folder) const;

  /// Returns what open_source takes for a page's wish: a camera that is plugged in, or a path below the folder. Throws
  /// Error naming the wish for a camera that is not there, a path that does not exist, is absolute or has "..", and
  /// where a symbolic link, also one in the folder that is to be opened, leads out.
  std::string source(const std::string& wish) const;

 private:
  std::filesystem::path inside(const std::string& path) const;
  bool is_below(const std::filesystem::path& real) const;
  bool leads_out(const std::filesystem::directory_entry& entry) const;
  std::optional<ChoiceEntry> entry_of(const std::filesystem::directory_entry& found) const;

  std::filesystem::path root_;
  ListCameras cameras_;
};

}  // namespace vesalius
