#include "stream/turn_hint.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Returns in how many frames somebody is surely found once they are turned by so many quarters. Of real frames of
/// empty rooms the scores of what is taken for people so are up to 0.87; those of people are 0.98 and more.
std::size_t frames_with_people(const Detector& detector, std::vector<Frame>& frames, int quarters) {
  constexpr float kSure = 0.9F;
  return std::size_t(std::ranges::count_if(frames, [&](Frame& frame) {
    frame.quarter_turns = quarters;
    return std::ranges::any_of(detector.detect(frame), [](const Person& person) { return person.score > kSure; });
  }));
}

std::optional<std::string> look(const Detector& detector, std::vector<Frame> frames) try {
  std::size_t most = frames.size() / 2;  // of fewer, people may be chance
  int best = 0;
  for (const int quarters : {1, 3, 2}) {
    const std::size_t count = frames_with_people(detector, frames, quarters);
    if (count <= most) continue;
    most = count;
    best = quarters;
  }
  if (best == 0) return std::nullopt;
  return fmt::format("nobody is found in the first frames, but people are when they are turned: --turn {}", 90 * best);
} catch (const Error&) {
  return std::nullopt;
}

}  // namespace

std::optional<std::string> TurnHint::add(const Frame& frame, bool somebody) {
  constexpr int kFrames = 30, kEvery = 6;
  if (looking_.valid()) {
    if (looking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    return looking_.get();
  }
  done_ = done_ || somebody || frame.up || frame.quarter_turns;
  if (done_) {
    kept_.clear();
    return std::nullopt;
  }
  if (frames_++ % kEvery == 0) {
    kept_.push_back(frame);
    kept_.back().colour = {};
  }
  if (frames_ < kFrames) return std::nullopt;
  done_ = true;
  looking_ = std::async(std::launch::async, look, detector_, std::exchange(kept_, {}));
  return std::nullopt;
}

std::optional<std::string> TurnHint::finish() {
  if (looking_.valid()) return looking_.get();
  if (kept_.empty()) return std::nullopt;
  done_ = true;
  return look(detector_, std::exchange(kept_, {}));
}

}  // namespace vesalius
