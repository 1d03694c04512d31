#include "commands/train/train_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "commands/synth/frame_maker.h"
#include "commands/synth/synth_recipe.h"
#include "console/interrupts.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_folder.h"
#include "downloads/sha256.h"
#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "train/parallel_in_order.h"
#include "vesalius/open_source.h"

namespace vesalius::cli {
namespace {

constexpr int kMostFrames = 1'000'000'000;

/// Throws unless two bodies have the same parts in the same order. Labels are numbers, so others cannot be mixed.
void expect_same_parts(const BodyModel& body, const std::string& name, const BodyModel& expected,
                       const std::string& expected_name) {
  for (std::size_t p = 0; p < std::max(body.parts.size(), expected.parts.size()); ++p) {
    const std::string ours = p < body.parts.size() ? body.parts[p].name : "missing";
    const std::string theirs = p < expected.parts.size() ? expected.parts[p].name : "missing";
    if (ours == theirs) continue;
    throw Error(fmt::format("{}: body part {} is {}, expected {} as in {}", name, p, ours, theirs, expected_name));
  }
}

void stop_if_interrupted() {
  if (interrupted()) throw Error("interrupted while frames were read");
}

LabelledFrame as_background(Frame frame) {
  LabelledFrame labelled;
  labelled.labels = LabelImage(frame.depth.width(), frame.depth.height(), kBackground);
  labelled.person = labelled.labels;
  labelled.frame = std::move(frame);
  return labelled;
}

void add_to_sum(Sha256& sum, const Frame& frame) {
  ByteWriter bytes;
  const Camera& camera = frame.camera;
  for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) bytes.real(value);
  for (const int value : {camera.width, camera.height}) bytes.number(static_cast<std::uint32_t>(value));
  for (const std::uint16_t depth_mm : frame.depth) bytes.number(depth_mm);
  sum.update(bytes.bytes());
}

/// Takes the frames of a DatasetReader or a LabelledFolder.
template <class Reader>
TrainInput labelled_input(std::shared_ptr<const Reader> reader, int count, TrainInput input, BodyModel& body,
                          std::string& body_from) {
  if (reader->size() == 0) throw Error(input.name + ": no frames in it, expected some to train from");
  if (body_from.empty()) {
    body = reader->body();
    body_from = input.name;
  }
  expect_same_parts(reader->body(), input.name, body, body_from);
  const auto most = static_cast<std::uint64_t>(count > 0 ? count : kMostFrames);
  const Camera camera = reader->read(0, false).frame.camera;
  input.frames = int(std::min(reader->size(), most));
  input.width = camera.width;
  input.height = camera.height;
  input.frame = [reader](int i) { return reader->read(i, false); };
  return input;
}

}  // namespace

TrainInput open_labelled(const std::string& folder, int count, BodyModel& body, std::string& body_from) {
  if (is_labelled_folder(folder)) {
    const auto reader = std::make_shared<const LabelledFolder>(folder);
    return labelled_input(reader, count, {.name = folder, .made_by = "", .hash = reader->content_hash(), .frame = {}},
                          body, body_from);
  }
  const auto reader = std::make_shared<const DatasetReader>(folder);
  const DatasetInfo& info = reader->info();
  return labelled_input(
      reader, count,
      {.name = folder, .made_by = info.recipe, .seed = info.seed, .hash = dataset_hash(info), .frame = {}}, body,
      body_from);
}

TrainInputs::TrainInputs(BodyModel body, std::vector<TrainInput> inputs, const std::vector<std::string>& backgrounds,
                         SourceOptions camera)
    : background_camera_(std::move(camera)), body_(std::move(body)), inputs_(std::move(inputs)) {
  for (const std::string& source : backgrounds) open_background(source);
}

TrainInputs::TrainInputs(const TrainSources& sources) : background_camera_(sources.camera) {
  if (sources.data.empty() && sources.recipes.empty()) throw UsageError("expected --data or --recipe to train from");
  if (!sources.recipes.empty() && sources.count == 0) throw UsageError("--recipe expects --count, frames to render");
  if (!sources.body.empty()) {
    body_ = parse_body_model(read_file(sources.body), sources.body);
    body_from_ = sources.body;
  }
  for (const std::string& folder : sources.data) {
    inputs_.push_back(open_labelled(folder, sources.count, body_, body_from_));
  }
  if (body_from_.empty()) {
    body_ = paper_body();
    body_from_ = "the paper's body";
  }
  for (const std::string& file : sources.recipes) open_recipe(file, sources);
  if (frames() > kMostFrames) throw UsageError(fmt::format("{} frames, expected at most {}", frames(), kMostFrames));
  for (const std::string& source : sources.backgrounds) open_background(source);
}

void TrainInputs::open_recipe(const std::string& file, const TrainSources& sources) {
  const synth::Recipe recipe = make_recipe({.file = file});
  LoadedAssets loaded = load_assets(recipe, sources.assets);
  for (const std::string& note : loaded.notes) {
    if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(note);
  }
  const DatasetInfo info =
      rendered_info(recipe, loaded, body_, sources.render_seed, static_cast<std::uint64_t>(sources.count));
  const Camera camera = sensor_of(recipe.sensor).camera;
  const auto generator =
      std::make_shared<const synth::Generator>(recipe, std::move(loaded.assets), body_, sources.render_seed);
  inputs_.push_back({.name = file,
                     .made_by = info.recipe,
                     .seed = info.seed,
                     .hash = dataset_hash(info),
                     .frames = sources.count,
                     .width = camera.width,
                     .height = camera.height,
                     .frame = [generator](int i) { return generator->frame(static_cast<std::uint64_t>(i)); }});
}

void TrainInputs::open_background(const std::string& source) {
  const auto frames = open_source(source, background_camera_);
  for (const std::string& note : frames->notes()) notes_.push_back(note);
  const std::optional<Frame> first = frames->next();
  if (!first) throw Error(source + ": no frames in it, expected some without people");
  backgrounds_.push_back({source, frames->size(), first->camera.width, first->camera.height});
}

std::int64_t TrainInputs::frames() const {
  std::int64_t frames = 0;
  for (const TrainInput& input : inputs_) frames += input.frames;
  return frames;
}

std::vector<BackgroundFacts> TrainInputs::read_backgrounds(const TakeFrame& take) const {
  std::vector<BackgroundFacts> all;
  for (const TrainBackground& background : backgrounds_) {
    BackgroundFacts facts;
    Sha256 sum;
    const auto frames = open_source(background.source, background_camera_);
    for (std::optional<Frame> frame = frames->next(); frame; frame = frames->next()) {
      stop_if_interrupted();
      add_to_sum(sum, *frame);
      with_context(background.source, [&] { take(as_background(std::move(*frame))); });
      ++facts.frames;
    }
    facts.sha256 = sum.finish();
    all.push_back(std::move(facts));
  }
  return all;
}

void TrainInputs::read(const Selection& selection, const TakeFrame& take) const {
  int before = 0;
  for (const TrainInput& input : inputs_) {
    std::vector<int> chosen;
    const auto first = int(std::ceil(input.frames * selection.share));
    for (int i = 0; i < first; ++i) {
      if (!selection.wanted || selection.wanted(before + i)) chosen.push_back(i);
    }
    before += input.frames;
    parallel_in_order(
        int(chosen.size()), [&](int i) { return input.frame(chosen[i]); },
        [&](int i, const LabelledFrame& frame) {
          stop_if_interrupted();
          with_context(fmt::format("{}: frame {}", input.name, chosen[i]), [&] { take(frame); });
          return true;
        });
  }
}

}  // namespace vesalius::cli
