#include "synth/body/makehuman.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "synth/body/population.h"
#include "synth/body/poser.h"
#include "synth/body/rig_map.h"
#include "synth/body/test_bodies.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(MakeHumanTargets, HaveWeightsGivenByTheirNames) {
  MakeHumanFactors factors;
  factors.gender = 0.75F;
  factors.age_years = 25.F;
  factors.muscle = 0.2F;
  factors.weight = 0.9F;
  factors.height = 0.7F;
  const FactorValues values = factor_values(factors);
  const auto weight = [&](const std::string& name) {
    float product = 1.F;
    for (const std::uint8_t f : factors_of_name(name)) product *= values[f];
    return product;
  };
  EXPECT_NEAR(weight("a/b-c/male-young-minmuscle-maxweight-maxheight.target"), 0.75F * 0.6F * 0.8F * 0.4F, 1e-6F);
  EXPECT_NEAR(weight("universal-female-young-averagemuscle-averageweight.target"), 0.25F * 0.4F * 0.2F, 1e-6F);
  EXPECT_NEAR(weight("asian-male-young.target"), 0.25F, 1e-6F);
  EXPECT_EQ(weight("male-old-minmuscle-maxweight-maxheight.target"), 0.F);
  EXPECT_EQ(weight("male-young-minmuscle-maxweight-minheight.target"), 0.F);
  EXPECT_THAT([] { factors_of_name("targets/male-giant.target"); },
              ThrowsMessage<Error>(HasSubstr("targets/male-giant.target: \"giant\"")));
}

TEST(MakeHumanTargets, HaveComplementaryFactorsThatSumToOne) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random(2, i);
    const FactorValues v = factor_values(sample_factors({}, random));
    EXPECT_NEAR(v[0] + v[1], 1.F, 1e-5F);
    EXPECT_NEAR(v[2] + v[3] + v[4], 1.F, 1e-5F);
    EXPECT_NEAR(v[5] + v[6] + v[7], 1.F, 1e-5F);
    EXPECT_NEAR(v[8] + v[9] + v[15], 1.F, 1e-5F);
    EXPECT_NEAR(v[10] + v[11] + v[12], 1.F, 1e-5F);
    for (const float value : v) EXPECT_TRUE(value >= 0.F && value <= 1.F);
  }
}

TEST(MakeHumanFactors, GiveHumanHeightsWhenSampled) {
  double sum = 0.0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random random(3, i);
    const MakeHumanFactors f = sample_factors({}, random);
    const Stature expected = stature_at(f.age_years, f.gender);
    EXPECT_LE(std::abs(f.stature_m - expected.mean_m), 2.51F * expected.sigma_m);
    EXPECT_TRUE(f.height >= 0.22F && f.height <= 0.78F);
    sum += static_cast<double>((f.stature_m - expected.mean_m) / expected.sigma_m);
  }
  EXPECT_NEAR(sum / 2000.0, 0.0, 0.08);
}

/// Returns the files of a model so small that it can be written here: a cube as body, and a joint for every bone of the
/// rig map.
std::map<std::string, std::string> small_files() {
  std::vector<std::string> bones{"root"};
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::ranges::find(bones, name) == bones.end()) bones.push_back(name);
  };
  const RigMap& map = makehuman_rig_map();
  for (const RigMap::Follow& f : map.follows) add(f.rig);
  for (const RigMap::Joint& j : map.bones) add(j.joint), add(j.tail);
  for (const RigMap::Finger& f : map.fingers) add(f.rig);
  std::string obj = "v -5 0 -5\nv 5 0 -5\nv 5 10 -5\nv -5 10 -5\nv -5 0 5\nv 5 0 5\nv 5 10 5\nv -5 10 5\n";
  std::string joints;
  std::string list;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const std::string index = std::to_string(8 + b);
    obj += "v " + std::to_string(b % 7) + " " + std::to_string(b % 5) + " " + std::to_string(b) + "e-1\n";
    joints += (b == 0 ? "\"" : ",\"") + bones[b] + "\":[" + index + "]";
    list += (b == 0 ? "\"" : ",\"") + bones[b] + R"(":{"head":")" + bones[b] + R"(","tail":")" +
            bones[(b + 1) % bones.size()] + R"(","parent":)" + (b == 0 ? "null}" : R"("root"})");
  }
  obj += "g body\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
  std::string weights;
  for (int v = 0; v < 8; ++v) weights += (v == 0 ? "[" : ",[") + std::to_string(v) + ",1]";
  return {{"d/3dobjs/base.obj", obj},
          {"d/rigs/default.mhskel", R"({"bones":{)" + list + R"(},"joints":{)" + joints + "}}"},
          {"d/rigs/default_weights.mhw", R"({"weights":{"root":[)" + weights + "]}}"},
          {"d/male.target", "2 0 2 0\n3 0 2 0\n6 0 2 0\n7 0 2 0\n8 1 0 0\n"}};
}

