#include "downloads/asset_list.h"

#include <algorithm>
#include <map>

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

std::string sources_with(const std::string& from, const std::string& to) {
  std::string text = "[[source]]\nhome = \"http://example.org/a\"\nlicence = \"L\"\ncredit = \"C\"\nfiles = [\n" +
                     ("[\"a.asf\", \"x y/a.asf\", 3, \"" + kSum) + "\"],\n[\"a_1.amc\", \"1.amc\", 4, \"" + kSum +
                     "\", \"a.asf\"],\n]\n";
  return text.replace(text.find(from), from.size(), to);
}

TEST(SourceList, ReadsASource) {
  const auto sources = parse_source_list(sources_with("", ""), "l");
  ASSERT_EQ(sources.size(), 1U);
  EXPECT_EQ(sources[0].home, "http://example.org/a");
  EXPECT_EQ(sources[0].originals.at("a.asf").path, "x y/a.asf");
  EXPECT_EQ(sources[0].originals.at("a_1.amc").digest.sha256, kSum);
  EXPECT_EQ(sources[0].originals.at("a_1.amc").skeleton, "a.asf");
  EXPECT_EQ(sources[0].bytes(), 7U);
}

TEST(SourceList, NamesTheLineOfErrors) {
  const auto error = [](const std::string& from, const std::string& to) {
    return test::error_of([&] { parse_source_list(sources_with(from, to), "l.toml"); });
  };
  EXPECT_THAT(error("home", "hmoe"), HasSubstr("l.toml:2: unknown key"));
  EXPECT_THAT(error(", 3, \"" + kSum + "\"", ""), HasSubstr("l.toml:6: files: expected [path, original's path"));
  EXPECT_THAT(error(", \"a.asf\"]", "]"), HasSubstr("l.toml:7: files: expected [path, original's path"));
  EXPECT_THAT(error("\"" + kSum + "\"", "\"\""), HasSubstr("l.toml:6: files: expected a text"));
  EXPECT_THAT(error("x y", ".."), HasSubstr("expected a path that leads nowhere else"));
  EXPECT_THAT(
      error("[\"a_1.amc\", \"1.amc\", 4, \"" + kSum + "\", \"a.asf\"]", "[\"a.asf\", \"b\", 4, \"" + kSum + "\"]"),
      HasSubstr("l.toml:7: files: this path is listed twice"));
}

TEST(AssetList, ContainsThePackagesOfTheProgram) {
  const AssetPackage& makehuman = asset_package("makehuman");
  EXPECT_THAT(makehuman.files, Contains(Field(&AssetFile::path, "makehuman/data/3dobjs/base.obj")));
  EXPECT_FALSE(makehuman.homes.empty());
  for (const std::string& home : makehuman.homes) EXPECT_TRUE(home.starts_with("https://")) << home;
  EXPECT_THAT(test::error_of([] { asset_package("moccap"); }), HasSubstr("expected makehuman, mocap"));
}

TEST(AssetList, KnowsWhereEachMotionWasPublished) {
  const AssetPackage& mocap = asset_package("motions");
  EXPECT_EQ(&mocap, &asset_package("mocap"));
  std::map<std::string, int> had;
  for (const AssetSource& source : mocap.sources) {
    EXPECT_TRUE(source.home.starts_with("https://raw.githubusercontent.com/")) << source.home;
    for (const auto& [path, original] : source.originals) ++had[path];
  }
  EXPECT_EQ(had.size(), 464U);
  for (const auto& [path, text] : mocap.enclosed) ++had[path];
  for (const AssetFile& file : mocap.files) EXPECT_EQ(had[file.path], 1) << file.path;
  EXPECT_EQ(had.size(), mocap.files.size());
  const auto manifest = std::ranges::find(mocap.files, "manifest.csv", &AssetFile::path);
  EXPECT_EQ(sha256_of(mocap.enclosed.at("manifest.csv")), manifest->digest.sha256);
}

}  // namespace
}  // namespace vesalius
