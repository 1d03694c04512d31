#include "cli/evaluate/truth_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cli/synth/synth_recipe.h"
#include "dataset/open_truth.h"
#include "synth/skeleton_joints.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kFramesPerThread = 4;

class RecipeTruth final : public TruthSource {
 public:
  RecipeTruth(const std::string& recipe_file, const RenderedTruth& rendered, int step, const BodyModel& body)
      : names_(part_names_of(body)), count_((rendered.count + step - 1) / step), step_(step) {
    const synth::Recipe recipe = make_recipe({.file = recipe_file});
    LoadedAssets loaded = load_assets(recipe, rendered.assets);
    notes_ = std::move(loaded.notes);
    notes_.push_back(fmt::format("rendered with seed {}: bodies {}, {} captured poses, checksum of the files used {}",
                                 rendered.seed, loaded.assets.makehuman ? "of MakeHuman" : "built in",
                                 loaded.assets.captured.size(), loaded.sum));
    generator_ = std::make_unique<synth::Generator>(recipe, std::move(loaded.assets), body, rendered.seed);
  }

  std::optional<TrueFrame> next() override {
    if (next_ == count_) return std::nullopt;
    if (taken_ == ready_.size()) render();
    ++next_;
    return as_true_frame(std::move(ready_[taken_++]), synth::joint_names());
  }
  int size() const override { return count_; }
  std::vector<std::string> notes() const override { return notes_; }
  std::vector<std::string> part_names() const override { return names_; }

 private:
  void render() {
    ready_ = std::vector<LabelledFrame>(std::min(count_ - next_, kFramesPerThread * std::max(1, thread_count())));
    taken_ = 0;
    parallel_for(static_cast<int>(ready_.size()),
                 [&](int i) { ready_[i] = generator_->frame(static_cast<std::uint64_t>(next_ + i) * step_); });
  }

  std::vector<std::string> names_;
  std::vector<std::string> notes_;
  std::unique_ptr<synth::Generator> generator_;
  std::vector<LabelledFrame> ready_;
  std::size_t taken_ = 0;
  int count_;
  int step_;
  int next_ = 0;
};

}  // namespace

std::unique_ptr<TruthSource> open_recipe_truth(const std::string& recipe_file, const RenderedTruth& rendered, int step,
                                               const BodyModel& body) {
  if (step < 1) throw UsageError("every 0th frame, expected a step of at least 1");
  if (rendered.count < 1) throw UsageError("--recipe expects --count, frames to render");
  return std::make_unique<RecipeTruth>(recipe_file, rendered, step, body);
}

}  // namespace vesalius::cli
