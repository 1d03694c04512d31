// Makes data/models/capsule.forest and data/sample: see data/models/README.md.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "../run_tool.h"
#include "io/files/atomic_file.h"
#include "io/sources/write_frames.h"
#include "pixel_score.h"
#include "random_scene.h"
#include "sample_sequence.h"
#include "train/grow_forest.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr std::uint64_t kTrainingSeed = 1, kTestSeed = 2;
constexpr int kTestFrames = 150;

std::vector<LabelledFrame> random_frames(int count, std::uint64_t seed) {
  const Camera camera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};
  std::vector<LabelledFrame> frames(static_cast<std::size_t>(count));
  parallel_for(count, [&](int i) { frames[i] = random_frame(camera, seed, static_cast<std::uint64_t>(i)); });
  return frames;
}

void print(const PixelScore& score, const BodyModel& body) {
  std::cout << "on " << kTestFrames << " other scenes, single pixels: parts " << score.part_recall
            << " (mean recall), body recall " << score.body_recall << ", precision " << score.body_precision << '\n';
  for (std::size_t p = 0; p < score.recall_by_part.size(); ++p) {
    std::cout << "  " << body.parts[p].name << ' ' << score.recall_by_part[p] << '\n';
  }
}

void make_forest(const std::string& path, int frames, const TrainOptions& options) {
  const Forest forest = grow_forest(random_frames(frames, kTrainingSeed), paper_body(), options);
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  save_model(forest, path);
  std::cout << path << ": " << std::filesystem::file_size(path) << " bytes\n";
  print(score_pixels(forest, random_frames(kTestFrames, kTestSeed)), forest.body);
}

/// The frames with their truth for `vesalius evaluate`: how many people, and their pixels.
void make_sequence(const std::string& folder) {
  const auto writer = make_frame_writer(FrameFormat::folder, folder);
  std::filesystem::create_directories(std::filesystem::path(folder) / "mask");
  std::string table = "frame,people\n";
  for (const LabelledFrame& labelled : sample_sequence()) {
    writer->write(labelled.frame);
    table += labelled.frame.name + "," + std::to_string(labelled.parts.size()) + "\n";
    Image<std::uint8_t> mask(labelled.person.width(), labelled.person.height());
    std::ranges::transform(labelled.person, mask.begin(),
                           [](std::uint8_t who) -> std::uint8_t { return who == kBackground ? 0 : 255; });
    write_png(mask, folder + "/mask/" + labelled.frame.name + ".png");
  }
  writer->close();
  write_file_atomically(folder + "/frames.csv", table);
  std::cout << folder << ": written\n";
}

int run(int argc, char** argv) {
  CLI::App app("Makes the capsule forest and the sample sequence");
  std::string out;
  int frames = 2500;
  bool only_sample = false;
  TrainOptions options;
  options.trees = 6;
  options.grow.leaf.max_depth = 18;
  options.sample.pixels_per_frame = 300;
  options.grow.split.candidates = 40;
  options.grow.split.max_offset_m = 0.5F;
  options.grow.split.half_normal = false;
  options.grow.split.one_sided = 0.5F;
  options.probe_clip_m = 1.F;
  options.grow.leaf.min_samples = 25;
  options.grow.leaf.part_balance = 0.F;
  app.add_option("OUT", out, "New folder: gets models/capsule.forest and sample/")->required();
  app.add_option("--frames", frames, "Scenes to learn from")->check(CLI::Range(1, 100000));
  app.add_option("--trees", options.trees);
  app.add_option("--depth", options.grow.leaf.max_depth);
  app.add_option("--pixels", options.sample.pixels_per_frame);
  app.add_option("--candidates", options.grow.split.candidates);
  app.add_option("--min-leaf", options.grow.leaf.min_samples);
  app.add_flag("--only-sample", only_sample, "Do not train");
  CLI11_PARSE(app, argc, argv);
  make_sequence(out + "/sample");
  if (!only_sample) make_forest(out + "/models/capsule.forest", frames, options);
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_make_sample", [&] { return vesalius::run(argc, argv); });
}
