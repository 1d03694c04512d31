// Measures the time of each stage of the detector, of networks and of the whole on all processors, and the time of
// fitting bodies and of making synthetic frames on one. `./dev bench --help` lists the flags.

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <exception>
#include <functional>
#include <iostream>
#include <string>

#include "bench/bench_fit.h"
#include "bench/bench_network.h"
#include "bench/bench_scenes.h"
#include "bench/bench_synth.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/forest/tree_walk.h"
#include "vesalius/grow_person.h"
#include "vesalius/labeller.h"
#include "vesalius/parallel.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {
namespace {

void add(const std::string& stage, const BenchScene& scene, std::function<void()> work) {
  benchmark::RegisterBenchmark((stage + "/" + scene.name).c_str(),
                               [work = std::move(work)](benchmark::State& state) {
                                 for (auto _ : state) work();
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

template <class T>
void keep(T&& value) {
  benchmark::DoNotOptimize(value);
}

/// Labels pixels as section 4.3 describes it, without any optimisation. The kernels are compared with this.
Posteriors label_plainly(const Forest& forest, const DepthImage& depth, const Camera& camera) {
  Posteriors out{depth.width(), depth.height(), forest.class_count(), static_cast<int>(forest.trees.size()), {}};
  out.sums.assign(depth.size() * static_cast<std::size_t>(out.classes), 0);
  const OffsetScaler scaler(forest.convention, camera);
  parallel_for(depth.height(), [&](int v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) == 0) continue;
      const OffsetScale scale = scaler.at(depth(u, v));
      for (const Tree& tree : forest.trees) {
        const TreeLeaf& leaf = walk(tree, depth, forest.convention, scale, u, v);
        for (std::size_t k = 0; k < TreeLeaf::kClasses && leaf.probability[k] != 0; ++k) {
          std::uint16_t& sum = out.at(u, v)[leaf.label[k]];
          sum = static_cast<std::uint16_t>(sum + leaf.probability[k]);
        }
      }
    }
  });
  return out;
}

/// Adds benchmarks of the kernels of labelling and smoothing for every instruction set of this machine, and of the
/// plain code.
void add_targets(const BenchScene& s, const std::shared_ptr<const ForestLabeller>& labeller) {
  add("label_pixels:plain", s, [&s] { keep(label_plainly(s.forest, s.frame.depth, s.frame.camera)); });
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const auto on_target = [target](const auto& work) {
      hwy::SetSupportedTargetsForTest(target);
      work();
      hwy::SetSupportedTargetsForTest(0);
    };
    const std::string name = hwy::TargetName(target);
    add("label_pixels:" + name, s, [=, &s] { on_target([&] { keep(labeller->label(s.frame)); }); });
    add("mean_filter:" + name, s,
        [=, &s] { on_target([&] { keep(mean_filter(s.posteriors, s.frame.depth, s.frame.camera, {})); }); });
  }
}

void add_labelling(const BenchScene& s) {
  const auto labeller = std::make_shared<ForestLabeller>(s.forest);
  add("label_pixels", s, [&s, labeller] { keep(labeller->label(s.frame)); });
  add_targets(s, labeller);
  const LabelChoice choice{.part_count = s.forest.body.part_count()};
  add("choose_labels", s, [&s, choice] { keep(choose_labels(s.posteriors, s.frame.depth, choice, LabelOptions())); });
  add("mode_filter", s, [&s] { keep(mode_filter(s.labels, s.frame.depth, SmoothOptions())); });
  add("mean_filter", s, [&s] { keep(mean_filter(s.posteriors, s.frame.depth, s.frame.camera, {})); });
}

void add_search(const BenchScene& s) {
  add("find_clusters", s,
      [&s] { keep(find_clusters(s.labels, s.frame.depth, s.frame.camera, s.forest.body, ClusterOptions())); });
  add("search_skeletons", s, [&s] { keep(search_skeletons(s.clusters.items, s.forest.body, SearchOptions())); });
  add("find_planes", s, [&s] { keep(flat_pixels(s.frame.depth, s.frame.camera, PlaneOptions())); });
  add("grow_person", s, [&s] {
    const GrowOptions options;
    const Mask flat = flat_pixels(s.frame.depth, s.frame.camera, options.plane);
    const Looks looks;
    keep(PersonGrower(s.frame, flat, s.forest.body, options, looks).grow(s.rough, s.clusters));
  });
}

void add_detect(const BenchScene& s) {
  const auto detector = std::make_shared<Detector>(s.forest);
  add("detect", s, [&s, detector] { keep(detector->detect(s.frame)); });
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    const auto scenes = vesalius::bench_scenes();
    for (const vesalius::BenchScene& scene : scenes) {
      vesalius::add_labelling(scene);
      vesalius::add_search(scene);
      vesalius::add_detect(scene);
    }
    vesalius::add_network_benchmarks();
    vesalius::add_fit_benchmarks();
    vesalius::add_synth_benchmarks();
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& e) {
    std::cerr << "vesalius_bench: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
