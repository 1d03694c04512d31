#include "commands/train/make_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "commands/synth/frame_maker.h"
#include "commands/synth/synth_recipe.h"
#include "commands/train/learn_network.h"
#include "commands/train/set_samples.h"
#include "commands/train/train_plan.h"
#include "commands/train/train_recipe.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_frame_codec.h"
#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "downloads/sha256.h"
#include "folders/owned_folder.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "io/files/plain_text.h"
#include "io/model/model_contents.h"
#include "learn/fit_boosted.h"
#include "learn/fit_vote_judge.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
constexpr int kMeasuredFrames = 48, kFewestMeasured = 4, kMostMeasured = 16;  ///< in all sets; in one
constexpr double kMargin = 1.1;  ///< by which the other frames may take more
// Bytes of a sample besides its features; of each of these, as it is, where it is read from a file, and in its bin.
constexpr double kSampleBytes = sizeof(BoostSample) + 16.0, kFeatureBytes = 2 * sizeof(float) + 1.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Loads what recipes use, once for all that use the same.
class AssetCache {
 public:
  explicit AssetCache(AssetPlaces places) : places_(std::move(places)) {}

  std::shared_ptr<const LoadedAssets> load(synth::Recipe recipe) {
    std::string key;
    for (const OptionText& option : list_options([&](OptionVisitor& v) { visit_options("", recipe, v); })) {
      const bool poses = option.name.starts_with("pose.") && !option.name.starts_with("pose.sampler.");
      if (poses || option.name == "body.kind") key += option.name + "=" + option.value + "\n";
    }
    std::shared_ptr<const LoadedAssets>& loaded = loaded_[key];
    if (!loaded) loaded = std::make_shared<const LoadedAssets>(load_assets(recipe, places_));
    return loaded;
  }
  const std::map<std::string, std::shared_ptr<const LoadedAssets>>& all() const { return loaded_; }

 private:
  AssetPlaces places_;
  std::map<std::string, std::shared_ptr<const LoadedAssets>> loaded_;
};

/// A set of the recipe with what its frames are made from.
struct Source {
  const FrameSet* set = nullptr;
  std::string folder;
  std::shared_ptr<const LoadedAssets> assets = {};  ///< for rendered frames, as all below
  DatasetInfo info = {};
  TrainInput input = {};  ///< rendered frames: without `frame`

  FrameMaker maker() const {
    return make_frame_maker(set->synth, assets->assets, parse_body_model(info.body_toml, folder), info.seed, {});
  }
};

/// Returns whether the folder has frames that the description tells, perhaps not all.
bool has_frames_of(const DatasetInfo& info, const std::string& folder) {
  if (!is_dataset(folder)) return false;
  try {
    const std::string path = description_path(folder);
    return dataset_hash(parse_description(read_file(path), path)) == dataset_hash(info);
  } catch (const Error&) {
    return false;
  }
}

std::uint64_t missing_frames(const Source& source) {
  if (!source.set->data.empty()) return 0;
  const bool ours = has_frames_of(source.info, source.folder);
  std::uint64_t missing = 0;
  for (std::uint64_t shard = 0; shard < shard_count(source.info); ++shard) {
    if (!ours || !fs::exists(shard_path(source.folder, shard))) missing += frames_of_shard(source.info, shard).count;
  }
  return missing;
}

/// Some frames of a set, and what all that are missing would take.
struct Measured {
  std::vector<LabelledFrame> frames;
  double seconds = 0.0, bytes = 0.0;
};

Measured measure(const Source& source, int most) {
  const int count = std::min(most, source.input.frames);
  Measured measured;
  measured.frames.resize(static_cast<std::size_t>(count));
  const auto number = [&](int i) { return std::int64_t{source.input.frames} * i / count; };
  if (!source.set->data.empty()) {
    parallel_for(count, [&](int i) { measured.frames[i] = source.input.frame(int(number(i))); });
    return measured;
  }
  const FrameMaker maker = source.maker();
  const int parts = parse_body_model(source.info.body_toml, source.folder).part_count();
  std::vector<double> bytes(static_cast<std::size_t>(count));
  const auto render = [&] {
    const Clock::time_point start = Clock::now();
    parallel_for(count, [&](int i) {
      const auto index = static_cast<std::uint64_t>(number(i));
      measured.frames[i] = maker.frame(index);
      bytes[i] = double(encode_frame({index, source.info.seed, measured.frames[i]}, parts).size());
    });
    return seconds_since(start) / count;
  };
  // A body is made when the first frame shows it: frames take longer until all have been shown.
  const double first_s = render(), again_s = render();
  const double missing = double(missing_frames(source)), times = missing / count;
  const double new_bodies = std::min(missing, double(source.set->synth.body.count));
  measured.seconds = missing * again_s + new_bodies * std::max(0.0, first_s - again_s);
  for (const double each : bytes) measured.bytes += times * each;
  return measured;
}

}  // namespace

