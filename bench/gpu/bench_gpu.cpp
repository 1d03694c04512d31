// Measures labelling and detection on a card beside the processor, and counts what a model of a card's speed needs
// (bench/gpu/model.py). `./dev cuda bench --help` lists the flags.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/gpu/count_reads.h"
#include "bench/gpu/timed_device.h"
#include "cuda/cuda_device.h"
#include "cuda/cuda_labeller.h"
#include "cuda/device_labeller.h"
#include "simulator/simulated_device.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"
#include "vesalius/network/network.h"
#include "vesalius/open_source.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  int device = 0, rounds = 20, batch = 256;
  bool simulated = false, count_only = false;
  std::string frames = VESALIUS_SOURCE_DIR "/data/rooms", json;
};

double median_ms(int rounds, const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i <= rounds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (i > 0) times.push_back(took.count());  // the first one makes memory
  }
  std::ranges::sort(times);
  return times[times.size() / 2];
}

std::vector<Frame> read_frames(const std::string& from) {
  std::vector<Frame> frames;
  const auto source = open_source(from);
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  if (frames.empty()) throw Error(from + ": no frames");
  return frames;
}

Json count(const Forest& forest, const Frame& frame, float gate) {
  Posteriors posteriors;
  ForestLabeller(forest).label_into(frame, gate, posteriors);
  const WalkReads reads = count_reads(forest, frame.depth, frame.camera, posteriors.settled);
  return {{"width", frame.camera.width},
          {"height", frame.camera.height},
          {"trees", forest.trees.size()},
          {"classes", forest.class_count()},
          {"headings", forest.headings},
          {"pixels", reads.pixels},
          {"nodes", reads.nodes},
          {"warp_levels", reads.warp_levels},
          {"node_sectors", reads.node_sectors},
          {"probe_sectors", reads.probe_sectors},
          {"forest_bytes", reads.forest_bytes},
          {"touched_bytes", reads.touched_bytes},
          {"logit_bytes", reads.logit_bytes}};
}

/// For each convolution of a network that sees 320x256 pixels: its threads, and the steps that each takes one after the
/// other, of kReadChannels inputs at a place of the window (convolve.cuh).
Json network_counts(const Network& network) {
  const auto groups = [](int count, int of) { return (count + of - 1) / of; };
  const std::vector<NetworkPicture> pictures = pictures_of(network);
  Json layers = Json::array();
  for (std::size_t n = 0; n < network.layers.size(); ++n) {
    const Convolution& c = network.layers[n];
    const int width = 320 >> pictures[n + 1].halvings, height = 256 >> pictures[n + 1].halvings;
    layers.push_back(
        {{"threads", height * groups(width, gpu::kConvolvePixels) * groups(c.outputs, gpu::kConvolveChannels)},
         {"steps", c.side * c.side * groups(c.inputs, gpu::kReadChannels)}});
  }
  return layers;
}

/// Milliseconds of each kind of work for the labels of one picture, every pixel looked at.
Json kernel_times(const Forest& forest, const std::shared_ptr<gpu::Device>& device, const Frame& frame, int rounds) {
  const auto timed = std::make_shared<gpu::TimedDevice>(device);
  const gpu::DeviceLabeller labeller(forest, timed);
  LabelOptions options;
  options.gate = 2.F;
  std::vector<std::pair<std::string, std::vector<double>>> all;
  for (int i = 0; i <= rounds; ++i) {
    timed->take_times();
    labeller.label_pictures({frame.depth}, {frame.camera}, options, {});
    if (i == 0) continue;
    for (const auto& [name, ms] : timed->take_times()) {
      auto found = std::ranges::find(all, name, &std::pair<std::string, std::vector<double>>::first);
      if (found == all.end()) found = all.insert(found, {name, {}});
      found->second.push_back(ms);
    }
  }
  Json medians = Json::object();
  for (auto& [name, times] : all) {
    std::ranges::sort(times);
    medians[name] = times[times.size() / 2];
  }
  return medians;
}

