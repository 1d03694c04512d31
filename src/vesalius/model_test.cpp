#include "vesalius/model.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/default_judge.h"
#include "vesalius/error.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/test_blind_labeller.h"

namespace vesalius {
namespace {

Forest one_leaf() {
  Forest forest;
  forest.body = paper_body();
  forest.trees.push_back({{}, {TreeLeaf{{3, 0, 0, 0}, {200, 0, 0, 0}}}});
  return forest;
}

const Frame kFrame = depth_frame(DepthImage(2, 2, 1000), {2, 2, 5.F, 5.F, 0.F, 0.F});

TEST(OnDevice, LabelsWithTheForestOnTheProcessor) {
  for (const Model& model : {on_device(one_leaf()), on_device(one_leaf(), "cpu")}) {
    EXPECT_EQ(model.labeller->label(kFrame).at(1, 1)[3], 200);
    EXPECT_EQ(model.labeller->label(kFrame).classes, 26) << "with a background";
    EXPECT_EQ(model.body.name, paper_body().name);
    EXPECT_TRUE(model.forest.trees.empty());
  }
}

TEST(OnDevice, JudgesCutOutsUnlessTheModelHasAJudge) {
  Model model = one_leaf();
  EXPECT_EQ(on_device(model).judge, default_judge_of_cut_outs());
  model.judge = {2, 0.5F, {BoostedTree{}}, {"one", "other"}};
  EXPECT_EQ(on_device(model).judge, model.judge);
  model.judge = {};
  model.forest.has_background = true;
  EXPECT_TRUE(on_device(model).judge.empty());
}

TEST(OnDevice, KeepsALabellerOfYourOwn) {
  const auto own = std::make_shared<test::BlindLabeller>();
  EXPECT_EQ(on_device(own, "no such device").labeller, own);
}

TEST(Model, HasTheHeadingsThatATrainedForestKnows) {
  Forest forest = one_leaf();
  forest.facing = {8, 25, {1.F}};
  const Model model(forest);
  EXPECT_EQ(model.headings, forest.facing);
  EXPECT_TRUE(model.forest.facing.empty());
  EXPECT_THAT([&] { check(model); }, testing::ThrowsMessage<Error>(testing::HasSubstr("regression of headings")));
}

TEST(Model, IsRefusedWithPartsThatItsForestLacks) {
  Model model = one_leaf();
  model.body.parts[3].name = "tail";
  EXPECT_THAT([&] { on_device(model); }, testing::ThrowsMessage<Error>(testing::HasSubstr("other parts")));
}

TEST(OnDevice, RefusesAnUnknownDevice) {
  for (const char* device : {"", "cuda", "CPU", "cuda:", "cpu:0"}) {
    EXPECT_THAT([&] { on_device(one_leaf(), device); },
                testing::ThrowsMessage<UsageError>(testing::HasSubstr("expected \"cpu\", \"auto\"")));
  }
}

/// A device that is lost after some pictures.
class Failing : public Labeller {
 public:
  Failing(const Model& model, int pictures) : model_(on_device(model)), left_(pictures) {}
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    if (left_-- <= 0) throw DeviceError("test:0: lost");
    model_.labeller->label_into(frame, gate, out);
  }

 private:
  Model model_;
  mutable int left_;
};

/// A kind of which a machine has `count`; each is lost after `pictures`. What is said is kept in `notes`.
LabellerDevices failing_devices(int count, int pictures, std::vector<std::string>& notes) {
  const auto make = [=](const Model& model, int number) -> std::shared_ptr<const Labeller> {
    if (number >= count) throw DeviceError("test:" + std::to_string(number) + ": not there");
    return std::make_shared<Failing>(model, pictures);
  };
  return {{{"test", make}}, [&notes](const std::string& note) { notes.push_back(note); }};
}

TEST(OnDevice, TakesTheDeviceThatIsAskedFor) {
  std::vector<std::string> notes;
  const LabellerDevices devices = failing_devices(2, 1, notes);
  for (const char* device : {"test", "test:0", "test:1"}) {
    const auto labeller = on_device(one_leaf(), device, devices).labeller;
    EXPECT_EQ(labeller->label(kFrame).at(0, 0)[3], 200);
    EXPECT_THROW(labeller->label(kFrame), DeviceError) << "another device would be another's choice";
  }
  EXPECT_THROW(on_device(one_leaf(), "test:2", devices), DeviceError);
  for (const char* device : {"test:", "test:-1", "test:1x", "test2", "tes"}) {
    EXPECT_THAT([&] { on_device(one_leaf(), device, devices); },
                testing::ThrowsMessage<UsageError>(testing::HasSubstr("\"test\" or \"test:NUMBER\"")));
  }
  EXPECT_THAT(notes, testing::IsEmpty());
}

TEST(OnDevice, GoesOnAloneWhereAnyDeviceWillDo) {
  std::vector<std::string> notes;
  const LabellerDevices lost = failing_devices(1, 1, notes);
  const auto labeller = on_device(one_leaf(), "auto", lost).labeller;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(labeller->label(kFrame).at(1, 0)[3], 200);
  EXPECT_THAT(notes, testing::ElementsAre("test:0: lost; the processor goes on"));

  notes.clear();
  const LabellerDevices none = failing_devices(0, 1, notes);
  EXPECT_EQ(on_device(one_leaf(), "auto", none).labeller->label(kFrame).at(1, 0)[3], 200);
  EXPECT_THAT(notes, testing::ElementsAre("test:0: not there; the processor labels"));
}

}  // namespace
}  // namespace vesalius
