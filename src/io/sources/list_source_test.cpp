#include "io/sources/list_source.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <tuple>
#include <vector>

#include "io/files/test_files.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

TEST(ParseTumList, SortsLinesByTime) {
  const auto entries = parse_tum_list("# comment\r\n\n 2.5 depth/b.png \r\n1.25\tdepth/with space.png", "depth.txt");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].time_s, 1.25);
  EXPECT_EQ(entries[0].file, "depth/with space.png");
  EXPECT_EQ(entries[1].stamp, "2.5");
  EXPECT_EQ(entries[1].file, "depth/b.png");
}

TEST(ParseTumList, NamesTheFileAndTheLineOfErrors) {
  const auto message = [](const char* text) { return error_of([&] { parse_tum_list(text, "depth.txt"); }); };
  EXPECT_EQ(message("1 a.png\n\nx b.png\n"), "depth.txt:3: expected \"timestamp file\"");
  EXPECT_THAT(message("1"), HasSubstr("depth.txt:1"));
  EXPECT_THAT(message("1x a.png"), HasSubstr("depth.txt:1"));
  EXPECT_THAT(message("nan a.png"), HasSubstr("depth.txt:1"));
  EXPECT_THAT(message("1e999 a.png"), HasSubstr("depth.txt:1"));
  EXPECT_THAT(error_of([] { parse_tum_list({"1 a\0.png", 9}, "depth.txt"); }), HasSubstr("depth.txt:1"));
}

TEST(ParseTumList, KeepsEqualTimesInOrder) {
  std::vector<std::string> files;
  for (const TumEntry& entry : parse_tum_list("2 b.png\n1.0 a.png\n2.0 c.png\n", "depth.txt"))
    files.push_back(entry.file);
  EXPECT_THAT(files, ElementsAre("a.png", "b.png", "c.png"));
}

TEST(ParseTumList, TakesCommasAndAMarkOfByteOrder) {
  const auto entries = parse_tum_list(
      "\xEF\xBB\xBF"
      "1.5,depth/a.png\r\n2.5, depth/b.png,\r\n",
      "depth.txt");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].time_s, 1.5);
  EXPECT_EQ(entries[1].file, "depth/b.png");
}

TEST(ParseTumList, TakesCommasAsPointsAndPowerShellsText) {
  const auto entries = parse_tum_list("1700000000,25 a.png\n1700000000,5\tdepth/b.png\n", "depth.txt");
  ASSERT_EQ(entries.size(), 2);
  EXPECT_EQ(entries[0].time_s, 1700000000.25);
  EXPECT_EQ(entries[0].stamp, "1700000000.25");
  EXPECT_EQ(entries[1].file, "depth/b.png");
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("1 a.png\r\n2 b.png")) wide += {c, '\0'};
  EXPECT_THAT(parse_tum_list(wide, "depth.txt"),
              ElementsAre(Field(&TumEntry::file, "a.png"), Field(&TumEntry::file, "b.png")));
}

TEST(ParseTumList, RefusesAMatrixOfDepth) {
  EXPECT_EQ(error_of([] { parse_tum_list("1503 1504 1510\n1500 1502 0\n", "depth.txt"); }),
            "depth.txt:1: expected \"timestamp file\"");
}

TEST(ParseTumList, KnowsUnitsByTheirDigits) {
  for (const char* stamp :
       {"1700000000.033", "1700000000033", "1700000000033.0", "1700000000033000", "1700000000033000000"}) {
    EXPECT_NEAR(parse_tum_list(std::string(stamp) + " a.png", "depth.txt").front().time_s, 1700000000.033, 1e-6)
        << stamp;
  }
  EXPECT_EQ(parse_tum_list("12345678 a.png", "depth.txt").front().time_s, 12345678.0) << "of a clock that began at 0";
}

std::vector<TumEntry> entries_at(const std::vector<double>& times_s) {
  std::vector<TumEntry> entries;
  for (const double time_s : times_s) entries.push_back({time_s, "", "f"});
  return entries;
}

TEST(Associate, PairsTheNearestAndUsesEachColourOnce) {
  EXPECT_THAT(associate(entries_at({1.0, 1.01, 2.0}), entries_at({1.012, 1.9, 2.015}), 0.02), ElementsAre(-1, 0, 2));
  EXPECT_THAT(associate(entries_at({1.0}), entries_at({1.02000001}), 0.02), ElementsAre(-1));
  EXPECT_THAT(associate(entries_at({1.0}), {}, 0.02), ElementsAre(-1));
}

/// Pairs as the benchmark's tool does: it sorts all pairs by difference and times.
std::vector<int> all_pairs(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour, double limit) {
  std::vector<std::tuple<double, double, double, int, int>> pairs;
  for (int i = 0; i < static_cast<int>(depth.size()); ++i) {
    for (int j = 0; j < static_cast<int>(colour.size()); ++j) {
      const double difference = std::abs(depth[i].time_s - colour[j].time_s);
      if (difference < limit) pairs.emplace_back(difference, depth[i].time_s, colour[j].time_s, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> partner(depth.size(), -1);
  std::set<int> used;
  for (const auto& [difference, a, b, i, j] : pairs) {
    if (partner[i] >= 0 || used.count(j) != 0) continue;
    partner[i] = j;
    used.insert(j);
  }
  return partner;
}

TEST(Associate, AgreesWithComparingAllPairs) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const auto times = [&] {
      std::set<double> chosen;
      const std::uint32_t count = random.below(40);
      for (std::uint32_t i = 0; i < count; ++i) chosen.insert(random.uniform(0.0, 0.5));
      return std::vector<double>(chosen.begin(), chosen.end());
    };
    const auto depth = entries_at(times());
    const auto colour = entries_at(times());
    EXPECT_EQ(associate(depth, colour, 0.02), all_pairs(depth, colour, 0.02)) << "seed " << seed;
  }
}

}  // namespace

}  // namespace vesalius