std::shared_ptr<const MakeHumanModel> load(const std::map<std::string, std::string>& files) {
  const ReadText read = [&](const std::string& path) { return files.at(path); };
  return std::make_shared<const MakeHumanModel>(read, MakeHumanModel::files("d", {"d/male.target"}));
}

TEST(MakeHuman, MorphsBodyAndJointsByTheTargets) {
  const auto model = load(small_files());
  MakeHumanFactors factors;
  factors.gender = 0.F;
  const BodyMesh woman = make_body(*model, factors, paper_body());
  factors.gender = 0.5F;
  const BodyMesh man = make_body(*model, factors, paper_body());
  EXPECT_NEAR(woman.stature_m, 1.F, 1e-5F);  // files are in decimetres
  EXPECT_NEAR(man.stature_m, 1.1F, 1e-5F);
  EXPECT_NEAR(man.rig[0].head.x() - woman.rig[0].head.x(), 0.05F, 1e-5F);  // half a target of one decimetre
  factors.stature_m = 2.2F;
  const BodyMesh tall = make_body(*model, factors, paper_body());
  for (std::size_t v = 0; v < 8; ++v) EXPECT_LT((tall.vertices[v] - 2.F * man.vertices[v]).norm(), 1e-5F);
}

TEST(MakeHuman, NamesTheFileOfErrors) {
  const auto expect = [](const std::string& path, const std::string& from, const std::string& to,
                         const std::string& message) {
    auto files = small_files();
    std::string& text = files.at(path);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    EXPECT_THAT([&] { load(files); }, ThrowsMessage<Error>(HasSubstr(message))) << to;
  };
  expect("d/3dobjs/base.obj", "f 1 5 8 4\n", "", "d/3dobjs/base.obj: group \"body\" is not a closed surface");
  expect("d/3dobjs/base.obj", "f 1 5 8 4", "f 1 5 8 900", "d/3dobjs/base.obj:");
  expect("d/male.target", "8 1", "9999 1", "d/male.target:5: expected a vertex");
  expect("d/rigs/default.mhskel", "wrist.L\":[", "wrist.X\":[", "d/rigs/default.mhskel: joint \"wrist.L\"");
  expect("d/rigs/default_weights.mhw", "[3,1]", "[3,0.4]", "vertex 3: its weights sum to 0.4");
  expect("d/rigs/default_weights.mhw", "\"root\"", "\"tail\"", "weights of bone \"tail\"");
}

