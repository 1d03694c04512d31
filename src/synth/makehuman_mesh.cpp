#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "synth/makehuman_files.h"
#include "synth/text_lines.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kMostVertices = 1'000'000;
constexpr float kFarthest = 1000.F;  // decimetres; keeps later arithmetic finite

/// Vertex of a face's corner, "12" or "12/3" or "12/3/4", counted from 0.
std::uint32_t corner(const TextLines& lines, std::string_view word, std::size_t vertex_count) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 1 || value > vertex_count) {
    lines.fail(fmt::format("\"{}\": expected a vertex number from 1 to {}", shown(word), vertex_count));
  }
  return value - 1;
}

void add_face(TextLines& lines, ObjGroup& mesh) {
  std::vector<std::uint32_t> corners;
  for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
    corners.push_back(corner(lines, word, mesh.vertices.size()));
  }
  if (corners.size() < 3) lines.fail(fmt::format("face of {} corners, expected at least 3", corners.size()));
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

/// Whether every edge is used once in each direction.
bool closed(const std::vector<Triangle>& triangles) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::ranges::sort(edges);
  if (std::ranges::adjacent_find(edges) != edges.end()) return false;
  return std::ranges::all_of(edges, [&](const auto& e) {
    return std::ranges::binary_search(edges, std::pair{e.second, e.first});
  });
}

}  // namespace

ObjGroup parse_obj(std::string_view text, const std::string& name, std::string_view group) {
  ObjGroup mesh;
  bool wanted = false;
  TextLines lines(text, name);
  while (lines.next_line()) {
    const std::string_view what = lines.word();
    if (what == "v") {
      if (mesh.vertices.size() == kMostVertices) lines.fail(fmt::format("more than {} vertices", kMostVertices));
      const float x = lines.number(kFarthest);
      const float y = lines.number(kFarthest);
      mesh.vertices.emplace_back(x, y, lines.number(kFarthest));
    } else if (what == "g") {
      wanted = lines.word() == group;
    } else if (what == "f" && wanted) {
      add_face(lines, mesh);
    }
  }
  if (mesh.triangles.empty()) throw Error(fmt::format("{}: no faces in group \"{}\", expected some", name, group));
  if (!closed(mesh.triangles)) {
    throw Error(fmt::format("{}: group \"{}\" is not a closed surface: is the file cut short?", name, group));
  }
  return mesh;
}

MorphTarget parse_target(std::string_view text, const std::string& name, std::size_t vertex_count) {
  MorphTarget target;
  TextLines lines(text, name);
  while (lines.next_line()) {
    TextLines rest = lines;
    const std::string_view first = rest.word();
    if (first.empty() || first.front() == '#') continue;
    const std::uint32_t vertex = lines.index();
    if (vertex >= vertex_count) lines.fail(fmt::format("vertex {}, expected 0 to {}", vertex, vertex_count - 1));
    const float x = lines.number(kFarthest);
    const float y = lines.number(kFarthest);
    const float z = lines.number(kFarthest);
    if (!lines.word().empty()) lines.fail("more than 4 words, expected \"vertex x y z\"");
    target.vertex.push_back(vertex);
    target.offset.emplace_back(x, y, z);
  }
  return target;
}

}  // namespace vesalius::synth
