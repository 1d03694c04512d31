#include "dataset/hdf5_array.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr double kMaxChunkBytes = 256.0 * 1048576.0;
constexpr std::size_t kCacheBytes = std::size_t{32}
                                    << 20;  // a chunk of pictures does not fit in the library's default of 1 MB

/// An object of the library, which the destructor closes.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t id() const { return id_; }
  bool ok() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// While an object of this class lives, the library does not print its errors; they become the text of an Error.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

std::vector<hsize_t> shape_of(const Handle& dataset) {
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  if (!space.ok() || H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE) return {};
  std::vector<hsize_t> shape(std::max(0, H5Sget_simple_extent_ndims(space.id())));
  if (H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr) < 0) return {};
  return shape;
}

/// Returns the type of IEEE half floats as NumPy writes them.
Handle half_float() {
  Handle type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
  H5Tset_fields(type.id(), 15, 10, 5, 0, 10);
  H5Tset_size(type.id(), 2);
  H5Tset_ebias(type.id(), 15);
  return type;
}

/// Returns whether a data set holds numbers of a usual type. Only these are passed to the library's conversion: a
/// damaged type with more bits than its bytes can hold makes it write past its buffers.
bool has_numbers(const Handle& dataset) {
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const Handle half = half_float();
  const auto is = [&](hid_t known) { return H5Tequal(type.id(), known) > 0; };
  return is(half.id()) || is(H5T_IEEE_F32LE) || is(H5T_IEEE_F64LE) || is(H5T_STD_I8LE) || is(H5T_STD_U8LE) ||
         is(H5T_STD_I16LE) || is(H5T_STD_U16LE) || is(H5T_STD_I32LE) || is(H5T_STD_U32LE) || is(H5T_STD_I64LE) ||
         is(H5T_STD_U64LE);
}

/// Returns the bytes that must be unpacked to read any number; 0 if the data is contiguous. The result is a double
/// because the product of a damaged file's lengths may exceed any integer.
double chunk_bytes(const Handle& dataset, std::size_t dimensions) {
  const Handle properties(H5Dget_create_plist(dataset.id()), H5Pclose);
  if (!properties.ok() || H5Pget_layout(properties.id()) != H5D_CHUNKED) return 0.0;
  std::vector<hsize_t> chunk(dimensions);
  if (H5Pget_chunk(properties.id(), static_cast<int>(dimensions), chunk.data()) < 0) return 0.0;
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  return std::accumulate(chunk.begin(), chunk.end(), static_cast<double>(H5Tget_size(type.id())),
                         [](double product, hsize_t n) { return product * static_cast<double>(n); });
}

}  // namespace

struct Hdf5Array::State {
  std::string place;  ///< for messages
  Handle file;
  Handle dataset;
  std::vector<hsize_t> shape;
  std::size_t row_length = 1;
};

Hdf5Array::Hdf5Array(const std::string& path, const std::string& name, const std::vector<std::size_t>& row_shape)
    : state_(std::make_unique<State>()) {
  const Quiet quiet;
  State& s = *state_;
  s.place = fmt::format("{}: {}", path, name);
  s.file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!s.file.ok()) throw Error(path + ": cannot be read, expected an HDF5 file");
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.id(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, kCacheBytes, H5D_CHUNK_CACHE_W0_DEFAULT);
  s.dataset = Handle(H5Dopen2(s.file.id(), name.c_str(), access.id()), H5Dclose);
  if (!s.dataset.ok()) throw Error(fmt::format("{}: no data set \"{}\"", path, name));
  s.shape = shape_of(s.dataset);
  std::vector<hsize_t> expected(row_shape.begin(), row_shape.end());
  expected.insert(expected.begin(), s.shape.empty() ? 0 : s.shape.front());
  if (s.shape != expected) {
    throw Error(fmt::format("{}: shape {}, expected any number of rows of {}", s.place, fmt::join(s.shape, "x"),
                            row_shape.empty() ? "one number" : fmt::format("{}", fmt::join(row_shape, "x"))));
  }
  if (!has_numbers(s.dataset)) throw Error(s.place + ": expected integers or floating-point numbers, little endian");
  if (chunk_bytes(s.dataset, s.shape.size()) > kMaxChunkBytes) {
    throw Error(fmt::format("{}: packed in blocks of more than {:.0f} MiB", s.place, kMaxChunkBytes / 1048576.0));
  }
  s.row_length = std::accumulate(row_shape.begin(), row_shape.end(), std::size_t{1}, std::multiplies<>());
}

Hdf5Array::~Hdf5Array() = default;
Hdf5Array::Hdf5Array(Hdf5Array&&) noexcept = default;
Hdf5Array& Hdf5Array::operator=(Hdf5Array&&) noexcept = default;

std::size_t Hdf5Array::rows() const { return state_->shape.front(); }

std::vector<float> Hdf5Array::read(std::size_t row) const {
  const Quiet quiet;
  const State& s = *state_;
  std::vector<hsize_t> first(s.shape.size(), 0);
  std::vector<hsize_t> count = s.shape;
  first.front() = row;
  count.front() = 1;
  const hsize_t length = s.row_length;
  const Handle memory(H5Screate_simple(1, &length, nullptr), H5Sclose);
  const Handle space(H5Dget_space(s.dataset.id()), H5Sclose);
  std::vector<float> values(s.row_length);
  // The library accepts the selection of a row beyond the last and fails only when it reads.
  if (row >= rows() || !memory.ok() || !space.ok() ||
      H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dread(s.dataset.id(), H5T_NATIVE_FLOAT, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
    throw Error(fmt::format("{}: row {} of {} cannot be read", s.place, row, rows()));
  }
  return values;
}

}  // namespace vesalius
