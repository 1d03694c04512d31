#include "export/write_gltf.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "export/moving_skeleton.h"
#include "export/test_people.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_sections.h"
#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

using nlohmann::json;

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value{};
  std::memcpy(&value, bytes.data() + at, sizeof(Number));
  return value;
}

/// A GLB file as whoever shows it reads it.
class Scene {
 public:
  explicit Scene(std::string glb) : glb_(std::move(glb)) {
    const auto size = number_at<std::uint32_t>(glb_, 12);
    gltf = json::parse(glb_.substr(20, size));
    binary_ = 20 + size + 8;
  }

  /// Returns an accessor's elements.
  std::vector<std::vector<double>> read(const json& index) const {
    const std::map<std::string, std::size_t> widths{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const std::map<int, std::size_t> sizes{{5121, 1}, {5123, 2}, {5126, 4}};
    const json& accessor = gltf.at("accessors").at(index.get<std::size_t>());
    const json& view = gltf.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const int type = accessor.at("componentType");
    std::size_t at = binary_ + view.at("byteOffset").get<std::size_t>();
    EXPECT_EQ(at % 4, 0U);
    std::vector<std::vector<double>> all(accessor.at("count").get<std::size_t>());
    for (std::vector<double>& element : all) {
      for (std::size_t i = 0; i < widths.at(accessor.at("type")); ++i, at += sizes.at(type)) {
        element.push_back(type == 5121   ? double(number_at<std::uint8_t>(glb_, at))
                          : type == 5123 ? double(number_at<std::uint16_t>(glb_, at))
                                         : double(number_at<float>(glb_, at)));
      }
    }
    return all;
  }

  /// Returns the keys and values of a node's channel, empty where it has none.
  std::pair<std::vector<double>, std::vector<std::vector<double>>> track(std::size_t node, const char* path) const {
    for (const json& channel : gltf.at("animations").at(0).at("channels")) {
      if (channel.at("target") != json{{"node", node}, {"path", path}}) continue;
      const json& sampler = gltf.at("animations").at(0).at("samplers").at(channel.at("sampler").get<std::size_t>());
      std::vector<double> keys;
      for (const std::vector<double>& key : read(sampler.at("input"))) keys.push_back(key[0]);
      return {keys, read(sampler.at("output"))};
    }
    return {};
  }

  /// Returns where a node is at a key frame.
  Eigen::Isometry3d place_of(std::size_t node, std::size_t frame) const {
    const std::vector<double> at = track(node, "translation").second.at(frame);
    const std::vector<double> turn = track(node, "rotation").second.at(frame);
    const Eigen::Isometry3d local =
        Eigen::Translation3d(at[0], at[1], at[2]) * Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]).normalized();
    for (std::size_t other = 0; other < gltf.at("nodes").size(); ++other) {
      const json children = gltf.at("nodes").at(other).value("children", json::array());
      if (std::ranges::count(children, json(node)) > 0) return place_of(other, frame) * local;
    }
    return local;
  }

  /// Returns the vertices of the mesh of a node at a key frame, by targets and skin.
  std::vector<Eigen::Vector3d> vertices(std::size_t node, std::size_t frame) const {
    const json& mesh = gltf.at("meshes").at(gltf.at("nodes").at(node).at("mesh").get<std::size_t>());
    const json& primitive = mesh.at("primitives").at(0);
    const json& skin = gltf.at("skins").at(gltf.at("nodes").at(node).at("skin").get<std::size_t>());
    const auto inverses = read(skin.at("inverseBindMatrices"));
    std::vector<Eigen::Matrix4d> joints;
    for (std::size_t j = 0; j < inverses.size(); ++j) {
      joints.emplace_back(place_of(skin.at("joints").at(j), frame).matrix() *
                          Eigen::Map<const Eigen::Matrix4d>(inverses[j].data()));
    }
    auto places = read(primitive.at("attributes").at("POSITION"));
    const auto weights = track(node, "weights").second;
    const json targets = primitive.value("targets", json::array());
    for (std::size_t t = 0; t < targets.size(); ++t) {
      const auto more = read(targets.at(t).at("POSITION"));
      EXPECT_GE(weights.at(frame * targets.size() + t)[0], 0.0) << "Blender and Unity show no others";
      EXPECT_LE(weights.at(frame * targets.size() + t)[0], 1.0);
      for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          places[i][axis] += weights.at(frame * targets.size() + t)[0] * more[i][axis];
        }
      }
    }
    const auto of_bone = read(primitive.at("attributes").at("JOINTS_0"));
    const auto share = read(primitive.at("attributes").at("WEIGHTS_0"));
    std::vector<Eigen::Vector3d> skinned;
    for (std::size_t i = 0; i < places.size(); ++i) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      const Eigen::Vector4d place(places[i][0], places[i][1], places[i][2], 1.0);
      for (std::size_t k = 0; k < 4; ++k) {
        sum += share[i][k] * (joints.at(static_cast<std::size_t>(of_bone[i][k])) * place);
      }
      skinned.emplace_back(sum.head<3>());
    }
    return skinned;
  }

  json gltf;

 private:
  std::string glb_;
  std::size_t binary_ = 0;
};

