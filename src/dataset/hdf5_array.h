#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace vesalius {

/// Numbers in an HDF5 file, read row by row: a row is all that shares its first index. Types that bring libhdf5 down
/// are refused, but its version 1.10 does not survive all damage (blocks whose length does not fit the type): read
/// files from those you trust.
class Hdf5Array {
 public:
  /// `row_shape`: the lengths of the dimensions after the first. Throws Error naming file and data set where one is
  /// missing or unreadable, holds no numbers, has another shape, or is packed in blocks too large to unpack.
  Hdf5Array(const std::string& path, const std::string& name, const std::vector<std::size_t>& row_shape);
  ~Hdf5Array();
  Hdf5Array(Hdf5Array&&) noexcept;
  Hdf5Array& operator=(Hdf5Array&&) noexcept;

  std::size_t rows() const;
  /// The last index fastest, converted from whatever type of number the file has (half floats, integers). What is not
  /// finite stays so. Throws Error for a row that the file cannot give.
  std::vector<float> read(std::size_t row) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius
