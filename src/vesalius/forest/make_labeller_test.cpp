#include "vesalius/forest/make_labeller.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

Forest one_leaf() {
  Forest forest;
  forest.body = paper_body();
  forest.trees.push_back({{}, {TreeLeaf{{3, 0, 0, 0}, {200, 0, 0, 0}}}});
  return forest;
}

TEST(MakeLabeller, LabelsWithTheForestOnTheProcessor) {
  for (const auto& labeller : {make_labeller(one_leaf()), make_labeller(one_leaf(), "cpu")}) {
    EXPECT_EQ(labeller->label(DepthImage(2, 2, 1000), {2, 2, 5.F, 5.F, 0.F, 0.F}).at(1, 1)[3], 200);
    EXPECT_EQ(labeller->body().name, paper_body().name);
    EXPECT_FALSE(labeller->has_background());
    EXPECT_FALSE(labeller->has_distributions());
  }
}

TEST(MakeLabeller, RefusesAnUnknownDevice) {
  for (const char* device : {"", "cuda", "CPU", "cuda:", "cpu:0"}) {
    EXPECT_THAT([&] { make_labeller(one_leaf(), device); },
                testing::ThrowsMessage<UsageError>(testing::HasSubstr("expected \"cpu\", \"auto\"")));
  }
}

/// A device that is lost after some pictures.
class Failing : public PixelLabeller {
 public:
  Failing(Forest forest, int pictures) : forest_(std::move(forest)), left_(pictures) {}
  void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const override {
    if (left_-- <= 0) throw DeviceError("test:0: lost");
    forest_.label_into(depth, camera, gate, out);
  }
  const BodyModel& body() const override { return forest_.body(); }
  bool has_background() const override { return false; }
  bool has_distributions() const override { return false; }

 private:
  ForestLabeller forest_;
  mutable int left_;
};

/// A kind of which a machine has `count`; each is lost after `pictures`. What is said is kept in `notes`.
LabellerDevices failing_devices(int count, int pictures, std::vector<std::string>& notes) {
  const auto make = [=](Forest forest, int number) -> std::shared_ptr<const PixelLabeller> {
    if (number >= count) throw DeviceError("test:" + std::to_string(number) + ": not there");
    return std::make_shared<Failing>(std::move(forest), pictures);
  };
  return {{{"test", make}}, [&notes](const std::string& note) { notes.push_back(note); }};
}

TEST(MakeLabeller, TakesTheDeviceThatIsAskedFor) {
  std::vector<std::string> notes;
  const LabellerDevices devices = failing_devices(2, 1, notes);
  const DepthImage depth(2, 2, 1000);
  const Camera camera{2, 2, 5.F, 5.F, 0.F, 0.F};
  for (const char* device : {"test", "test:0", "test:1"}) {
    const auto labeller = make_labeller(one_leaf(), device, devices);
    EXPECT_EQ(labeller->label(depth, camera).at(0, 0)[3], 200);
    EXPECT_THROW(labeller->label(depth, camera), DeviceError) << "another device would be another's choice";
  }
  EXPECT_THROW(make_labeller(one_leaf(), "test:2", devices), DeviceError);
  for (const char* device : {"test:", "test:-1", "test:1x", "test2", "tes"}) {
    EXPECT_THAT([&] { make_labeller(one_leaf(), device, devices); },
                testing::ThrowsMessage<UsageError>(testing::HasSubstr("\"test\" or \"test:NUMBER\"")));
  }
  EXPECT_THAT(notes, testing::IsEmpty());
}

TEST(MakeLabeller, GoesOnAloneWhereAnyDeviceWillDo) {
  const DepthImage depth(2, 2, 1000);
  const Camera camera{2, 2, 5.F, 5.F, 0.F, 0.F};
  std::vector<std::string> notes;
  const LabellerDevices lost = failing_devices(1, 1, notes);
  const auto labeller = make_labeller(one_leaf(), "auto", lost);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(labeller->label(depth, camera).at(1, 0)[3], 200);
  EXPECT_THAT(notes, testing::ElementsAre("test:0: lost; the processor goes on"));

  notes.clear();
  const LabellerDevices none = failing_devices(0, 1, notes);
  EXPECT_EQ(make_labeller(one_leaf(), "auto", none)->label(depth, camera).at(1, 0)[3], 200);
  EXPECT_THAT(notes, testing::ElementsAre("test:0: not there; the processor labels"));
}

}  // namespace
}  // namespace vesalius
