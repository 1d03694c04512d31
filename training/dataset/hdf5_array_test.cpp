#include "dataset/hdf5_array.h"

#include <cmath>

#include "dataset/test_hdf5.h"
#include "io/files/test_files.h"

namespace vesalius {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Hdf5Array, ReadsRowsOfAnyTypeOfNumber) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    test::Hdf5Writer file(path);
    const hid_t half = test::half_float();
    file.put("half", {2, 2, 2}, {0.5F, -2.25F, 1024.F, 0.1F, INFINITY, 5, 6, 7}, half);
    H5Tclose(half);
    file.put("packed", {3, 2}, {1, 2, 3, 4, 5, -6}, H5T_STD_I8LE, {2, 2});
    file.put("flags", {3}, {1, 0, 1}, H5T_STD_U8LE);
  }
  const Hdf5Array half(path, "half", {2, 2});
  EXPECT_EQ(half.rows(), 2U);
  EXPECT_THAT(half.read(0), ElementsAre(0.5F, -2.25F, 1024.F, 0.0999755859375F));
  EXPECT_THAT(half.read(1), ElementsAre(INFINITY, 5.F, 6.F, 7.F));
  EXPECT_THAT(Hdf5Array(path, "packed", {2}).read(2), ElementsAre(5.F, -6.F));
  const Hdf5Array flags(path, "flags", {});
  EXPECT_EQ(flags.rows(), 3U);
  EXPECT_THAT(flags.read(1), ElementsAre(0.F));
  EXPECT_THAT(test::error_of([&] { flags.read(3); }), HasSubstr("a.h5: flags: row 3 of 3 cannot be read"));
}

TEST(Hdf5Array, ThrowsErrorsAndPrintsNothing) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    test::Hdf5Writer file(path);
    file.put("a", {2, 3}, {1, 2, 3, 4, 5, 6}, H5T_STD_U8LE);
    const hid_t odd = H5Tcopy(H5T_STD_I16LE);
    H5Tset_precision(odd, 11);
    file.put("odd", {1, 3}, {1, 2, 3}, odd);
    H5Tclose(odd);
    file.put("huge", {2, 1U << 30}, {}, H5T_STD_U8LE, {1, 1U << 29});
  }
  const auto error = [](const std::string& file, const char* name, const std::vector<std::size_t>& row_shape) {
    return test::error_of([&] { Hdf5Array(file, name, row_shape); });
  };
  testing::internal::CaptureStderr();
  EXPECT_EQ(error(path, "b", {3}), path + ": no data set \"b\"");
  EXPECT_EQ(error(path, "a", {4}), path + ": a: shape 2x3, expected any number of rows of 4");
  EXPECT_EQ(error(path, "a", {}), path + ": a: shape 2x3, expected any number of rows of one number");
  EXPECT_THAT(error(path, "odd", {3}), HasSubstr("odd: expected integers or floating-point numbers"));
  EXPECT_THAT(error(path, "huge", {1U << 30}), HasSubstr("blocks of more than 256 MiB"));
  EXPECT_THAT(error(folder / "none.h5", "a", {3}), HasSubstr("none.h5: cannot be read, expected an HDF5 file"));
  test::put(folder / "text.h5", "no HDF5");
  EXPECT_THAT(error(folder / "text.h5", "a", {3}), HasSubstr("text.h5: cannot be read, expected an HDF5 file"));
  const std::string whole = test::get(path);
  test::put(folder / "cut.h5", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(error(folder / "cut.h5", "a", {3}), HasSubstr("cut.h5: "));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace vesalius
