#include "io/files/known_kind.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "vesalius/image_file.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using namespace std::literals;
using test::error_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kPointer =
    "version https://git-lfs.github.com/spec/v1\n"
    "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";

TEST(KnownKind, SaysWhatStandsInPlaceOfAFile) {
  EXPECT_THAT(known_kind(kPointer), HasSubstr("git lfs pull"));
  EXPECT_THAT(known_kind("PK\3\4\x14\0\0\0"sv), HasSubstr("unzip"));
  EXPECT_THAT(known_kind(std::string(257, 'a') + "ustar\0"), HasSubstr("tar xf"));
  EXPECT_THAT(known_kind("\x1F\x8B\x08"sv), HasSubstr("gunzip"));
  EXPECT_THAT(known_kind("\xFD"
                         "7zXZ\0\0"sv),
              HasSubstr("unxz"));
  EXPECT_THAT(known_kind("<!DOCTYPE html><html>"), HasSubstr("web page"));
  EXPECT_THAT(known_kind("<HTML><head>"), HasSubstr("web page"));
  EXPECT_THAT(known_kind("\0\0\0\x18"
                         "ftypmp42"sv),
              HasSubstr("MP4"));
  EXPECT_THAT(known_kind("\0\0\0\x18"
                         "ftypheic"sv),
              HasSubstr("HEIC"));
  EXPECT_THAT(known_kind("RIFF1234AVI LIST"sv), HasSubstr("AVI film; if it has depth of 16 bits: ffmpeg"));
  EXPECT_THAT(known_kind("RIFF1234WAVEfmt "sv), HasSubstr("sound"));
  EXPECT_THAT(known_kind("II+\0\x08\0\0\0"sv), HasSubstr("BigTIFF"));
  EXPECT_THAT(known_kind("P2\n640 480\n"sv), HasSubstr("PGM of text"));
  EXPECT_THAT(known_kind("ply\nformat ascii 1.0\n"sv), HasSubstr("PLY"));
  EXPECT_THAT(known_kind(std::string(512, '\0')), HasSubstr("zeros"));
  for (const std::string_view other : {""sv, "\0"sv, "\x89PNG\r\n\x1a\n"sv, "some text"sv, "P"sv}) {
    EXPECT_THAT(known_kind(other), IsEmpty());
  }
}

TEST(KnownKind, SaysWhatToDoWithRecordingsThatAreNotRead) {
  const test::TemporaryFolder folder;
  const auto said = [&](const char* name) { return error_of([&] { open_source(test::put(folder / name, "?")); }); };
  EXPECT_THAT(said("scene.sens"), HasSubstr("reader.py: --export_depth_images"));
  EXPECT_THAT(said("a.svo2"), HasSubstr("SVO Export"));
  EXPECT_THAT(said("a.klg"), HasSubstr("depth of .klg, expected PNG of 16 bits"));
}

TEST(KnownKind, NamesAPointerOfGitWhateverIsExpected) {
  const test::TemporaryFolder folder;
  for (const char* name :
       {"a.bag", "a.mcap", "a.db3", "a.mkv", "a.png", "a.pcd", "a.bag.active", "a.mcap.zstd", "a.xyz", "a"}) {
    const std::string path = test::put(folder / name, kPointer);
    const auto said = error_of([&] {
      SourceOptions options;
      options.fx = 100.F;
      open_source(path, options)->next();
    });
    EXPECT_THAT(said, AllOf(HasSubstr(path), HasSubstr("git lfs pull"))) << name;
  }
  EXPECT_THAT(error_of([&] { load_model(test::put(folder / "a.model", kPointer)); }), HasSubstr("git lfs pull"));
  EXPECT_THAT(error_of([&] { decode_colour(kPointer, "a.jpg"); }), HasSubstr("git lfs pull"));
}

}  // namespace
}  // namespace vesalius
