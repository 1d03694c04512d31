#include "evaluation/ablation_report.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "evaluation/evaluation_csv.h"
#include "evaluation/evaluation_json.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Returns forty frames of one person each. All are found; a variant misses every second one and takes half the time.
SetResult set_of_forty() {
  SetResult set;
  set.name = "room, left";
  set.frame_ms = 40.0;
  MetricTable half;
  for (std::uint64_t i = 0; i < 40; ++i) {
    set.metrics.add(i, {{Metric::people_found, 1.0, 1.0}, {Metric::mask_iou, 0.9, 1.0}});
    half.add(i, {{Metric::people_found, i % 2 == 0 ? 1.0 : 0.0, 1.0}, {Metric::mask_iou, 0.9, 1.0}});
  }
  set.ablation.push_back({"1 tree", half.estimates(), 20.0});
  return set;
}

TEST(Ablation, HasATableWithDifferences) {
  Document document("t");
  add_ablation(set_of_forty(), document);
  const std::string text = document.markdown();
  EXPECT_THAT(text, HasSubstr("| as it is | 100.00 % | 90.00 % | 40.0 ms |"));
  EXPECT_THAT(text, HasSubstr("| 1 tree | 50.00 %, -50.00 % (-"));
  EXPECT_THAT(text, HasSubstr("90.00 %, +0.00 % (+0.00 % to +0.00 %) | 20.0 ms, 0.50 of it |"));
}

TEST(Ablation, HasALineForEachVariant) {
  const std::string text = ablation_lines(set_of_forty());
  EXPECT_THAT(text, StartsWith("  1 tree "));
  EXPECT_THAT(text, HasSubstr("20.0 ms, 0.50 of it; people found -50.00 % ("));
  EXPECT_THAT(text, HasSubstr(" *; mask IoU with misses +0.00 % (+0.00 % to +0.00 %)\n"));
}

TEST(Ablation, IsWrittenAsCsvAndJson) {
  const SetResult set = set_of_forty();
  const std::string csv = ablation_csv({set});
  EXPECT_THAT(csv, HasSubstr("\nroom; left,,people.found,1,,,,\n"));
  EXPECT_THAT(csv, HasSubstr("\nroom; left,1 tree,people.found,0.5,-0.5,-"));
  EXPECT_THAT(csv, HasSubstr(",worse\n"));
  EXPECT_THAT(csv, HasSubstr("\nroom; left,1 tree,frame_ms,20,-20,,,\n"));
  Evaluation evaluation;
  evaluation.sets.push_back(set);
  const auto json = nlohmann::json::parse(evaluation_json(evaluation)).at("sets").at(0).at("ablation");
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0].at("variant"), "1 tree");
  EXPECT_EQ(json[0].at("frame_ms"), 20.0);
  EXPECT_EQ(json[0].at("figures").at("people.found").at("difference"), -0.5);
  EXPECT_EQ(json[0].at("figures").at("mask.iou").at("verdict"), "same");
}

TEST(Ablation, AddsNothingUnlessRequested) {
  SetResult set = set_of_forty();
  set.ablation.clear();
  Document document("t");
  const std::string before = document.markdown();
  add_ablation(set, document);
  EXPECT_EQ(document.markdown(), before);
  EXPECT_THAT(ablation_lines(set), IsEmpty());
  EXPECT_EQ(ablation_csv({set}), "set,variant,figure,value,difference,low,high,verdict\n");
}

}  // namespace
}  // namespace vesalius
