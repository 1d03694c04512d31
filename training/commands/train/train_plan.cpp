#include "commands/train/train_plan.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "commands/train/train_curves.h"
#include "train/estimate_training.h"
#include "train/training_memory.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"
#include "vesalius/base/parallel_in_order.h"

namespace vesalius::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
constexpr double kUsedShare = 0.8;         ///< share of the machine's memory; other programs need some too
constexpr int kMeasuredFrames = 64;        ///< frames of each input that are measured
constexpr double kMostMeasuring_s = 5.0;   ///< longest time for measuring each input
constexpr int kUnknownBackgrounds = 1000;  ///< frames of a source that does not say how many it has
constexpr int kPackedFrames = 32;          ///< frames of each input that are packed to see how much memory they take
constexpr double kPackedMargin = 1.1;      ///< factor by which the other frames may take more

double gib(std::uint64_t bytes) { return static_cast<double>(bytes) / kGiB; }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

int class_count(const TrainInputs& inputs, const TrainOptions& options) {
  return inputs.body().part_count() + (options.sample.background_share > 0.F ? 1 : 0);
}

std::vector<FrameGroup> groups_of(const TrainInputs& inputs) {
  std::vector<FrameGroup> groups;
  for (const TrainInput& input : inputs.inputs()) {
    groups.push_back({static_cast<std::uint64_t>(input.frames), 0, false});
  }
  for (const TrainBackground& background : inputs.backgrounds()) {
    const int frames = background.frames >= 0 ? background.frames : kUnknownBackgrounds;
    groups.push_back({static_cast<std::uint64_t>(frames), 0, true});
  }
  return groups;
}

/// Estimates the memory of an input's frame from some of its frames, because the size of packed depth depends on its
/// content.
std::uint64_t measured_frame_bytes(const TrainInput& input) {
  const int count = std::min(input.frames, kPackedFrames);
  std::uint64_t bytes = 0;
  parallel_in_order(
      count,
      [&](int i) {
        const auto number = static_cast<std::int64_t>(i) * input.frames / count;
        return FrameStore::frame_bytes(input.frame(static_cast<int>(number)).frame.depth);
      },
      [&](int /*i*/, std::uint64_t of_frame) {
        bytes += of_frame;
        return true;
      });
  return static_cast<std::uint64_t>(kPackedMargin * static_cast<double>(bytes) / count);
}

/// Returns groups_of() with the measured bytes. All frames are held `copies` times.
std::vector<FrameGroup> measured_groups(const TrainInputs& inputs, double copies) {
  std::vector<FrameGroup> groups = groups_of(inputs);
  for (FrameGroup& group : groups) {
    group.frames = static_cast<std::uint64_t>(std::ceil(copies * static_cast<double>(group.frames)));
  }
  const std::size_t input_count = inputs.inputs().size();
  for (std::size_t i = 0; i < input_count; ++i) groups[i].frame_bytes = measured_frame_bytes(inputs.inputs()[i]);
  for (std::size_t i = input_count; i < groups.size(); ++i) {
    const TrainBackground& background = inputs.backgrounds()[i - input_count];
    groups[i].frame_bytes = FrameStore::most_frame_bytes(background.width, background.height);
  }
  return groups;
}

/// Returns the peak memory in bytes that the program has taken so far, for its libraries and open sources.
std::uint64_t own_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;
}

[[noreturn]] void refuse(const TrainInputs& inputs, const TrainOptions& options, std::span<const FrameGroup> groups,
                         std::uint64_t needed, std::uint64_t own, std::uint64_t limit) {
  const std::uint64_t left = limit > own ? limit - own : 0;
  const TrainingFit fit = training_fit(groups, options, class_count(inputs, options), left);
  const auto frames = static_cast<std::int64_t>(std::floor(static_cast<double>(inputs.frames()) * fit.frame_share));
  throw Error(
      fmt::format("training on {} frames with {} pixels each takes {:.2f} GiB, --memory allows {:.2f}: expected "
                  "--memory {:.1f}{}{}",
                  inputs.frames(), options.sample.pixels_per_frame, gib(needed), gib(limit),
                  std::ceil(10.0 * gib(needed)) / 10.0, frames > 0 ? fmt::format(", or {} frames", frames) : "",
                  fit.pixels > 0 ? fmt::format(", or --pixels {}", fit.pixels) : ""));
}

