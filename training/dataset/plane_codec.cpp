#include "dataset/plane_codec.h"

#include <algorithm>
#include <vector>

#include "io/files/packed.h"

namespace vesalius {
namespace {

constexpr int kLevel = 1;  // higher levels save less than 3 % of depth and take several times as long
constexpr std::size_t kValues = 65536;
constexpr std::size_t kWidestNumber = 3;  // bytes of a varint of at most 2 x 65536
constexpr unsigned kEscape = 255;         // this symbol's number is in the wide stream

void write_packed(ByteWriter& out, std::string_view raw) { out.bytes() += pack(raw, kLevel); }

std::size_t pixels(int width, int height) { return std::size_t(width) * height; }

/// Predicts a reading from its neighbours (the median predictor of LOCO-I); holes are left out.
class Prediction {
 public:
  Prediction(const Image<std::uint16_t>& ranks, int v)
      : here_(ranks.row(v)), above_(v > 0 ? ranks.row(v - 1) : nullptr) {}

  int at(int u) {
    const int left = u > 0 ? here_[u - 1] : 0;
    const int above = above_ != nullptr ? above_[u] : 0;
    if (left != 0) last_ = left;
    if (left == 0) return above != 0 ? above : last_;
    if (above == 0) return left;
    const int corner = u > 0 ? above_[u - 1] : 0;
    if (corner == 0) return (left + above) / 2;
    return std::max(std::min(left, above), std::min(std::max(left, above), left + above - corner));
  }

 private:
  const std::uint16_t* here_;
  const std::uint16_t* above_;
  int last_ = 1;
};

std::uint8_t predicted_byte(const std::uint8_t* here, const std::uint8_t* above, int u) {
  const int left = u > 0 ? here[u - 1] : above != nullptr ? above[u] : 0;
  return static_cast<std::uint8_t>((left + (above != nullptr ? above[u] : left)) / 2);
}

/// Returns a plane of a colour picture minus its prediction, modulo 256.
std::string residual(const Image<std::uint8_t>& plane) {
  std::string out(plane.size(), '\0');
  auto next = out.begin();
  for (int v = 0; v < plane.height(); ++v) {
    const std::uint8_t* here = plane.row(v);
    const std::uint8_t* above = v > 0 ? plane.row(v - 1) : nullptr;
    for (int u = 0; u < plane.width(); ++u) *next++ = static_cast<char>(here[u] - predicted_byte(here, above, u));
  }
  return out;
}

Image<std::uint8_t> from_residual(const std::string& residual, int width, int height) {
  Image<std::uint8_t> plane(width, height);
  auto next = residual.begin();
  for (int v = 0; v < height; ++v) {
    std::uint8_t* here = plane.row(v);
    const std::uint8_t* above = v > 0 ? plane.row(v - 1) : nullptr;
    for (int u = 0; u < width; ++u) {
      here[u] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(*next++) + predicted_byte(here, above, u));
    }
  }
  return plane;
}

/// Returns the values that occur in ascending order, without holes.
std::vector<std::uint16_t> values_of(const DepthImage& depth) {
  std::uint16_t largest = 0;
  for (const std::uint16_t value : depth) largest = std::max(largest, value);
  std::vector<std::uint8_t> occurs(std::size_t{largest} + 1, 0);
  for (const std::uint16_t value : depth) occurs[value] = 1;
  std::vector<std::uint16_t> values;
  for (std::size_t value = 1; value < occurs.size(); ++value) {
    if (occurs[value] != 0) values.push_back(static_cast<std::uint16_t>(value));
  }
  return values;
}

std::vector<std::uint16_t> read_values(ByteReader& in, std::size_t most) {
  const std::string steps = read_packed(in, 0, kWidestNumber * most, "depth values");
  const std::string name = in.name() + ": depth values";
  ByteReader reader(steps, name);
  std::vector<std::uint16_t> values;
  std::uint32_t value = 0;
  while (reader.left() > 0) {
    const std::uint32_t step = reader.varint("depth values");
    if (step == 0 || step >= kValues || value + step >= kValues) in.fail("depth values: expected ascending ones");
    value += step;
    values.push_back(static_cast<std::uint16_t>(value));
  }
  return values;
}

Image<std::uint8_t> channel(const ColourImage& colour, std::uint8_t (*get)(const Rgb&)) {
  Image<std::uint8_t> plane(colour.width(), colour.height());
  std::transform(colour.begin(), colour.end(), plane.begin(), get);
  return plane;
}

}  // namespace

