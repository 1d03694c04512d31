#include "c/sized_struct.h"

#include <gtest/gtest.h>

namespace vesalius::c {
namespace {

/// A structure as a newer header may have it: that of this library with more behind.
struct Newer {
  vesalius_camera known{};
  double added = 0.0;
};

/// A structure of which the first version had the first two members.
struct Grown {
  std::uint32_t struct_size;
  std::int32_t a, b;
};
constexpr std::size_t kFirst = 8;

TEST(SizedStruct, TakesThatOfANewerHeaderWhereWhatIsNewIsNotUsed) {
  Newer newer;
  newer.known.struct_size = sizeof(Newer);
  newer.known.width = 640;
  EXPECT_EQ(read_struct(&newer.known, "camera").width, 640);
  newer.added = 1.0;
  EXPECT_EQ(guarded([&] { read_struct(&newer.known, "camera"); }), VESALIUS_ERROR_ARGUMENT);
}

TEST(SizedStruct, TakesThatOfAnOlderHeader) {
  const Grown older{kFirst, 5, 77};  // what lies behind the older structure is not read
  EXPECT_EQ(read_struct(&older, "x", kFirst).a, 5);
  EXPECT_EQ(read_struct(&older, "x", kFirst).b, 0);
}

TEST(SizedStruct, WritesWhatTheProgramHasRoomFor) {
  Grown older{kFirst, 0, 77};
  write_struct(Grown{0, 1, 2}, &older, "x", kFirst);
  EXPECT_EQ(older.struct_size, kFirst);
  EXPECT_EQ(older.a, 1);
  EXPECT_EQ(older.b, 77);
  Newer newer;
  newer.known.struct_size = sizeof(Newer);
  newer.added = 9.0;
  vesalius_camera values{};
  values.height = 3;
  write_struct(values, &newer.known, "camera");
  EXPECT_EQ(newer.known.height, 3);
  EXPECT_EQ(newer.known.struct_size, sizeof(Newer));
  EXPECT_EQ(newer.added, 0.0);
}

TEST(SizedStruct, RefusesSizesThatCannotBe) {
  for (const std::uint32_t size : {0U, 4U, static_cast<unsigned>(sizeof(vesalius_camera)) - 1U, 5000U, ~0U}) {
    vesalius_camera camera{};
    camera.struct_size = size;
    EXPECT_EQ(guarded([&] { read_struct(&camera, "camera"); }), VESALIUS_ERROR_ARGUMENT) << size;
    EXPECT_EQ(guarded([&] { write_struct(vesalius_camera{}, &camera, "camera"); }), VESALIUS_ERROR_ARGUMENT) << size;
  }
  EXPECT_EQ(guarded([] { read_struct(static_cast<vesalius_camera*>(nullptr), "camera"); }), VESALIUS_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace vesalius::c
