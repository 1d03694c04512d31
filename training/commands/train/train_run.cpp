#include "commands/train/train_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "commands/train/grow_display.h"
#include "commands/train/train_recipe.h"
#include "commands/train/train_report.h"
#include "commands/train/train_session.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "cuda/cuda_device.h"
#include "cuda_train/device_executor.h"
#include "cuda_train/train_kernels.h"
#include "io/files/plain_text.h"
#include "train/local_executor.h"
#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"
#include "vesalius/error.h"
#include "vesalius/model.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius::cli {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;
constexpr double kGiB = 1024.0 * kMiB;

/// Makes an executor over the sets, which grows at most so many trees at a time (train/local_executor.h).
using MakeExecutor = std::function<std::unique_ptr<Executor>(const std::vector<TrainingSet*>&, int trees_at_once)>;

/// The devices that a list like "cuda:0,cuda:1" names.
struct Wanted {
  std::string kind;  ///< empty if they are no devices or of several kinds
  std::vector<int> numbers;
};

Wanted parse_list(const std::string& names) {
  Wanted wanted;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    const DeviceName device = parse_device(name);
    if (!wanted.numbers.empty() && device.kind != wanted.kind) return {};
    wanted.kind = device.kind;
    wanted.numbers.push_back(device.number);
  }
  return names.ends_with(',') ? Wanted{} : wanted;
}

constexpr const char* kCards = "cuda";

MakeExecutor open_cards(const std::vector<int>& numbers) {
  std::vector<std::shared_ptr<gpu::Device>> cards;
  cards.reserve(numbers.size());
  for (const int number : numbers) cards.push_back(gpu::open_cuda_device(number, gpu::train_kernels_on_cards()));
  return [cards](const std::vector<TrainingSet*>& sets, int trees_at_once) {
    return std::make_unique<gpu::DeviceExecutor>(sets, cards, trees_at_once);
  };
}

/// What trains: the processor, or one or more cards (`vesalius train --device`).
class TrainDevice {
 public:
  /// Takes a name as on_device does, or several of one kind with commas between. Throws UsageError for a device
  /// that this build does not know and DeviceError for one that this machine does not have. What "auto" decides is said
  /// on standard error.
  explicit TrainDevice(const std::string& names) : any_(names == "auto") {
    if (names == "cpu") return;
    const LabellerDevices known{{{kCards, {}}}, {}};  // for what is said of an unknown one
    const Wanted wanted = any_ ? Wanted{{}, {0}} : parse_list(names);
    if (!any_ && wanted.kind != kCards) throw_unknown_device(names, known);
    try {
      make_ = open_cards(wanted.numbers);
    } catch (const DeviceError& e) {
      if (!any_) throw;
      say("note: " + std::string(e.what()) + "; the processor trains");
    }
  }

  /// Calls `train` with an executor over the sets. Where any device will do and one fails, a note is said and `train`
  /// is called again with an executor on the processor; what it stored until then is not done again.
  void run(const std::vector<TrainingSet*>& sets, int trees_at_once,
           const std::function<void(Executor&)>& train) const {
    if (make_) {
      try {
        train(*make_(sets, trees_at_once));
        return;
      } catch (const DeviceError& e) {
        if (!any_) throw;
        say("note: " + std::string(e.what()) + "; the processor goes on");
      }
    }
    LocalExecutor executor(sets, trees_at_once);
    train(executor);
  }

 private:
  MakeExecutor make_;  ///< empty for the processor
  bool any_ = false;
};

/// Trains one forest and holds what its steps share.
class Training {
 public:
  Training(const TrainRun& run, const TrainOptions& options, const TrainInputs& inputs)
      : run_(run),
        options_(options),
        inputs_(inputs),
        device_(run.device),
        set_(inputs.body(), training_convention(options), options.sample,
             static_cast<std::uint64_t>(options.grow.seed)) {}

  void run(const std::function<TrainPlan()>& plan) {
    const TrainPlan planned = plan();
    trees_at_once_ = planned.trees_at_once;
    tell(fmt::format("about {:.0f} s, at most {:.2f} GiB", planned.seconds, double(planned.bytes) / kGiB));
    if (!run_.report.empty()) make_report_folder(run_.report);
    fill();
    expect_enough();
    if (run_.curves) {
      figures_.curves = train_curves(inputs_, set_, background_frames_, options_, run_.shown);
    }
    const Forest forest = grow();
    save_model(forest, run_.out);
    session_->remove();
    summarise(forest);
    if (!run_.report.empty()) report(forest);
  }

