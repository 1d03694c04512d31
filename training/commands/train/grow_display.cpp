#include "commands/train/grow_display.h"

#include <fmt/format.h>

#include <utility>

#include "console/interrupts.h"
#include "console/text_sink.h"

namespace vesalius::cli {
namespace {

constexpr std::chrono::milliseconds kPeriod(100);

}  // namespace

GrowDisplay::GrowDisplay(const std::string& round, const TrainingSet& set, int trees, int max_depth,
                         GrowProgress& progress, bool shown)
    : round_(round),
      trees_(trees),
      work_(double(set.samples().size()) * max_depth * trees),
      progress_(progress),
      status_(shown),
      judged_(!set.held_out().empty()),
      votes_(set),
      thread_([this] { watch(); }) {}

GrowDisplay::~GrowDisplay() {
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

double GrowDisplay::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void GrowDisplay::add(Tree tree) {
  const std::scoped_lock lock(mutex_);
  done_.push_back(std::move(tree));
}

void GrowDisplay::watch() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kPeriod, [this] { return end_; })) {
    const std::vector<Tree> done = std::exchange(done_, {});
    lock.unlock();
    if (interrupted()) progress_.stop = true;
    measure(done);
    if (status_.due()) status_.show(line());
    lock.lock();
  }
}

void GrowDisplay::measure(const std::vector<Tree>& trees) {
  if (trees.empty() || !status_.shown() || !judged_) return;
  for (const Tree& tree : trees) votes_.add(tree);
  const SampleAccuracy accuracy = votes_.accuracy();
  accuracy_ = fmt::format(", accuracy {:.3f} ({:.3f} among parts)", accuracy.with_background(), accuracy.parts_only());
}

std::string GrowDisplay::line() const {
  const double share = work_ > 0.0 ? double(progress_.settled) / work_ : 0.0;
  const double spent_s = seconds();
  const double left_s = share > 0.0 ? spent_s / share * (1.0 - share) : 0.0;
  return fmt::format("{}: {} of {} trees, {:.0f} %, {:.2f} M nodes, {:.0f} M evaluations/s, {:.0f} s left{}", round_,
                     votes_.trees(), trees_, 100.0 * share, double(progress_.nodes) * 1e-6,
                     double(progress_.evaluations) / spent_s * 1e-6, left_s, accuracy_);
}

TrainDisplay::TrainDisplay(const TrainingSet& set, int max_depth, bool shown)
    : set_(set), max_depth_(max_depth), shown_(shown) {}

void TrainDisplay::begin_round(const TreeRound& round, GrowProgress& progress) {
  round_ = round;
  progress_ = &progress;
  grown_ = 0;
  totals_.resumed += round.trees - round.missing;
  display_.emplace(round.name, set_, round.missing, max_depth_, progress, shown_);
}

void TrainDisplay::add_tree(const Tree& tree) {
  ++grown_;
  display_->add(tree);
}

void TrainDisplay::end_round() {
  totals_.evaluations += progress_->evaluations;
  totals_.seconds += display_->seconds();
  display_.reset();
}

void TrainDisplay::add_hard_negatives(std::size_t samples) {
  totals_.hard_negatives = samples;
  if (shown_) say(fmt::format("{} hard negatives", samples));
}

bool TrainDisplay::end_leaf_round(int round, int rounds, double likelihood) {
  const auto now = std::chrono::steady_clock::now();
  if (!leaves_) {
    leaves_.emplace(shown_);
    leaves_start_ = now;  // the first round is not in the rate: trees are walked before it
    first_leaf_round_ = round;
  }
  leaf_rounds_ = round + 1;
  all_leaf_rounds_ = rounds;
  const double spent_s = std::chrono::duration<double>(now - leaves_start_).count();
  const double per_round_s = round > first_leaf_round_ ? spent_s / (round - first_leaf_round_) : 0.0;
  if (leaves_->due() || leaf_rounds_ == rounds) {
    leaves_->show(fmt::format("leaves: {} of {} rounds, true classes at {:.3f}, {:.1f} s a round, {:.0f} s left",
                              leaf_rounds_, rounds, likelihood, per_round_s, per_round_s * (rounds - leaf_rounds_)));
  }
  if (leaf_rounds_ == rounds) leaves_.reset();
  return !interrupted();
}

std::string TrainDisplay::done() const {
  if (all_leaf_rounds_ > 0)
    return fmt::format("the trees and {} of {} rounds of leaves", leaf_rounds_, all_leaf_rounds_);
  return fmt::format("{} of {} trees of the {}", round_.trees - round_.missing + grown_, round_.trees, round_.name);
}

}  // namespace vesalius::cli