Json measure(const Arguments& arguments, const Model& model, const Model& network, const std::vector<Frame>& frames,
             const std::shared_ptr<gpu::Device>& device) {
  Json figures{{"device", device->name()}, {"processor_threads", thread_count()}};
  if (!arguments.simulated) {
    for (const gpu::KernelFacts& kernel : gpu::kernel_facts(arguments.device)) {
      figures["kernels"][kernel.name] = {{"registers", kernel.registers}, {"occupancy", kernel.occupancy}};
    }
  }
  const Frame& frame = frames.front();
  const Forest& forest = model.forest;
  const auto on_device = std::make_shared<gpu::DeviceLabeller>(forest, device);
  const auto on_processor = std::make_shared<ForestLabeller>(forest);
  figures["kernel_ms"] = kernel_times(forest, device, frame, arguments.rounds);
  LabelOptions every;
  every.gate = 2.F;
  std::vector<DepthImage> pictures;
  std::vector<Camera> cameras;
  for (int i = 0; i < arguments.batch; ++i) {
    const Frame& next = frames[static_cast<std::size_t>(i) % frames.size()];
    pictures.push_back(next.depth);
    cameras.push_back(next.camera);
  }
  const double one_ms =
      median_ms(arguments.rounds, [&] { on_device->label_pictures({frame.depth}, {frame.camera}, every, {}); });
  const double batch_ms =
      median_ms(std::max(1, arguments.rounds / 4), [&] { on_device->label_pictures(pictures, cameras, every, {}); });
  const double gated_ms = median_ms(std::max(1, arguments.rounds / 4),
                                    [&] { on_device->label_pictures(pictures, cameras, LabelOptions{}, {}); });
  const double processor_ms = median_ms(arguments.rounds, [&] {
    const Posteriors posteriors = on_processor->label(frame);
    choose_labels(mean_filter(posteriors, frame.depth, frame.camera, {}), frame.depth, {forest.body.part_count()},
                  every);
  });
  figures["labels_ms"] = {{"device, one picture", one_ms},
                          {"device, a picture of a batch", batch_ms / arguments.batch},
                          {"device, a picture of a batch, gated", gated_ms / arguments.batch},
                          {"processor", processor_ms}};
  const auto label_ms = [&](const std::shared_ptr<const Labeller>& labeller) {
    const Frame grid = every_nth(frame, grid_step(frame.camera, {}));
    return median_ms(arguments.rounds, [&] { labeller->label(grid); });
  };
  figures["network_ms"] = {{"device", label_ms(gpu::make_device_labeller(network, device))},
                           {"processor", label_ms(vesalius::on_device(network).labeller)}};
  const auto detect_ms = [&](const std::shared_ptr<const Labeller>& labeller, int threads) {
    const ThreadLimit limit(threads);
    Model placed = model;
    placed.labeller = labeller;
    const Detector detector(std::move(placed));
    return median_ms(std::max(1, arguments.rounds / 4),
                     [&] {
                       for (const Frame& each : frames) detector.detect(each);
                     }) /
           static_cast<double>(frames.size());
  };
  figures["detect_ms"] = {{"device and one core", detect_ms(on_device, 1)},
                          {"one core", detect_ms(on_processor, 1)},
                          {"two cores", detect_ms(on_processor, 2)}};
  return figures;
}

void run(const Arguments& arguments) {
  keep_freed_memory();
  const Model model = load_model(VESALIUS_SOURCE_DIR "/data/models/default.forest");
  const Model network = load_model(VESALIUS_SOURCE_DIR "/data/models/default.model");
  const std::vector<Frame> frames = read_frames(arguments.frames);
  constexpr float kNoGate = 2.F;
  Json figures{{"counts", count(model.forest, frames.front(), kNoGate)},
               {"gated_counts", count(model.forest, frames.front(), LabelOptions{}.gate)},
               {"network_counts", network_counts(*network.network)}};
  if (!arguments.count_only) {
    std::shared_ptr<gpu::Device> device;
    if (arguments.simulated) {
      device = std::make_shared<gpu::SimulatedDevice>();
    } else {
      device = gpu::open_cuda_device(arguments.device);
    }
    figures["measured"] = measure(arguments, model, network, frames, device);
  }
  const std::string text = figures.dump(1) + "\n";
  if (arguments.json.empty()) {
    std::fputs(text.c_str(), stdout);
    return;
  }
  std::ofstream file(arguments.json);
  if (!(file << text).flush()) throw Error(arguments.json + ": cannot be written");
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  CLI::App app("Measures labelling and detection on a card beside the processor.");
  vesalius::Arguments arguments;
  app.add_option("--device", arguments.device, "Number of the card")->check(CLI::NonNegativeNumber);
  app.add_flag("--simulated", arguments.simulated,
               "The simulator instead of a card: to try this program, not to measure");
  app.add_flag("--count-only", arguments.count_only, "Only what bench/gpu/model.py needs");
  app.add_option("--frames", arguments.frames, "Frames to label; those of data/rooms without");
  app.add_option("--rounds", arguments.rounds, "Runs of which a median is taken")->check(CLI::Range(1, 10000));
  app.add_option("--batch", arguments.batch, "Pictures that are labelled together")->check(CLI::Range(1, 100000));
  app.add_option("--json", arguments.json, "File for the figures; standard output without");
  CLI11_PARSE(app, argc, argv);
  try {
    vesalius::run(arguments);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "vesalius_bench_gpu: %s\n", e.what());
    return 1;
  }
  return 0;
}
