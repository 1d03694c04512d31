#include "commands/evaluate/truth_recipe.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "commands/synth/synth_recipe.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "synth/body/poser.h"
#include "synth/generate.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr int kFramesPerThread = 4;

class RecipeTruth final : public TruthSource {
 public:
  RecipeTruth(const std::string& recipe_file, const RenderedTruth& rendered, int step, const BodyModel& body)
      : names_(part_names_of(body)), step_(step) {
    const synth::Recipe recipe = make_recipe({.file = recipe_file});
    AssetPlaces places = rendered.assets;
    places.movements = rendered.clip.has_value();
    LoadedAssets loaded = load_assets(recipe, places);
    notes_ = std::move(loaded.notes);
    notes_.push_back(fmt::format("rendered with seed {}: bodies {}, {} captured poses, checksum of the files used {}",
                                 rendered.seed, loaded.assets.makehuman ? "of MakeHuman" : "built in",
                                 loaded.assets.captured.size(), loaded.sum));
    if (rendered.clip) {
      const auto clips = std::make_shared<const synth::ClipGenerator>(recipe, std::move(loaded.assets), body,
                                                                      rendered.seed, *rendered.clip);
      clips_ = {static_cast<std::uint32_t>(clips->frames_per_clip()), rendered.clip->rate_hz};
      frame_ = [clips](std::uint64_t index) { return clips->frame(index); };
    } else {
      const auto frames =
          std::make_shared<const synth::Generator>(recipe, std::move(loaded.assets), body, rendered.seed);
      frame_ = [frames](std::uint64_t index) { return frames->frame(index); };
    }
    const std::int64_t all = std::int64_t{rendered.count} * std::max<std::int64_t>(1, clips_.frames_per_clip);
    if (all > std::numeric_limits<int>::max()) throw UsageError(fmt::format("{} frames of clips are too many", all));
    count_ = int((all + step - 1) / step);
  }

  std::optional<TrueFrame> next() override {
    if (next_ == count_) return std::nullopt;
    if (taken_ == ready_.size()) render();
    const int clip = clips_.clip_of(static_cast<std::uint64_t>(next_++) * step_);
    return as_true_frame(std::move(ready_[taken_++]), synth::joint_names(), clip);
  }
  int size() const override { return count_; }
  std::vector<std::string> notes() const override { return notes_; }
  std::vector<std::string> part_names() const override { return names_; }

 private:
  void render() {
    ready_ = std::vector<LabelledFrame>(std::min(count_ - next_, kFramesPerThread * std::max(1, thread_count())));
    taken_ = 0;
    parallel_for(int(ready_.size()), [&](int i) { ready_[i] = frame_(static_cast<std::uint64_t>(next_ + i) * step_); });
  }

  std::vector<std::string> names_;
  std::vector<std::string> notes_;
  std::function<LabelledFrame(std::uint64_t index)> frame_;
  ClipLayout clips_;
  std::vector<LabelledFrame> ready_;
  std::size_t taken_ = 0;
  int count_ = 0;
  int step_;
  int next_ = 0;
};

}  // namespace

std::unique_ptr<TruthSource> open_recipe_truth(const std::string& recipe_file, const RenderedTruth& rendered, int step,
                                               const BodyModel& body) {
  if (step < 1) throw UsageError("every 0th frame, expected a step of at least 1");
  if (rendered.count < 1) throw UsageError("--recipe expects --count, frames or clips to render");
  if (rendered.clip) check(*rendered.clip);
  return std::make_unique<RecipeTruth>(recipe_file, rendered, step, body);
}

}  // namespace vesalius::cli
