#include "commands/synth/contact_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "vesalius/error.h"

namespace vesalius {
namespace {

BodyModel one_part() {
  BodyModel body;
  body.parts = {{.name = "head", .colour = {250, 10, 20}}};
  return body;
}

LabelledFrame labelled(bool colour) {
  LabelledFrame frame;
  frame.frame.name = "7";
  frame.frame.depth = DepthImage(64, 48, 2000);
  if (colour) frame.frame.colour = ColourImage(64, 48, {1, 2, 3});
  frame.labels = LabelImage(64, 48, kBackground);
  for (int v = 0; v < 24; ++v) std::fill_n(frame.labels.row(v), 64, std::uint8_t{0});
  return frame;
}

TEST(ContactSheet, ShowsDepthColourAndLabelsOfEveryFrame) {
  const std::vector<LabelledFrame> frames(5, labelled(true));
  const ColourImage sheet = contact_sheet(frames, one_part(), 2, 64);
  const auto count = [&](Rgb colour) { return std::count(sheet.begin(), sheet.end(), colour); };
  EXPECT_EQ(count({1, 2, 3}), 5 * 64 * 48) << "every pixel of the colour pictures";
  EXPECT_EQ(sheet.width() / 2 >= 3 * 64, true);
  EXPECT_EQ(sheet.height() / 3 >= 48, true);
}

TEST(ContactSheet, LeavesOutMissingColour) {
  const ColourImage with = contact_sheet({labelled(true)}, one_part(), 1, 64);
  const ColourImage without = contact_sheet({labelled(false)}, one_part(), 1, 64);
  EXPECT_EQ(with.width() - without.width(), 64);
}

TEST(ContactSheet, IsABlankPageWithoutFrames) { EXPECT_FALSE(contact_sheet({}, one_part(), 3).empty()); }

TEST(ContactSheet, RefusesLabelsOfAnotherSize) {
  LabelledFrame frame = labelled(false);
  frame.labels = LabelImage(10, 10, kBackground);
  EXPECT_THROW(contact_sheet({frame}, one_part(), 1), Error);
}

}  // namespace
}  // namespace vesalius