/// Returns the folder `data` of MakeHuman's files, unpacked from the developers' archive; nothing if there is none.
std::optional<std::filesystem::path> unpacked_makehuman() {
  const char* set = std::getenv("VESALIUS_SHARED");
  const std::filesystem::path shared = set != nullptr ? set : VESALIUS_SOURCE_DIR "/../shared";
  const std::filesystem::path archive = shared / "assets" / "makehuman.tar.xz";
  if (!std::filesystem::exists(archive)) return std::nullopt;
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("vesalius_makehuman_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string command = "tar -C '" + folder.string() + "' -xf '" + archive.string() + "'";
  if (std::system(command.c_str()) != 0) return std::nullopt;
  return folder / "makehuman" / "makehuman" / "data";
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> targets_below(const std::filesystem::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".target") paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

void expect_good_body(const BodyMesh& mesh, const MakeHumanFactors& factors, std::uint64_t seed) {
  EXPECT_NEAR(mesh.stature_m, factors.stature_m, 1e-4F);
  const auto [low, high] = std::ranges::minmax(mesh.vertices, {}, [](const Vector3f& p) { return p.y(); });
  EXPECT_NEAR(high.y() - low.y(), factors.stature_m, 1e-3F);
  const auto shared = std::make_shared<const BodyMesh>(mesh);
  const Poser poser(shared, paper_body());
  Random random(6, seed);
  for (const float angle : {0.F, 0.5F}) {
    const Pose pose = random_pose(random, angle);
    PosedBody body = poser.pose(pose);
    // In some old people the hollow of the mouth extends 4 mm behind the head's joint, so the point behind it is
    // tested.
    const auto head = static_cast<std::size_t>(Bone::head);
    body.joints[head] += world_rotations(pose)[head] * Vector3f(0.F, 0.F, -0.01F);
    for (std::size_t b = 0; b < kBoneCount; ++b) {
      EXPECT_TRUE(is_inside(body.vertices, mesh.topology->triangles, mesh.topology->triangles.size(), body.joints[b]))
          << bone_name(static_cast<Bone>(b)) << " of body " << seed;
    }
    for (const Vector3f& centre : body.parts) EXPECT_TRUE(centre.allFinite());
  }
  const PosedBody t = poser.pose({});
  for (const Bone bone : {Bone::l_upper_arm, Bone::l_forearm, Bone::r_upper_arm, Bone::r_forearm, Bone::l_thigh,
                          Bone::l_shin, Bone::r_thigh, Bone::r_shin}) {
    const auto b = static_cast<std::size_t>(bone);
    EXPECT_GT((t.ends[b] - t.joints[b]).normalized().dot(rest_direction(bone)), 0.999F) << bone_name(bone);
  }
  EXPECT_EQ(std::set<int>(mesh.topology->part.begin(), mesh.topology->part.end()).size(), 25U);
}

/// Returns the number of triangles whose mirror image, with all corners within a millimetre, does not have the mirrored
/// part.
int unlike_their_twins(const BodyMesh& mesh) {
  std::map<std::array<int, 3>, std::uint8_t> parts;
  const auto key = [&](const Triangle& t, float side) {
    const Vector3f c = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.F;
    return std::array<int, 3>{static_cast<int>(std::lround(side * c.x() * 2000.F)),
                              static_cast<int>(std::lround(c.y() * 2000.F)),
                              static_cast<int>(std::lround(c.z() * 2000.F))};
  };
  const BodyTopology& topology = *mesh.topology;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) parts[key(topology.triangles[t], 1.F)] = topology.part[t];
  int unlike = 0;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const auto twin = parts.find(key(topology.triangles[t], -1.F));
    if (twin != parts.end() && paper_body().parts[topology.part[t]].mirror != static_cast<int>(twin->second)) ++unlike;
  }
  return unlike;
}

// This one test covers everything that needs MakeHuman's real files, because unpacking and loading them takes a second
// or two.
// Labels: statistics
TEST(MakeHumanFilesTour, MakesManyValidBodies) {
  const auto data = unpacked_makehuman();
  if (!data) GTEST_SKIP() << "no MakeHuman files: set VESALIUS_SHARED to the folder with assets/makehuman.tar.xz";
  const auto model = std::make_shared<const MakeHumanModel>(
      ReadText(slurp), MakeHumanModel::files(data->string(), targets_below(*data / "targets")));
  for (std::uint64_t i = 0; i < 12; ++i) {
    Random random(4, i);
    const MakeHumanFactors factors = sample_factors({}, random);
    const BodyMesh mesh = make_body(*model, factors, paper_body());
    EXPECT_TRUE(is_closed(mesh.topology->triangles, mesh.topology->triangles.size()));
    expect_good_body(mesh, factors, i);
    EXPECT_LT(unlike_their_twins(mesh), 130) << i;  // half a per cent, since quads are cut the same way on both sides
  }
  MakeHumanFactors adult;
  adult.gender = 1.F;
  const float man_m = make_body(*model, adult, paper_body()).stature_m;
  adult.gender = 0.F;
  const float woman_m = make_body(*model, adult, paper_body()).stature_m;
  EXPECT_NEAR(man_m, 1.76F, 0.12F);  // without scaling, these are MakeHuman's own averages
  EXPECT_NEAR(woman_m, 1.63F, 0.12F);
  std::filesystem::remove_all(data->parent_path().parent_path().parent_path());
}

