#include "io/recordings/message_fields.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::AllOf;
using testing::HasSubstr;

using testing::ElementsAre;

const std::string kName = "messages";

TEST(MessageFields, OfCdrAreThoseThatWereWritten) {
  CdrWriter out;
  out.header(1'234'567'890'123'456'789, "camera");
  out.u8(7);
  out.real64(-2.5);  // seven bytes of padding before it
  out.text("");
  out.u32(4'000'000'000U);
  out.real32(0.25F);
  out.bytes(std::string("\0\xFF", 2));
  MessageFields in(out.message(), MessageLayout::cdr, kName);
  std::string frame;
  EXPECT_EQ(in.header(frame), 1'234'567'890'123'456'789);
  EXPECT_EQ(frame, "camera");
  EXPECT_EQ(in.u8("a"), 7);
  EXPECT_EQ(in.real64("b"), -2.5);
  EXPECT_EQ(in.text("c"), "");
  EXPECT_EQ(in.u32("d"), 4'000'000'000U);
  EXPECT_EQ(in.real32("e"), 0.25F);
  EXPECT_EQ(in.bytes("f"), std::string("\0\xFF", 2));
}

TEST(MessageFields, OfCdrMayBeBigEndian) {
  const std::string bytes("\0\0\0\0\x05\0\0\0\0\0\x01\x02\x40\x09\0\0\0\0\0\0", 20);
  MessageFields in(bytes, MessageLayout::cdr, kName);
  EXPECT_EQ(in.u8("a"), 5);
  EXPECT_EQ(in.u32("b"), 0x0102U);
  EXPECT_EQ(in.real64("c"), 3.125);
}

TEST(MessageFields, OfRos1FollowEachOtherWithoutGaps) {
  const std::string bytes("\x05\x02\x01\0\0\x02\0\0\0ab\x01\0\0\0\0\0\0\0\0\0\xF0\x3F", 23);
  MessageFields in(bytes, MessageLayout::ros1, kName);
  EXPECT_EQ(in.u8("a"), 5);
  EXPECT_EQ(in.u32("b"), 0x0102U);
  EXPECT_EQ(in.text("c"), "ab");
  EXPECT_THAT(in.list64("d"), ElementsAre(1.0));
  EXPECT_THAT(error_of([&] { in.u8("the byte after the end"); }),
              AllOf(HasSubstr("messages"), HasSubstr("the byte after the end"), HasSubstr("0 are left")));
}

TEST(MessageFields, RefusesLengthsBeyondTheEnd) {
  const std::string bytes(
      "\xFF\xFF\xFF\xFF"
      "ab",
      6);
  EXPECT_THAT(error_of([&] { MessageFields(bytes, MessageLayout::ros1, kName).bytes("it"); }),
              HasSubstr("expected 4294967295 bytes"));
  EXPECT_THAT(error_of([&] { MessageFields(bytes, MessageLayout::ros1, kName).list64("it"); }),
              AllOf(HasSubstr("it"), HasSubstr("expected 8 bytes")));
  EXPECT_THAT(error_of([&] { MessageFields("\x07\x01\0\0", MessageLayout::cdr, kName); }), HasSubstr("no CDR"));
}

TEST(Protobuf, FieldsAreFoundByTheirNumbers) {
  // 1: varint 300, 2: fixed32 7, 3: text "hi", 4: double 1 twice, 5: packed double 1
  const std::string bytes(
      "\x08\xAC\x02\x15\x07\0\0\0\x1A\x02hi\x21\0\0\0\0\0\0\xF0\x3F\x21\0\0\0\0\0\0\xF0\x3F\x2A\x08\0\0\0\0\0\0\xF0"
      "\x3F",
      40);
  const ProtobufFields fields = parse_protobuf(bytes, kName);
  EXPECT_EQ(fields.number(1), 300U);
  EXPECT_EQ(fields.number(2), 7U);
  EXPECT_EQ(fields.text(3), "hi");
  EXPECT_THAT(fields.list64(4), ElementsAre(1.0, 1.0));
  EXPECT_THAT(fields.list64(5), ElementsAre(1.0));
  EXPECT_EQ(fields.number(9), 0U);
  for (std::size_t size : {1U, 2U, 5U, 11U, 20U}) {
    EXPECT_THAT(error_of([&] { parse_protobuf(std::string_view(bytes).substr(0, size), kName); }),
                HasSubstr("no Protocol Buffers"));
  }
}

}  // namespace
}  // namespace vesalius
