#include "io/recordings/foxglove_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "io/recordings/message_fields.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;
using Value = FoxgloveMessage::Value;

enum class FieldKind { time, number, text, bytes, reals };

/// A field of a schema. In ROS the fields come in this order.
struct Field {
  std::uint32_t number;  ///< in Protocol Buffers
  std::string_view name;
  FieldKind kind;
  std::size_t count = 0;        ///< of reals: how many ROS has without their number; 0 = their number stands before
  std::string_view parts = {};  ///< of reals: names of each, where they are a message
};

constexpr std::array<Field, 7> kRawImage{{{1, "timestamp", FieldKind::time},
                                          {7, "frame_id", FieldKind::text},
                                          {2, "width", FieldKind::number},
                                          {3, "height", FieldKind::number},
                                          {4, "encoding", FieldKind::text},
                                          {5, "step", FieldKind::number},
                                          {6, "data", FieldKind::bytes}}};
constexpr std::array<Field, 4> kCompressedImage{{{1, "timestamp", FieldKind::time},
                                                 {4, "frame_id", FieldKind::text},
                                                 {2, "data", FieldKind::bytes},
                                                 {3, "format", FieldKind::text}}};
constexpr std::array<Field, 4> kCompressedVideo{{{1, "timestamp", FieldKind::time},
                                                 {2, "frame_id", FieldKind::text},
                                                 {3, "data", FieldKind::bytes},
                                                 {4, "format", FieldKind::text}}};
constexpr std::array<Field, 9> kCameraCalibration{{{1, "timestamp", FieldKind::time},
                                                   {9, "frame_id", FieldKind::text},
                                                   {2, "width", FieldKind::number},
                                                   {3, "height", FieldKind::number},
                                                   {4, "distortion_model", FieldKind::text},
                                                   {5, "D", FieldKind::reals},
                                                   {6, "K", FieldKind::reals, 9},
                                                   {7, "R", FieldKind::reals, 9},
                                                   {8, "P", FieldKind::reals, 12}}};
constexpr std::array<Field, 5> kFrameTransform{{{1, "timestamp", FieldKind::time},
                                                {2, "parent_frame_id", FieldKind::text},
                                                {3, "child_frame_id", FieldKind::text},
                                                {4, "translation", FieldKind::reals, 3, "xyz"},
                                                {5, "rotation", FieldKind::reals, 4, "xyzw"}}};

using FieldList = std::span<const Field>;

std::string_view schema_of(const RecordedTopic& topic) {
  return std::string_view(topic.type).substr(topic.type.find_first_of("./") + 1);
}

FieldList fields_of(std::string_view schema) {
  if (schema == "RawImage") return kRawImage;
  if (schema == "CompressedImage") return kCompressedImage;
  if (schema == "CompressedVideo") return kCompressedVideo;
  return schema == "CameraCalibration" ? FieldList(kCameraCalibration) : FieldList(kFrameTransform);
}

/// Returns nothing where the text is not base64.
std::shared_ptr<const std::string> from_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::uint8_t kNone = 64;
  static const std::array<std::uint8_t, 256> digits = [&] {
    std::array<std::uint8_t, 256> all{};
    all.fill(kNone);
    for (std::size_t i = 0; i < kDigits.size(); ++i) all[static_cast<unsigned char>(kDigits[i])] = std::uint8_t(i);
    return all;
  }();
  text = text.substr(0, text.find_last_not_of('=') + 1);
  auto bytes = std::make_shared<std::string>();
  bytes->reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::uint8_t digit = digits[static_cast<unsigned char>(text[i])];
    if (digit == kNone) return nullptr;
    bits = bits << 6U | digit;
    if (i % 4 != 0) *bytes += static_cast<char>(bits >> (6U - 2U * (i % 4)) & 0xFFU);
  }
  return bytes;
}

/// google.protobuf.Timestamp
std::uint64_t protobuf_time(std::string_view bytes, const std::string& name) {
  const ProtobufFields time = parse_protobuf(bytes, name);
  return time.number(1) * kNanoseconds + time.number(2);
}

Value value_in(const ProtobufFields& message, const Field& field, const std::string& name) {
  Value value;
  if (field.kind == FieldKind::time) {
    value.number = protobuf_time(message.text(field.number), name);
  } else if (field.kind == FieldKind::number) {
    value.number = message.number(field.number);
  } else if (field.kind != FieldKind::reals) {
    value.text = message.text(field.number);
  } else if (field.parts.empty()) {
    value.reals = message.list64(field.number);
  } else {
    const ProtobufFields parts = parse_protobuf(message.text(field.number), name);
    for (std::uint32_t part = 1; part <= field.parts.size(); ++part) {
      const std::vector<double> real = parts.list64(part);
      value.reals.push_back(real.empty() ? 0.0 : real.back());
    }
  }
  return value;
}

