#include "metrics/pixel_metrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "metrics/test_terms.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::value_of;

constexpr std::uint8_t kNone = kBackground;

template <class T>
Image<T> row(const std::vector<T>& values) {
  Image<T> image(static_cast<int>(values.size()), 1);
  std::ranges::copy(values, image.begin());
  return image;
}

double mean_recall(const PixelConfusion& confusion) {
  MetricTable table;
  table.add(1, pixel_terms(confusion, confusion, paper_body()));
  return find_estimate(table.estimates(), Metric::pixel_mean_recall)->value;
}

TEST(PixelConfusion, AgreesWithCountingByHand) {
  // Truth:  a a a a b b . . . .   and two pixels without reading.
  // Given:  a a b . b a . . a .
  const LabelImage truth = row<std::uint8_t>({0, 0, 0, 0, 1, 1, kNone, kNone, kNone, kNone, 0, 1});
  const LabelImage given = row<std::uint8_t>({0, 0, 1, kNone, 1, 0, kNone, kNone, 0, kNone, 1, 0});
  const DepthImage depth = row<std::uint16_t>({9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 0, 0});
  const int background = paper_body().part_count();
  PixelConfusion confusion(background);
  confusion.add(truth, given, depth);
  EXPECT_EQ(confusion.count(0, 0), 2U);
  EXPECT_EQ(confusion.count(0, background), 1U);
  EXPECT_EQ(confusion.of_truth(background), 4U);
  const MetricTerms terms = pixel_terms(confusion, confusion, paper_body());
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.recall.l_foot"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.recall.l_leg"), 0.5);
  EXPECT_TRUE(std::isnan(value_of(terms, "pixels.recall.l_knee")));
  EXPECT_DOUBLE_EQ(mean_recall(confusion), 0.5);  // other parts do not occur
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.person_iou"), 5.0 / 7.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.background_iou"), 3.0 / 5.0);
}

TEST(PixelConfusion, AgreesWithSets) {
  Random random(3);
  const int parts = paper_body().part_count();
  LabelImage truth(40, 30), given(40, 30);
  DepthImage depth(40, 30);
  const auto label = [&] { return static_cast<std::uint8_t>(random.below(6) == 5 ? kNone : random.below(5)); };
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth[i] = label();
    given[i] = random.below(2) == 0 ? truth[i] : label();
    depth[i] = static_cast<std::uint16_t>(random.below(3));
  }
  PixelConfusion confusion(parts);
  confusion.add(truth, given, depth);
  std::map<int, std::pair<int, int>> right_of;  // part -> right, all
  int both = 0, either = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (depth[i] == 0) continue;
    both += truth[i] != kNone && given[i] != kNone;
    either += truth[i] != kNone || given[i] != kNone;
    if (truth[i] == kNone) continue;
    right_of[truth[i]].first += truth[i] == given[i];
    ++right_of[truth[i]].second;
  }
  double sum = 0.0;
  for (const auto& [part, counts] : right_of) sum += static_cast<double>(counts.first) / counts.second;
  EXPECT_NEAR(mean_recall(confusion), sum / static_cast<double>(right_of.size()), 1e-12);
  EXPECT_DOUBLE_EQ(value_of(pixel_terms(confusion, confusion, paper_body()), "pixels.person_iou"),
                   static_cast<double>(both) / either);
  PixelConfusion twice(parts);
  twice.add(confusion);
  twice.add(confusion);
  EXPECT_EQ(twice.count(1, 1), 2 * confusion.count(1, 1));
  EXPECT_DOUBLE_EQ(mean_recall(twice), mean_recall(confusion));
}

TEST(PixelConfusion, RefusesOtherSizesAndLabels) {
  PixelConfusion confusion(2);
  const DepthImage depth(2, 1, 9);
  EXPECT_THROW(confusion.add(LabelImage(2, 1), LabelImage(1, 2), depth), Error);
  EXPECT_THROW(confusion.add(LabelImage(2, 1, 2), LabelImage(2, 1), depth), Error);
  EXPECT_THROW(confusion.add(PixelConfusion(3)), Error);
}

TEST(MaskIou, CountsOnlyReadings) {
  const Mask a = row<std::uint8_t>({1, 1, 1, 0, 0, 1});
  const Mask b = row<std::uint8_t>({0, 7, 1, 1, 0, 0});
  const DepthImage depth = row<std::uint16_t>({5, 5, 5, 5, 5, 0});
  EXPECT_DOUBLE_EQ(mask_iou(a, b, depth), 0.5);
  EXPECT_DOUBLE_EQ(mask_iou(Mask(6, 1, 0), Mask(6, 1, 0), depth), 0.0);
}

TEST(MaskTerms, GivePersonIouOrTheFalseShareOfAnEmptyFrame) {
  FrameTruth truth;
  truth.people = 1;
  truth.mask = row<std::uint8_t>({1, 1, 0, 0, 0});
  const LabelImage labels = row<std::uint8_t>({3, kNone, 0, kNone, 3});
  const DepthImage depth = row<std::uint16_t>({5, 5, 5, 5, 0});
  EXPECT_DOUBLE_EQ(value_of(mask_terms(truth, labels, depth), "pixels.person_iou"), 1.0 / 3.0);
  truth.people = 0;
  EXPECT_DOUBLE_EQ(value_of(mask_terms(truth, labels, depth), "pixels.body_on_empty"), 0.5);
  EXPECT_TRUE(mask_terms(truth, labels, DepthImage(5, 1, 0)).empty());
  truth.people = 1;
  truth.mask = {};
  EXPECT_TRUE(mask_terms(truth, labels, depth).empty());
}

TEST(PixelTerms, NameTheirParts) {
  PixelConfusion with(paper_body().part_count()), inside(paper_body().part_count());
  const auto hand = static_cast<std::uint8_t>(paper_body().find_part("l_hand"));
  const LabelImage truth = row<std::uint8_t>({hand, hand, kNone});
  const DepthImage depth(3, 1, 9);
  with.add(truth, row<std::uint8_t>({hand, kNone, kNone}), depth);
  inside.add(truth, row<std::uint8_t>({hand, hand, kNone}), depth);
  const MetricTerms terms = pixel_terms(with, inside, paper_body());
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.recall.l_hand"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.recall_inside.l_hand"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "pixels.background_iou"), 0.5);
  EXPECT_EQ(terms.size(), 4U);  // parts that do not occur have no terms
}

}  // namespace
}  // namespace vesalius
