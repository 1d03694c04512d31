#include "c/guard.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>
#include <string>
#include <thread>

namespace vesalius::c {
namespace {

template <class E>
vesalius_status thrown(const E& exception) {
  return guarded([&] { throw exception; });
}

TEST(Guard, GivesEachKindOfExceptionItsStatus) {
  EXPECT_EQ(guarded([] {}), VESALIUS_OK);
  EXPECT_EQ(thrown(UsageError("x")), VESALIUS_ERROR_ARGUMENT);
  EXPECT_EQ(thrown(CapacityError("x")), VESALIUS_ERROR_CAPACITY);
  EXPECT_EQ(thrown(Error("x")), VESALIUS_ERROR_INPUT);
  EXPECT_EQ(thrown(DeviceError("x")), VESALIUS_ERROR_DEVICE);
  EXPECT_EQ(thrown(std::bad_alloc()), VESALIUS_ERROR_MEMORY);
  EXPECT_EQ(thrown(std::logic_error("x")), VESALIUS_ERROR_INTERNAL);
  EXPECT_EQ(thrown(1), VESALIUS_ERROR_INTERNAL);
  EXPECT_EQ(guarded_value(-1, []() -> int { throw Error("x"); }), -1);
  EXPECT_EQ(guarded_value(-1, [] { return 3; }), 3);
}

TEST(Guard, KeepsOneLine) {
  thrown(Error("a\nb\tc"));
  EXPECT_STREQ(last_error(), "a b c");
}

TEST(Guard, CutsLongMessagesBetweenCharacters) {
  for (const std::string letter : {"x", "\u00e9", "\u20ac", "\U0001F600"}) {
    std::string message;
    while (message.size() < 5000) message += letter;
    thrown(Error(message));
    const std::string kept = last_error();
    EXPECT_GT(kept.size(), 1018U);
    EXPECT_LT(kept.size(), 1024U);
    EXPECT_EQ(kept.size() % letter.size(), 0U);
    EXPECT_EQ(kept, message.substr(0, kept.size()));
  }
}

// Labels: threads
TEST(Guard, KeepsTheErrorsOfThreadsApart) {
  thrown(Error("mine"));
  std::thread([] {
    EXPECT_STREQ(last_error(), "");
    thrown(Error("theirs"));
    EXPECT_STREQ(last_error(), "theirs");
  }).join();
  EXPECT_STREQ(last_error(), "mine");
}

TEST(Guard, NamesWhatIsNull) {
  EXPECT_EQ(guarded([] { need(static_cast<int*>(nullptr), "camera"); }), VESALIUS_ERROR_ARGUMENT);
  EXPECT_STREQ(last_error(), "camera is NULL");
}

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
