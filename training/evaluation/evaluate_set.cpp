#include "evaluation/evaluate_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/files/plain_text.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"
#include "vesalius/track_people.h"

namespace vesalius {
namespace {

constexpr std::size_t kFramesPerThread = 4;
constexpr std::size_t kFailuresKept = 10;
constexpr std::size_t kWorstKept = 3;
/// The first of every so many frames is for fitting joints and is left out of the joints' metrics.
constexpr int kFitEvery = 10;
/// Consecutive frames that are resampled together for intervals: what one frame shows, the next ones show too.
constexpr std::size_t kFramesPerBlock = 30;

/// Throws Error naming the source unless its parts, if it has any, are the body's.
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

/// Adds a frame to the worst ones, of which the worst is first, if something went wrong in it and it is among the
/// kWorstKept worst.
void keep_if_worst(WorstFrame frame, std::vector<WorstFrame>& worst) {
  if (frame.score.what_went_wrong.empty()) return;
  const auto place =
      std::ranges::find_if(worst, [&](const WorstFrame& other) { return other.score.badness < frame.score.badness; });
  worst.insert(place, std::move(frame));
  if (worst.size() > kWorstKept) worst.pop_back();
}

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
        throw Error(fmt::format("{}: interrupted after {}", result_.name, counted(index_, "frame")));
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
    keep_if_worst({std::move(item.frame.frame), std::move(item.score)}, result_.worst);
  }

  TruthSource& source_;
  const SetOptions& options_;
  const FrameScorer& scorer_;
  const EvaluationHooks& hooks_;
  int index_ = 0;
  int done_ = 0;
  SetResult result_;
};

/// What a block of consecutive frames adds to the metrics.
struct Block {
  std::string name;  ///< name of its first frame
  MetricTerms terms;
};

/// What one recording adds to the result of its set.
struct SequenceResult {
  int frames = 0;
  std::vector<Block> blocks;
  std::vector<WorstFrame> worst;
  std::vector<TrustSample> trust_samples;
  std::vector<StanceSample> stance_samples;
};

/// One recording while its frames come.
class SequenceEvaluation {
 public:
  SequenceEvaluation(const SetOptions& options, const FrameScorer& judge, const SequenceTrackerFactory& trackers,
                     SequenceScorer::Options scored)
      : options_(options), tracker_(trackers()), scorer_(judge, scored) {}

  /// Throws Error naming the source and the frame.
  void add(TrueFrame frame) {
    const std::string name = frame.frame.name;
    try {
      TrackedFrame tracked = tracker_(frame.frame);
      Frame shown = frame.frame;
      FrameScore score = scorer_.add(std::move(frame), std::move(tracked));
      names_.push_back(name);
      of_frames_.push_back(std::move(score.terms));
      keep_if_worst({std::move(shown), std::move(score)}, result_.worst);
    } catch (const Error& e) {
      throw Error(fmt::format("{}: frame {}: {}", options_.source, name, e.what()));
    }
  }

  SequenceResult finish() {
    const std::vector<MetricTerms> more = scorer_.finish();
    for (std::size_t i = 0; i < of_frames_.size(); ++i) {
      if (i % kFramesPerBlock == 0) result_.blocks.push_back({names_[i], {}});
      MetricTerms& terms = result_.blocks.back().terms;
      terms.insert(terms.end(), of_frames_[i].begin(), of_frames_[i].end());
      terms.insert(terms.end(), more[i].begin(), more[i].end());
    }
    result_.frames = int(of_frames_.size());
    result_.trust_samples = scorer_.take_trust_samples();
    result_.stance_samples = scorer_.take_stance_samples();
    return std::move(result_);
  }

 private:
  const SetOptions& options_;
  SequenceTracker tracker_;
  SequenceScorer scorer_;
  std::vector<std::string> names_;
  std::vector<MetricTerms> of_frames_;
  SequenceResult result_;
};

/// The recordings of a set, which threads take one after the other.
class SequencesEvaluation {
 public:
  SequencesEvaluation(const OpenTruth& open, const SetOptions& options, const FrameScorer& judge,
                      const SequenceTrackerFactory& trackers, SequenceScorer::Options scored,
                      const EvaluationHooks& hooks)
      : open_(open), options_(options), judge_(judge), trackers_(trackers), scored_(scored), hooks_(hooks) {}

