#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace vesalius {

/// Reads an array of numbers in an HDF5 file row by row; a row is all numbers that share their first index. Types that
/// make libhdf5 crash are refused. Some damage still crashes its version 1.10 (blocks whose length does not fit the
/// type), so read only files from a source that you trust.
class Hdf5Array {
 public:
  /// `row_shape` gives the lengths of the dimensions after the first. Throws Error naming file and data set if one of
  /// them is missing or unreadable, or the data set holds no numbers, has another shape, or is packed in blocks too
  /// large to unpack.
  Hdf5Array(const std::string& path, const std::string& name, const std::vector<std::size_t>& row_shape);
  ~Hdf5Array();
  Hdf5Array(Hdf5Array&&) noexcept;
  Hdf5Array& operator=(Hdf5Array&&) noexcept;

  std::size_t rows() const;
  /// Returns a row with the last index varying fastest, converted from the file's type of number (such as half floats
  /// or integers). Infinities and NaN are kept. Throws Error if the row cannot be read.
  std::vector<float> read(std::size_t row) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius
