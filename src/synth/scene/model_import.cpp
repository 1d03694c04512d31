#include "synth/scene/model_import.h"

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMaxFileBytes = std::size_t{64} << 20;
constexpr float kSmallest_m = 0.01F, kLargest_m = 20.F;

/// A file's bytes for Assimp.
class Bytes : public Assimp::IOStream {
 public:
  explicit Bytes(std::string bytes) : bytes_(std::move(bytes)) {}

  size_t Read(void* to, size_t size, size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  size_t Write(const void* /*from*/, size_t /*size*/, size_t /*count*/) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// Assimp opens files through this: those of the model's folder, and none to write.
class Folder : public Assimp::IOSystem {
 public:
  Folder(const std::string& model, const ReadText& read)
      : model_(model), folder_(std::filesystem::path(model).parent_path()), read_(read) {}

  bool Exists(const char* path) const override {
    if (path == model_) return true;
    try {
      return within(path) && !read_(path).empty();
    } catch (const Error&) {
      return false;
    }
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (std::strpbrk(mode, "wa+") != nullptr || (path != model_ && !within(path))) return nullptr;
    try {
      std::string bytes = read_(path);
      if (bytes.size() > kMaxFileBytes) {
        throw Error(fmt::format("{}: {} bytes, expected at most {}", path, bytes.size(), kMaxFileBytes));
      }
      return new Bytes(std::move(bytes));
    } catch (const Error& e) {  // Assimp's own messages do not say why
      error_ = e.what();
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* file) override { delete file; }

  const std::string& error() const { return error_; }

 private:
  bool within(const std::string& path) const {
    const std::filesystem::path relative =
        std::filesystem::path(path).lexically_normal().lexically_relative(folder_.lexically_normal());
    return folder_.empty() ? !std::filesystem::path(path).is_absolute() && *std::filesystem::path(path).begin() != ".."
                           : !relative.empty() && *relative.begin() != "..";
  }

  std::string model_;
  std::filesystem::path folder_;
  const ReadText& read_;
  std::string error_;
};

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  std::string line = what;
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  throw Error(fmt::format("{}: {}", path, line.substr(0, 200)));
}

Material material_of(const aiMaterial& from) {
  aiColor4D colour(0.7F, 0.7F, 0.7F, 1.F);
  if (from.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) from.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  const auto byte = [](float c) {
    return static_cast<std::uint8_t>(std::isfinite(c) ? std::clamp(c, 0.F, 1.F) * 255.F + 0.5F : 128.F);
  };
  Material material;
  material.colour = {byte(colour.r), byte(colour.g), byte(colour.b)};
  material.second = material.colour;
  return material;
}

void add(const aiMesh& from, const std::string& path, const ImportOptions& options, SceneMesh& mesh) {
  if ((from.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D& p = from.mVertices[i];
    const Vector3f point = options.z_up ? Vector3f(p.x, p.z, -p.y) : Vector3f(p.x, p.y, p.z);
    if (!point.allFinite()) fail(path, fmt::format("vertex {} is not finite", base + i));
    mesh.vertices.emplace_back(point * options.metres_per_unit);
  }
  // Materials beyond what a mesh can tell apart look like the last.
  const auto material =
      static_cast<std::uint8_t>(std::min<std::size_t>(from.mMaterialIndex, mesh.materials.size() - 1));
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= from.mNumVertices) fail(path, fmt::format("face {} has a vertex out of range", f));
    }
    mesh.triangles.push_back({base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
    mesh.material.push_back(material);
    if (mesh.triangles.size() > static_cast<std::size_t>(options.max_triangles)) {
      fail(path, fmt::format("more than {} triangles", options.max_triangles));
    }
  }
}

/// On the floor, about the origin.
void settle(const std::string& path, SceneMesh& mesh) {
  Eigen::AlignedBox3f bounds;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) bounds.extend(mesh.vertices[corner]);
  }
  const float size = bounds.sizes().maxCoeff();
  if (!(size >= kSmallest_m && size <= kLargest_m)) {
    fail(path, fmt::format("is {} m in size, expected {} to {}: see the scale", size, kSmallest_m, kLargest_m));
  }
  const Vector3f foot(bounds.center().x(), bounds.min().y(), bounds.center().z());
  for (Vector3f& p : mesh.vertices) p -= foot;
}

}  // namespace

SceneMesh import_model(const std::string& path, const ReadText& read, const ImportOptions& options) {
  if (!(std::isfinite(options.metres_per_unit) && options.metres_per_unit > 0.F)) {
    throw UsageError(fmt::format("scale of a model is {}, expected above 0", options.metres_per_unit));
  }
  std::string ending = std::filesystem::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (ending != ".obj" && ending != ".gltf" && ending != ".glb") fail(path, "expected a .obj, .gltf or .glb file");

  auto* folder = new Folder(path, read);  // the importer deletes it
  Assimp::Importer importer;
  importer.SetIOHandler(folder);
  // Textures, cameras and bones are of no use here, and less that can go wrong.
  importer.SetPropertyInteger("PP_RVC_FLAGS", aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                  aiComponent_COLORS | aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS |
                                                  aiComponent_ANIMATIONS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                                                  aiComponent_CAMERAS);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                                     aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr) {
    if (!folder->error().empty()) throw Error(folder->error());
    fail(path, importer.GetErrorString());
  }
  SceneMesh mesh;
  for (unsigned i = 0; i < std::min(scene->mNumMaterials, 256U); ++i) {
    mesh.materials.push_back(material_of(*scene->mMaterials[i]));
  }
  if (mesh.materials.empty()) mesh.materials.emplace_back();
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) add(*scene->mMeshes[i], path, options, mesh);
  if (mesh.triangles.empty()) fail(path, "has no triangles");
  settle(path, mesh);
  return mesh;
}

}  // namespace vesalius::synth
