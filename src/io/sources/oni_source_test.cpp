#include "io/sources/oni_source.h"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/files/byte_stream.h"
#include "io/files/test_files.h"
#include "io/sources/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::random_frame;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kDepth = 2, kImage = 3;

std::vector<Frame> all_of(FrameSource& source) {
  std::vector<Frame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

template <class T>
std::string raw(const Image<T>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
}

template <class T>
Image<T> mirrored(const Image<T>& image) {
  Image<T> turned(image.width(), image.height());
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) turned(u, v) = image(image.width() - 1 - u, v);
  }
  return turned;
}

/// Writes the records of a recording one by one.
class Records {
 public:
  explicit Records(bool is_old = false) : is_old_(is_old) {
    out_.bytes() += "NI10";
    out_.number(std::uint8_t{1});
    out_.number(std::uint8_t{0});
    out_.number(static_cast<std::uint16_t>(is_old ? 0 : 1));
    out_.number(is_old ? 4U : 0U);
    out_.number(std::uint64_t{0});
    out_.number(9U);
  }
  void stream(std::uint32_t id, const std::string& name, std::uint32_t kind, const std::string& codec, int width = 37,
              int height = 23) {
    tables_[id] = {};
    table_places_[id] = add(id, is_old_ ? 0x02 : 0x0D, stream_fields(name, kind, codec), "");
    ByteWriter mode;
    for (const int value : {width, height, 30}) mode.number(static_cast<std::uint32_t>(value));
    property(id, "xnMapOutputMode", mode.bytes());
  }
  void property(std::uint32_t id, const std::string& name, const std::string& value, std::uint32_t kind = 0x06) {
    ByteWriter fields;
    fields.text(name + std::string(1, '\0'));
    fields.text(value);
    add(id, kind, fields.bytes(), "");
    ++state_;
  }
  void integer(std::uint32_t id, const std::string& name, std::uint64_t value) {
    ByteWriter bytes;
    bytes.number(value);
    property(id, name, bytes.bytes(), 0x03);
  }
  void reals(std::uint32_t id, const std::string& name, const std::vector<double>& values) {
    ByteWriter bytes;
    for (const double value : values) bytes.real(value);
    property(id, name, bytes.bytes());
  }
  void picture(std::uint32_t id, std::int64_t time_us, const std::string& data) {
    ByteWriter fields;
    fields.number(static_cast<std::uint64_t>(time_us));
    fields.number(7U);
    const std::uint64_t at = add(id, 0x0A, fields.bytes(), data);
    ByteWriter entry;
    entry.number(static_cast<std::uint64_t>(time_us));
    entry.number(state_);
    entry.number(at);
    tables_[id] += entry.bytes();
  }
  /// Writes the tables of pictures as a recorder does that is closed.
  void tables() {
    for (const auto& [id, entries] : tables_) {
      const std::uint64_t at = add(id, 0x0E, "", std::string(20, '\0') + entries);
      ByteWriter place;
      place.number(at);
      // The last field of the record of the stream.
      out_.bytes().replace(table_places_[id] + stream_bytes_ - 8, 8, place.bytes());
    }
  }
  const std::string& end() {
    add(0, 0x0B, "", "");
    return out_.bytes();
  }
  std::string& bytes() { return out_.bytes(); }

 private:
  std::string stream_fields(const std::string& name, std::uint32_t kind, const std::string& codec) {
    ByteWriter fields;
    // Of one length, so that the place of the table is known.
    fields.text((name + std::string(10, '\0')).substr(0, 10));
    fields.number(kind);
    fields.bytes() += codec;
    if (!is_old_) fields.bytes() += std::string(28, '\0');
    stream_bytes_ = 28 + fields.bytes().size();
    return fields.bytes();
  }
  std::uint64_t add(std::uint32_t id, std::uint32_t kind, const std::string& fields, const std::string& data) {
    const std::uint64_t at = out_.bytes().size();
    out_.bytes() += std::string("NIR\0", 4);
    out_.number(kind);
    out_.number(id);
    out_.number(static_cast<std::uint32_t>((is_old_ ? 24 : 28) + fields.size()));
    out_.number(static_cast<std::uint32_t>(data.size()));
    out_.bytes() += std::string(is_old_ ? 4 : 8, '\0') + fields + data;
    return at;
  }

