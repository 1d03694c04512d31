#include "io/files/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "io/files/atomic_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

constexpr Rgb kPlain{128, 128, 128};

void check_inputs(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person,
                  const BodyModel& body) {
  check(frame);
  if (!labels.same_size(frame.depth) || !person.same_size(frame.depth)) {
    throw Error(fmt::format("frame {}: labels or body index of another size than its depth", frame.name));
  }
  const auto unknown = [&](std::uint8_t label) { return label != kBackground && label >= body.part_count(); };
  if (const auto bad = std::find_if(labels.begin(), labels.end(), unknown); bad != labels.end()) {
    throw Error(fmt::format("frame {}: label {}, expected less than {} or {}", frame.name, *bad, body.part_count(),
                            kBackground));
  }
}

void append(std::string& bytes, float value) {
  const auto word = std::bit_cast<std::array<char, sizeof value>>(value);
  bytes.append(word.data(), word.size());
}

}  // namespace

std::string serialise_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person,
                            const BodyModel& body) {
  check_inputs(frame, labels, person, body);
  const auto holes = std::count(frame.depth.begin(), frame.depth.end(), std::uint16_t{0});
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar label\nproperty uchar person\nend_header\n",
      frame.depth.size() - holes);
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      if (frame.depth(u, v) == 0) continue;
      const Eigen::Vector3f p = frame.camera.point(float(u), float(v), float(frame.depth(u, v)) / 1000.F);
      const std::uint8_t label = labels(u, v);
      const Rgb unlabelled = frame.colour.empty() ? kPlain : frame.colour(u, v);
      const Rgb colour = label == kBackground ? unlabelled : body.parts[label].colour;
      for (const float coordinate : {p.x(), p.y(), p.z()}) append(bytes, coordinate);
      for (const std::uint8_t byte : {colour.r, colour.g, colour.b, label, person(u, v)}) {
        bytes.push_back(static_cast<char>(byte));
      }
    }
  }
  return bytes;
}

void write_cloud(const Frame& frame, const LabelImage& labels, const Image<std::uint8_t>& person, const BodyModel& body,
                 const std::string& path) {
  const std::string bytes = with_context(path, [&] { return serialise_cloud(frame, labels, person, body); });
  write_file_atomically(path, bytes);
}

}  // namespace vesalius
