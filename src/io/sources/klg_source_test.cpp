#include "io/sources/klg_source.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/sources/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_frame;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class T>
std::string raw(const Image<T>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  out.resize(size);
  return out;
}

class Log {
 public:
  explicit Log(std::uint32_t frames) { out_.number(frames); }
  Log& frame(std::int64_t time_us, const std::string& depth, const std::string& colour = "") {
    out_.number(static_cast<std::uint64_t>(time_us));
    out_.number(static_cast<std::uint32_t>(depth.size()));
    out_.number(static_cast<std::uint32_t>(colour.size()));
    out_.bytes() += depth + colour;
    return *this;
  }
  const std::string& bytes() { return out_.bytes(); }

 private:
  ByteWriter out_;
};

TEST(KlgSource, ReadsPackedAndRawPictures) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 640, 480), b = random_frame("b", 2, 640, 480);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(480, 640, CV_8UC3, cv::Scalar(0, 0, 250)), jpeg);
  Log log(3);
  log.frame(1'000'000, packed(raw(a.depth)), raw(a.colour)).frame(1'033'000, raw(b.depth));
  log.frame(1'066'000, packed(raw(b.depth)), std::string(jpeg.begin(), jpeg.end()));
  const auto source = open_source(test::put(folder / "a.klg", log.bytes()));
  EXPECT_EQ(source->size(), 3);
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("those of ElasticFusion (528, 528, 320, 240) assumed")));
  const Frame first = *source->next(), second = *source->next(), third = *source->next();
  EXPECT_FALSE(source->next());
  EXPECT_EQ(first.depth, a.depth);
  EXPECT_EQ(first.colour, a.colour);
  EXPECT_EQ(first.camera, (Camera{640, 480, 528.F, 528.F, 320.F, 240.F}));
  EXPECT_EQ(first.name, "1.000000");
  EXPECT_EQ(second.depth, b.depth);
  EXPECT_TRUE(second.colour.empty());
  EXPECT_NEAR(third.colour(5, 5).r, 250, 5);
  EXPECT_EQ(third.time_s, 1.066);
  source->seek(1.02);
  EXPECT_EQ(source->next()->name, "1.033000");
  EXPECT_EQ(source->span()->last_s, 1.066);
}

TEST(KlgSource, TakesTheSizeFromJpegOrCamera) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(23, 37, CV_8UC3, cv::Scalar(0, 250, 0)), jpeg);
  SourceOptions options;
  options.fx = 41.F;
  Log with(1);
  with.frame(0, packed(raw(a.depth)), std::string(jpeg.begin(), jpeg.end()));
  EXPECT_EQ(open_source(test::put(folder / "with.klg", with.bytes()), options)->next()->depth, a.depth);
  Log without(1);
  without.frame(0, packed(raw(a.depth)));
  test::put(folder / "without.klg", without.bytes());
  EXPECT_THAT(error_of([&] { open_source(folder / "without.klg", options); }),
              HasSubstr("without.klg: depth of 1702 bytes, expected those of 640x480"));
  options.fx.reset();
  options.camera_file = test::put(folder / "meta.json", R"({"width": 37, "height": 23, "fx": 50})");
  options.depth_scale = 500.F;
  const Frame frame = *open_source(folder / "without.klg", options)->next();
  EXPECT_GT(a.depth(1, 0), 0);
  EXPECT_EQ(frame.depth(1, 0), a.depth(1, 0) * 2);
  EXPECT_EQ(frame.camera.fx, 50.F);
}

TEST(KlgSource, GivesTheWholeFramesOfALogCutShort) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 160, 120, false);
  SourceOptions options;
  options.fx = 130.F;
  const std::string depth = packed(raw(a.depth));
  const std::string whole = Log(2).frame(0, depth).frame(33'000, depth).bytes();
  const auto cut = open_source(test::put(folder / "cut.klg", whole.substr(0, whole.size() - 1)), options);
  EXPECT_EQ(cut->size(), 1);
  EXPECT_THAT(cut->notes(), ElementsAre(HasSubstr("the 1 whole frames before it are read")));
  // The number is written when the log is closed.
  const auto open =
      open_source(test::put(folder / "open.klg", Log(0).frame(0, depth).frame(0, depth).bytes()), options);
  EXPECT_EQ(open->size(), 2);
  EXPECT_THAT(open->notes(), IsEmpty());
  open->next();
  EXPECT_EQ(open->next()->name, "0.000000_again");
}

TEST(KlgSource, NamesWhatIsDamaged) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1, 160, 120, false);
  const auto error = [&](const std::string& bytes) {
    return error_of([&] { open_source(test::put(folder / "a.klg", bytes)); });
  };
  EXPECT_THAT(error(""), HasSubstr("a.klg: "));
  EXPECT_THAT(error("abc"), HasSubstr("expected a number of frames"));
  EXPECT_THAT(error("some text that is no log"), HasSubstr("no whole frame"));
  EXPECT_THAT(error(Log(1).frame(0, "not packed").bytes()), HasSubstr("its zlib data cannot be decompressed"));
  const std::string depth = packed(raw(a.depth));
  SourceOptions options;
  options.fx = 130.F;
  Log log(4);
  log.frame(0, depth).frame(1, depth.substr(0, depth.size() / 2)).frame(2, depth, "no JPEG");
  log.frame(3, packed(raw(a.depth).substr(2)));
  const auto source = open_source(test::put(folder / "b.klg", log.bytes()), options);
  EXPECT_TRUE(source->next());
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("b.klg: 0.000001: damaged"));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("b.klg: 0.000002: "));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("depth of 38398 bytes, expected 38400 of 160x120 pixels"));
  EXPECT_FALSE(source->next());
}

/// Written from pictures worked out below (tests/recordings/other_side.py --fixtures).
TEST(KlgSource, ReadsWhatOthersWrote) {
  SourceOptions options;
  options.fx = 14.5F;
  for (const char* name : {"packed.klg", "raw.klg"}) {
    const auto source = open_source(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_klg/" + name, options);
    ASSERT_EQ(source->size(), 3);
    for (int i = 0; i < 3; ++i) {
      const Frame frame = *source->next();
      EXPECT_EQ(frame.time_s, 1e9 + 0.033 * i);
      ASSERT_EQ(frame.depth.width(), 16);
      for (int v = 0; v < 12; ++v) {
        for (int u = 0; u < 16; ++u) {
          ASSERT_EQ(frame.depth(u, v), u == v ? 0 : 1000 + 100 * i + 10 * v + u) << u << " " << v;
          ASSERT_NEAR(frame.colour(u, v).g, 20 * v, 40);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vesalius