class ModelMaker::Work {
 public:
  Work(Run run, ModelRecipe recipe)
      : run_(std::move(run)), recipe_(std::move(recipe)), folder_(run_.train.out + ".work"), assets_(run_.assets) {
    if (!recipe_.model.empty()) {
      at_hand_ = load_model(recipe_.model);
      at_hand_->context = {};
      at_hand_->judge = {};
      body_ = at_hand_->body;
      body_from_ = recipe_.model;
    }
    if (!recipe_.body.empty()) {
      body_ = parse_body_model(read_file(recipe_.body), recipe_.body);
      body_from_ = recipe_.body;
    }
    for (const FrameSet& set : recipe_.sets) {
      if (!set.data.empty()) open_data(set);
    }
    if (body_from_.empty()) body_ = paper_body();
    for (const FrameSet& set : recipe_.sets) {
      if (set.data.empty()) open_rendered(set);
    }
    name_steps();
    if (!run_.train.shown) return;
    for (const auto& [key, loaded] : assets_.all()) {
      for (const std::string& note : loaded->notes) say("note: " + note);
    }
  }

  std::string estimate() { return is_made() ? run_.train.out + ": made by this recipe already\n" : plan(); }

  void make() {
    if (!run_.train.restart && is_made()) return tell(run_.train.out + ": made by this recipe already");
    if (recipe_.network && !grown()) expect_network_tool(recipe_.learn);
    const FolderLock lock(folder_);
    if (run_.train.restart) remove_work();
    tell(plan());
    const auto start = Clock::now();
    Model model = recipe_.network ? learn() : grow();
    if (!recipe_.context.frames.empty()) model.context = fitted(context_, model, fit_context);
    if (!recipe_.judge.frames.empty())
      model.judge = fitted(judge_, model, model.network != nullptr ? fit_vote_judge : fit_judge);
    save_model(model, run_.train.out);
    const std::string labeller =
        model.network != nullptr ? "a network" : counted(std::ssize(model.forest.trees), "tree");
    tell(fmt::format("{}: {}{}{}, {:.2f} MiB, made in {}; {} keeps frames and steps for a changed recipe",
                     run_.train.out, labeller, model.context.empty() ? "" : ", a context",
                     model.judge.empty() ? "" : ", a judge", double(fs::file_size(run_.train.out)) / 1024.0 / 1024.0,
                     duration(seconds_since(start)), folder_));
  }

 private:
  /// A step that fits boosted trees to samples of sets.
  struct Step {
    std::string name;
    const FitSets* sets = nullptr;
    std::string before;  ///< how the model was made that the samples are taken with
    std::string recipe;  ///< how what this step adds is made; empty for a step that the recipe lacks
    SampleFrame (*sampler)(const Model&) = nullptr;
  };

  /// Returns a model whose pixels a network labels.
  Model learn() {
    if (std::optional<Model> model = grown()) return std::move(*model);
    const std::string learned = learn_network(
        recipe_.learn, {datasets_of(recipe_.learn.frames), datasets_of(recipe_.learn.held_out), folder_ + "/network",
                        run_.train.device, run_.train.max_bytes, run_.train.restart, run_.train.shown});
    Network network = load_network(learned, body_.part_count());
    network.made_from = forest_recipe_;
    Model model;
    model.body = body_;
    model.network = std::make_shared<Network>(std::move(network));
    save_model(model, grown_path());
    return model;
  }

  /// Renders what is missing of sets. Returns their folders.
  std::vector<std::string> datasets_of(const std::vector<std::string>& names) {
    std::vector<std::string> folders;
    for (const std::string& name : names) {
      render(sources_.at(name));
      folders.push_back(sources_.at(name).folder);
    }
    return folders;
  }

  void open_data(const FrameSet& set) {
    Source source{.set = &set, .folder = set.data};
    source.input = open_labelled(set.data, set.count, body_, body_from_);
    sources_.emplace(set.name, std::move(source));
  }

