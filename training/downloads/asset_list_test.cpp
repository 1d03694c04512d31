#include "downloads/asset_list.h"

#include <algorithm>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;

const std::string kSum(64, 'a');

std::string list_with(const std::string& from, const std::string& to) {
  std::string text = R"([[package]]
name = "p"
licence = "L"
credit = "C"
page = "http://example.org"
homes = ["http://example.org/a", "http://example.org/b"]
archive = ["p.tar.xz", 9, ")" +
                     kSum + R"("]
files = [
  ["a", 3, ")" + kSum +
                     R"("],
  ["sub/b", 4, ")" + kSum +
                     R"("],
]
)";
  const std::size_t at = text.find(from);
  return text.replace(at, from.size(), to);
}

TEST(AssetList, ReadsAPackage) {
  const auto packages = parse_asset_list(list_with("", ""), "l");
  ASSERT_EQ(packages.size(), 1U);
  EXPECT_EQ(packages[0].name, "p");
  EXPECT_EQ(packages[0].homes.size(), 2U);
  EXPECT_EQ(packages[0].archive.path, "p.tar.xz");
  ASSERT_EQ(packages[0].files.size(), 2U);
  EXPECT_EQ(packages[0].files[1].path, "sub/b");
  EXPECT_EQ(packages[0].files[1].digest.sha256, kSum);
  EXPECT_EQ(packages[0].bytes(), 7U);
}

TEST(AssetList, NamesTheLineOfErrors) {
  const auto error = [](const std::string& from, const std::string& to) {
    return test::error_of([&] { parse_asset_list(list_with(from, to), "l.toml"); });
  };
  EXPECT_THAT(error("name =", "nmae ="), HasSubstr("l.toml:2: unknown key"));
  EXPECT_THAT(error("licence = \"L\"", ""), HasSubstr("l.toml:1: missing key \"licence\""));
  EXPECT_THAT(error("\"p\"", "\"../p\""), HasSubstr("name: expected letters"));
  EXPECT_THAT(error("\"C\"", "7"), HasSubstr("l.toml:4: credit: expected a text"));
  EXPECT_THAT(error("\"sub/b\"", "\"../b\""), HasSubstr("l.toml:10: files: expected a path"));
  EXPECT_THAT(error("\"sub/b\"", "\"/b\""), HasSubstr("expected a path that leads nowhere else"));
  EXPECT_THAT(error("\"sub/b\"", "\"a\""), HasSubstr("l.toml:10: files: this path is listed twice"));
  EXPECT_THAT(error("3,", "-3,"), HasSubstr("expected a whole number from 0"));
  EXPECT_THAT(error("3,", ""), HasSubstr("expected [path, bytes, SHA-256]"));
  EXPECT_THAT(error("a\"],\n  [", "A\"],\n  ["), HasSubstr("l.toml:9: files: expected a SHA-256"));
  EXPECT_THAT(error("[[package]]", "x = ["), HasSubstr("not valid TOML"));
  EXPECT_THAT(test::error_of([] { parse_asset_list(list_with("", "") + list_with("", ""), "l"); }),
              HasSubstr("this name is used twice"));
}

TEST(AssetList, ContainsThePackagesOfTheProgram) {
  const AssetPackage& makehuman = asset_package("makehuman");
  EXPECT_THAT(makehuman.files, Contains(Field(&AssetFile::path, "makehuman/data/3dobjs/base.obj")));
  EXPECT_FALSE(makehuman.homes.empty());
  for (const std::string& home : makehuman.homes) EXPECT_TRUE(home.starts_with("https://")) << home;
  const AssetPackage& mocap = asset_package("mocap");
  EXPECT_EQ(std::ranges::count_if(
                mocap.files, [](const AssetFile& f) { return f.path.ends_with(".bvh") || f.path.ends_with(".amc"); }),
            453);
  EXPECT_THAT(test::error_of([] { asset_package("moccap"); }), HasSubstr("expected makehuman, mocap"));
}

}  // namespace
}  // namespace vesalius
