#include "downloads/assets.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "downloads/packed_motion.h"
#include "downloads/unpack.h"
#include "folders/owned_folder.h"
#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".unfinished";

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// The folder of one installation, with a place for files that have no final name yet.
class Workplace {
 public:
  explicit Workplace(const std::string& folder) : unfinished_(folder + "/" + kUnfinished) {
    std::error_code error;
    for (fs::path path = fs::path(folder).lexically_normal(); !path.empty() && !fs::exists(path, error);
         path = path.parent_path()) {
      if (path.has_filename()) made_.push_back(path);  // "D/" is skipped, since it names D again
    }
    lock_.emplace(folder);
    clear();  // removes what a killed installation left
    fs::create_directory(unfinished_, error);
    if (error) throw Error(fmt::format("{}: cannot be written: {}", folder, error.message()));
  }
  ~Workplace() {
    clear();
    // Folders that this installation made are removed if they are still empty; a folder with files in it cannot be
    // removed this way.
    for (const fs::path& path : made_) {
      if (::rmdir(path.c_str()) != 0) break;
    }
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  std::string unfinished(const std::string& name) const { return unfinished_ + "/" + name; }

 private:
  void clear() const {
    std::error_code ignored;
    fs::remove_all(unfinished_, ignored);
  }

  std::string unfinished_;
  std::vector<fs::path> made_;      ///< folders that this installation made, innermost first
  std::optional<FolderLock> lock_;  ///< taken after `made_` is known
};

/// The installation of one package into a folder.
class Installation {
 public:
  Installation(const AssetPackage& package, const std::string& folder, const InstallWatch& watch, WebOptions options)
      : package_(package), folder_(folder), root_(folder + "/" + package.name), watch_(watch), options_(options) {
    options_.go_on = [this](std::uint64_t bytes) { return !watch_ || watch_(done_bytes_ + bytes, total_bytes_); };
    for (const AssetFile& file : package.files) {
      go_on();
      if (!holds(path_of(file), file.digest)) missing_.push_back(&file);
    }
  }

  void run(const std::string& mirror) {
    if (missing_.empty()) return;
    workplace_.emplace(folder_);
    if (mirror.empty()) return fetch_published();
    Origins origins;
    origins.push_back(std::make_unique<Origin>(mirror, options_));
    if (!fetch_archive(*origins.front())) fetch_files(origins, package_.name + "/");
  }

  InstallReport report() const { return {missing_.size(), package_.files.size() - missing_.size()}; }

 private:
  using Origins = std::vector<std::unique_ptr<Origin>>;

  std::string path_of(const AssetFile& file) const { return root_ + "/" + file.path; }
  std::unique_ptr<VerifiedFile> begin(const AssetFile& file) const {
    return std::make_unique<VerifiedFile>(path_of(file), workplace_->unfinished("file"), file.digest);
  }
  void go_on() const {
    if (!options_.go_on(0)) throw Error(package_.name + ": interrupted");
  }

  /// How a missing file is had, and the number of bytes that are fetched for it.
  struct Supply {
    std::uint64_t bytes = 0;
    std::function<void()> get;
  };