/// Returns somebody with a whole body, in another pose and shape in each frame.
PeopleRecord record_of_bodies(const std::vector<int>& ids, std::size_t frames) {
  PeopleRecord record;
  for (const FleshBone& bone : builtin_flesh().bones) record.bones.push_back(bone.name);
  for (std::size_t f = 0; f < frames; ++f) {
    RecordedFrame& frame = record.frames.emplace_back();
    frame.time_s = 10.0 + 0.5 * static_cast<double>(f);
    for (const int id : ids) {
      RecordedPerson& person = frame.people.emplace_back();
      person.id = id;
      const BodyState state = test::random_state(10 * f + static_cast<std::size_t>(id), 0.2);
      FittedBody& body = person.body.emplace();
      for (const PlacedBone& placed : place_bones(builtin_flesh(), state)) {
        FittedBone& bone = body.bones.emplace_back();
        bone.head = placed.head.cast<float>();
        bone.tail = placed.tail.cast<float>();
        bone.global = Eigen::Quaternionf(placed.global.cast<float>());
      }
      for (const double number : state.shape) body.shape.push_back(static_cast<float>(number));
    }
  }
  return record;
}

TEST(ToGlb, IsAWellFormedFileWithTheRotationsOfEveryFrame) {
  const std::vector<MovingSkeleton> skeletons = moving_skeletons(test::people(), std::nullopt);
  const std::string glb = to_glb(skeletons);
  const auto word = [&](std::size_t at) { return number_at<std::uint32_t>(glb, at); };
  ASSERT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), glb.size());
  const std::uint32_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0U);
  const json gltf = json::parse(glb.substr(20, json_size));
  const std::size_t binary = 20 + json_size + 8;
  EXPECT_EQ(glb.substr(binary - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(gltf.at("nodes").size(), 6U);
  EXPECT_EQ(gltf.at("scenes").at(0).at("nodes"), (json{0, 3}));
  EXPECT_EQ(gltf.at("nodes").at(3).at("name"), "person7:Hips");
  for (const json& channel : gltf.at("animations").at(0).at("channels")) {
    const json& sampler = gltf.at("animations").at(0).at("samplers").at(channel.at("sampler").get<std::size_t>());
    const json& output = gltf.at("accessors").at(sampler.at("output").get<std::size_t>());
    const json& view = gltf.at("bufferViews").at(output.at("bufferView").get<std::size_t>());
    const bool turns = channel.at("target").at("path") == "rotation";
    EXPECT_EQ(output.at("type"), turns ? "VEC4" : "VEC3");
    const auto node = channel.at("target").at("node").get<std::size_t>();
    const MovingSkeleton& skeleton = skeletons[node / 3];
    ASSERT_EQ(output.at("count"), skeleton.poses.size());
    float first[4];
    std::memcpy(first, glb.data() + binary + view.at("byteOffset").get<std::size_t>(), turns ? 16 : 12);
    const Eigen::Quaterniond& local = skeleton.poses[0].local[node % 3];
    const Eigen::Vector3d& place = node % 3 == 0 ? skeleton.poses[0].root_m : skeleton.poses[0].offsets_m[node % 3];
    EXPECT_NEAR(first[0], turns ? local.x() : place.x(), 1e-6);
    EXPECT_NEAR(first[1], turns ? local.y() : place.y(), 1e-6);
  }
}

TEST(ToGlb, SkinsTheFleshThatTheViewerDraws) {
  const PeopleRecord record = record_of_bodies({1, 2}, 3);
  const Scene scene(to_glb(moving_skeletons(record, std::nullopt)));
  const std::size_t bones = builtin_flesh().bones.size();
  ASSERT_EQ(scene.gltf.at("scenes").at(0).at("nodes"), (json{0, bones, bones + 1, 2 * bones + 1}));
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t p = 0; p < 2; ++p) {
      const std::vector<Eigen::Vector3d> vertices = scene.vertices(bones + p * (bones + 1), f);
      for (const BoneSections& bone : flesh_sections(builtin_flesh(), *record.frames[f].people[p].body)) {
        for (const FleshSection& section : bone) {
          for (int i = 0; i < 14; ++i) {
            const float angle = 2.F * std::numbers::pi_v<float> * static_cast<float>(i) / 14.F;
            const Eigen::Vector3f at =
                section.centre + std::cos(angle) * section.first + std::sin(angle) * section.second;
            const Eigen::Vector3d expected(at.x(), -at.y(), -at.z());
            double nearest_m = 1.0;
            for (const Eigen::Vector3d& v : vertices) nearest_m = std::min(nearest_m, (v - expected).norm());
            ASSERT_LT(nearest_m, 5e-4) << "person " << p << " in frame " << f;
          }
        }
      }
    }
  }
}

