#include "evaluation/evaluate_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr std::size_t kFramesPerThread = 4;
constexpr std::size_t kFailuresKept = 10;

/// A frame that is being scored.
struct Item {
  TrueFrame frame;
  int index = 0;
  FrameScore score;
  std::string failure;
};

class SetEvaluation {
 public:
  SetEvaluation(TruthSource& source, const SetOptions& options, const FrameScorer& scorer, const EvaluationHooks& hooks)
      : source_(source), options_(options), scorer_(scorer), hooks_(hooks) {
    result_.name = options.name;
    result_.source = options.source;
    result_.notes = source.notes();
    check_parts(source.part_names(), scorer.body(), options.source);
  }

  SetResult run() {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t batch = kFramesPerThread * std::max(1, thread_count());
    for (std::vector<Item> items = read(batch); !items.empty(); items = read(batch)) {
      parallel_for(int(items.size()), [&](int i) { score(items[i]); });
      for (Item& item : items) take(std::move(item));
      if (hooks_.stop && hooks_.stop())
        throw Error(fmt::format("{}: interrupted after {} frames", result_.name, index_));
    }
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (result_.frames == 0) throw Error(fmt::format("{}: no frame that could be evaluated", options_.source));
    return std::move(result_);
  }

 private:
  /// Returns the next frames, fewer at the end. Frames that cannot be read are reported.
  std::vector<Item> read(std::size_t count) {
    std::vector<Item> items;
    while (items.size() < count) {
      try {
        std::optional<TrueFrame> frame = source_.next();
        if (!frame) break;
        items.push_back({std::move(*frame), index_, {}, {}});
      } catch (const Error& e) {
        fail(e.what());
      }
      ++index_;
    }
    return items;
  }

  void score(Item& item) const {
    try {
      item.score = scorer_.score(item.frame, options_.fit_joints || item.index % kFitEvery == 0);
    } catch (const Error& e) {
      item.failure = e.what();
    }
  }

  void fail(const std::string& why) {
    if (!options_.keep_going) throw Error(why);
    if (hooks_.failure) hooks_.failure(why);
    ++result_.failed;
    if (result_.failures.size() < kFailuresKept) result_.failures.push_back(why);
  }

  void take(Item item) {
    ++done_;
    if (hooks_.progress) hooks_.progress(done_, source_.size());
    if (!item.failure.empty())
      return fail(fmt::format("{}: frame {}: {}", options_.source, item.frame.frame.name, item.failure));
    ++result_.frames;
    FrameScore& score = item.score;
    result_.metrics.add(frame_key(result_.name.c_str(), item.frame.frame.name.c_str()), score.terms);
    ++result_.log.frames;
    result_.log.expected += score.expected;
    result_.log.proposals.insert(result_.log.proposals.end(), score.proposals.begin(), score.proposals.end());
    result_.joint_precision.add(score.joint_precision);
    result_.centre_precision.add(score.centre_precision);
    if (options_.fit_joints) std::ranges::move(score.known_people, std::back_inserter(result_.known_people));
    if (score.confusion) {
      if (!result_.confusion) result_.confusion.emplace(score.confusion->parts());
      result_.confusion->add(*score.confusion);
    }
    keep_if_worst({std::move(item.frame.frame), std::move(item.score)}, options_.worst, result_.worst);
  }

  TruthSource& source_;
  const SetOptions& options_;
  const FrameScorer& scorer_;
  const EvaluationHooks& hooks_;
  int index_ = 0;
  int done_ = 0;
  SetResult result_;
};

}  // namespace

void check_parts(const std::vector<std::string>& names, const BodyModel& body, const std::string& source) {
  const std::vector<BodyPart>& parts = body.parts;
  for (std::size_t p = 0; p < names.size(); ++p) {
    const std::string ours = p < parts.size() ? parts[p].name : "missing";
    if (ours == names[p]) continue;
    throw Error(fmt::format("{}: part {} is {}, in the model {}", source, p, names[p], ours));
  }
  if (names.empty() || names.size() == parts.size()) return;
  throw Error(fmt::format("{}: {} parts, the model has {}", source, names.size(), parts.size()));
}

void keep_if_worst(WorstFrame frame, std::size_t most, std::vector<WorstFrame>& worst) {
  if (frame.score.what_went_wrong.empty()) return;
  const auto place =
      std::ranges::find_if(worst, [&](const WorstFrame& other) { return other.score.badness < frame.score.badness; });
  worst.insert(place, std::move(frame));
  if (worst.size() > most) worst.pop_back();
}

SetResult evaluate_set(TruthSource& frames, const SetOptions& options, const FrameScorer& scorer,
                       const EvaluationHooks& hooks) {
  return SetEvaluation(frames, options, scorer, hooks).run();
}

}  // namespace vesalius
