#include "io/files/packed.h"

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::HasSubstr;

std::string unpack(const std::string& bytes, std::size_t smallest, std::size_t largest) {
  const std::string name = "test";
  ByteReader in(bytes, name);
  std::string raw = read_packed(in, smallest, largest, "numbers");
  in.expect_end();
  return raw;
}

std::string random_bytes(std::size_t count, std::uint32_t bound) {
  Random random(3);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.below(bound));
  return bytes;
}

TEST(Packed, ReadsBackWhatAnyLevelPacked) {
  for (const std::string& raw : {std::string(), std::string("x"), random_bytes(5000, 256), random_bytes(70000, 3)}) {
    for (const int level : {1, 3, 4, 16, 19}) {
      const std::string packed = pack(raw, level);
      EXPECT_EQ(unpack(packed, raw.size(), raw.size()), raw) << level;
      EXPECT_EQ(pack(raw, level), packed) << level;
    }
  }
  EXPECT_LT(pack(random_bytes(70000, 3), 16).size(), 70000U / 4) << "1.6 bits a byte";
}

TEST(Packed, RefusesSizesOutsideTheBounds) {
  const std::string packed = pack(std::string(100, 'a'), 1);
  EXPECT_EQ(unpack(packed, 0, 100).size(), 100U);
  EXPECT_THAT(error_of([&] { unpack(packed, 0, 99); }), HasSubstr("numbers: 100 bytes, expected 0 to 99"));
  EXPECT_THAT(error_of([&] { unpack(packed, 101, 200); }), HasSubstr("numbers: 100 bytes, expected 101 to 200"));
}

TEST(Packed, RefusesAFrameOfAnotherSize) {
  const std::string packed = pack(std::string(100000, 'a'), 1);
  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_NE(error_of([&] { unpack(packed.substr(0, size), 0, 100000); }), "") << size;
  }
  for (const char claimed : {'\x10', '\xff'}) {  // fewer and more bytes than the frame holds
    std::string forged = packed;
    forged[0] = claimed;
    EXPECT_THAT(error_of([&] { unpack(forged, 0, 200000); }), HasSubstr("numbers: cannot be decompressed"));
  }
  ByteWriter text;
  text.number(std::uint32_t{5});
  text.text("hello");
  EXPECT_THAT(error_of([&] { unpack(text.bytes(), 5, 5); }), HasSubstr("numbers: cannot be decompressed"));
}

}  // namespace
}  // namespace vesalius
