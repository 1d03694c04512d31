#include "vesalius/network/network.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/network/test_networks.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kParts = 3;

/// 0: to 1/2; 1: to 1/4; 2: classes; 3: votes; 4: to 1/2 again; 5: adds 1/4 enlarged and 6 what layer 5 makes; 7: to
/// 1/8; 8: centres.
Network good_network() {
  Random random(1);
  Network network;
  network.classes_of = 2;
  network.person_of = 3;
  network.centres_of = 8;
  const auto add = [&](const Convolution& c) { test::add_random(network, random, c); };
  add({.stride = 2, .inputs = kNetworkInputs, .outputs = 6});
  add({.input = 1, .stride = 2, .inputs = 6, .outputs = 5});
  add({.input = 1, .side = 1, .inputs = 6, .outputs = kParts + 1, .wide = true});
  add({.input = 2, .side = 1, .inputs = 5, .outputs = kPersonNumbers, .wide = true});
  add({.input = 0, .stride = 2, .inputs = kNetworkInputs, .outputs = 5});
  add({.input = 1, .inputs = 6, .outputs = 5, .added = 2, .added_scale = 1.F});
  add({.input = 6, .inputs = 5, .outputs = 5, .added = 6, .added_scale = 1.F});
  add({.input = 2, .stride = 2, .inputs = 5, .outputs = 7});
  add({.input = 8, .side = 1, .inputs = 7, .outputs = kCentreNumbers * kParts, .wide = true});
  return network;
}

TEST(Network, IsGoodIfPicturesFit) {
  const Network network = good_network();
  EXPECT_NO_THROW(check(network, kParts));
  const std::vector<NetworkPicture> pictures = pictures_of(network);
  ASSERT_EQ(pictures.size(), network.layers.size() + 1);
  EXPECT_EQ(pictures[0].channels, kNetworkInputs);
  EXPECT_EQ(pictures[2].channels, 5);
  EXPECT_EQ(pictures[2].halvings, 2);
  EXPECT_FALSE(pictures[2].wide);
  EXPECT_EQ(pictures[3].halvings, 1);
  EXPECT_TRUE(pictures[3].wide);
  EXPECT_EQ(pictures[9], (NetworkPicture{.channels = 9, .halvings = 3, .wide = true}));
  EXPECT_NO_THROW(check(test::without_centres(network), kParts));
}

struct Fault {
  const char* message;
  std::function<void(Network&)> make;
};

