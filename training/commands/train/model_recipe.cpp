#include "commands/train/model_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <sstream>

#include "commands/synth/synth_recipe.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius::cli {
namespace {

constexpr std::size_t kMaxRecipeBytes = std::size_t{1} << 18;
constexpr int kMaxFrames = 100'000'000, kMaxSeed = 2'000'000'000, kMaxStep = 1'000'000;
constexpr int kFewestFrames = 2;
constexpr int kMostViews = 1'000'000'000, kMostBatch = 65536;
constexpr const char *kForest = "forest", *kNetwork = "network";

/// The texts of a recipe as they stand in its file.
struct Words {
  std::string body, synth_file, model, forest_frames, backgrounds, context_frames, judge_frames;
  std::string labeller = kForest, network_frames, held_out;
};

void visit_set(const std::string& prefix, FrameSet& set, OptionVisitor& visitor) {
  visitor.option(prefix + "data", set.data, {"", 0, 0, "Folder of labelled frames instead of rendered ones"});
  visitor.option(prefix + "looks", set.looks, {"", 0, 0, "Names of [look.NAME] that apply, with commas between"});
  visitor.option(prefix + "count", set.count, {"", 0, kMaxFrames, "Frames"});
  visitor.option(prefix + "seed", set.seed, {"", 0, kMaxSeed, "Seed of `vesalius synth`"});
}

void visit_fit(const std::string& prefix, std::string& frames, int& step, OptionVisitor& visitor) {
  visitor.option(prefix + "frames", frames, {"", 0, 0, "Names of sets, with commas between"});
  visitor.option(prefix + "step", step, {"frames", 1, kMaxStep, "The first of every so many frames"});
}

void visit_network(NetworkOptions& learn, OptionVisitor& visitor) {
  visitor.option("network.config", learn.config, {"", 0, 0, "Size of the network: small or default"});
  visitor.option("network.views", learn.views, {"", 1, kMostViews, "Pictures to learn from"});
  visitor.option("network.batch", learn.batch, {"", 0, kMostBatch, "Pictures at once; 0: what suits the device"});
  visitor.option("network.rate", learn.rate, {"", 0, 1, "Learning rate; 0: what suits the batch"});
  visitor.option("network.seed", learn.seed, {"", 0, kMaxSeed, "Seed of all that is random"});
  visitor.option("network.init", learn.init, {"", 0, 0, "File of weights to begin with"});
  visitor.option("network.python", learn.python, {"", 0, 0, "Python that has PyTorch"});
}

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream words(text);
  for (std::string name; std::getline(words, name, ',');) {
    const std::size_t begin = name.find_first_not_of(' ');
    if (begin != std::string::npos) names.push_back(name.substr(begin, name.find_last_not_of(' ') + 1 - begin));
  }
  return names;
}

std::string without_dots(std::string_view name) { return name.find('.') == name.npos ? std::string(name) : ""; }

class RecipeReader {
 public:
  explicit RecipeReader(const std::string& path)
      : path_(path), reader_(path_), text_(read_file(path, kMaxRecipeBytes)), root_(reader_.parse(text_)) {}

  ModelRecipe read() {
    if (!root_["frames"].is_table()) {
      throw UsageError(path_ +
                       ": no [frames.NAME] in it, expected the recipe of a model; frames of a recipe of synth are "
                       "learned from with --count");
    }
    for (const auto& [name, table] : tables("frames")) recipe_.sets.push_back({.name = name});
    parse_options(text_, path_, [&](OptionVisitor& visitor) { visit(visitor); });
    check(recipe_.forest);
    recipe_.body = resolved(words_.body);
    recipe_.model = resolved(words_.model);
    for (const std::string& place : names_in(words_.backgrounds)) recipe_.backgrounds.push_back(resolved(place));
    recipe_.forest_frames = sets_of("forest", words_.forest_frames);
    recipe_.context.frames = sets_of("context", words_.context_frames);
    recipe_.judge.frames = sets_of("judge", words_.judge_frames);
    recipe_.learn.frames = sets_of("network", words_.network_frames);
    recipe_.learn.held_out = sets_of("network", words_.held_out, "held-out");
    recipe_.learn.init = resolved(recipe_.learn.init);
    if (recipe_.learn.python.find('/') != std::string::npos) recipe_.learn.python = resolved(recipe_.learn.python);
    recipe_.network = is_network();
    recipe_.network ? expect_network() : expect_forest();
    for (FrameSet& set : recipe_.sets) complete(set);
    return std::move(recipe_);
  }

 private:
  std::vector<std::pair<std::string, const toml::table*>> tables(std::string_view kind) const {
    std::vector<std::pair<std::string, const toml::table*>> found;
    if (!root_.contains(kind)) return found;
    for (const auto& [name, node] : reader_.table(*root_.get(kind), kind)) {
      if (without_dots(name.str()).empty())
        reader_.fail(node, in_quotes(name.str()) + ": expected a name without dots");
      found.emplace_back(name.str(), &reader_.table(node, name.str()));
    }
    return found;
  }