 private:
  /// Reads all frames, the backgrounds first: the recipe contains a hash of their bytes, so a run that does not match
  /// the session is refused before the rest is read.
  void fill() {
    Progress progress(total_frames(), run_.shown);
    const auto add = [&](const LabelledFrame& frame) {
      set_.add(frame);
      progress.step();
      if (set_.bytes() <= run_.max_bytes) return;
      throw Error(fmt::format(
          "{} frames take {:.2f} GiB, --memory allows {:.2f}: expected frames like those measured beforehand",
          progress.done(), double(set_.bytes()) / kGiB, double(run_.max_bytes) / kGiB));
    };
    const std::vector<BackgroundFacts> backgrounds = inputs_.read_backgrounds(add);
    background_frames_ = set_.frames().size();
    recipe_ = train_recipe(options_, inputs_, backgrounds);
    session_.emplace(run_.out + ".work", untrained_forest(), run_.restart);
    inputs_.read({}, add);
    figures_.reading_s = progress.seconds();
    progress.clear();
    tell(fmt::format("{}, {:.2f} million samples, {:.1f} s", counted(std::ssize(set_.frames()), "frame"),
                     double(set_.samples().size()) * 1e-6, figures_.reading_s));
  }

  void expect_enough() {
    const auto body = set_.class_pixels().first(set_.body().part_count());
    const bool people = std::ranges::any_of(body, [](std::uint64_t pixels) { return pixels > 0; });
    const bool judged = run_.report.empty() || !set_.held_out().empty();
    if (people && judged) return;
    session_->remove();
    const std::size_t frames = set_.frames().size();
    if (!people) throw Error(fmt::format("no person in any of {} frames, expected some to learn from", frames));
    throw Error(fmt::format("no frame of {} is held out, --report expects some: --held-out-share up", frames));
  }

  /// Returns the number of frames with an estimate for backgrounds that do not know theirs.
  int total_frames() const {
    std::int64_t frames = inputs_.frames();
    for (const TrainBackground& background : inputs_.backgrounds()) {
      if (background.frames < 0) return -1;
      frames += background.frames;
    }
    return int(frames);
  }

  Forest untrained_forest() const {
    Forest forest = set_.untrained_forest();
    forest.recipe = recipe_;
    return forest;
  }

  Forest grow() {
    Forest forest;
    device_.run({&set_}, trees_at_once_, [&](Executor& executor) {
      TrainDisplay display(set_, options_.grow.leaf.max_depth, run_.shown);
      try {
        forest = train_forest(executor, untrained_forest(), options_, *session_, display);
        figures_.grown = display.totals();
      } catch (const Interrupted&) {
        throw Error(
            fmt::format("interrupted, {} are in {}: the same command goes on", display.done(), session_->folder()));
      }
    });
    return forest;
  }

  void summarise(const Forest& forest) {
    figures_.accuracy = held_out_accuracy(forest, set_);
    figures_.model = run_.out;
    figures_.model_bytes = std::filesystem::file_size(run_.out);
    figures_.threads = thread_count();
    tell(fmt::format("{}: {}, {:.2f} MiB, grown in {:.1f} s", run_.out, counted(std::ssize(forest.trees), "tree"),
                     double(figures_.model_bytes) / kMiB, figures_.grown.seconds));
    if (set_.held_out().empty()) return;
    tell(fmt::format("accuracy {:.3f} ({:.3f} among parts) on {} held-out samples", figures_.accuracy.with_background(),
                     figures_.accuracy.parts_only(), set_.held_out().size()));
  }

  void report(const Forest& forest) {
    figures_.by_trees = accuracy_by_trees(forest, set_);
    figures_.by_level = accuracy_by_level(forest, set_);
    write_report_page(train_report(forest, set_, figures_), run_.report);
    tell(fmt::format("{}/report.html", run_.report));
  }

  void tell(const std::string& text) const {
    if (run_.shown) say(text);
  }

  const TrainRun& run_;
  const TrainOptions& options_;
  const TrainInputs& inputs_;
  TrainDevice device_;
  TrainingSet set_;
  int trees_at_once_ = 1;
  std::size_t background_frames_ = 0;
  std::string recipe_;
  std::optional<TrainSession> session_;
  TrainFigures figures_;
};

}  // namespace

void train(const TrainRun& run, const TrainOptions& options, const TrainInputs& inputs,
           const std::function<TrainPlan()>& plan) {
  Training(run, options, inputs).run(plan);
}

}  // namespace vesalius::cli