  void take(const std::vector<Supply>& supplies) {
    for (const Supply& supply : supplies) total_bytes_ += supply.bytes;
    for (const Supply& supply : supplies) {
      go_on();
      supply.get();
      done_bytes_ += supply.bytes;
    }
  }
  Supply fetched(const Origins& origins, const std::string& prefix, const AssetFile& file) const {
    return {file.digest.bytes, [this, &origins, prefix, &file] { fetch_file(origins, prefix, file); }};
  }
  void fetch_files(const Origins& origins, const std::string& prefix) {
    std::vector<Supply> supplies;
    for (const AssetFile* file : missing_) supplies.push_back(fetched(origins, prefix, *file));
    take(supplies);
  }
  void fetch_published() {
    Origins homes, sources;
    for (const std::string& home : package_.homes) homes.push_back(std::make_unique<Origin>(home, options_));
    for (const AssetSource& source : package_.sources) {
      sources.push_back(std::make_unique<Origin>(source.home, options_));
    }
    std::vector<Supply> supplies;
    for (const AssetFile* file : missing_) supplies.push_back(published(homes, sources, *file));
    take(supplies);
  }
  /// `sources` are those of the package, in its order.
  Supply published(const Origins& homes, const Origins& sources, const AssetFile& file) const {
    if (const auto enclosed = package_.enclosed.find(file.path); enclosed != package_.enclosed.end()) {
      return {0, [this, &file, &bytes = enclosed->second] { write(file, bytes); }};
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const auto found = package_.sources[i].originals.find(file.path);
      if (found == package_.sources[i].originals.end()) continue;
      return {found->second.digest.bytes,
              [this, &file, &original = found->second, &source = *sources[i]] { make(file, original, source); }};
    }
    return fetched(homes, "", file);
  }
  void write(const AssetFile& file, std::string_view bytes) const {
    const auto target = begin(file);
    target->write(bytes);
    target->commit();
  }
  void make(const AssetFile& file, const AssetOriginal& original, Origin& source) const {
    const std::string place = source.place_of(original.path);
    const std::string path = workplace_->unfinished("originals/" + file.path);
    if (!fetch_aside(source, original.path, original.digest, path)) {
      throw Error(fmt::format("{}: not found, expected the original of {}; --mirror takes the package from elsewhere",
                              place, path_of(file)));
    }
    try {
      write(file, packed_motion(read_file(path), file.path, original.skeleton));
    } catch (const Error& e) {
      throw Error(fmt::format("made from {}: {}", place, e.what()));
    }
    std::remove(path.c_str());
  }
  /// Fetches a checked file to `path`, which is below the workplace. Returns whether the origin has it.
  bool fetch_aside(Origin& origin, const std::string& name, const FileDigest& digest, const std::string& path) const {
    VerifiedFile file(path, workplace_->unfinished("aside"), digest);
    try {
      if (!origin.get(name, file)) return false;
      file.commit();
    } catch (const WrongBytes& e) {
      throw WrongBytes(fmt::format("{}: {}", origin.place_of(name), e.what()));
    }
    return true;
  }
  void fetch_file(const Origins& origins, const std::string& prefix, const AssetFile& file) const {
    if (origins.empty()) {
      throw Error(fmt::format("{}: no public address holds {}, expected a mirror with {}", package_.name, file.path,
                              package_.archive.path));
    }
    std::string refused;
    for (const auto& origin : origins) {
      const auto target = begin(file);
      try {
        if (!origin->get(prefix + file.path, *target)) continue;
        target->commit();
        return;
      } catch (const WrongBytes& e) {  // this home has another release; the next may have the right one
        if (refused.empty()) refused = fmt::format("{}: {}", origin->place_of(prefix + file.path), e.what());
      }
    }
    if (!refused.empty()) throw WrongBytes(refused);
    throw Error(fmt::format("{}: not found{}", origins.front()->place_of(prefix + file.path),
                            origins.size() > 1 ? ", nor at the other homes of " + package_.name : ""));
  }

  bool fetch_archive(Origin& mirror) {
    const std::string& name = package_.archive.path;
    const std::string path = workplace_->unfinished("checked-" + fs::path(name).filename().string());
    total_bytes_ = package_.archive.digest.bytes;
    if (!fetch_aside(mirror, name, package_.archive.digest, path)) {
      total_bytes_ = 0;
      return false;
    }
    done_bytes_ = total_bytes_;
    unpack_archive(path);
    return true;
  }
  void unpack_archive(const std::string& path) const {
    std::map<std::string, const AssetFile*> wanted;
    for (const AssetFile* file : missing_) wanted[package_.name + "/" + file->path] = file;
    std::unique_ptr<VerifiedFile> target;
    const auto take = [&](const std::string& member) {
      go_on();
      const auto found = wanted.find(member);
      if (found == wanted.end()) return false;
      target = begin(*found->second);
      wanted.erase(found);
      return true;
    };
    const auto finish = [&] {
      target->commit();
      target.reset();
    };
    unpack(path, {take, [&](std::string_view bytes) { target->write(bytes); }, finish});
    if (!wanted.empty()) {
      throw Error(fmt::format("{}: holds no {}", package_.archive.path, wanted.begin()->first));
    }
  }

  const AssetPackage& package_;
  std::string folder_;
  std::string root_;  ///< folder of the package
  std::optional<Workplace> workplace_;
  const InstallWatch& watch_;
  WebOptions options_;
  std::vector<const AssetFile*> missing_;
  std::uint64_t done_bytes_ = 0;
  std::uint64_t total_bytes_ = 0;
};

}  // namespace

std::string assets_folder() {
  if (const std::string own = variable("VESALIUS_ASSETS"); !own.empty()) return own;
  if (const std::string data = variable("XDG_DATA_HOME"); data.starts_with('/')) return data + "/vesalius";
  if (const std::string home = variable("HOME"); !home.empty()) return home + "/.local/share/vesalius";
  throw Error("no folder for assets: expected VESALIUS_ASSETS, XDG_DATA_HOME or HOME to be set");
}

std::string default_assets_folder() {
  try {
    return assets_folder();
  } catch (const Error&) {
    return "";
  }
}

bool has_assets(const AssetPackage& package, const std::string& folder) {
  for (const AssetFile& file : package.files) {
    const fs::path path = fs::path(folder) / package.name / file.path;
    std::error_code error;
    if (!fs::is_regular_file(path, error) || fs::file_size(path, error) != file.digest.bytes || error) return false;
  }
  return true;
}

std::function<std::string(const std::string& path)> asset_reader(const AssetPackage& package,
                                                                 const std::string& folder) {
  return [root = folder + "/" + package.name + "/"](const std::string& path) { return read_file(root + path); };
}

InstallReport install_assets(const AssetPackage& package, const std::string& folder, const std::string& mirror,
                             const InstallWatch& watch, WebOptions options) {
  Installation installation(package, folder, watch, std::move(options));
  installation.run(mirror);
  return installation.report();
}

}  // namespace vesalius
