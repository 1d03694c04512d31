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

}  // namespace
}  // namespace vesalius::c
