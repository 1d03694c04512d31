#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "synth/scene/scene.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// The files of one model. Together they may have at most 64 MiB.
class ModelFiles {
 public:
  ModelFiles(std::string path, const ReadText& read) : path_(std::move(path)), read_(read) {}

  const std::string& path() const { return path_; }
  /// Returns the bytes of the model file. Throws Error if it cannot be read or is too large.
  std::string model();
  /// Returns the bytes of a file that the model names relative to its folder, or nothing if the name leads out of that
  /// folder or the file cannot be read. Throws Error if it is too large.
  std::optional<std::string> beside(const std::string& name);
  /// Throws an Error of the form "model.obj: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string taken(std::string bytes, const std::string& path);

  std::string path_;
  const ReadText& read_;
  std::size_t bytes_ = 0;  ///< bytes read so far
};

/// The mesh of a model while it is being read. It never exceeds its limits, so a small file that expands to a large
/// mesh cannot fill the memory.
class ModelMesh {
 public:
  ModelMesh(const ModelFiles& files, int max_triangles) : files_(files), max_triangles_(max_triangles) {}

  /// Throws Error if there is no room for so many more vertices.
  void expect_room(std::size_t vertices) const;
  /// Adds a vertex. Throws Error if the point is not finite or there is no more room.
  void add_vertex(const Eigen::Vector3f& point);
  /// Adds a triangle; its corners are indices of vertices already added. Throws Error if there is no more room.
  void add_triangle(const Triangle& corners, std::uint8_t material);
  /// Adds a material of that colour and returns its index. If the mesh cannot have more materials, returns that of the
  /// last one.
  std::uint8_t add_material(const Rgb& colour);

  const std::vector<Eigen::Vector3f>& vertices() const { return mesh_.vertices; }
  SceneMesh take() { return std::move(mesh_); }

 private:
  const ModelFiles& files_;
  int max_triangles_;
  SceneMesh mesh_;
};

/// Converts channels from the range 0-1 to a colour.
Rgb colour_of(const Eigen::Vector3f& shares);
/// The colour of a model that states none.
inline constexpr Rgb kPlainGrey{179, 179, 179};

}  // namespace vesalius::synth