/// Measurements of an input: some frames that are made and dropped, and the time that all frames will take.
struct Measured {
  std::vector<LabelledFrame> frames;
  double seconds = 0.0;
};

Measured measure(const TrainInput& input, const TrainInputs& inputs, const TrainOptions& options) {
  Measured measured;
  TrainingSet set(inputs.body(), training_convention(options), options.sample, 1);
  const Clock::time_point start = Clock::now();
  parallel_in_order(
      std::min(input.frames, kMeasuredFrames), [&](int i) { return input.frame(i); },
      [&](int /*i*/, LabelledFrame frame) {
        set.add(frame);
        frame.frame.colour = {};
        measured.frames.push_back(std::move(frame));
        return seconds_since(start) < kMostMeasuring_s;
      });
  measured.seconds = seconds_since(start) / static_cast<double>(measured.frames.size()) * input.frames;
  return measured;
}

std::string duration(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : fmt::format("{:.1f} h", seconds / 3600.0);
}

}  // namespace

std::uint64_t default_memory() {
  const auto pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES));
  const auto page_bytes = static_cast<double>(::sysconf(_SC_PAGESIZE));
  return static_cast<std::uint64_t>(kUsedShare * pages * page_bytes);
}

MemoryPlan plan_memory(const TrainInputs& inputs, const TrainOptions& options, bool curves, std::uint64_t limit) {
  const std::vector<FrameGroup> groups = measured_groups(inputs, curves ? 1.0 + kCurveFrames : 1.0);
  const TrainingMemory memory = training_memory(groups, options, class_count(inputs, options));
  const std::uint64_t own = own_memory();
  if (own + memory.total(1) > limit) refuse(inputs, options, groups, own + memory.total(1), own, limit);
  MemoryPlan plan;
  const int most = std::min(thread_count(), std::max(options.trees, 1));
  while (plan.trees_at_once < most && own + memory.total(plan.trees_at_once + 1) <= limit) ++plan.trees_at_once;
  plan.bytes = own + memory.total(plan.trees_at_once);
  return plan;
}

std::string estimate_text(const TrainInputs& inputs, const TrainOptions& options, const MemoryPlan& plan) {
  std::vector<LabelledFrame> frames;
  double reading_s = 0.0;
  for (const TrainInput& input : inputs.inputs()) {
    Measured measured = measure(input, inputs, options);
    reading_s += measured.seconds;
    std::ranges::move(measured.frames, std::back_inserter(frames));
  }
  const std::uint64_t samples = expected_samples(groups_of(inputs), options);
  const GrowthEstimate growth = estimate_growth(frames, inputs.body(), samples, options, plan.trees_at_once);
  std::string text;
  text += fmt::format("frames        {} in {}, {:.1f} a second\n", inputs.frames(), duration(reading_s),
                      static_cast<double>(inputs.frames()) / reading_s);
  text += fmt::format("samples       {:.2f} million\n", static_cast<double>(samples) * 1e-6);
  text += fmt::format("evaluations   {:.1f} thousand million, {:.0f} million a second on {} threads\n",
                      growth.evaluations * 1e-9, growth.evaluations_per_s * 1e-6, thread_count());
  text +=
      fmt::format("trees         {} in {}, {} at a time\n",
                  options.trees + (class_count(inputs, options) > inputs.body().part_count() ? options.hard_trees : 0),
                  duration(growth.seconds()), plan.trees_at_once);
  text += fmt::format("time          {:.0f} s in all ({})\n", reading_s + growth.seconds(),
                      duration(reading_s + growth.seconds()));
  text += fmt::format("memory        at most {:.2f} GiB\n", gib(plan.bytes));
  return text;
}

}  // namespace vesalius::cli