using Eigen::Vector3f;

MakeHumanFactors person(float gender, float age_years, float weight, float stature_m) {
  MakeHumanFactors factors;
  factors.gender = gender;
  factors.age_years = age_years;
  factors.weight = weight;
  factors.stature_m = stature_m;
  return factors;
}

std::vector<MakeHumanFactors> people() {
  std::vector<MakeHumanFactors> all{person(1.F, 30.F, 0.5F, 1.8F),  person(0.F, 30.F, 0.5F, 1.62F),
                                    person(0.5F, 5.F, 0.5F, 1.05F), person(1.F, 50.F, 1.F, 1.75F),
                                    person(0.F, 20.F, 0.F, 1.6F),   person(0.F, 70.F, 1.F, 1.6F)};
  for (std::uint64_t i = 0; i < 14; ++i) {
    Random random(11, i);
    all.push_back(sample_factors({}, random));
  }
  return all;
}

TEST(BuiltinBody, HasTheGivenStatureAndStandsOnTheFloor) {
  for (const MakeHumanFactors& factors : people()) {
    const BodyMesh mesh = make_body(builtin_bodies(), factors, paper_body());
    const auto [low, high] = std::ranges::minmax(mesh.vertices, {}, [](const Vector3f& p) { return p.y(); });
    EXPECT_NEAR(low.y(), 0.F, 1e-5F);
    EXPECT_NEAR(high.y(), factors.stature_m, 0.001F);
    EXPECT_FLOAT_EQ(mesh.stature_m, factors.stature_m);
    EXPECT_TRUE(is_closed(mesh.topology->triangles, mesh.topology->triangles.size()));
    EXPECT_GT(mesh.topology->triangles.size(), 3000U);
    EXPECT_LT(mesh.topology->triangles.size(), 6000U);
    EXPECT_EQ(std::set<int>(mesh.topology->part.begin(), mesh.topology->part.end()).size(), 25U);
  }
}

TEST(BuiltinBody, HasExactlyMirroredSides) {
  for (const MakeHumanFactors& factors : people()) {
    const BodyMesh mesh = make_body(builtin_bodies(), factors, paper_body());
    const BodyTopology& topology = *mesh.topology;
    std::map<std::array<float, 3>, std::uint32_t> by_place;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vector3f& p = mesh.vertices[v];
      EXPECT_TRUE(by_place.insert({{p.x(), p.y(), p.z()}, v}).second || p.x() == 0.F);
    }
    const std::size_t half = topology.triangles.size() / 2;
    for (std::size_t t = 0; t < half; ++t) {
      const int partner = paper_body().parts[topology.part[t]].mirror;
      ASSERT_EQ(partner, static_cast<int>(topology.part[t + half])) << t;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3f& p = mesh.vertices[topology.triangles[t][k]];
        const Vector3f& q = mesh.vertices[topology.triangles[t + half][2 - k]];
        ASSERT_EQ(p, Vector3f(-q.x(), q.y(), q.z()));
      }
    }
  }
}

