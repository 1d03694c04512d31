#include "bench/bench_synth.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands/synth/synth_recipe.h"
#include "dataset/labelled_frame_codec.h"
#include "downloads/assets.h"
#include "synth/body/body_detail.h"
#include "synth/body/makehuman.h"
#include "synth/dress/dress.h"
#include "synth/generate.h"
#include "synth/mocap/thin_poses.h"
#include "synth/pose/pose_sampler.h"
#include "synth/sensor/render.h"
#include "synth/sensor/sensor_noise.h"

namespace vesalius {
namespace {

using namespace synth;

constexpr std::uint64_t kSeed = 1;
constexpr std::uint64_t kFrames = 64;  ///< number of frames that the stages repeat, which gives a mean over scenes
constexpr std::uint64_t kBodies = 20;

/// A value that is made when it is first used, so that only benchmarks selected by the filter are prepared.
template <class T>
class Later {
 public:
  explicit Later(std::function<T()> make) : make_(std::move(make)) {}
  T& operator*() {
    if (value_ == nullptr) value_ = std::make_unique<T>(make_());
    return *value_;
  }

 private:
  std::function<T()> make_;
  std::unique_ptr<T> value_;
};
using AssetsLater = std::shared_ptr<Later<BodiesAndMotions>>;

/// Frames of a recipe, with the input of each stage of making them.
struct Stages {
  Sensor sensor;
  std::unique_ptr<Generator> generator;
  std::vector<BuiltScene> scenes;
  std::vector<Rendering> renderings;
  std::vector<LabelledFrame> frames;
  Renderer renderer;

  Stages(const BodiesAndMotions& assets, int width, int height) {
    Recipe recipe;
    recipe.body.count = static_cast<int>(kBodies);
    recipe.sensor.width = width;
    recipe.sensor.height = height;
    recipe.sensor.colour = false;
    sensor = sensor_of(recipe.sensor);
    generator = std::make_unique<Generator>(recipe, assets, paper_body(), kSeed);
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      scenes.push_back(generator->scene(i));
      renderings.push_back(render(i));
      frames.push_back(generator->frame(i));
    }
  }
  Rendering render(std::uint64_t i) {
    return renderer.render(scenes[i].scene, scenes[i].view, {.colour = false, .projector = projector_of(sensor)});
  }
};

/// Measures `work(i)`, where i cycles through the numbers below `count`.
template <class Work>
void add(const std::string& name, std::uint64_t count, Work work) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    work(0);  // makes the input of the work
    std::uint64_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(work(i++ % count));
  })->Unit(benchmark::kMillisecond);
}

void add_stages(const std::string& kind, const AssetsLater& assets, int width, int height) {
  const auto stages = std::make_shared<Later<Stages>>([=] { return Stages(**assets, width, height); });
  const std::string place = "/" + kind + "/" + std::to_string(width);
  add("synth_frame" + place, kFrames, [=](std::uint64_t i) { return (**stages).generator->frame(i); });
  add("synth_scene" + place, kFrames, [=](std::uint64_t i) { return (**stages).generator->scene(i); });
  add("synth_render" + place, kFrames, [=](std::uint64_t i) { return (**stages).render(i); });
  add("synth_sense" + place, kFrames, [=](std::uint64_t i) {
    Stages& s = **stages;
    Image<std::uint32_t> source;
    return sense(s.renderings[i], s.sensor, Random(kSeed, i), &source);
  });
  add("synth_encode" + place, kFrames, [=](std::uint64_t i) {
    return encode_frame({i, kSeed, (**stages).frames[i]}, paper_body().part_count());
  });
}

/// Adds benchmarks of the steps that make a new body.
void add_body_steps(const std::string& kind, const AssetsLater& assets) {
  const auto bare = [assets](Random& random) {
    const BodiesAndMotions& a = **assets;
    return a.makehuman == nullptr ? make_body(builtin_bodies(), sample_factors({}, random), paper_body())
                                  : make_body(*a.makehuman, sample_factors({}, random), paper_body());
  };
  const auto dressed = [bare](std::uint64_t k) {
    Random random(kSeed, k);
    const BodyMesh mesh = bare(random);
    return std::make_shared<const BodyMesh>(dress(mesh, sample_outfit({}, random), paper_body(), random));
  };
  const auto posers = std::make_shared<Later<std::vector<Poser>>>([dressed] {
    std::vector<Poser> made;
    for (std::uint64_t k = 0; k < kBodies; ++k) made.emplace_back(dressed(k), paper_body());
    return made;
  });
  add("synth_body_shape/" + kind, kBodies, [bare](std::uint64_t k) {
    Random random(kSeed, k);
    return bare(random);
  });
  add("synth_body_dressed/" + kind, kBodies, dressed);
  add("synth_body_shares/" + kind, kBodies,
      [posers](std::uint64_t k) { return part_shares((**posers)[k].mesh(), paper_body().part_count()); });
  add("synth_body_detail/" + kind, kBodies, [posers](std::uint64_t k) { return BodyDetail((**posers)[k]); });
}

