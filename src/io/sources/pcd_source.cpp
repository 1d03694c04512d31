#include "io/sources/pcd_source.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "io/files/read_file.h"
#include "io/sources/camera_file.h"
#include "io/sources/folder_source.h"
#include "io/sources/frame_times.h"
#include "io/sources/pcd.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

class PcdSource final : public FrameSource {
 public:
  PcdSource(std::vector<fs::path> files, CameraFacts facts) : files_(std::move(files)), facts_(std::move(facts)) {
    const Camera camera = read(files_.front()).camera;
    if (!facts_.fx) {
      notes_.push_back(fmt::format("{}: intrinsics estimated from its points: fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}",
                                   files_.front().string(), camera.fx, camera.fy, camera.cx, camera.cy));
    }
  }

  std::optional<Frame> next() override {
    if (next_ == files_.size()) return std::nullopt;
    return read(files_[next_++]);
  }

  int size() const override { return int(files_.size()); }
  std::optional<TimeSpan> span() const override { return TimeSpan{0.0, usual_time_s(files_.size() - 1)}; }
  void seek(double time_s) override { next_ = first_not_before(time_s, files_.size(), usual_time_s); }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  Frame read(const fs::path& file) {
    const std::string path = file.string();
    PointGrid grid = parse_pcd(read_file(path), path);
    CameraFacts facts = facts_;
    if (!facts.fx) facts.fill_from(estimate_camera(grid, path));
    std::vector<std::string> notes;
    const Camera camera =
        resolve_camera(facts, grid.points_m.width(), grid.points_m.height(), !grid.colour.empty(), path, notes);
    if (facts.distorted) {
      notes.push_back(facts.origin + ": lens distortion not removed: the grid of a cloud is taken as rectified");
    }
    if (next_ == 0) notes_ = std::move(notes);
    return {file.stem().string(), {}, camera, depth_of(grid), std::move(grid.colour)};
  }

  std::vector<fs::path> files_;
  CameraFacts facts_;
  std::vector<std::string> notes_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> open_pcd(const std::string& path, const SourceOptions& options) {
  std::vector<fs::path> files;
  fs::path folder(path);
  if (fs::is_directory(folder)) {
    files = list_files(path, {".pcd"});
    if (files.empty()) throw Error(path + ": no frames, expected *.pcd");
  } else {
    files.push_back(folder);
    folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  }
  return std::make_unique<PcdSource>(std::move(files), find_camera_facts(options, {folder.string()}));
}

}  // namespace vesalius