TEST(ToGlb, HasOneMeshWhereTheShapeStaysAsItIs) {
  PeopleRecord record = record_of_bodies({1}, 2);
  record.frames[1].people[0].body = record.frames[0].people[0].body;
  const Scene scene(to_glb(moving_skeletons(record, std::nullopt)));
  EXPECT_FALSE(scene.gltf.at("meshes").at(0).at("primitives").at(0).contains("targets"));
  const std::size_t body = builtin_flesh().bones.size();
  EXPECT_TRUE(scene.track(body, "weights").first.empty());
  EXPECT_EQ(scene.vertices(body, 1), scene.vertices(body, 0));
}

TEST(ToGlb, HidesWhoIsNotThere) {
  PeopleRecord record = record_of_bodies({1, 2}, 5);
  for (const std::size_t away : {0U, 2U, 4U}) record.frames[away].people.pop_back();
  const Scene scene(to_glb(moving_skeletons(record, std::nullopt)));
  const std::size_t second = builtin_flesh().bones.size() + 1;
  const auto [keys, scales] = scene.track(second, "scale");
  EXPECT_EQ(keys, (std::vector<double>{0.0, 0.5, 1.0, 1.5, 2.0}));
  ASSERT_EQ(scales.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(scales[k], (k % 2 == 1 ? std::vector<double>{1.0, 1.0, 1.0} : std::vector<double>{0.0, 0.0, 0.0})) << k;
  }
  EXPECT_TRUE(scene.track(0, "scale").first.empty()) << "the first is always there";
}

TEST(ToGlb, HasNoFleshWhereARecordHasNoShapes) {
  PeopleRecord record = record_of_bodies({1}, 2);
  record.frames[1].people[0].body->shape.clear();
  const Scene scene(to_glb(moving_skeletons(record, std::nullopt)));
  EXPECT_EQ(scene.gltf.at("nodes").size(), builtin_flesh().bones.size());
  EXPECT_FALSE(scene.gltf.contains("meshes"));
  record.frames[1].people[0].body->shape.resize(3);
  EXPECT_THROW(moving_skeletons(record, std::nullopt), Error) << "of a version that has other shapes";
}

}  // namespace
}  // namespace vesalius
