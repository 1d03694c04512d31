#include "io/sources/open_source.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "io/files/image_bytes.h"
#include "io/sources/folder_source.h"
#include "io/sources/list_source.h"
#include "io/sources/pcd_source.h"
#include "io/sources/tum.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

enum class Kind { unknown, folder, tum, pcd, png };

struct Location {
  Kind kind = Kind::unknown;
  std::string path;
};

Location split_scheme(const std::string& uri) {
  constexpr std::array<std::pair<std::string_view, Kind>, 4> kSchemes{
      {{"folder:", Kind::folder}, {"tum:", Kind::tum}, {"pcd:", Kind::pcd}, {"png:", Kind::png}}};
  for (const auto& [scheme, kind] : kSchemes) {
    if (uri.starts_with(scheme)) return {kind, uri.substr(scheme.size())};
  }
  return {Kind::unknown, uri};
}

/// Takes the scale off "walking:1000", unless there is a folder of that very name.
void split_scale(std::string& path, SourceOptions& options) {
  std::error_code ignored;
  const std::size_t colon = path.rfind(':');
  if (colon == path.npos || fs::exists(path, ignored)) return;
  float scale = 0.F;
  const char* end = path.data() + path.size();
  const auto [stop, error] = std::from_chars(path.data() + colon + 1, end, scale);
  if (error != std::errc() || stop != end) return;
  if (options.depth_scale) throw UsageError(path + ": the depth scale is given twice, here and as an option");
  options.depth_scale = scale;
  path.resize(colon);
}

bool has_extension(const std::string& path, std::string_view wanted) {
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == wanted;
}

Kind kind_of_file(const std::string& path) {
  if (has_extension(path, ".png")) return Kind::png;
  if (has_extension(path, ".pcd")) return Kind::pcd;
  throw Error(path + ": unknown kind of file, expected a folder, a depth PNG or a PCD file");
}

Kind kind_of_folder(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(fs::path(path) / "depth.txt", ignored)) return Kind::tum;
  if (fs::is_directory(fs::path(path) / "depth", ignored)) return Kind::folder;
  const bool png = !list_files(path, {".png"}).empty();
  const bool pcd = !list_files(path, {".pcd"}).empty();
  if (png && pcd) throw Error(path + ": PNG and PCD files in one folder, expected folder: or pcd: before the path");
  if (png) return Kind::folder;
  if (pcd) return Kind::pcd;
  throw Error(path + ": no frames, expected depth/*.png, depth.txt, *.png or *.pcd");
}

/// Throws unless there is a folder (true) or file (false) at `path`.
bool is_folder(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    const std::string why = error ? error.message() : "no such file or folder";
    throw Error(path + ": " + why + ", expected a folder, a depth PNG or a PCD file");
  }
  return fs::is_directory(status);
}

}  // namespace

std::unique_ptr<FrameSource> open_source(const std::string& uri, const SourceOptions& given) {
  auto [kind, path] = split_scheme(uri);
  SourceOptions options = given;
  if (kind == Kind::tum) split_scale(path, options);
  const bool folder = is_folder(path);
  if (kind == Kind::unknown) kind = folder ? kind_of_folder(path) : kind_of_file(path);
  if (!options.colour_file.empty() && (folder || kind != Kind::png)) {
    throw UsageError(path + ": a colour file goes with a single depth PNG only");
  }
  if (!folder && (kind == Kind::tum || kind == Kind::folder)) throw Error(path + ": a file, expected a folder");
  switch (kind) {
    case Kind::tum:
      return open_list(list_tum(path, options));
    case Kind::pcd:
      return open_pcd(path, options);
    default:
      return open_list(folder ? list_folder(path, options) : list_single_png(path, options));
  }
}

Frame make_frame(const Camera& camera, const std::uint16_t* depth_mm, std::size_t depth_stride, const std::uint8_t* rgb,
                 std::size_t rgb_stride) {
  check(camera);
  if (std::int64_t{camera.width} * camera.height > kMaxPixels) throw Error("frame buffers: more pixels than supported");
  if (depth_mm == nullptr) throw Error("frame buffers: no depth, expected a pointer to its first value");
  const auto width = static_cast<std::size_t>(camera.width);
  const std::size_t depth_bytes = width * sizeof(std::uint16_t);
  const std::size_t rgb_bytes = width * 3;
  if (depth_stride == 0) depth_stride = depth_bytes;
  if (rgb_stride == 0) rgb_stride = rgb_bytes;
  if (depth_stride < depth_bytes || rgb_stride < rgb_bytes) {
    throw Error(fmt::format("frame buffers: strides {} (depth) and {} (colour) bytes, expected at least {} and {}",
                            depth_stride, rgb_stride, depth_bytes, rgb_bytes));
  }
  Frame frame;
  frame.camera = camera;
  frame.depth = DepthImage(camera.width, camera.height);
  if (rgb != nullptr) frame.colour = ColourImage(camera.width, camera.height);
  const auto* depth_rows = reinterpret_cast<const char*>(depth_mm);
  static_assert(sizeof(Rgb) == 3);
  for (int v = 0; v < camera.height; ++v) {
    const auto row = static_cast<std::size_t>(v);
    std::memcpy(frame.depth.row(v), depth_rows + row * depth_stride, depth_bytes);
    if (rgb != nullptr) std::memcpy(static_cast<void*>(frame.colour.row(v)), rgb + row * rgb_stride, rgb_bytes);
  }
  return frame;
}

}  // namespace vesalius
