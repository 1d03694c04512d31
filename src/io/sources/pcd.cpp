#include "io/sources/pcd.h"

#include <fmt/format.h>
#include <lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <vector>

#include "io/files/data_file.h"
#include "io/files/image_bytes.h"
#include "io/sources/camera_file.h"
#include "io/sources/folder_source.h"
#include "io/sources/list_source.h"
#include "io/sources/pcd_header.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD files hold little-endian numbers");

constexpr std::size_t kMaxCloudBytes = std::size_t{1} << 30;

template <class T>
T load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

float load_coordinate(const PcdField& field, const char* at) {
  return field.size == 8 ? float(load<double>(at)) : load<float>(at);
}

/// Where a field's values lie in decoded bytes: the offset of the first one and the distance to the next point's.
struct Column {
  const char* first;
  std::size_t step;
  const char* at(std::size_t point) const { return first + point * step; }
};

template <class ColumnOf>
PointGrid gather(const PcdHeader& header, ColumnOf&& column_of) {
  PointGrid grid{Image<Eigen::Vector3f>(header.width, header.height, Eigen::Vector3f::Zero()), {}};
  for (int axis = 0; axis < 3; ++axis) {
    const PcdField& field = header.fields[header.xyz[axis]];
    const Column column = column_of(field);
    for (std::size_t i = 0; i < grid.points_m.size(); ++i)
      grid.points_m[i][axis] = load_coordinate(field, column.at(i));
  }
  if (header.rgb >= 0) {
    grid.colour = ColourImage(header.width, header.height);
    const Column column = column_of(header.fields[header.rgb]);
    for (std::size_t i = 0; i < grid.colour.size(); ++i) grid.colour[i] = unpack_rgb(load<std::uint32_t>(column.at(i)));
  }
  return grid;
}

PointGrid decode_binary(const PcdHeader& header, std::string_view data, const std::string& name) {
  const std::size_t expected = header.points() * header.point_bytes;
  if (data.size() < expected) {
    throw Error(fmt::format("{}: truncated: {} bytes of points, expected {}", name, data.size(), expected));
  }
  return gather(header, [&](const PcdField& field) { return Column{data.data() + field.offset, header.point_bytes}; });
}

/// Decodes compressed points. In this encoding all values of one field lie together.
PointGrid decode_compressed(const PcdHeader& header, std::string_view data, const std::string& name) {
  const std::size_t expected = header.points() * header.point_bytes;
  if (data.size() < 8) throw Error(name + ": truncated: expected two sizes after DATA binary_compressed");
  const std::size_t packed_bytes = load<std::uint32_t>(data.data());
  const std::size_t plain_bytes = load<std::uint32_t>(data.data() + 4);
  if (plain_bytes != expected) {
    throw Error(fmt::format("{}: {} bytes of points after decompression, expected {}", name, plain_bytes, expected));
  }
  if (packed_bytes > data.size() - 8) {
    throw Error(
        fmt::format("{}: truncated: {} bytes of compressed points, expected {}", name, data.size() - 8, packed_bytes));
  }
  // LZF's longest copy makes 264 bytes from 3, so so few bytes cannot hold more.
  if (plain_bytes / 88 > packed_bytes) throw Error(name + ": damaged: too few compressed bytes for its points");
  std::vector<char> plain(plain_bytes);
  const unsigned int got = lzf_decompress(data.data() + 8, static_cast<unsigned int>(packed_bytes), plain.data(),
                                          static_cast<unsigned int>(plain_bytes));
  if (got != plain_bytes) throw Error(name + ": damaged: its points cannot be decompressed");
  return gather(header, [&](const PcdField& field) {
    return Column{plain.data() + header.points() * field.offset, std::size_t{field.size} * field.count};
  });
}

/// Returns the next word of ascii data, or an empty one at the end.
std::string_view next_word(std::string_view& text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if(begin, text.end(), is_space);
  const std::size_t from = begin - text.begin();
  const std::string_view word = text.substr(from, end - begin);
  text.remove_prefix(from + word.size());
  return word;
}

template <class T>
bool parse_word(std::string_view word, T& value) {
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && stop == word.data() + word.size();
}

bool parse_colour(const PcdField& field, std::string_view word, Rgb& colour) {
  if (field.type == 'F') {  // the colour is stored in the bits of this number
    float bits = 0.F;
    if (!parse_word(word, bits)) return false;
    colour = std::isnan(bits) ? Rgb{} : unpack_rgb(std::bit_cast<std::uint32_t>(bits));
    return true;
  }
  std::int64_t packed = 0;
  if (!parse_word(word, packed)) return false;
  colour = unpack_rgb(static_cast<std::uint32_t>(packed));
  return true;
}

/// Stores one value of point `i`. Returns false if the word is not a number.
bool store_word(const PcdHeader& header, int field, std::string_view word, std::size_t i, PointGrid& grid) {
  if (field == header.rgb) return parse_colour(header.fields[field], word, grid.colour[i]);
  for (int axis = 0; axis < 3; ++axis) {
    if (field != header.xyz[axis]) continue;
    double value = 0.0;
    if (!parse_word(word, value)) return false;
    grid.points_m[i][axis] = float(value);
  }
  return true;
}