  SetResult run() {
    const auto start = std::chrono::steady_clock::now();
    SetResult result;
    result.name = options_.name;
    result.source = options_.source;
    {
      const auto source = open_();
      check_parts(source->part_names(), judge_.body(), options_.source);
      result.notes = source->notes();
    }
    parallel_for(std::max(1, thread_count()), [&](int) {
      try {
        work();
      } catch (...) {
        stopped_ = true;
        throw;
      }
    });
    for (auto& [index, sequence] : results_) take(std::move(sequence), result);
    result.failed = int(failures_.size());
    for (const std::string& why : failures_) {
      if (result.failures.size() < kFailuresKept) result.failures.push_back(why);
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (result.frames == 0) throw Error(fmt::format("{}: no frame that could be evaluated", options_.source));
    return result;
  }

 private:
  /// Evaluates recordings that no other thread has taken, going through the frames once.
  void work() {
    const auto source = open_();
    std::optional<SequenceEvaluation> sequence;
    int wanted = next_++;
    int index = -1;   // of the recording that the last frame belongs to, in their order
    int number = -1;  // its FrameTruth::sequence
    while (!stopped_) {
      std::optional<TrueFrame> frame = next_of(*source);
      if (!frame) break;
      check_order(*frame, number);
      if (frame->truth.sequence != number) {
        if (sequence) {
          keep(wanted, *sequence);
          sequence.reset();
          wanted = next_++;
        }
        number = frame->truth.sequence;
        if (++index == wanted) sequence.emplace(options_, judge_, trackers_, scored_);
      }
      if (sequence) {
        evaluate(std::move(*frame), *sequence);
      } else {
        source->leave_sequence();
      }
    }
    if (sequence) keep(wanted, *sequence);
  }

  /// Returns the next frame that can be read.
  std::optional<TrueFrame> next_of(TruthSource& source) {
    while (!stopped_) {
      try {
        return source.next();
      } catch (const Error& e) {
        fail(e.what());
      }
    }
    return std::nullopt;
  }

  void check_order(const TrueFrame& frame, int before) const {
    const int number = frame.truth.sequence;
    if (number < 0) {
      throw Error(
          fmt::format("{}: frame {} stands alone, expected recordings in which people can be followed: folders "
                      "of frames in their order, or clips",
                      options_.source, frame.frame.name));
    }
    if (number >= before) return;
    throw Error(fmt::format("{}: frame {} of recording {} after one of recording {}, expected one after the other",
                            options_.source, frame.frame.name, number, before));
  }

  void evaluate(TrueFrame frame, SequenceEvaluation& sequence) {
    try {
      sequence.add(std::move(frame));
    } catch (const Error& e) {
      fail(e.what());
    }
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (hooks_.progress) hooks_.progress(done_, -1);
    if (hooks_.stop && hooks_.stop())
      throw Error(fmt::format("{}: interrupted after {}", options_.name, counted(done_, "frame")));
  }

  /// Threads that pass over the same frames meet the same failures, of which each counts once.
  void fail(const std::string& why) {
    if (!options_.keep_going) throw Error(why);
    const std::scoped_lock lock(mutex_);
    if (failures_.insert(why).second && hooks_.failure) hooks_.failure(why);
  }

  void keep(int index, SequenceEvaluation& sequence) {
    SequenceResult result = sequence.finish();
    const std::scoped_lock lock(mutex_);
    results_.emplace(index, std::move(result));
  }

  void take(SequenceResult sequence, SetResult& result) const {
    result.frames += sequence.frames;
    for (const Block& block : sequence.blocks) {
      result.metrics.add(frame_key(result.name.c_str(), block.name.c_str()), block.terms);
    }
    std::ranges::move(sequence.trust_samples, std::back_inserter(result.trust_samples));
    std::ranges::move(sequence.stance_samples, std::back_inserter(result.stance_samples));
    for (WorstFrame& worst : sequence.worst) keep_if_worst(std::move(worst), result.worst);
  }

  const OpenTruth& open_;
  const SetOptions& options_;
  const FrameScorer& judge_;
  const SequenceTrackerFactory& trackers_;
  SequenceScorer::Options scored_;
  const EvaluationHooks& hooks_;
  std::atomic<int> next_ = 0;  ///< recording that the next free thread takes
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;  ///< guards all below, and the hooks
  int done_ = 0;
  std::map<int, SequenceResult> results_;  ///< by the order of the recordings
  std::set<std::string> failures_;
};

}  // namespace

SetResult evaluate_set(TruthSource& frames, const SetOptions& options, const FrameScorer& scorer,
                       const EvaluationHooks& hooks) {
  return SetEvaluation(frames, options, scorer, hooks).run();
}

SetResult evaluate_sequences(const OpenTruth& open, const SetOptions& options, const FrameScorer& judge,
                             const SequenceTrackerFactory& trackers, SequenceScorer::Options scored,
                             const EvaluationHooks& hooks) {
  return SequencesEvaluation(open, options, judge, trackers, scored, hooks).run();
}

SequenceTrackerFactory sequence_trackers(Model model, const PeopleOptions& options) {
  const auto detector = std::make_shared<const Detector>(std::move(model), options.detect);
  return [detector, options] {
    // A tracker refers to the detector's body, so that both live as long as this function.
    const auto tracker = std::make_shared<PeopleTracker>(make_tracker(*detector, options));
    return [detector, tracker](const Frame& frame) { return follow(*detector, *tracker, frame); };
  };
}

}  // namespace vesalius
