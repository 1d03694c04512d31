#include "downloads/sha256.h"

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

std::string sum_of(std::string_view bytes) {
  Sha256 sum;
  sum.update(bytes);
  return sum.finish();
}

TEST(Sha256, GivesTheStandardsAnswers) {
  // FIPS 180-4 example values (NIST CSRC, "SHA256.pdf").
  EXPECT_EQ(sum_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sum_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sum_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, IsTheSameForBytesInPieces) {
  std::string bytes;
  for (int i = 0; i < 200'000; ++i) bytes += static_cast<char>(i * 7 + i / 251);
  Sha256 sum;
  for (std::size_t at = 0, step = 1; at < bytes.size(); at += step, step = step * 3 + 1) {
    sum.update(std::string_view(bytes).substr(at, step));
  }
  EXPECT_EQ(sum.finish(), sum_of(bytes));
  EXPECT_EQ(sum.finish(), sum_of("")) << "begins anew";

  const test::TemporaryFolder folder;
  EXPECT_EQ(sha256_of_file(test::put(folder / "f", bytes)), sum_of(bytes));
  // The file has exactly as many bytes as are read at a time, so the end comes without a short piece before it.
  EXPECT_EQ(sha256_of_file(test::put(folder / "g", bytes.substr(0, 1 << 16))), sum_of(bytes.substr(0, 1 << 16)));
}

TEST(Sha256, NamesAFileThatCannotBeRead) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::error_of([&] { sha256_of_file(folder / "none"); }), HasSubstr("No such file"));
  EXPECT_THAT(test::error_of([&] { sha256_of_file(folder.path()); }), HasSubstr("not a regular file"));
  EXPECT_THAT(test::error_of([&] { sha256_of_file("/dev/zero"); }), HasSubstr("not a regular file"));
}

}  // namespace
}  // namespace vesalius
