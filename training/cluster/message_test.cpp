#include "cluster/message.h"

#include <gmock/gmock.h>

#include <sstream>

#include "cluster/reduce_task.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

TEST(RecordLine, KeepsEveryByte) {
  for (const std::size_t size : {0, 1, 2, 3, 4, 1000, 100000}) {
    std::string message(size, '\0');
    for (std::size_t i = 0; i < size; ++i) message[i] = static_cast<char>(i * i / 7);
    const std::string line = record_line({"00012.3", message});
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    const Record record = parse_record(line, "input");
    EXPECT_EQ(record.key, "00012.3");
    EXPECT_EQ(record.message, message);
  }
}

TEST(RecordLine, NamesKeyAndPlaceOfDamage) {
  const std::string line = record_line({"key", std::string(300, 'x')});
  int refused = 0;
  for (std::size_t at = 4; at + 1 < line.size(); ++at) {
    std::string damaged = line;
    damaged[at] = damaged[at] == 'A' ? 'B' : 'A';
    try {
      EXPECT_EQ(parse_record(damaged, "input").message, std::string(300, 'x')) << "padding bits alone may differ";
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::StartsWith("input: key: "));
      ++refused;
    }
  }
  EXPECT_GE(refused, static_cast<int>(line.size()) - 8);
  for (const std::string bad : {"", "key", "\tAAAA", "key\t", "key\tAAA", "key\t????"}) {
    EXPECT_THROW(parse_record(bad, "input"), Error) << bad;
  }
}

TEST(KeyMerger, AddsSumsAndKeepsPiecesInAnyOrder) {
  const std::vector<std::string> sums{sums_message({{0, 2}, {1, 2, 3}}), sums_message({{1}, {10, 20, 30}}),
                                      sums_message({{0, 2}, {1, 2, 3}})};
  const std::vector<std::string> pieces{piece_message(3, "c"), piece_message(1, "a"), piece_message(3, "c")};
  for (const std::vector<int>& order : {std::vector<int>{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}) {
    KeyMerger added, kept;
    for (const int i : order) {
      added.add(sums[i], "key");
      kept.add(pieces[i], "key");
    }
    EXPECT_EQ(added.sums().shards, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(added.sums().numbers, (std::vector<std::int64_t>{11, 22, 33}));
    EXPECT_THAT(kept.pieces(), testing::ElementsAre(testing::Pair(1, "a"), testing::Pair(3, "c")));
  }
}

TEST(KeyMerger, RefusesWhatCannotBeRight) {
  const auto refuses = [](const std::string& first, const std::string& second) {
    KeyMerger merger;
    merger.add(first, "key");
    EXPECT_THROW(merger.add(second, "key"), Error);
  };
  refuses(piece_message(1, "a"), piece_message(1, "b"));
  refuses(sums_message({{0, 1}, {1}}), sums_message({{1, 2}, {1}}));
  refuses(sums_message({{0}, {1}}), sums_message({{1}, {1, 2}}));
  refuses(sums_message({{0}, {1}}), piece_message(1, "a"));
}

TEST(RunCombineTask, MergesNeighboursOfAKey) {
  std::istringstream in(record_line({"a", piece_message(0, "x")}) + record_line({"a", piece_message(1, "y")}) +
                        record_line({"b", sums_message({{0}, {5}})}) + record_line({"b", sums_message({{1}, {6}})}));
  std::ostringstream out;
  run_combine_task(in, out);
  std::istringstream lines(out.str());
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  KeyMerger merger;
  merger.add(parse_record(line, "out").message, "a");
  EXPECT_EQ(merger.pieces().size(), 2U);
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(parse_record(line, "out").message, sums_message({{0, 1}, {11}}));
  EXPECT_FALSE(std::getline(lines, line));
}

}  // namespace
}  // namespace vesalius