  /// Shows everything that may stand in the file, so that what is unknown is refused with its place. What decides how
  /// frames look is read later, set by set.
  void visit(OptionVisitor& visitor) {
    synth::Recipe any;
    visitor.option("body", words_.body, {"", 0, 0, "Body model"});
    visitor.option("synth.recipe", words_.synth_file, {"", 0, 0, "File of more options of synth"});
    visit_options("synth.", any, visitor);
    for (const auto& [name, table] : tables("look")) visit_options("look." + name + ".", any, visitor);
    for (FrameSet& set : recipe_.sets) {
      visit_set("frames." + set.name + ".", set, visitor);
      visit_options("frames." + set.name + ".", any, visitor);
    }
    visitor.option("forest.model", words_.model, {"", 0, 0, "Model whose forest is taken"});
    visitor.option("forest.frames", words_.forest_frames, {"", 0, 0, "Names of sets, with commas between"});
    visitor.option("forest.background", words_.backgrounds, {"", 0, 0, "Sources of frames without people"});
    visit_options("forest.", recipe_.forest, visitor);
    visitor.option("labeller", words_.labeller, {"", 0, 0, "What labels pixels: forest or network"});
    visitor.option("network.frames", words_.network_frames, {"", 0, 0, "Names of sets, with commas between"});
    visitor.option("network.held-out", words_.held_out, {"", 0, 0, "Names of sets that it is measured on"});
    visit_network(recipe_.learn, visitor);
    visit_fit("context.", words_.context_frames, recipe_.context.step, visitor);
    visit_fit("judge.", words_.judge_frames, recipe_.judge.step, visitor);
  }

  std::string resolved(const std::string& path) const {
    if (path.empty()) return path;
    return (std::filesystem::path(path_).parent_path() / path).lexically_normal().string();
  }

  /// Returns the names of a step's sets.
  std::vector<std::string> sets_of(const std::string& step, const std::string& text,
                                   const std::string& option = "frames") {
    std::vector<std::string> known;
    for (const FrameSet& set : recipe_.sets) known.push_back(set.name);
    std::vector<std::string> names = names_in(text);
    for (const std::string& name : names) expect_known(*root_[step][option].node(), "set", name, known);
    used_.insert(names.begin(), names.end());
    return names;
  }

  void expect_known(const toml::node& at, const std::string& kind, const std::string& name,
                    const std::vector<std::string>& known) const {
    if (std::ranges::find(known, name) != known.end()) return;
    const std::string nearest = nearest_name(name, known);
    reader_.fail(at, fmt::format("no {} is called {}{}", kind, in_quotes(name),
                                 nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest)));
  }

  bool is_network() const {
    if (root_.contains("labeller"))
      expect_known(*root_.get("labeller"), "labeller", words_.labeller, {kForest, kNetwork});
    if (words_.labeller == kNetwork) return true;
    if (root_.contains("network")) {
      reader_.fail(*root_.get("network"), "[network] says how a network is learned: expected labeller = \"network\"");
    }
    return false;
  }

  void expect_network() const {
    if (recipe_.learn.frames.empty()) throw Error(path_ + ": expected network.frames, sets to learn from");
    if (root_.contains("forest")) reader_.fail(*root_.get("forest"), "expected no [forest] beside [network]");
    if (const toml::node* config = root_["network"]["config"].node())
      expect_known(*config, "config", recipe_.learn.config, {"small", "default"});
  }

  void expect_forest() const {
    if (recipe_.forest_frames.empty() == recipe_.model.empty()) {
      throw Error(path_ + ": expected one of forest.frames, sets to learn from, and forest.model, a model at hand");
    }
    if (recipe_.model.empty() || (recipe_.backgrounds.empty() && recipe_.body.empty())) return;
    throw Error(path_ + ": forest.model is taken as it is, expected neither body nor forest.background");
  }

  void complete(FrameSet& set) {
    const toml::node& at = *root_["frames"][set.name].node();
    if (!used_.contains(set.name)) reader_.fail(at, fmt::format("no step learns from set {}", in_quotes(set.name)));
    set.data = resolved(set.data);
    if (recipe_.network && !set.data.empty() && set.count > 0) {
      reader_.fail(at, fmt::format("set {}: a network learns from all of its data, expected no count", set.name));
    }
    if (!set.data.empty()) return;
    if (set.count == 0) reader_.fail(at, fmt::format("set {}: expected count, the frames to render", set.name));
    std::vector<std::string> known;
    for (const auto& [name, table] : tables("look")) known.push_back(name);
    std::vector<std::string> overrides{options_of("synth", "")};
    for (const std::string& look : names_in(set.looks)) {
      expect_known(at, "look", look, known);
      overrides.push_back(options_of("look", look));
    }
    overrides.push_back(options_of("frames", set.name));
    set.synth = with_context(reader_.place(at), [&] {
      return make_recipe({.file = resolved(words_.synth_file), .change = [&](synth::Recipe& recipe) {
                            for (const std::string& toml : overrides) {
                              parse_options(toml, path_,
                                            [&](OptionVisitor& visitor) { visit_options("", recipe, visitor); });
                            }
                          }});
    });
  }

  /// Returns the options of synth in a table as TOML.
  std::string options_of(const std::string& kind, const std::string& name) const {
    const auto view = name.empty() ? root_[kind] : root_[kind][name];
    if (!view.is_table()) return "";
    toml::table options = *view.as_table();
    for (const char* own : {"recipe", "data", "looks", "count", "seed"}) options.erase(own);
    std::ostringstream text;
    text << options;
    return text.str();
  }

  std::string path_;
  TomlReader reader_;
  std::string text_;
  toml::table root_;
  Words words_;
  ModelRecipe recipe_;
  std::set<std::string> used_;
};

}  // namespace

const FrameSet& ModelRecipe::set(const std::string& name) const {
  return *std::ranges::find(sets, name, &FrameSet::name);
}

ModelRecipe read_model_recipe(const std::string& path) { return RecipeReader(path).read(); }

void scale(ModelRecipe& recipe, double share) {
  for (FrameSet& set : recipe.sets) {
    if (set.count > 0) set.count = std::max(kFewestFrames, int(std::lround(set.count * share)));
  }
  recipe.learn.views = std::max(1, int(std::lround(recipe.learn.views * share)));
}

}  // namespace vesalius::cli
