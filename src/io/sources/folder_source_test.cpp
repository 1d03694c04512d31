#include "io/sources/folder_source.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::TemporaryFolder;
using testing::HasSubstr;

TEST(NaturalLess, ComparesNumbersByValue) {
  const std::vector<std::string> ordered = {"1", "01", "2", "10", "a", "a1b", "a1c", "a02", "a2", "a2b", "a10", "b"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      const bool equal_numbers = (ordered[i] == "1" && ordered[j] == "01") || (ordered[i] == "01" && ordered[j] == "1");
      if (!equal_numbers) {
        EXPECT_EQ(natural_less(ordered[i], ordered[j]), i < j) << ordered[i] << ' ' << ordered[j];
      }
    }
  }
  EXPECT_NE(natural_less("1", "01"), natural_less("01", "1"));
}

TEST(ListFiles, ListsOnlyTheWantedKinds) {
  const TemporaryFolder folder;
  for (const char* name : {"b10.png", "b9.PNG", "._b1.png", "c.jpg", "d.txt", "png"}) put(folder / name, "");
  std::vector<std::string> names;
  for (const auto& path : list_files(folder.path(), {".png", ".jpg"})) names.push_back(path.filename().string());
  EXPECT_THAT(names, testing::ElementsAre("b9.PNG", "b10.png", "c.jpg"));
  EXPECT_THAT(error_of([&] { list_files(folder / "none", {".png"}); }),
              HasSubstr("none: folder cannot be read: No such"));
}

/// Returns the times of the frames that are called so, with this meta.json.
std::vector<double> times_of(const std::vector<std::string>& names, const std::string& meta) {
  const TemporaryFolder folder;
  for (const std::string& name : names) put(folder / "depth/" + name + ".png", "");
  put(folder / "meta.json", meta);
  std::vector<double> times_s;
  for (const FrameFiles& files : list_folder(folder.path(), {}).frames) times_s.push_back(files.time_s.value_or(-1.0));
  return times_s;
}

TEST(ListFolder, TakesTimesFromTheRateAndTheNumbersOfFrames) {
  const std::string meta = R"({"rate_hz": 4})";
  EXPECT_THAT(times_of({"002", "003", "010"}, meta), testing::ElementsAre(0.5, 0.75, 2.5));
  EXPECT_THAT(times_of({"a2", "a3", "a10"}, meta), testing::ElementsAre(0.0, 0.25, 0.5));
  EXPECT_THAT(times_of({"1", "01"}, meta), testing::ElementsAre(0.0, 0.25));  // the numbers do not rise
  EXPECT_THAT(times_of({"1", "2"}, "{}"), testing::ElementsAre(-1.0, -1.0));
}

}  // namespace
}  // namespace vesalius