PointGrid decode_ascii(const PcdHeader& header, std::string_view data, const std::string& name) {
  if (data.size() / 2 + 1 < header.points() * 3) {
    throw Error(fmt::format("{}: truncated: {} bytes cannot hold {} points", name, data.size(), header.points()));
  }
  PointGrid grid{Image<Eigen::Vector3f>(header.width, header.height, Eigen::Vector3f::Zero()), {}};
  if (header.rgb >= 0) grid.colour = ColourImage(header.width, header.height);
  for (std::size_t i = 0; i < header.points(); ++i) {
    for (int field = 0; field < int(header.fields.size()); ++field) {
      for (std::uint32_t k = 0; k < header.fields[field].count; ++k) {
        const std::string_view word = next_word(data);
        if (word.empty()) throw Error(fmt::format("{}: truncated: ends at point {} of {}", name, i, header.points()));
        if (!store_word(header, field, word, i, grid)) {
          throw Error(fmt::format("{}: point {}: field {}: expected a number", name, i, header.fields[field].name));
        }
      }
    }
  }
  return grid;
}

/// A least-squares fit of pixel = focal * slope + centre over the points for which `use` holds.
struct LineFit {
  double n = 0, s = 0, p = 0, ss = 0, sp = 0;

  void add(double slope, double pixel) {
    n += 1;
    s += slope;
    p += pixel;
    ss += slope * slope;
    sp += slope * pixel;
  }
  double focal() const { return (n * sp - s * p) / (n * ss - s * s); }
  double centre() const { return (p - focal() * s) / n; }
};

struct GridFit {
  LineFit u, v;
  double off_px(const Eigen::Vector3f& point, int column, int row) const {
    return std::max(std::abs(u.focal() * point.x() / point.z() + u.centre() - column),
                    std::abs(v.focal() * point.y() / point.z() + v.centre() - row));
  }
};

bool has_reading(const Eigen::Vector3f& point) { return point.allFinite() && point.z() > 0.F; }

template <class Use>
GridFit fit_grid(const PointGrid& grid, Use&& use) {
  GridFit fit;
  for (int v = 0; v < grid.points_m.height(); ++v) {
    for (int u = 0; u < grid.points_m.width(); ++u) {
      const Eigen::Vector3f& point = grid.points_m(u, v);
      if (!has_reading(point) || !use(point, u, v)) continue;
      fit.u.add(double{point.x()} / point.z(), u);
      fit.v.add(double{point.y()} / point.z(), v);
    }
  }
  return fit;
}

namespace fs = std::filesystem;

class PcdSource final : public FrameSource {
 public:
  PcdSource(std::vector<fs::path> files, CameraFacts facts) : files_(std::move(files)), facts_(std::move(facts)) {
    const Camera camera = read(files_.front()).camera;
    if (!facts_.has_focal()) {
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
  bool is_sequence() const override { return false; }
  std::vector<std::string> notes() const override { return notes_; }
  std::vector<SourceItem> contents() const override {
    const fs::path& first = files_.front();
    return {{files_.size() == 1 ? first.filename().string() : "*.pcd", "points of rows and columns",
             long(files_.size()), "depth and colour", ""}};
  }

 private:
  Frame read(const fs::path& file) {
    const std::string path = file.string();
    PointGrid grid = parse_pcd(read_file(path), path);
    CameraFacts facts = facts_;
    if (!facts.has_focal()) facts.fill_from(estimate_camera(grid, path));
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

PointGrid parse_pcd(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw Error(name + ": empty file, expected a PCD");
  const PcdHeader header = parse_pcd_header(bytes, name);
  if (std::int64_t{header.width} * header.height > kMaxPixels ||
      header.point_bytes > kMaxCloudBytes / header.points()) {
    throw Error(fmt::format("{}: {}x{} points of {} bytes, expected at most {} bytes", name, header.width,
                            header.height, header.point_bytes, kMaxCloudBytes));
  }
  const std::string_view data = bytes.substr(header.data_begin);
  switch (header.encoding) {
    case PcdEncoding::ascii:
      return decode_ascii(header, data, name);
    case PcdEncoding::binary:
      return decode_binary(header, data, name);
    default:
      return decode_compressed(header, data, name);
  }
}

DepthImage depth_of(const PointGrid& grid) {
  DepthImage depth(grid.points_m.width(), grid.points_m.height());
  std::transform(grid.points_m.begin(), grid.points_m.end(), depth.begin(), [](const Eigen::Vector3f& point) {
    const float mm = std::round(point.z() * 1000.F);
    return mm >= 1.F && mm <= 65535.F ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};
  });
  return depth;
}

CameraFacts estimate_camera(const PointGrid& grid, const std::string& name) {
  constexpr double kOnGridPx = 1.0;
  constexpr double kMinShare = 0.9;
  const GridFit rough = fit_grid(grid, [](const Eigen::Vector3f&, int, int) { return true; });
  const GridFit fit =
      fit_grid(grid, [&](const Eigen::Vector3f& point, int u, int v) { return rough.off_px(point, u, v) < kOnGridPx; });
  const double focal[] = {fit.u.focal(), fit.v.focal()};
  const bool on_grid = fit.u.n >= 16 && fit.u.n >= kMinShare * rough.u.n;
  if (!on_grid || !(focal[0] > 0 && focal[0] < 1e6 && focal[1] > 0 && focal[1] < 1e6)) {
    throw Error(
        fmt::format("{}: its points lie on no pinhole camera's grid ({} of {} within {} px): expected intrinsics "
                    "in meta.json beside it or --fx, --fy, --cx, --cy",
                    name, fit.u.n, rough.u.n, kOnGridPx));
  }
  CameraFacts facts;
  facts.origin = name;
  facts.fx = float(focal[0]);
  facts.fy = float(focal[1]);
  facts.cx = float(fit.u.centre());
  facts.cy = float(fit.v.centre());
  return facts;
}

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
