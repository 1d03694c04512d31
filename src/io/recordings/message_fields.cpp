#include "io/recordings/message_fields.h"

#include <fmt/format.h>

#include <bit>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Bytes before a CDR message that say how it is written.
constexpr std::size_t kCdrHead = 4;

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

/// A field takes thirty times as much memory as its two bytes; messages of cameras have a hundred.
constexpr std::size_t kMostFields = 1U << 20U;

}  // namespace

MessageFields::MessageFields(std::string_view bytes, MessageLayout layout, const std::string& name)
    : bytes_(bytes), aligned_(layout == MessageLayout::cdr), name_(name) {
  if (!aligned_) return;
  if (bytes.size() < kCdrHead || bytes[0] != 0 || static_cast<unsigned char>(bytes[1]) > 1) {
    throw Error(name + ": a message that is no CDR of version 1");
  }
  big_endian_ = bytes[1] == 0;
  at_ = kCdrHead;
}

std::string_view MessageFields::take(std::size_t count, const char* what) {
  if (count > bytes_.size() - at_) {
    throw Error(fmt::format("{}: a message ends within {}: expected {} bytes, {} are left", name_, what, count,
                            bytes_.size() - at_));
  }
  at_ += count;
  return bytes_.substr(at_ - count, count);
}

std::uint64_t MessageFields::number(std::size_t size, const char* what) {
  if (aligned_) {
    const std::size_t over = (at_ - kCdrHead) % size;
    if (over != 0) take(size - over, what);
  }
  const std::string_view bytes = take(size, what);
  if (!big_endian_) return little_endian(bytes);
  return little_endian(std::string(bytes.rbegin(), bytes.rend()));
}

float MessageFields::real32(const char* what) { return std::bit_cast<float>(u32(what)); }
double MessageFields::real64(const char* what) { return std::bit_cast<double>(number(8, what)); }

std::string_view MessageFields::text(const char* what) {
  std::string_view value = bytes(what);
  if (aligned_ && value.ends_with('\0')) value.remove_suffix(1);
  return value;
}

std::string_view MessageFields::bytes(const char* what) { return take(u32(what), what); }

std::vector<double> MessageFields::reals64(std::size_t count, const char* what) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(real64(what));
  return values;
}

std::vector<double> MessageFields::list64(const char* what) { return reals64(u32(what), what); }

std::int64_t MessageFields::header(std::string& frame) {
  if (!aligned_) u32("the header's number");
  const auto seconds = std::int64_t{u32("the time stamp")};
  const auto nanoseconds = std::int64_t{u32("the time stamp")};
  frame = text("the frame");
  return seconds * kNanoseconds + nanoseconds;
}

std::uint64_t ProtobufFields::number(std::uint32_t field) const {
  const auto found = numbers.find(field);
  return found == numbers.end() ? 0 : found->second;
}

std::string_view ProtobufFields::text(std::uint32_t field) const {
  const auto found = texts.find(field);
  return found == texts.end() ? std::string_view() : found->second.back();
}

std::vector<std::string_view> ProtobufFields::all_texts(std::uint32_t field) const {
  const auto found = texts.find(field);
  return found == texts.end() ? std::vector<std::string_view>() : found->second;
}

std::vector<double> ProtobufFields::list64(std::uint32_t field) const {
  if (const auto single = reals.find(field); single != reals.end()) return single->second;
  std::vector<double> values;
  const std::string_view packed = text(field);
  for (std::size_t at = 0; at + 8 <= packed.size(); at += 8) {
    values.push_back(std::bit_cast<double>(little_endian(packed.substr(at, 8))));
  }
  return values;
}

ProtobufFields parse_protobuf(std::string_view bytes, const std::string& name) {
  ProtobufFields fields;
  const auto fail = [&] { throw Error(name + ": a message that is no Protocol Buffers"); };
  const auto take = [&](std::uint64_t count) {
    if (count > bytes.size()) fail();
    const std::string_view taken = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return taken;
  };
  const auto varint = [&] {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<unsigned char>(take(1)[0]);
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    fail();
    return value;
  };
  for (std::size_t count = 0; !bytes.empty(); ++count) {
    if (count == kMostFields) throw Error(fmt::format("{}: a message of more than {} fields", name, kMostFields));
    const std::uint64_t tag = varint();
    const auto field = static_cast<std::uint32_t>(tag >> 3U);
    switch (tag & 7U) {
      case 0:
        fields.numbers[field] = varint();
        break;
      case 1: {
        const std::uint64_t value = little_endian(take(8));
        fields.numbers[field] = value;
        fields.reals[field].push_back(std::bit_cast<double>(value));
        break;
      }
      case 2:
        fields.texts[field].push_back(take(varint()));
        break;
      case 5:
        fields.numbers[field] = little_endian(take(4));
        break;
      default:
        fail();
    }
  }
  return fields;
}

CdrWriter::CdrWriter() : bytes_("\0\1\0\0", kCdrHead) {}

void CdrWriter::number(std::uint64_t value, std::size_t size) {
  const std::size_t over = (bytes_.size() - kCdrHead) % size;
  if (over != 0) bytes_.append(size - over, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xFFU);
}

void CdrWriter::real32(float value) { number(std::bit_cast<std::uint32_t>(value), 4); }
void CdrWriter::real64(double value) { number(std::bit_cast<std::uint64_t>(value), 8); }

void CdrWriter::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size() + 1));
  bytes_ += value;
  bytes_ += '\0';
}

void CdrWriter::bytes(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size()));
  bytes_ += value;
}

void CdrWriter::header(std::int64_t time_ns, std::string_view frame) {
  i32(static_cast<std::int32_t>(time_ns / kNanoseconds));
  u32(static_cast<std::uint32_t>(time_ns % kNanoseconds));
  text(frame);
}

}  // namespace vesalius