// Labels: statistics
TEST(BuiltinBody, HasItsJointsInsideInAnyModeratePose) {
  int outside = 0;
  int all = 0;
  for (const MakeHumanFactors& factors : people()) {
    const auto mesh = std::make_shared<const BodyMesh>(make_body(builtin_bodies(), factors, paper_body()));
    const Poser poser(mesh, paper_body());
    Random random(5);
    for (int i = 0; i < 3; ++i) {
      const PosedBody body = poser.pose(random_pose(random, 0.6F));
      for (const Vector3f& joint : body.joints) {
        ++all;
        if (!is_inside(body.vertices, mesh->topology->triangles, mesh->topology->triangles.size(), joint)) ++outside;
      }
    }
  }
  EXPECT_EQ(outside, 0) << "of " << all;
}

TEST(BuiltinBody, HasTheCentresOfPartsInside) {
  int outside = 0;
  for (const MakeHumanFactors& factors : people()) {
    const auto mesh = std::make_shared<const BodyMesh>(make_body(builtin_bodies(), factors, paper_body()));
    const PosedBody body = Poser(mesh, paper_body()).pose({});
    for (const Vector3f& centre : body.parts) {
      ASSERT_TRUE(centre.allFinite());
      if (!is_inside(body.vertices, mesh->topology->triangles, mesh->topology->triangles.size(), centre)) ++outside;
    }
  }
  EXPECT_EQ(outside, 0);
}

TEST(BuiltinBody, FacesForwardsWithItsFeet) {
  const BodyMesh mesh = make_body(builtin_bodies(), {}, paper_body());
  const Vector3f& front =
      std::ranges::max(mesh.vertices, {}, [](const Vector3f& p) { return p.y() > 1.4F ? p.z() : -9.F; });
  const Vector3f& back =
      std::ranges::min(mesh.vertices, {}, [](const Vector3f& p) { return p.y() > 1.4F ? p.z() : 9.F; });
  EXPECT_EQ(front.x(), 0.F);                // the nose, on the middle line
  EXPECT_GT(front.z(), -back.z() + 0.01F);  // extends further than the back of the head
  const Vector3f& toe =
      std::ranges::max(mesh.vertices, {}, [](const Vector3f& p) { return p.y() < 0.1F ? p.z() : -9.F; });
  EXPECT_GT(toe.z(), 0.12F);
}

TEST(BuiltinBody, FollowsItsFactors) {
  const auto depth_of_trunk = [](const BodyMesh& mesh) {
    float front = 0.F, back = 0.F;
    for (const Vector3f& p : mesh.vertices) {
      if (std::abs(p.y() - 0.6F * mesh.stature_m) > 0.03F * mesh.stature_m) continue;
      if (std::abs(p.x()) > 0.1F * mesh.stature_m) continue;
      front = std::max(front, p.z());
      back = std::min(back, p.z());
    }
    return front - back;
  };
  const BodyMesh thin = make_body(builtin_bodies(), person(0.5F, 30.F, 0.F, 1.7F), paper_body());
  const BodyMesh heavy = make_body(builtin_bodies(), person(0.5F, 30.F, 1.F, 1.7F), paper_body());
  EXPECT_GT(depth_of_trunk(heavy), 1.2F * depth_of_trunk(thin));
  const auto head_share = [](const BodyMesh& mesh) {
    const auto bones = rest_bones(mesh);
    return (mesh.stature_m - bones[index(Bone::neck)].head.y()) / mesh.stature_m;
  };
  const BodyMesh child = make_body(builtin_bodies(), person(0.5F, 5.F, 0.5F, 1.F), paper_body());
  EXPECT_GT(head_share(child), 1.08F * head_share(thin));
}

TEST(BuiltinBody, IsTheSameForTheSameFactors) {
  const BodyMesh a = make_body(builtin_bodies(), {}, paper_body());
  const BodyMesh b = make_body(builtin_bodies(), {}, paper_body());
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.topology->triangles, b.topology->triangles);
}

TEST(BuiltinBody, SamplesPeopleOfHumanHeight) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Random random(1, i);
    const MakeHumanFactors factors = sample_factors({}, random);
    EXPECT_GT(factors.stature_m, factors.age_years < 18.F ? 0.9F : 1.38F);
    EXPECT_LT(factors.stature_m, factors.gender > 0.5F ? 1.95F : 1.86F);
  }
}

}  // namespace

}  // namespace vesalius::synth
