#include "synth/scene/model_import.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>

#include "synth/text/test_text.h"
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

/// Returns a right triangle as t.bin: three floats for each corner, then the indices.
std::string triangle_bytes() {
  const float points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  return std::string(reinterpret_cast<const char*>(points), sizeof points) + std::string("\0\0\1\0\2\0\0\0", 8);
}

const std::string kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,2,2]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1]}}],
    "buffers":[{"uri":"t.bin","byteLength":44}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";

std::string number_bytes(std::uint32_t value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string glb(std::string json, const std::string& binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string chunks = number_bytes(std::uint32_t(json.size())) + "JSON" + json +
                             number_bytes(std::uint32_t(binary.size())) + std::string("BIN\0", 4) + binary;
  return "glTF" + number_bytes(2) + number_bytes(std::uint32_t(12 + chunks.size())) + chunks;
}

float highest_of(const SceneMesh& mesh) {
  float highest = 0.F;
  for (const auto& p : mesh.vertices) highest = std::max(highest, p.y());
  return highest;
}

TEST(ModelImport, ReadsAGltfWithItsBuffer) {
  const SceneMesh mesh = import_model("m/t.gltf", files({{"m/t.gltf", kGltf}, {"m/t.bin", triangle_bytes()}}));
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_NEAR(highest_of(mesh), 2.F, 1e-6F);
  EXPECT_EQ(mesh.materials[mesh.material[0]].colour, (Rgb{255, 128, 0}));
}

TEST(ModelImport, ReadsABinaryGltfAndOneWithItsBufferInBase64) {
  const std::string bare = replaced(kGltf, R"("uri":"t.bin",)", "");
  EXPECT_NEAR(highest_of(import_model("t.glb", files({{"t.glb", glb(bare, triangle_bytes())}}))), 2.F, 1e-6F);
  const std::string data =
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
  EXPECT_NEAR(highest_of(import_model("t.gltf", files({{"t.gltf", replaced(kGltf, "t.bin", data)}}))), 2.F, 1e-6F);
}

TEST(ModelImport, PlacesNodesRelativeToTheirParents) {
  const std::string nodes = replaced(
      kGltf, R"([{"mesh":0,"scale":[2,2,2]}])",
      R"([{"children":[1,2],"translation":[0,1,0]},{"mesh":0},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,4,0,1]}])");
  const SceneMesh mesh = import_model("t.gltf", files({{"t.gltf", nodes}, {"t.bin", triangle_bytes()}}));
  EXPECT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(highest_of(mesh), 5.F, 1e-6F);
}

void expect_error(const std::string& path, std::map<std::string, std::string> of, const std::string& words) {
  EXPECT_THAT([&] { import_model(path, files(of)); }, ThrowsMessage<Error>(HasSubstr(words))) << path;
}

TEST(ModelImport, NamesTheFaultOfAFile) {
  expect_error("a.stl", {{"a.stl", "solid"}}, "a.stl: expected a .obj, .gltf or .glb file");
  expect_error("a.obj", {}, "a.obj: cannot open");
  expect_error("a.obj", {{"a.obj", ""}}, "a.obj: has no triangles");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\n"}}, "a.obj: has no triangles");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"}}, "a.obj:4: expected the number of one of");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"}}, "a.obj:3: a face of 2 corners");
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1000 0 0\nv 0 1 0\nf 1 2 3\n"}}, "1000 m in size");
  expect_error("a.gltf", {{"a.gltf", "{\"asset\":"}}, "a.gltf:1: not valid JSON");
  expect_error("a.glb", {{"a.glb", "glTF\x02"}}, "a.glb: 5 bytes that are no binary glTF");
  expect_error("a.gltf", {{"a.gltf", kGltf}}, "a.gltf: buffers 0: no file \"t.bin\"");
  expect_error("a.gltf", {{"a.gltf", kGltf}, {"t.bin", "short"}}, "a.gltf: buffers 0: 5 bytes, expected 44");
}

void expect_gltf_error(const std::string& from, const std::string& to, const std::string& words) {
  ASSERT_NE(replaced(kGltf, from, to), kGltf) << from;
  expect_error("a.gltf", {{"a.gltf", replaced(kGltf, from, to)}, {"t.bin", triangle_bytes()}}, words);
}

TEST(ModelImport, NamesThePlaceOfAFaultInAGltf) {
  expect_gltf_error("\"2.0\"", "\"1.0\"", "glTF \"1.0\", expected 2");
  expect_gltf_error("\"nodes\":[0]", "\"nodes\":[7]", "a node \"7\"");
  expect_gltf_error("\"mesh\":0", "\"mesh\":1", "meshes 1, expected one of 1");
  expect_gltf_error("[2,2,2]", "[2,2]", "nodes 0: 2 numbers of \"scale\", expected 3");
  expect_gltf_error("\"count\":3,\"type\":\"VEC3\"", "\"count\":4000000000,\"type\":\"VEC3\"",
                    "accessors 0: 4000000000 elements");
  expect_gltf_error("\"count\":3,\"type\":\"VEC3\"", "\"count\":2,\"type\":\"VEC3\"",
                    "accessors 1: index 2 at 2, expected one below 2");
  expect_gltf_error("\"bufferView\":0", "\"sparse\":{}", "accessors 0: sparse or compressed");
  expect_gltf_error("5126", "5122", "accessors 0: component type 5122");
  expect_gltf_error("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0", "KHR_draco");
}

