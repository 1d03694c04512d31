#include "stream/turn_hint.h"

#include <gmock/gmock.h>

#include "stream/test_crossing.h"
#include "vesalius/upright.h"

namespace vesalius {
namespace {

using test::Crossing;

/// Knows the labels of upright pictures, and takes others for empty.
class KnowsUpright : public test::Knowing {
 public:
  using Knowing::Knowing;
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    try {
      Knowing::label_into(frame, gate, out);
    } catch (const Error&) {
      BlindLabeller::label_into(frame, gate, out);
    }
  }
};

/// Returns the frames of a camera that lies on its side, so that people are upright once turned by `quarters`.
std::vector<Frame> lying(const Crossing& source, int quarters) {
  std::vector<Frame> frames;
  for (const LabelledFrame& truth : source.frames()) {
    Frame frame = turned(truth.frame, (4 - quarters) % 4);
    frame.quarter_turns.reset();
    frames.push_back(std::move(frame));
  }
  return frames;
}

TEST(TurnHint, NamesTheTurnByWhichPeopleAreFound) {
  const Crossing source;
  const Detector detector = Detector(std::make_shared<KnowsUpright>(source.frames()));
  for (const int quarters : {1, 2, 3}) {
    const std::vector<Frame> frames = lying(source, quarters);
    TurnHint hint(detector);
    for (const Frame& frame : frames) EXPECT_EQ(hint.add(frame, false), std::nullopt);
    EXPECT_THAT(hint.finish().value_or(""), testing::HasSubstr("--turn " + std::to_string(90 * quarters)));
    EXPECT_EQ(hint.finish(), std::nullopt) << "it is said once";
  }
}

TEST(TurnHint, SaysItAmongManyFrames) {
  const Crossing source;
  const std::vector<Frame> frames = lying(source, 1);
  TurnHint hint{Detector(std::make_shared<KnowsUpright>(source.frames()))};
  int said = 0;
  for (int i = 0; i < 30; ++i) said += hint.add(frames[std::size_t(i) % frames.size()], false) ? 1 : 0;
  EXPECT_EQ(said, 0);
  said += hint.finish() ? 1 : 0;
  EXPECT_EQ(said, 1);
}

TEST(TurnHint, IsSilentWherePeopleAreFoundOrTheCameraIsKnown) {
  const Crossing source;
  const std::vector<Frame> frames = lying(source, 1);
  for (const int known : {0, 1, 2}) {
    TurnHint hint{Detector(std::make_shared<KnowsUpright>(source.frames()))};
    for (Frame frame : frames) {
      if (known == 1) frame.quarter_turns = 0;
      if (known == 2) frame.up = Eigen::Vector3f(0, -1, 0);
      hint.add(frame, known == 0);
    }
    EXPECT_EQ(hint.finish(), std::nullopt);
  }
}

TEST(TurnHint, IsSilentInAnEmptyRoom) {
  const Crossing source;
  Frame frame = source.frames().front().frame;
  frame.depth = DepthImage(frame.depth.width(), frame.depth.height(), 3000);
  TurnHint hint{Detector(std::make_shared<KnowsUpright>(source.frames()))};
  hint.add(frame, false);
  EXPECT_EQ(hint.finish(), std::nullopt);
}

}  // namespace
}  // namespace vesalius
