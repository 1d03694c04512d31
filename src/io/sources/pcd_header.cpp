#include "io/sources/pcd_header.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "io/files/known_kind.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kMaxCount = 1 << 16;
constexpr std::size_t kMaxFields = 1024;

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
  Words words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == line.npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// Reads the lines in turn and keeps the line number for errors.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PcdHeader read() {
    while (!encoding_) read_line();
    return finished();
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(fmt::format("{}:{}: expected {}", name_, line_, expected));
  }

  void read_line() {
    ++line_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == bytes_.npos) fail("a PCD header line, the last of them DATA");
    const Words words = split(bytes_.substr(at_, end - at_));
    at_ = end + 1;
    if (words.empty() || words.front().front() == '#') return;
    const std::string_view key = words.front();
    const Words values(words.begin() + 1, words.end());
    if (key == "FIELDS" || key == "COLUMNS") return read_fields(values);
    if (key == "SIZE") return read_column(values, &PcdField::size, 8, "SIZE");
    if (key == "COUNT") return read_column(values, &PcdField::count, kMaxCount, "COUNT");
    if (key == "TYPE") return read_types(values);
    if (key == "WIDTH") return void(width_ = single(values, "WIDTH"));
    if (key == "HEIGHT") return void(height_ = single(values, "HEIGHT"));
    if (key == "POINTS") return void(points_ = single(values, "POINTS"));
    if (key == "DATA") return read_encoding(values);
    if (key != "VERSION" && key != "VIEWPOINT") fail("a PCD header (VERSION, FIELDS, SIZE, ...)");
  }

  std::uint32_t number(std::string_view word, const char* key) const {
    std::uint32_t value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size()) fail(fmt::format("{} of whole numbers", key));
    return value;
  }

  std::uint32_t single(const Words& values, const char* key) const {
    if (values.size() != 1) fail(fmt::format("{} and one number", key));
    return number(values.front(), key);
  }

  void read_fields(const Words& values) {
    if (!header_.fields.empty() || values.empty() || values.size() > kMaxFields) fail("one FIELDS line of field names");
    for (const std::string_view name : values) {
      PcdField field;
      field.name = name;
      header_.fields.push_back(std::move(field));
    }
  }

  void check_columns(const Words& values, const char* key) const {
    if (header_.fields.empty() || values.size() != header_.fields.size()) {
      fail(fmt::format("{} with a value for each of the {} FIELDS", key, header_.fields.size()));
    }
  }

  void read_column(const Words& values, std::uint32_t PcdField::*member, std::uint32_t largest, const char* key) {
    check_columns(values, key);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::uint32_t value = number(values[i], key);
      if (value < 1 || value > largest) fail(fmt::format("{} of 1 to {}", key, largest));
      header_.fields[i].*member = value;
    }
  }

  void read_types(const Words& values) {
    check_columns(values, "TYPE");
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] != "I" && values[i] != "U" && values[i] != "F") fail("TYPE of I, U and F");
      header_.fields[i].type = values[i].front();
    }
  }

  void read_encoding(const Words& values) {
    const std::string_view word = values.size() == 1 ? values.front() : "";
    if (word == "ascii") encoding_ = PcdEncoding::ascii;
    if (word == "binary") encoding_ = PcdEncoding::binary;
    if (word == "binary_compressed") encoding_ = PcdEncoding::binary_compressed;
    if (!encoding_) fail("DATA ascii, binary or binary_compressed");
  }

  void find_fields() {
    for (int i = 0; i < int(header_.fields.size()); ++i) {
      PcdField& field = header_.fields[i];
      field.offset = header_.point_bytes;
      header_.point_bytes += std::size_t{field.size} * field.count;
      for (int axis = 0; axis < 3; ++axis) {
        if (field.name != std::string(1, "xyz"[axis])) continue;
        if (field.type != 'F' || field.size < 4 || field.count != 1) fail("x, y and z as one F of 4 or 8 bytes");
        header_.xyz[axis] = i;
      }
      if (field.name == "rgb" || field.name == "rgba") {
        if (field.size != 4 || field.count != 1) fail("rgb or rgba as one number of 4 bytes");
        header_.rgb = i;
      }
    }
    for (const int index : header_.xyz) {
      if (index < 0) fail("FIELDS with x, y and z");
    }
  }

  PcdHeader finished() {
    find_fields();
    if (width_ < 1 || height_ < 2 || width_ > (1U << 26U) || height_ > (1U << 26U)) {
      throw Error(fmt::format("{}: WIDTH {} HEIGHT {}: expected an organised cloud, a point per pixel", name_, width_,
                              height_));
    }
    if (points_ && *points_ != std::uint64_t{width_} * height_) {
      throw Error(fmt::format("{}: POINTS {}, expected WIDTH x HEIGHT, {}x{}", name_, *points_, width_, height_));
    }
    header_.width = int(width_);
    header_.height = int(height_);
    header_.encoding = *encoding_;
    header_.data_begin = at_;
    return std::move(header_);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  std::optional<std::uint32_t> points_;
  std::optional<PcdEncoding> encoding_;
  PcdHeader header_;
};

}  // namespace

PcdHeader parse_pcd_header(std::string_view bytes, const std::string& name) {
  const std::string_view kind = known_kind(bytes.substr(0, kKindBytes));
  if (!kind.empty()) throw Error(fmt::format("{}: {}, expected a PCD file", name, kind));
  return HeaderReader(bytes, name).read();
}

}  // namespace vesalius