std::vector<Fault> faults() {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  return {
      {"layer 1: a window of side 2, expected 1 or 3", [](Network& n) { n.layers[1].side = 2; }},
      {"layer 1: a stride of 3, expected 1 or 2", [](Network& n) { n.layers[1].stride = 3; }},
      {"layer 1: a stride of 0, expected 1 or 2", [](Network& n) { n.layers[1].stride = 0; }},
      {"layer 1: reads a narrow picture of 6 channels (halved 1 times), expected a narrow one of 0",
       [](Network& n) { n.layers[1].inputs = 0; }},
      {"layer 1: 1025 outputs, expected 1 to 1024", [](Network& n) { n.layers[1].outputs = 1025; }},
      {"layer 1: 269 weights, 5 scales and 5 offsets, expected 270 weights, 5 scales and 5 offsets",
       [](Network& n) { n.layers[1].weights.pop_back(); }},
      {"layer 1: 270 weights, 4 scales and 5 offsets, expected", [](Network& n) { n.layers[1].scale.pop_back(); }},
      {"layer 1: 270 weights, 5 scales and 6 offsets, expected", [](Network& n) { n.layers[1].offset.push_back(0.F); }},
      {"layer 1: a scale that is not above 0", [](Network& n) { n.layers[1].scale[4] = 0.F; }},
      {"layer 1: a scale that is not above 0", [=](Network& n) { n.layers[1].scale[4] = nan; }},
      {"layer 1: a scale that is not above 0 and at most 1e9", [=](Network& n) { n.layers[1].scale[4] = inf; }},
      {"layer 1: an offset or added scale that is not from -1e9 to 1e9",
       [=](Network& n) { n.layers[1].offset[0] = nan; }},
      {"layer 1: an offset or added scale that is not from -1e9 to 1e9",
       [](Network& n) { n.layers[1].offset[0] = -2e9F; }},
      {"layer 5: an offset or added scale that is not from -1e9 to 1e9",
       [=](Network& n) { n.layers[5].added_scale = nan; }},
      {"layer 1: takes picture 2, expected one that a layer before it makes",
       [](Network& n) { n.layers[1].input = 2; }},
      {"layer 1: takes picture -1, expected one that a layer before it makes",
       [](Network& n) { n.layers[1].input = -1; }},
      {"layer 3: reads a wide picture of 4 channels (halved 1 times), expected a narrow one of 5 channels",
       [](Network& n) { n.layers[3].input = 3; }},
      {"layer 1: reads a narrow picture of 8 channels (halved 0 times), expected a narrow one of 6",
       [](Network& n) { n.layers[1].input = 0; }},
      {"layer 5: takes picture 6, expected one that a layer before it makes",
       [](Network& n) { n.layers[5].added = 6; }},
      {"layer 5: takes picture 0, expected", [](Network& n) { n.layers[5].added = 0; }},
      {"layer 5: takes picture -2, expected", [](Network& n) { n.layers[5].added = -2; }},
      {"layer 5: adds a narrow picture of 6 channels (halved 1 times) to a narrow picture of 5",
       [](Network& n) { n.layers[5].added = 1; }},
      {"layer 5: adds a narrow picture of 5 channels (halved 1 times) to a narrow picture of 5 channels (halved 2 "
       "times)",
       [](Network& n) { n.layers[5].stride = 2, n.layers[5].added = 5; }},
      {"layer 5: adds a narrow picture of 5 channels (halved 2 times) to a narrow picture of 5 channels (halved 0 "
       "times)",
       [](Network& n) {
         n.layers[4].stride = 1, n.layers[5].input = 5, n.layers[5].inputs = 5, n.layers[5].weights.resize(225);
       }},
      {"classes come from layer -1, which is not there", [](Network& n) { n.classes_of = -1; }},
      {"classes come from layer 9, which is not there", [](Network& n) { n.classes_of = 9; }},
      {"classes are a narrow picture of 4 channels (halved 1 times), expected a wide",
       [](Network& n) { n.layers[2].wide = false; }},
      {"classes are a wide picture of 5 channels (halved 2 times), expected a wide picture of 4 channels (halved 1 "
       "times)",
       [](Network& n) { n.classes_of = 3; }},
      {"votes come from layer 1000, which is not there", [](Network& n) { n.person_of = 1000; }},
      {"votes are a wide picture of 4 channels", [](Network& n) { n.person_of = 2; }},
      {"centres come from layer -2, which is not there", [](Network& n) { n.centres_of = -2; }},
      {"centres come from layer 9, which is not there", [](Network& n) { n.centres_of = 9; }},
      {"centres are a wide picture of 5 channels (halved 2 times), expected a wide picture of 9 channels (halved 3 "
       "times)",
       [](Network& n) { n.centres_of = 3; }},
      {"centres are a narrow picture of 9 channels (halved 3 times), expected a wide",
       [](Network& n) { n.layers[8].wide = false; }},
      {"257 layers, at most 256", [](Network& n) { n.layers.resize(257); }},
  };
}

TEST(Network, SaysWhatDoesNotFit) {
  for (const Fault& fault : faults()) {
    Network network = good_network();
    fault.make(network);
    EXPECT_THAT([&] { check(network, kParts); },
                ThrowsMessage<Error>(HasSubstr(std::string("network: ") + fault.message)));
  }
  EXPECT_THAT([] { check(good_network(), kParts + 1); },
              ThrowsMessage<Error>(HasSubstr("expected a wide picture of 5")));
  EXPECT_THROW(check({}, kParts), Error);
}

TEST(Network, HalvesNoMoreThanPicturesArePaddedFor) {
  Random random(2);
  Network network;
  for (int n = 0; n < 6; ++n) {
    test::add_random(network, random, {.input = n, .stride = 2, .inputs = kNetworkInputs, .outputs = kNetworkInputs});
  }
  EXPECT_THAT([&] { pictures_of(network); }, ThrowsMessage<Error>(HasSubstr("layer 5: halves pictures more than 5")));
  network.layers.pop_back();
  EXPECT_EQ(pictures_of(network).back().halvings, 5);
}

}  // namespace
}  // namespace vesalius
