#include "io/recordings/oni_depth.h"

#include <fmt/format.h>

#include <vector>

#include "io/files/byte_stream.h"

namespace vesalius {
namespace {

constexpr unsigned kEscape = 0xF;
constexpr unsigned kNone = 0xD;  ///< fills the last byte
constexpr unsigned kNoStep = 6;
constexpr unsigned kRuns = 0xE0;

class Unpacker {
 public:
  Unpacker(std::string_view packed, OniPacking packing, int width, int height, const std::string& name)
      : in_(packed, name), has_table_(packing == OniPacking::table_differences) {
    // A byte can stand for 30 pixels, no more: a size that is stated takes no memory before it is plausible.
    if (in_.left() * 30 < static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
      in_.fail(fmt::format("{} bytes of depth, too few for {}x{} pixels", in_.left(), width, height));
    }
    image_ = Image<std::uint16_t>(width, height);
    if (!has_table_) return;
    const auto count = in_.number<std::uint16_t>("size of a table of depth");
    for (unsigned i = 0; i < count; ++i) table_.push_back(in_.number<std::uint16_t>("table of depth"));
  }

  Image<std::uint16_t> unpack() {
    value_ = in_.number<std::uint16_t>("first depth");
    put();
    while (in_.left() > 0) {
      const unsigned byte = in_.number<std::uint8_t>("depth");
      if (byte == 0xFF) {
        put_escaped();
      } else if (byte >= kRuns) {
        for (unsigned i = 0; i < 2 * (byte - kRuns); ++i) put();
      } else {
        put_step(byte >> 4U);
        const unsigned second = byte & 0xFU;
        if (second == kEscape) {
          put_escaped();
        } else if (second != kNone) {
          put_step(second);
        }
      }
    }
    if (at_ != image_.size()) in_.fail(fmt::format("{} pixels of depth, expected {}", at_, image_.size()));
    return std::move(image_);
  }

 private:
  void put_step(unsigned code) {
    value_ = static_cast<std::uint16_t>(value_ + kNoStep - code);
    put();
  }

  /// A step to 63 in one byte, or a value in two, the high one first, which has its highest bit free.
  void put_escaped() {
    constexpr unsigned kIsStep = 0x80, kNoLongStep = 192;
    const unsigned byte = in_.number<std::uint8_t>("depth behind an escape");
    if ((byte & kIsStep) != 0) {
      value_ = static_cast<std::uint16_t>(value_ + kNoLongStep - byte);
    } else {
      value_ = static_cast<std::uint16_t>(byte << 8U | in_.number<std::uint8_t>("depth behind an escape"));
    }
    put();
  }

  void put() {
    if (at_ == image_.size()) in_.fail(fmt::format("more than {} pixels of depth", at_));
    if (has_table_ && value_ >= table_.size()) {
      in_.fail(fmt::format("depth number {} of a table of {}", value_, table_.size()));
    }
    image_[at_++] = has_table_ ? table_[value_] : value_;
  }

  ByteReader in_;
  bool has_table_;
  std::vector<std::uint16_t> table_;
  Image<std::uint16_t> image_;
  std::size_t at_ = 0;
  std::uint16_t value_ = 0;
};

}  // namespace

Image<std::uint16_t> unpack_oni(std::string_view packed, OniPacking packing, int width, int height,
                                const std::string& name) {
  return Unpacker(packed, packing, width, height, name).unpack();
}

}  // namespace vesalius