  void open_rendered(const FrameSet& set) {
    Source source{.set = &set, .folder = folder_ + "/frames/" + set.name, .assets = assets_.load(set.synth)};
    source.info = rendered_info(set.synth, *source.assets, body_, static_cast<std::uint64_t>(set.seed),
                                static_cast<std::uint64_t>(set.count));
    const Camera camera = sensor_of(set.synth.sensor).camera;
    source.input = {.name = set.name,
                    .made_by = source.info.recipe,
                    .seed = source.info.seed,
                    .hash = dataset_hash(source.info),
                    .frames = set.count,
                    .width = camera.width,
                    .height = camera.height,
                    .frame = {}};
    sources_.emplace(set.name, std::move(source));
  }

  std::vector<TrainInput> inputs_of(const std::vector<std::string>& names) const {
    std::vector<TrainInput> inputs;
    inputs.reserve(names.size());
    for (const std::string& name : names) inputs.push_back(sources_.at(name).input);
    return inputs;
  }

  /// Says how each section of the model is made. Equal texts mean equal sections.
  void name_steps() {
    if (recipe_.network) {
      forest_recipe_ = network_recipe(recipe_.learn, body_, inputs_of(recipe_.learn.frames));
    } else if (!at_hand_) {
      const TrainInputs inputs(body_, inputs_of(recipe_.forest_frames), recipe_.backgrounds, run_.camera);
      const auto facts = inputs.read_backgrounds([](const LabelledFrame&) {});
      forest_recipe_ = train_recipe(recipe_.forest, inputs, facts);
    } else {
      forest_recipe_ = labeller_recipe(*at_hand_);
    }
    std::string made = forest_recipe_;
    const auto name = [&](const char* kind, const char* what, const FitSets& sets, auto sampler) {
      Step step{kind, &sets, made, {}, sampler};
      if (!sets.frames.empty()) step.recipe = fitted_recipe(what, sets.step, inputs_of(sets.frames), made);
      made += step.recipe;
      return step;
    };
    context_ = name("context", "context of bodies", recipe_.context, context_sampler);
    judge_ = name("judge", "judge of people", recipe_.judge, judge_sampler);
  }

  /// Returns the model in a file if its forest was made as this one is to be.
  std::optional<Model> model_with_this_forest(const std::string& path) const {
    if (!fs::exists(path)) return std::nullopt;
    try {
      Model model = load_model(path);
      if (labeller_recipe(model) == forest_recipe_) return model;
    } catch (const Error&) {  // a damaged model is made again
    }
    return std::nullopt;
  }
  bool is_made() const {
    const std::optional<Model> model = model_with_this_forest(run_.train.out);
    return model && model->context.made_from == context_.recipe && model->judge.made_from == judge_.recipe;
  }
  std::string grown_path() const { return folder_ + "/grown.forest"; }
  std::optional<Model> grown() const { return at_hand_ ? at_hand_ : model_with_this_forest(grown_path()); }

  void remove_work() const {
    for (const char* name : {"frames", "samples", "grown.forest", "grown.forest.work", "network"}) {
      fs::remove_all(fs::path(folder_) / name);
    }
  }

  /// Renders what is missing of a set.
  void render(const Source& source) {
    if (!source.set->data.empty() || !rendered_.insert(source.set->name).second) return;
    if (!has_frames_of(source.info, source.folder)) fs::remove_all(source.folder);
    write_dataset(source.folder, source.maker(), source.info, run_.train.shown);
  }

  Model grow() {
    if (std::optional<Model> model = grown()) return std::move(*model);
    TrainSources sources;
    sources.backgrounds = recipe_.backgrounds;
    sources.camera = run_.camera;
    sources.data = datasets_of(recipe_.forest_frames);
    TrainRun run = run_.train;
    run.out = grown_path();
    run.restart = !fs::exists(run.out + ".work/recipe.toml") ||
                  read_file(run.out + ".work/recipe.toml") != forest_recipe_;  // trees of an earlier recipe
    if (!run_.cluster.engine.on.empty()) {
      train_on_cluster(run, recipe_.forest, sources, run_.cluster);
    } else {
      std::vector<TrainInput> inputs;
      for (const std::string& name : recipe_.forest_frames) {
        const Source& source = sources_.at(name);
        inputs.push_back(open_labelled(source.folder, source.set->count, body_, body_from_));
      }
      train(run, recipe_.forest, TrainInputs(body_, std::move(inputs), recipe_.backgrounds, run_.camera),
            [&] { return *plan_; });
    }
    return load_model(run.out);
  }

  std::string samples_path(const Step& step, const std::string& set) const {
    return fmt::format("{}/samples/{}-{}", folder_, step.name, set);
  }
  /// Says what a set's samples are made from.
  std::string samples_key(const Step& step, const Source& source) const {
    return fmt::format("{} of {:016x}, {} frames by {}, by a model made by {}\n", step.name, source.input.hash,
                       source.input.frames, step.sets->step, sha256_of(step.before));
  }

