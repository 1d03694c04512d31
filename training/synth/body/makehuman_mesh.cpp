#include "synth/body/makehuman_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kMostVertices = 1'000'000;
constexpr double kFarthest = 1000.0;  // decimetres; keeps the arithmetic finite

/// Returns the vertex of a face's corner, "12" or "12/3" or "12/3/4", counted from 0.
std::uint32_t corner(const TextScanner& scan, std::string_view word, std::size_t vertex_count) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value < 1 || value > vertex_count) {
    scan.fail(fmt::format("expected a vertex number from 1 to {}, found {}", vertex_count, in_quotes(word)));
  }
  return value - 1;
}

/// Reads three coordinates. If `more` is true, others may follow them on the line.
Eigen::Vector3f point(TextScanner& scan, bool more) {
  Eigen::Vector3f p;
  for (float& x : p) {
    if (scan.at_line_end()) scan.fail("expected three coordinates, found the end of the line");
    const double value = scan.number("a coordinate");
    if (!(std::abs(value) < kFarthest)) scan.fail(fmt::format("expected a coordinate below {} in size", kFarthest));
    x = float(value);
  }
  if (!more && !scan.at_line_end()) scan.fail("expected the end of the line after three coordinates");
  return p;
}

void add_face(TextScanner& scan, ObjGroup& mesh) {
  std::vector<std::uint32_t> corners;
  while (!scan.at_line_end()) corners.push_back(corner(scan, scan.word("a vertex"), mesh.vertices.size()));
  if (corners.size() < 3) scan.fail(fmt::format("face of {} corners, expected at least 3", corners.size()));
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

/// Returns whether every edge is used once in each direction.
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
  TextScanner scan(text, name);
  while (!scan.at_end()) {
    const std::string_view what = scan.word("a word");
    if (what == "v") {
      if (mesh.vertices.size() == kMostVertices) scan.fail(fmt::format("more than {} vertices", kMostVertices));
      mesh.vertices.push_back(point(scan, true));
    } else if (what == "g") {
      wanted = !scan.at_line_end() && scan.word("a group") == group;
    } else if (what == "f" && wanted) {
      add_face(scan, mesh);
    }
    while (!scan.at_line_end()) scan.word("a word");
  }
  if (mesh.triangles.empty()) throw Error(fmt::format("{}: no faces in group \"{}\", expected some", name, group));
  if (!closed(mesh.triangles)) {
    throw Error(fmt::format("{}: group \"{}\" is not a closed surface: is the file cut short?", name, group));
  }
  return mesh;
}

MorphTarget parse_target(std::string_view text, const std::string& name, std::size_t vertex_count) {
  MorphTarget target;
  TextScanner scan(text, name);
  while (!scan.at_end()) {
    if (scan.peek().front() == '#') {
      scan.skip_line();
      continue;
    }
    target.vertex.push_back(static_cast<std::uint32_t>(scan.whole("a vertex", 0, int(vertex_count) - 1)));
    target.offset.push_back(point(scan, false));
  }
  return target;
}

}  // namespace vesalius::synth
