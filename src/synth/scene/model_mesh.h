#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "synth/scene/scene.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// The files of one model. All of them together may hold 64 MiB.
class ModelFiles {
 public:
  ModelFiles(std::string path, const ReadText& read) : path_(std::move(path)), read_(read) {}

  const std::string& path() const { return path_; }
  /// Returns the bytes of the model itself. Throws Error where it cannot be read or is too large.
  std::string model();
  /// Returns the bytes of a file that the model names relative to its folder; nothing where the name leads out of that
  /// folder or nothing can be read there. Throws Error where it is too large.
  std::optional<std::string> beside(const std::string& name);
  /// Throws Error of the form "model.obj: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string taken(std::string bytes, const std::string& path);

  std::string path_;
  const ReadText& read_;
  std::size_t bytes_ = 0;  ///< read so far
};

/// The mesh of a model while it is read. It never grows beyond its limits, so that what a small file unfolds to cannot
/// fill the memory.
class ModelMesh {
 public:
  ModelMesh(const ModelFiles& files, int max_triangles) : files_(files), max_triangles_(max_triangles) {}

  /// Throws Error where there is no room for so many more vertices.
  void expect_room(std::size_t vertices) const;
  /// Throws Error for a point that is not finite, and where there is no more room.
  void add_vertex(const Eigen::Vector3f& point);
  /// The corners are indices of vertices already added. Throws Error where there is no more room.
  void add_triangle(const Triangle& corners, std::uint8_t material);
  /// Returns the index of a new material of that colour; the last one's where a mesh cannot tell more apart.
  std::uint8_t add_material(const Rgb& colour);

  const std::vector<Eigen::Vector3f>& vertices() const { return mesh_.vertices; }
  SceneMesh take() { return std::move(mesh_); }

 private:
  const ModelFiles& files_;
  int max_triangles_;
  SceneMesh mesh_;
};

/// Returns a colour whose channels are shares of 255.
Rgb colour_of(const Eigen::Vector3f& shares);
/// What a model without colours looks like.
inline constexpr Rgb kPlainGrey{179, 179, 179};

}  // namespace vesalius::synth