  /// Returns what a step adds. A trial goes on without it where its few frames have samples of one kind alone.
  BoostedTrees fitted(const Step& step, const Model& model,
                      BoostedTrees (*fit)(const std::vector<BoostSample>&, const BodyModel&)) {
    const std::vector<BoostSample> samples = samples_of(step, model);
    try {
      BoostedTrees trees = fit(samples, model.body);
      trees.made_from = step.recipe;
      return trees;
    } catch (const Error& e) {
      if (!run_.trial) throw;
      tell(fmt::format("note: {}; this trial goes on without", e.what()));
      return {};
    }
  }

  std::vector<BoostSample> samples_of(const Step& step, const Model& model) {
    const SampleFrame sample = step.sampler(model);
    std::vector<BoostSample> all;
    for (const std::string& name : step.sets->frames) {
      std::ranges::move(samples_of(step, sources_.at(name), sample), std::back_inserter(all));
    }
    const auto positive = std::ranges::count(all, true, &BoostSample::positive);
    tell(fmt::format("{}: {} samples of people, {} of other things", step.name, positive, std::ssize(all) - positive));
    return all;
  }

  std::vector<BoostSample> samples_of(const Step& step, const Source& source, const SampleFrame& sample) {
    const std::string path = samples_path(step, source.set->name), key = samples_key(step, source);
    if (auto samples = read_samples(path, key)) return std::move(*samples);
    render(source);
    const auto frames = open_truth(source.folder, step.sets->step);
    tell(fmt::format("{}: frames of set {}", step.name, source.set->name));
    Progress progress(frames->size(), run_.train.shown);
    std::vector<BoostSample> samples = cli::samples_of(*frames, sample, [&] { progress.step(); });
    progress.clear();
    fs::create_directories(folder_ + "/samples");
    write_samples(path, key, samples);
    return samples;
  }

  /// Returns the sets of a step whose samples are not there yet.
  std::vector<std::string> pending(const Step& step) const {
    std::vector<std::string> names;
    for (const std::string& name : step.sets->frames) {
      if (!read_samples(samples_path(step, name), samples_key(step, sources_.at(name)))) names.push_back(name);
    }
    return names;
  }

  /// Returns the sets whose frames are asked for, by their steps.
  std::map<std::string, std::vector<std::string>> needed_sets(bool grown) const {
    std::map<std::string, std::vector<std::string>> needed;
    if (!grown && !recipe_.network) needed["forest"] = recipe_.forest_frames;
    if (!grown && recipe_.network) {
      needed["network"] = recipe_.learn.frames;
      needed["held out"] = recipe_.learn.held_out;
    }
    for (const Step* step : {&context_, &judge_}) needed[step->name] = pending(*step);
    return needed;
  }

  std::string plan() {
    std::optional<Model> model = grown();
    std::map<std::string, std::vector<std::string>> needed = needed_sets(model.has_value());
    std::map<std::string, Measured> measured;
    for (const auto& [step, names] : needed) {
      for (const std::string& name : names) measured[name];
    }
    const int of_each = std::clamp(kMeasuredFrames / std::max(1, int(measured.size())), kFewestMeasured, kMostMeasured);
    std::string text;
    double seconds = 0.0, bytes = 0.0, memory = 0.0;
    for (auto& [name, set] : measured) {
      const Source& source = sources_.at(name);
      set = measure(source, of_each);
      seconds += set.seconds;
      bytes += kMargin * set.bytes;
      if (set.seconds > 0.0) {
        text += fmt::format("frames {:<22} {} of {} in {}, {:.2f} GiB\n", name, missing_frames(source),
                            source.input.frames, duration(set.seconds), set.bytes / kGiB);
      }
    }
    if (!model && recipe_.network) {
      text += fmt::format("frames                        about {}; the network's training then says its own\n",
                          duration(seconds));
      return text + disk(bytes);
    }
    if (!model) {
      const bool alone = run_.cluster.engine.on.empty();  // engines divide the frames among machines
      plan_ = plan_training(cycling(measured), recipe_.forest, run_.train.curves,
                            alone ? run_.train.max_bytes : std::numeric_limits<std::uint64_t>::max());
      seconds += plan_->seconds - plan_->reading_s;
      text += plan_->steps.substr(plan_->steps.find('\n') + 1);
      Forest pilot = plan_->pilot;
      if (!pilot.trees.empty()) pilot.trees.resize(static_cast<std::size_t>(recipe_.forest.trees), pilot.trees[0]);
      model = std::move(pilot);
    }
    for (const Step* step : {&context_, &judge_}) {
      const bool labels = model->network != nullptr || !model->forest.trees.empty();
      if (needed[step->name].empty() || !labels) continue;
      const Sampling sampling = sampling_of(*step, needed[step->name], measured, *model);
      expect_memory(*step, sampling.bytes);
      const double step_s = sampling.seconds;
      seconds += step_s;
      memory = std::max(memory, sampling.bytes);
      text += fmt::format("{:<29} samples of {} in {}\n", step->name, fmt::join(needed[step->name], ", "),
                          duration(step_s));
    }
    text += fmt::format("time                          about {}\n", duration(seconds));
    if (plan_) memory = std::max(memory, double(plan_->bytes));
    text += fmt::format("memory                        at most {:.2f} GiB\n", memory / kGiB);
    return text + disk(bytes);
  }