  bool is_old_;
  ByteWriter out_;
  std::uint32_t state_ = 0;
  std::size_t stream_bytes_ = 0;
  std::map<std::uint32_t, std::string> tables_;
  std::map<std::uint32_t, std::uint64_t> table_places_;
};

TEST(OniSource, PairsColourThatIsRegistered) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1), b = random_frame("b", 2), c = random_frame("c", 3);
  Records out;
  out.stream(1, "Depth1", kDepth, "NONE");
  out.stream(2, "Image1", kImage, "NONE");
  out.integer(1, "Registration", 1);
  out.reals(1, "xnFOV", {1.0, 0.8});
  out.reals(2, "xnFOV", {1.1, 0.9});
  out.picture(2, 1'003'000, raw(a.colour));
  out.picture(1, 1'000'000, raw(a.depth));
  out.picture(1, 1'033'000, raw(b.depth));
  out.picture(2, 1'030'000, raw(b.colour));
  out.picture(1, 1'200'000, raw(c.depth));
  const auto source = open_source(test::put(folder / "a.oni", out.end()));
  EXPECT_EQ(source->size(), 3);
  EXPECT_THAT(source->notes(), IsEmpty());
  const std::vector<Frame> frames = all_of(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].depth, a.depth);
  EXPECT_EQ(frames[0].colour, a.colour);
  EXPECT_EQ(frames[1].depth, b.depth);
  EXPECT_EQ(frames[1].colour, b.colour);
  EXPECT_EQ(frames[2].depth, c.depth);
  EXPECT_TRUE(frames[2].colour.empty());
  EXPECT_EQ(frames[1].name, "1.033000");
  EXPECT_EQ(frames[1].time_s, 1.033);
  // Of colour, onto whose grid depth is registered.
  EXPECT_NEAR(frames[0].camera.fx, 18.5 / std::tan(0.55), 1e-4);
  EXPECT_NEAR(frames[0].camera.fy, 11.5 / std::tan(0.45), 1e-4);
  EXPECT_EQ(frames[0].camera.cx, 18.F);
}

TEST(OniSource, LeavesOutColourWhereNobodySaysThatItIsRegistered) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Records out;
  out.stream(1, "Depth", kDepth, "NONE");
  out.stream(2, "Image", kImage, "NONE");
  out.reals(1, "xnFOV", {1.0, 0.8});
  out.picture(1, 0, raw(a.depth));
  out.picture(2, 0, raw(a.colour));
  test::put(folder / "a.oni", out.end());
  const auto source = open_source(folder / "a.oni");
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("no colour, since the file does not say")));
  EXPECT_TRUE(source->next()->colour.empty());
  SourceOptions options;
  options.colour_topic = "Image";
  EXPECT_EQ(open_source(folder / "a.oni", options)->next()->colour, a.colour);
  options.colour_topic = "Infrared";
  EXPECT_THROW(open_source(folder / "a.oni", options), UsageError);
}

TEST(OniSource, ReadsJpegAndFindsItsSizeWrong) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  for (const int width : {37, 40}) {
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", cv::Mat(23, width, CV_8UC3, cv::Scalar(0, 0, 250)), jpeg);
    Records out;
    out.stream(1, "Depth1", kDepth, "NONE");
    out.stream(2, "Image1", kImage, "JPEG");
    out.integer(1, "Registration", 1);
    out.picture(1, 0, raw(a.depth));
    out.picture(2, 0, std::string(jpeg.begin(), jpeg.end()));
    const auto source = open_source(test::put(folder / "a.oni", out.end()));
    if (width == 37) {
      EXPECT_NEAR(source->next()->colour(5, 5).r, 250, 5);
    } else {
      EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("a.oni: 0.000000: colour of 40x23 pixels"));
    }
  }
}

TEST(OniSource, TurnsMirroredPicturesBack) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Records out;
  out.stream(1, "Depth1", kDepth, "NONE");
  out.integer(1, "xnMirror", 1);
  out.picture(1, 0, raw(mirrored(a.depth)));
  out.integer(1, "xnMirror", 0);
  out.picture(1, 33'000, raw(a.depth));
  out.tables();
  const std::vector<Frame> frames = all_of(*open_source(test::put(folder / "a.oni", out.end())));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].depth, a.depth);
  EXPECT_EQ(frames[1].depth, a.depth);
}