const json& member(const json& object, std::string_view key) {
  static const json none;
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

std::uint64_t whole(const json& value) { return value.is_number_unsigned() ? value.get<std::uint64_t>() : 0; }
double real(const json& value) { return value.is_number() ? value.get<double>() : 0.0; }

Value value_in(const json& message, const Field& field, const std::string& name) {
  const json& found = member(message, field.name);
  Value value;
  if (field.kind == FieldKind::time) {
    value.number = whole(member(found, "sec")) * kNanoseconds + whole(member(found, "nsec"));
  } else if (field.kind == FieldKind::number) {
    value.number = whole(found);
  } else if (field.kind == FieldKind::reals) {
    for (const char part : field.parts) value.reals.push_back(real(member(found, std::string_view(&part, 1))));
    if (found.is_array()) std::ranges::transform(found, std::back_inserter(value.reals), real);
  } else if (found.is_string()) {
    const auto& text = found.get_ref<const std::string&>();
    value.owned = field.kind == FieldKind::bytes ? from_base64(text) : std::make_shared<const std::string>(text);
    if (!value.owned) throw Error(fmt::format("{}: \"{}\": expected base64", name, field.name));
    value.text = *value.owned;
  }
  return value;
}

Value value_in(MessageFields& message, const Field& field, const std::string&) {
  Value value;
  const char* what = field.name.data();
  if (field.kind == FieldKind::time) {
    value.number = message.u32(what) * std::uint64_t{kNanoseconds};
    value.number += message.u32(what);
  } else if (field.kind == FieldKind::number) {
    value.number = message.u32(what);
  } else if (field.kind == FieldKind::reals) {
    value.reals = field.count == 0 ? message.list64(what) : message.reals64(field.count, what);
  } else {
    value.text = field.kind == FieldKind::text ? message.text(what) : message.bytes(what);
  }
  return value;
}

/// Parses JSON of few values, which take far more memory than their bytes; long texts do not.
json parse_json(std::string_view message, const std::string& name) {
  constexpr std::ptrdiff_t kMostValues = 1 << 16;
  const auto begins_another = [](char c) { return c == ',' || c == '[' || c == '{'; };
  if (std::ranges::count_if(message, begins_another) > kMostValues) {
    throw Error(fmt::format("{}: a message of more than {} values", name, kMostValues));
  }
  json parsed = json::parse(message, nullptr, false);
  if (!parsed.is_object()) throw Error(name + ": a message that is no JSON object");
  return parsed;
}

}  // namespace

const Value& FoxgloveMessage::operator[](std::string_view field) const {
  static const Value none;
  const auto found = values_.find(field);
  return found == values_.end() ? none : found->second;
}

class FoxgloveReader {
 public:
  FoxgloveReader(FieldList fields, const std::string& name) : fields_(fields), name_(name) {}
  template <class Message>
  FoxgloveMessage operator()(Message&& message) const {
    FoxgloveMessage read;
    for (const Field& field : fields_) read.values_.emplace(field.name, value_in(message, field, name_));
    return read;
  }

 private:
  FieldList fields_;
  const std::string& name_;
};

bool is_foxglove(const RecordedTopic& topic, std::string_view schema) {
  if (schema_of(topic) != schema) return false;
  return topic.type.starts_with(is_ros(topic) ? "foxglove_msgs/" : "foxglove.") && topic.layout != MessageLayout::other;
}

std::vector<FoxgloveMessage> read_foxglove(const RecordedTopic& topic, std::string_view message,
                                           const std::string& name) {
  const bool is_list = schema_of(topic) == "FrameTransforms";
  const FoxgloveReader read(fields_of(schema_of(topic)), name);
  std::vector<FoxgloveMessage> all;
  if (topic.layout == MessageLayout::protobuf) {
    const ProtobufFields fields = parse_protobuf(message, name);
    if (!is_list) return {read(fields)};
    for (const std::string_view one : fields.all_texts(1)) all.push_back(read(parse_protobuf(one, name)));
  } else if (topic.layout == MessageLayout::json) {
    const json parsed = parse_json(message, name);
    if (!is_list) return {read(parsed)};
    for (const json& one : member(parsed, "transforms")) all.push_back(read(one));
  } else {
    MessageFields fields(message, topic.layout, name);
    for (std::uint32_t left = is_list ? fields.u32("the number of transforms") : 1; left > 0; --left) {
      all.push_back(read(fields));
    }
  }
  return all;
}

}  // namespace vesalius