void add_kind(const std::string& kind, const AssetsLater& assets) {
  add_body_steps(kind, assets);
  add_stages(kind, assets, 320, 240);
  add_stages(kind, assets, 640, 480);
}

/// Returns poses along `count` motions of `steps` poses each. A motion starts at a sampled pose and turns every joint
/// by about one degree per step.
std::vector<Pose> motion_poses(std::size_t count, int steps) {
  Random random(kSeed);
  std::vector<Pose> poses;
  while (poses.size() < count) {
    Pose pose = sample_pose({}, random).pose;
    for (int i = 0; i < steps; ++i) {
      for (Eigen::Quaternionf& q : pose.local) {
        const Eigen::Vector3d step(random.normal(), random.normal(), random.normal());
        const Eigen::Vector3f small = 0.012F * step.cast<float>();
        q = (q * Eigen::Quaternionf(1.F, small.x(), small.y(), small.z())).normalized();
      }
      poses.push_back(pose);
    }
  }
  poses.resize(count);
  return poses;
}

constexpr float kFiveDegrees = 0.0872664626F;

void add_thinning(const std::string& kind, int steps) {
  constexpr std::size_t kPoses = 100000;
  const auto poses = std::make_shared<Later<std::vector<Pose>>>([=] { return motion_poses(kPoses, steps); });
  benchmark::RegisterBenchmark(("thin_poses/" + kind).c_str(), [=](benchmark::State& state) {
    const std::vector<Pose>& all = **poses;
    std::size_t kept = 0;
    for (auto _ : state) kept = thin_poses(all, kFiveDegrees).size();
    state.counters["kept"] = static_cast<double>(kept);
  })->Unit(benchmark::kMillisecond);
}

using Weight = float PoseSamplerOptions::*;

/// Draws 10000 poses of some kinds, and counts those of some postures that differ by 5 degrees in some joint.
void add_sampling(const std::string& name, const std::vector<Weight>& kinds, const std::vector<Posture>& postures) {
  constexpr int kDraws = 10000;
  PoseSamplerOptions options = only(kinds.front());
  for (const Weight kind : kinds) options.*kind = 1.F;
  benchmark::RegisterBenchmark(("sample_pose/" + name).c_str(), [=](benchmark::State& state) {
    std::vector<Pose> poses;
    for (auto _ : state) {
      poses.clear();
      Random random(kSeed);
      for (int i = 0; i < kDraws; ++i) {
        const SampledPose drawn = sample_pose(options, random);
        if (std::ranges::count(postures, drawn.posture) > 0) poses.push_back(drawn.pose);
      }
    }
    state.counters["kept"] = static_cast<double>(thin_poses(poses, kFiveDegrees).size());
  })->Unit(benchmark::kMillisecond);
}

void add_samplings() {
  using O = PoseSamplerOptions;
  add_sampling("lying", {&O::lying, &O::lying_varied, &O::turning_over}, {Posture::lying});
  add_sampling("floor", {&O::floor_sitting, &O::sitting_up, &O::kneeling, &O::crawling, &O::getting_up},
               {Posture::sitting, Posture::kneeling});
  add_sampling("bent", {&O::bending, &O::picking_up}, {Posture::standing});
  add_sampling("seated", {&O::sitting, &O::hands_together, &O::hands_on_self, &O::drinking, &O::leaning},
               {Posture::sitting});
}

}  // namespace

void add_synth_benchmarks() {
  add_thinning("motions", 25);
  add_thinning("single", 1);
  add_samplings();
  add_kind("builtin", std::make_shared<Later<BodiesAndMotions>>([] { return BodiesAndMotions(); }));
  const std::string folder = default_assets_folder();
  for (const char* package : {"makehuman", "mocap"}) {
    if (has_assets(asset_package(package), folder)) continue;
    std::cerr << "no MakeHuman bodies in captured poses: " << package << " is not in \"" << folder << "\"\n";
    return;
  }
  add_kind("makehuman", std::make_shared<Later<BodiesAndMotions>>([folder] {
             return cli::load_assets(Recipe(), {folder, {}}).assets;
           }));
}

}  // namespace vesalius
