#include "synth/scene/model_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr std::size_t kMostMaterials = 256;

}  // namespace

void ModelFiles::fail(const std::string& what) const { throw Error(fmt::format("{}: {}", path_, what)); }

std::string ModelFiles::taken(std::string bytes, const std::string& path) {
  bytes_ += bytes.size();
  if (bytes_ > kMostBytes) {
    throw Error(fmt::format("{}: a model of more than {} bytes with its files", path, kMostBytes));
  }
  return bytes;
}

std::string ModelFiles::model() { return taken(read_(path_), path_); }

std::optional<std::string> ModelFiles::beside(const std::string& name) {
  const fs::path relative = fs::path(name).lexically_normal();
  if (relative.empty() || relative.is_absolute() || *relative.begin() == "..") return std::nullopt;
  const std::string path = (fs::path(path_).parent_path() / relative).string();
  std::string bytes;
  try {
    bytes = read_(path);
  } catch (const Error&) {
    return std::nullopt;
  }
  return taken(std::move(bytes), path);
}

void ModelMesh::expect_room(std::size_t vertices) const {
  const std::size_t most = 3 * std::size_t(max_triangles_);
  if (vertices > most - mesh_.vertices.size()) files_.fail(fmt::format("more than {} vertices", most));
}

void ModelMesh::add_vertex(const Eigen::Vector3f& point) {
  expect_room(1);
  if (!point.allFinite()) files_.fail(fmt::format("vertex {} is not finite", mesh_.vertices.size()));
  mesh_.vertices.push_back(point);
}

void ModelMesh::add_triangle(const Triangle& corners, std::uint8_t material) {
  if (std::ssize(mesh_.triangles) == max_triangles_) files_.fail(fmt::format("more than {} triangles", max_triangles_));
  mesh_.triangles.push_back(corners);
  mesh_.material.push_back(material);
}

std::uint8_t ModelMesh::add_material(const Rgb& colour) {
  if (mesh_.materials.size() < kMostMaterials) {
    Material material;
    material.colour = material.second = colour;
    mesh_.materials.push_back(material);
  }
  return static_cast<std::uint8_t>(mesh_.materials.size() - 1);
}

Rgb colour_of(const Eigen::Vector3f& shares) {
  const auto byte = [](float share) { return static_cast<std::uint8_t>(std::clamp(share, 0.F, 1.F) * 255.F + 0.5F); };
  return {byte(shares.x()), byte(shares.y()), byte(shares.z())};
}

}  // namespace vesalius::synth