  /// Returns the forest's sets with the frames that were measured in the place of all.
  TrainInputs cycling(const std::map<std::string, Measured>& measured) const {
    std::vector<TrainInput> inputs = inputs_of(recipe_.forest_frames);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const std::vector<LabelledFrame>& frames = measured.at(recipe_.forest_frames[i]).frames;
      inputs[i].frame = [&frames, per = std::max(1, inputs[i].frames / int(frames.size()))](int number) {
        return frames[std::size_t(number / per) % frames.size()];
      };
    }
    return {body_, std::move(inputs), recipe_.backgrounds, run_.camera};
  }

  /// What the samples of some sets take.
  struct Sampling {
    double seconds = 0.0, bytes = 0.0;
  };
  Sampling sampling_of(const Step& step, const std::vector<std::string>& names,
                       const std::map<std::string, Measured>& measured, const Model& model) const {
    const SampleFrame sample = step.sampler(model);
    Sampling sampling;
    for (const std::string& name : names) {
      const std::vector<LabelledFrame>& frames = measured.at(name).frames;
      std::vector<std::vector<BoostSample>> found(kFewestMeasured);
      const Clock::time_point start = Clock::now();
      parallel_for(kFewestMeasured,
                   [&](int i) { found[i] = sample(as_true_frame(frames[std::size_t(i) % frames.size()])); });
      const double times = double(sources_.at(name).input.frames) / step.sets->step / kFewestMeasured;
      sampling.seconds += times * seconds_since(start);
      for (const std::vector<BoostSample>& each : found) {
        for (const BoostSample& one : each)
          sampling.bytes += times * (kSampleBytes + kFeatureBytes * double(one.features.size()));
      }
    }
    return sampling;
  }

  void expect_memory(const Step& step, double bytes) const {
    if (bytes <= double(run_.train.max_bytes)) return;
    throw Error(
        fmt::format("the samples of the {} take about {:.2f} GiB, --memory allows {:.2f}: expected a larger step",
                    step.name, bytes / kGiB, double(run_.train.max_bytes) / kGiB));
  }

  /// Says how much of the disk is taken. Throws Error where there is less.
  std::string disk(double bytes) const {
    const fs::path place = fs::absolute(folder_).parent_path();
    std::error_code ignored;
    const fs::space_info space = fs::space(place, ignored);
    if (!ignored && bytes > double(space.available)) {
      throw Error(
          fmt::format("{}: frames take about {:.2f} GiB, the disk has {:.2f}: expected another place for --out, "
                      "fewer frames (--scale)",
                      folder_, bytes / kGiB, double(space.available) / kGiB));
    }
    return fmt::format("disk                          {:.2f} GiB more in {}\n", bytes / kGiB, folder_);
  }

  void tell(const std::string& text) const {
    if (!run_.train.shown) return;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) say(line);
  }

  Run run_;
  ModelRecipe recipe_;
  std::string folder_;
  AssetCache assets_;
  BodyModel body_;
  std::string body_from_;
  std::optional<Model> at_hand_;  ///< a model at hand, without context and judge
  std::map<std::string, Source> sources_;
  std::set<std::string> rendered_;  ///< sets that this run has completed
  std::string forest_recipe_;
  Step context_, judge_;
  std::optional<TrainPlan> plan_;  ///< plan of the forest
};

ModelMaker::ModelMaker(Run run, ModelRecipe recipe)
    : work_(std::make_unique<Work>(std::move(run), std::move(recipe))) {}
ModelMaker::~ModelMaker() = default;
std::string ModelMaker::estimate() { return work_->estimate(); }
void ModelMaker::make() { work_->make(); }

}  // namespace vesalius::cli