TEST(OniSource, ReadsTenthsOfMillimetresAndShifts) {
  const test::TemporaryFolder folder;
  DepthImage stored(37, 23, 2);
  stored(3, 4) = 4;
  Records tenths;
  tenths.stream(1, "Depth", kDepth, "NONE");
  tenths.integer(1, "oniPixelFormat", 101);
  tenths.picture(1, 0, raw(DepthImage(37, 23, 12344)));
  EXPECT_EQ(open_source(test::put(folder / "t.oni", tenths.end()))->next()->depth(3, 4), 1234);
  Records shifts;
  shifts.stream(1, "Depth", kDepth, "NONE");
  shifts.integer(1, "oniPixelFormat", 102);
  ByteWriter table;
  for (const int z : {0, 400, 1000, 2000}) table.number(static_cast<std::uint16_t>(z));
  shifts.property(1, "S2D", table.bytes());
  shifts.picture(1, 0, raw(DepthImage(37, 23, 2)));
  shifts.picture(1, 0, raw(stored));
  const auto source = open_source(test::put(folder / "s.oni", shifts.end()));
  EXPECT_EQ(source->next()->depth, DepthImage(37, 23, 1000));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("0.000000_again: a shift of 4, expected less than 4"));
  Records none;
  none.stream(1, "Depth", kDepth, "NONE");
  none.integer(1, "oniPixelFormat", 103);
  none.picture(1, 0, raw(stored));
  EXPECT_THAT(error_of([&] { open_source(test::put(folder / "n.oni", none.end())); }),
              HasSubstr("depth as shifts, expected a property S2D"));
}

TEST(OniSource, TakesTheCameraOfThePartThatIsCropped) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  for (const bool is_mirrored : {false, true}) {
    Records out;
    out.stream(1, "Depth", kDepth, "NONE", 160, 120);
    ByteWriter cropping;
    cropping.number(1U);
    for (const int value : {100, 10, 37, 23}) cropping.number(static_cast<std::uint16_t>(value));
    out.property(1, "xnCropping", cropping.bytes());
    out.integer(1, "xnMirror", is_mirrored ? 1 : 0);
    out.picture(1, 0, raw(a.depth));
    const auto source = open_source(test::put(folder / "a.oni", out.end()));
    EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("a focal length of 131.2 pixels assumed")));
    const Camera camera = source->next()->camera;
    EXPECT_EQ(camera.width, 37);
    // Columns 100 to 136 of 160, or 23 to 59 seen from the other side.
    EXPECT_EQ(camera.cx, is_mirrored ? 79.5F - 23.F : 79.5F - 100.F);
    EXPECT_EQ(camera.cy, 59.5F - 10.F);
  }
}

TEST(OniSource, ReadsOldRecordings) {
  const test::TemporaryFolder folder;
  const Frame a = random_frame("a", 1);
  Records out(true);
  out.stream(1, "Depth1", kDepth, "NONE");
  out.reals(1, "xnRealWorldTranslationData", {120.0, 0.1, 2.0});
  out.picture(1, 5'000'000, raw(a.depth));
  const Frame frame = *open_source(test::put(folder / "a.oni", out.end()))->next();
  EXPECT_EQ(frame.depth, a.depth);
  EXPECT_EQ(frame.camera.fx, 600.F);
  EXPECT_EQ(frame.time_s, 5.0);
}