void write_depth_plane(ByteWriter& out, const DepthImage& depth) {
  const std::vector<std::uint16_t> values = values_of(depth);
  std::vector<std::uint16_t> rank_of(values.empty() ? 1 : std::size_t{values.back()} + 1, 0);
  ByteWriter steps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    rank_of[values[i]] = static_cast<std::uint16_t>(i + 1);
    steps.varint(values[i] - (i > 0 ? values[i - 1] : 0U));
  }
  Image<std::uint16_t> ranks(depth.width(), depth.height());
  std::transform(depth.begin(), depth.end(), ranks.begin(), [&](std::uint16_t value) { return rank_of[value]; });

  std::string symbols(depth.size(), '\0');
  ByteWriter wide;
  char* next = symbols.data();
  for (int v = 0; v < depth.height(); ++v) {
    Prediction prediction(ranks, v);
    const std::uint16_t* here = ranks.row(v);
    for (int u = 0; u < depth.width(); ++u, ++next) {
      const int expected = prediction.at(u);
      if (here[u] == 0) continue;  // a hole is symbol 0
      const unsigned code = zigzag(here[u] - expected) + 1;
      *next = static_cast<char>(std::min(code, kEscape));
      if (code >= kEscape) wide.varint(code - kEscape);
    }
  }
  write_packed(out, steps.bytes());
  write_packed(out, symbols);
  write_packed(out, wide.bytes());
}

DepthImage read_depth_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const std::vector<std::uint16_t> values = read_values(in, std::min(count, kValues));
  const std::string symbols = read_packed(in, count, count, "depth");
  const std::string wide_bytes = read_packed(in, 0, kWidestNumber * count, "wide depth steps");
  const std::string name = in.name() + ": wide depth steps";
  ByteReader wide(wide_bytes, name);
  Image<std::uint16_t> ranks(width, height);
  auto next = symbols.begin();
  for (int v = 0; v < height; ++v) {
    Prediction prediction(ranks, v);
    for (int u = 0; u < width; ++u, ++next) {
      const int expected = prediction.at(u);
      unsigned code = static_cast<unsigned char>(*next);
      if (code == 0) continue;
      if (code == kEscape) code += wide.varint("depth");
      const std::int64_t rank = std::int64_t{expected} + unzigzag(code - 1);
      if (rank < 1 || rank > static_cast<std::int64_t>(values.size())) in.fail("depth: no such value");
      ranks(u, v) = static_cast<std::uint16_t>(rank);
    }
  }
  wide.expect_end();
  for (std::uint16_t& rank : ranks) rank = rank == 0 ? std::uint16_t{0} : values[rank - 1U];
  return ranks;
}

void write_byte_plane(ByteWriter& out, const Image<std::uint8_t>& plane) {
  write_packed(out, {reinterpret_cast<const char*>(plane.data()), plane.size()});
}

Image<std::uint8_t> read_byte_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const std::string bytes = read_packed(in, count, count, "labels");
  Image<std::uint8_t> plane(width, height);
  std::copy(bytes.begin(), bytes.end(), plane.begin());
  return plane;
}

// Red and blue mostly follow green, so their differences from it are small.
void write_colour_plane(ByteWriter& out, const ColourImage& colour) {
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return c.g; })));
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return static_cast<std::uint8_t>(c.r - c.g); })));
  write_packed(out, residual(channel(colour, [](const Rgb& c) { return static_cast<std::uint8_t>(c.b - c.g); })));
}

ColourImage read_colour_plane(ByteReader& in, int width, int height) {
  const std::size_t count = pixels(width, height);
  const auto plane = [&] { return from_residual(read_packed(in, count, count, "colour"), width, height); };
  const Image<std::uint8_t> green = plane();
  const Image<std::uint8_t> red = plane();
  const Image<std::uint8_t> blue = plane();
  ColourImage colour(width, height);
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const std::uint8_t g = green[i];
    colour[i] = {static_cast<std::uint8_t>(red[i] + g), g, static_cast<std::uint8_t>(blue[i] + g)};
  }
  return colour;
}

void skip_colour_plane(ByteReader& in) {
  for (int plane = 0; plane < 3; ++plane) {
    in.number<std::uint32_t>("colour");
    in.text("colour");
  }
}

}  // namespace vesalius
