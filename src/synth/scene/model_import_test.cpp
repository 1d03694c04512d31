#include "synth/scene/model_import.h"

#include <gmock/gmock.h>

#include <map>

#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kCube =
    "mtllib cube.mtl\n"
    "v 1 2 1\nv 3 2 1\nv 3 4 1\nv 1 4 1\nv 1 2 3\nv 3 2 3\nv 3 4 3\nv 1 4 3\n"
    "usemtl red\nf 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\n"
    "usemtl blue\nf 3 7 8 4\nf 1 4 8 5\nf 2 6 7 3\n";
constexpr const char* kColours = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";

ReadText files(std::map<std::string, std::string> of) {
  return [of = std::move(of)](const std::string& path) {
    const auto found = of.find(path);
    if (found == of.end()) throw Error(path + ": cannot open");
    return found->second;
  };
}

TEST(ModelImport, ReadsAnObjWithItsColours) {
  ImportOptions options;
  options.metres_per_unit = 0.5F;
  const SceneMesh mesh = import_model("m/cube.obj", files({{"m/cube.obj", kCube}, {"m/cube.mtl", kColours}}), options);
  ASSERT_EQ(mesh.triangles.size(), 12U);
  ASSERT_EQ(mesh.material.size(), 12U);
  Eigen::AlignedBox3f bounds;
  for (const auto& p : mesh.vertices) bounds.extend(p);
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector3f(-0.5F, 0.F, -0.5F)) || bounds.min().y() == 0.F);
  EXPECT_NEAR(bounds.min().y(), 0.F, 1e-6F);
  EXPECT_NEAR(bounds.max().y(), 1.F, 1e-6F);
  EXPECT_NEAR(bounds.min().x(), -0.5F, 1e-6F);
  EXPECT_NEAR(bounds.max().z(), 0.5F, 1e-6F);
  int red = 0, blue = 0;
  for (const std::uint8_t m : mesh.material) {
    red += mesh.materials[m].colour == Rgb{255, 0, 0} ? 1 : 0;
    blue += mesh.materials[m].colour == Rgb{0, 0, 255} ? 1 : 0;
  }
  EXPECT_EQ(red, 6);
  EXPECT_EQ(blue, 6);
}

TEST(ModelImport, TurnsZUpwards) {
  ImportOptions options;
  options.z_up = true;
  const SceneMesh mesh = import_model("p.obj", files({{"p.obj", "v 0 0 0\nv 1 0 0\nv 0 0 2\nf 1 2 3\n"}}), options);
  float highest = 0.F;
  for (const auto& p : mesh.vertices) highest = std::max(highest, p.y());
  EXPECT_NEAR(highest, 2.F, 1e-6F);
}

TEST(ModelImport, ReadsAGltfWithItsBuffer) {
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,2,2]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "buffers":[{"uri":"t.bin","byteLength":44}],
      "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
      {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
  const float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string bin(reinterpret_cast<const char*>(points), sizeof points);
  bin += std::string("\0\0\1\0\2\0\0\0", 8);
  const SceneMesh mesh = import_model("t.gltf", files({{"t.gltf", gltf}, {"t.bin", bin}}));
  ASSERT_EQ(mesh.triangles.size(), 1U);
  float highest = 0.F;
  for (const auto& p : mesh.vertices) highest = std::max(highest, p.y());
  EXPECT_NEAR(highest, 2.F, 1e-6F);
}

void expect_error(const std::string& path, std::map<std::string, std::string> of, const std::string& words) {
  EXPECT_THAT([&] { import_model(path, files(of)); }, ThrowsMessage<Error>(HasSubstr(words))) << path;
}

TEST(ModelImport, SaysWhatIsWrongWithAFile) {
  expect_error("a.stl", {{"a.stl", "solid"}}, "a.stl: expected a .obj, .gltf or .glb file");
  expect_error("a.obj", {}, "a.obj: cannot open");
  expect_error("a.obj", {{"a.obj", ""}}, "a.obj");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\n"}}, "a.obj");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"}}, "a.obj");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"}}, "a.obj");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1000 0 0\nv 0 1 0\nf 1 2 3\n"}}, "1000 m in size");
  expect_error("a.gltf", {{"a.gltf", "{\"asset\":"}}, "a.gltf");
  expect_error("a.glb", {{"a.glb", "glTF\x02"}}, "a.glb");
}

TEST(ModelImport, KeepsToItsLimits) {
  ImportOptions options;
  options.max_triangles = 11;
  const ReadText read = files({{"cube.obj", kCube}, {"cube.mtl", kColours}});
  EXPECT_THAT([&] { import_model("cube.obj", read, options); },
              ThrowsMessage<Error>(HasSubstr("more than 11 triangles")));
  options.metres_per_unit = 0.F;
  EXPECT_THROW(import_model("cube.obj", read, options), UsageError);
}

TEST(ModelImport, ReadsNoFileOutsideTheModelsFolder) {
  std::vector<std::string> asked;
  const auto read = [&](const std::string& path) -> std::string {
    asked.push_back(path);
    if (path == "m/cube.obj") return "mtllib ../../etc/secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    throw Error(path + ": cannot open");
  };
  EXPECT_EQ(import_model("m/cube.obj", read).triangles.size(), 1U);
  EXPECT_GT(asked.size(), 1U);
  for (const std::string& path : asked) {
    EXPECT_THAT(path, testing::StartsWith("m/"));
    EXPECT_THAT(path, testing::Not(HasSubstr("..")));
  }
}

}  // namespace
}  // namespace vesalius::synth