TEST(OniSource, FindsPicturesByTheirTablesAndWithout) {
  const test::TemporaryFolder folder;
  std::vector<Frame> truth;
  Records out;
  out.stream(1, "Depth1", kDepth, "NONE");
  out.stream(2, "Image1", kImage, "NONE");
  out.integer(1, "Registration", 1);
  for (int i = 0; i < 9; ++i) {
    truth.push_back(random_frame("f", static_cast<std::uint64_t>(i)));
    out.picture(1, 33'333 * i, raw(truth.back().depth));
    out.picture(2, 33'333 * i + 9'000, raw(truth.back().colour));
  }
  const std::size_t pictures_end = out.bytes().size();
  out.tables();
  const std::string bytes = out.end();
  std::string blind = bytes;
  // Damage between pictures is not seen where the tables are used.
  blind.replace(pictures_end - 37 * 23 * 3 - 40, 3, "???");
  test::put(folder / "whole.oni", bytes);
  test::put(folder / "blind.oni", blind);
  test::put(folder / "cut.oni", bytes.substr(0, pictures_end + 5));
  for (const char* name : {"whole.oni", "blind.oni", "cut.oni"}) {
    SCOPED_TRACE(name);
    const auto source = open_source(folder / name);
    ASSERT_EQ(source->size(), 9);
    EXPECT_EQ(source->span()->first_s, 0.0);
    EXPECT_EQ(source->span()->last_s, 0.266664);
    for (const std::size_t from : {4, 0, 8}) {
      source->seek(0.033333 * static_cast<double>(from));
      for (std::size_t i = from; i < 8; ++i) {
        const auto frame = source->next();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->depth, truth[i].depth);
        EXPECT_EQ(frame->colour, truth[i].colour);
      }
    }
    source->seek(1.0);
    EXPECT_FALSE(source->next());
    const bool is_cut = std::string(name) == "cut.oni";
    EXPECT_EQ(source->notes().size(), is_cut ? 2U : 1U);
    if (is_cut) {
      EXPECT_THAT(source->notes()[0], HasSubstr("cut short or damaged at byte " + std::to_string(pictures_end)));
    }
  }
  EXPECT_THAT(error_of([&] { all_of(*open_source(folder / "blind.oni")); }), HasSubstr("no picture of Image1"));
}

TEST(OniSource, SaysWhatItMisses) {
  const test::TemporaryFolder folder;
  const auto error = [&](const std::string& bytes) {
    return error_of([&] { open_source(test::put(folder / "a.oni", bytes)); });
  };
  Records empty;
  EXPECT_THAT(error(empty.end()), AllOf(HasSubstr("a.oni"), HasSubstr("no depth")));
  EXPECT_THAT(error("NI10"), HasSubstr("version"));
  EXPECT_THAT(error(std::string("NI10\2\0\0\0", 8) + std::string(16, '\0')), HasSubstr("version 2.0.0.0"));
  EXPECT_THAT(error(""), HasSubstr("empty"));
  Records packed;
  packed.stream(1, "Depth", kDepth, "Im8z");
  packed.picture(1, 0, "some");
  EXPECT_THAT(error(packed.end()), HasSubstr("depth packed with \"Im8z\", expected 16zT, 16zP or NONE"));
  Records short_one;
  short_one.stream(1, "Depth", kDepth, "NONE");
  short_one.picture(1, 0, "some");
  const auto source = open_source(test::put(folder / "short.oni", short_one.end()));
  EXPECT_THAT(error_of([&] { source->next(); }), HasSubstr("a picture of 4 bytes, expected 1702"));
  EXPECT_FALSE(source->next());
}

/// Written by OpenNI2's recorder from pictures worked out below (tests/recordings/other_side.py --fixtures).
TEST(OniSource, ReadsWhatOpenNi2Recorded) {
  SourceOptions options;
  options.colour_topic = "Image";
  for (const std::string name : {"raw.oni", "jpeg.oni"}) {
    SCOPED_TRACE(name);
    const auto source = open_source(std::string(VESALIUS_FUZZ_SEEDS) + "/fuzz_oni/" + name, options);
    EXPECT_THAT(source->notes(), IsEmpty());
    const std::vector<Frame> frames = all_of(*source);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[2].name, "0.066666");
    for (int i = 0; i < 3; ++i) {
      const Frame& frame = frames[static_cast<std::size_t>(i)];
      ASSERT_EQ(frame.depth.width(), 16);
      ASSERT_EQ(frame.depth.height(), 12);
      ASSERT_TRUE(frame.colour.same_size(frame.depth));
      EXPECT_NEAR(frame.camera.fx, 14.5, 1e-3);
      EXPECT_NEAR(frame.camera.fy, 15.0, 1e-3);
      for (int v = 0; v < 12; ++v) {
        for (int u = 0; u < 16; ++u) {
          ASSERT_EQ(frame.depth(u, v), u == v ? 0 : 1000 + 100 * i + 10 * v + u) << u << " " << v;
          ASSERT_NEAR(frame.colour(u, v).r, 10 * u, name == "raw.oni" ? 0 : 40);
          ASSERT_NEAR(frame.colour(u, v).g, 20 * v, name == "raw.oni" ? 0 : 40);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vesalius
