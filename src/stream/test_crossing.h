#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "capsule/capsule_person.h"
#include "vesalius/error.h"
#include "vesalius/forest/test_blind_labeller.h"
#include "vesalius/frame_source.h"

namespace vesalius::test {

/// Two people of capsules who cross, frames without times or 30 a second. One can move in it.
class Crossing : public FrameSource {
 public:
  static constexpr int kLength = 24;

  explicit Crossing(bool timed = false) {
    for (int i = 0; i < kLength; ++i) {
      CapsuleScene scene;
      scene.people.resize(2);
      scene.people[0].feet = {-0.8F + 0.07F * static_cast<float>(i), 0.9F, 2.2F};
      scene.people[1].feet = {0.8F - 0.07F * static_cast<float>(i), 0.9F, 3.F};
      scene.people[1].build.shirt = {200, 60, 40};
      scene.floor_y_m = 0.9F;
      LabelledFrame truth = render(scene, {160, 120, 131.F, 131.F, 79.5F, 59.5F}, paper_body());
      truth.frame.name = std::to_string(i);
      if (timed) truth.frame.time_s = i / kUsualRate;
      frames_.push_back(std::move(truth));
    }
  }
  std::optional<Frame> next() override {
    if (given_ == kLength) return std::nullopt;
    return frames_[static_cast<std::size_t>(given_++)].frame;
  }
  int size() const override { return kLength; }
  std::optional<TimeSpan> span() const override { return TimeSpan{0.0, (kLength - 1) / kUsualRate}; }
  void seek(double time_s) override {
    given_ = std::clamp(static_cast<int>(std::ceil(time_s * kUsualRate - 1e-6)), 0, kLength);
  }
  void begin_again() { given_ = 0; }
  const std::vector<LabelledFrame>& frames() const { return frames_; }

 private:
  std::vector<LabelledFrame> frames_;
  int given_ = 0;
};

/// Knows the true labels of some frames, or of parts of them, by their depth. Every third frame takes longer, and some
/// cannot be labelled.
class Knowing : public BlindLabeller {
 public:
  explicit Knowing(const std::vector<LabelledFrame>& frames, int fails_at = -1)
      : frames_(frames), fails_at_(fails_at) {}

  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    BlindLabeller::label_into(frame, gate, out);
    const DepthImage& depth = frame.depth;
    // The principal point tells which part of the picture this is.
    const Camera& whole = frames_.front().frame.camera;
    const Box part{static_cast<int>(std::lround(whole.cx - frame.camera.cx)),
                   static_cast<int>(std::lround(whole.cy - frame.camera.cy)), depth.width(), depth.height()};
    const bool within =
        part.u >= 0 && part.v >= 0 && part.u + part.width <= whole.width && part.v + part.height <= whole.height;
    if (!within) throw Error("an unknown frame");
    const auto truth =
        std::ranges::find_if(frames_, [&](const LabelledFrame& f) { return crop(f.frame.depth, part) == depth; });
    if (truth == frames_.end()) throw Error("an unknown frame");
    const auto index = static_cast<int>(truth - frames_.begin());
    if (index == fails_at_) throw Error("cannot label this one");
    if (index % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    (depth.same_size(truth->frame.depth) ? wholes : parts).fetch_add(1);
    for (int v = 0; v < depth.height(); ++v) {
      for (int u = 0; u < depth.width(); ++u) {
        const std::uint8_t label = truth->labels(part.u + u, part.v + v);
        if (label == kBackground) continue;
        out.at(u, v)[out.classes - 1] = 0;
        out.at(u, v)[label] = 255;
      }
    }
  }

  mutable std::atomic<int> wholes = 0, parts = 0;  ///< frames that were labelled, and parts of frames

 private:
  const std::vector<LabelledFrame>& frames_;
  int fails_at_;
};

}  // namespace vesalius::test