// The files of the following tests once made the reader take gigabytes or many seconds, or drop the vertex.

TEST(ModelImport, RefusesABinaryGltfThatClaimsMoreThanItHolds) {
  const std::string bytes = "glTF" + number_bytes(2) + number_bytes(20) + number_bytes(0xFFFFFFF0U) + "JSON";
  ASSERT_EQ(bytes.size(), 20U);
  expect_error("a.glb", {{"a.glb", bytes}}, "a.glb: a chunk of 4294967280 bytes at byte 12, expected at most the 0");
}

TEST(ModelImport, RefusesNodesThatDoNotFormATree) {
  std::string nodes = "[";
  for (int i = 1; i <= 40; ++i) nodes += "{\"children\":[" + std::to_string(i) + "," + std::to_string(i) + "]},";
  expect_gltf_error(R"([{"mesh":0,"scale":[2,2,2]}])", nodes + R"({"mesh":0}])", "is reached twice, expected a tree");
  expect_gltf_error(R"([{"mesh":0,"scale":[2,2,2]}])", R"([{"mesh":0,"children":[0]}])", "nodes 0 is reached twice");
}

std::string polygon(int corners) {
  std::string obj;
  std::string face = "f";
  for (int i = 0; i < corners; ++i) {
    const float turn = 6.2832F * float(i) / float(corners);
    obj += "v " + std::to_string(std::cos(turn)) + " " + std::to_string(std::sin(turn)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  return obj + face + "\n";
}

TEST(ModelImport, RefusesAFaceOfVeryManyCorners) {
  EXPECT_EQ(import_model("a.obj", files({{"a.obj", polygon(128)}})).triangles.size(), 126U);
  expect_error("a.obj", {{"a.obj", polygon(100'000)}}, "a.obj:100001: a face of more than 128 corners");
}

TEST(ModelImport, RefusesVerticesThatAreNotFinite) {
  expect_error("a.obj", {{"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 nan 0\nf 1 2 3\n"}},
               "a.obj:4: expected a coordinate");
  std::string bytes = triangle_bytes();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  bytes.replace(12, sizeof nan, reinterpret_cast<const char*>(&nan), sizeof nan);
  expect_error("a.gltf", {{"a.gltf", kGltf}, {"t.bin", bytes}}, "a.gltf: vertex 1 is not finite");
}

TEST(ModelImport, RefusesFilesThatAreTooLarge) {
  expect_error("a.obj", {{"a.obj", std::string((std::size_t{64} << 20) + 1, ' ')}},
               "a model of more than 67108864 bytes");
}

TEST(ModelImport, RespectsItsLimits) {
  ImportOptions options;
  options.max_triangles = 11;
  const ReadText read = files({{"cube.obj", kCube}, {"cube.mtl", kColours}});
  EXPECT_THAT([&] { import_model("cube.obj", read, options); },
              ThrowsMessage<Error>(HasSubstr("more than 11 triangles")));
  options.max_triangles = 2;
  EXPECT_THAT([&] { import_model("cube.obj", read, options); },
              ThrowsMessage<Error>(HasSubstr("more than 6 vertices")));
  options.max_triangles = 12;
  EXPECT_EQ(import_model("cube.obj", read, options).triangles.size(), 12U);
  options.metres_per_unit = 0.F;
  EXPECT_THROW(import_model("cube.obj", read, options), UsageError);
}

TEST(ModelImport, ReadsNoFileOutsideTheModelsFolder) {
  std::vector<std::string> asked;
  const auto read = [&](const std::string& path) -> std::string {
    asked.push_back(path);
    if (path == "m/cube.obj") return "mtllib ../../etc/secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    if (path == "m/t.gltf") return replaced(kGltf, "t.bin", "../t.bin");
    return triangle_bytes();
  };
  EXPECT_EQ(import_model("m/cube.obj", read).triangles.size(), 1U);
  EXPECT_THROW(import_model("m/t.gltf", read), Error);
  EXPECT_THAT(asked, testing::ElementsAre("m/cube.obj", "m/t.gltf"));
}

TEST(ModelImport, ReadsContinuedFacesAndNegativeIndices) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf -4//1 -3//1 \\\n -2//1 -1//1\nl 1 2\n";
  EXPECT_EQ(import_model("a.obj", files({{"a.obj", obj}})).triangles.size(), 2U);
}

}  // namespace
}  // namespace vesalius::synth
