#include "downloads/packed_motion.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "downloads/assets.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

TEST(PackedMotion, KeepsEveryFourthFrameOfABvh) {
  const std::string head = "HIERARCHY\r\nROOT Hips\r\n{\r\n\tOFFSET 0.00000 0 0\r\n\tCHANNELS 3 Zrotation \r\n}";
  const std::string original = head + "\r\n \r\nMOTION\r\nFrames: 6\r\nFrame Time: .0083333\r\n" +
                               "1.004\t-0.0049  508.625 \r\n8 8 8\r\n\r\n8 8 8\r\n8 8 8\r\n" +
                               "-508.635 100.00 7.62852e-016\r\n9 9 9";
  EXPECT_EQ(packed_motion(original, "a/b.bvh", ""),
            "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0.00000 0 0\n\tCHANNELS 3 Zrotation \n}\n"
            "MOTION\nFrames: 2\nFrame Time: 0.0333332\n1 0 508.62\n-508.63 100 0\n");
}

TEST(PackedMotion, KeepsEveryFourthFrameOfAnAmc) {
  const std::string original =
      "#!OML:ASF X:\\f\xfcr Bonn\\bjorn.ASF\r\n:FULLY-SPECIFIED\r\n:DEGREES\r\n"
      "7\r\nroot 4.0961 17.34249 -0.0004 1 0.0625 355.6454\r\nrradius 59.7256\r\nlhand -0.001 0.125\r\n"
      "8\r\nroot 9 9 9 9 9 9\r\n9\r\n10\r\nlhand 9 9\r\n11\r\nlhand 1e1 20.10\r\nroot 1 2 3 4 5 6\r\n12\r\n";
  EXPECT_EQ(packed_motion(original, "HDM_bk_1.amc", "HDM_bk.asf"),
            "#!OML:ASF HDM_bk.asf\n:FULLY-SPECIFIED\n:DEGREES\n"
            "1\nroot 4.096 17.342 0 1 0.062 355.645\nrradius 59.73\nlhand 0 0.12\n"
            "2\nlhand 10 20.1\nroot 1 2 3 4 5 6\n");
}

TEST(PackedMotion, LeavesSkeletonsAsTheyAre) {
  const std::string skeleton = "# \xe4\r\n:version 1.10\r\n";
  EXPECT_EQ(packed_motion(skeleton, "01.asf", ""), skeleton);
}

TEST(PackedMotion, NamesTheLineOfWhatIsNoMotion) {
  const auto error = [](const std::string& text, const std::string& name) {
    return test::error_of([&] { packed_motion(text, name, "s.asf"); });
  };
  EXPECT_EQ(error("HIERARCHY\nMOTION\nFrames: 1\n", "a.bvh"), "a.bvh:3: expected \"Frame Time:\" before the end");
  EXPECT_EQ(error("", "a.bvh"), "a.bvh:0: expected \"Frame Time:\" before the end");
  EXPECT_EQ(error("MOTION\nFrame Time: soon\n", "a.bvh"), "a.bvh:2: expected numbers");
  EXPECT_EQ(error("MOTION\nFrame Time: 1\n\n1 2x\n", "a.bvh"), "a.bvh:4: expected numbers");
  EXPECT_EQ(error("<!DOCTYPE html>\n", "a.amc"), "a.amc:1: expected a frame before the end");
  EXPECT_EQ(error("1\nroot 1 , 2\n", "a.amc"), "a.amc:2: expected numbers");
}

// Originals that the package's own files would be made of: frames between are put in, lines end in CR LF and numbers
// have digits that rounding takes away.
std::string more_digits(const std::string& word, std::size_t decimals) {
  std::string out = word == "0" ? "-0." : word;
  if (out.find('.') == out.npos) out += '.';
  out.append(decimals - (out.size() - out.find('.') - 1), '0');
  return out + "21";
}

std::string line_of_original(const std::string& line, bool has_bone) {
  std::istringstream words(line);
  std::string out, word;
  if (has_bone) words >> out;
  const std::size_t decimals = out == "root" ? 3 : 2;
  while (words >> word) out += " " + more_digits(word, decimals);
  return out + "\r\n";
}

std::string original_bvh(std::istream& packed) {
  std::string out, line;
  while (std::getline(packed, line) && !line.starts_with("Frame Time: ")) out += line + "\r\n";
  out += "Frame Time: " + std::to_string(std::stod(line.substr(12)) * 1e6 / 4) + "e-6\r\n";
  while (std::getline(packed, line)) out += line_of_original(line, false) + "7\r\n7\r\n7\r\n";
  return out;
}

std::string original_amc(std::istream& packed) {
  std::string out, line;
  int frame = 0;
  while (std::getline(packed, line)) {
    if (line.find_first_not_of("0123456789") != line.npos) {
      out += line.starts_with(':') || line.starts_with('#') ? line + "\r\n" : line_of_original(line, true);
      continue;
    }
    for (int i = frame == 0 ? 3 : 0; i < 3; ++i) out += std::to_string(++frame) + "\r\nroot 7\r\n";
    out += std::to_string(++frame) + "\r\n";
  }
  return out;
}

TEST(PackedMotion, MakesTheMotionsOfThePackage) {
  const AssetPackage& mocap = asset_package("mocap");
  const std::string folder = default_assets_folder();
  if (!has_assets(mocap, folder)) GTEST_SKIP() << "no motions in " << folder;
  const auto read = asset_reader(mocap, folder);
  int made = 0;
  for (const AssetSource& source : mocap.sources) {
    for (const auto& [path, original] : source.originals) {
      const std::string expected = read(path);
      std::istringstream packed(expected);
      const std::string text = path.ends_with(".bvh")   ? original_bvh(packed)
                               : path.ends_with(".amc") ? original_amc(packed)
                                                        : expected;
      ASSERT_EQ(packed_motion(text, path, original.skeleton), expected) << path;
      ++made;
    }
  }
  EXPECT_EQ(made, 464);
}

}  // namespace
}  // namespace vesalius
