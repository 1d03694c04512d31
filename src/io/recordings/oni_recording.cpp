#include "io/recordings/oni_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "io/files/byte_stream.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kRecordMagic = 0x0052494E;  // "NIR" and 0
constexpr std::uint64_t kFileHead = 24;
constexpr std::uint32_t kHead = 28, kOldHead = 24;
/// Fields of a record hold names and properties; a table of shifts has some 20,000 bytes.
constexpr std::uint32_t kMostFields = 1U << 20U;

enum class Kind : std::uint32_t {
  stream_1004 = 0x02,
  integer = 0x03,
  real = 0x04,
  text = 0x05,
  general = 0x06,
  data = 0x0A,
  end = 0x0B,
  stream_1005 = 0x0C,
  stream = 0x0D,
  table = 0x0E
};

/// A text without the zero at its end.
std::string name_in(ByteReader& in, const char* what) {
  std::string_view name = in.text(what);
  return std::string(name.substr(0, name.find('\0')));
}

}  // namespace

std::optional<std::uint64_t> OniStream::integer(const std::string& property) const {
  const auto found = properties.find(property);
  if (found == properties.end() || found->second.size() != sizeof(std::uint64_t)) return std::nullopt;
  return ByteReader(found->second, property).number<std::uint64_t>("number");
}

std::vector<double> OniStream::reals(const std::string& property, std::size_t count) const {
  const auto found = properties.find(property);
  if (found == properties.end() || found->second.size() != count * sizeof(double)) return {};
  ByteReader in(found->second, property);
  std::vector<double> values;
  while (in.left() > 0) values.push_back(in.real64("number"));
  return values;
}

/// What stands before the fields of a record.
struct OniRecording::Head {
  std::uint64_t at = 0;  ///< of the record
  Kind kind{};
  std::uint32_t stream = 0;
  std::uint32_t head_bytes = 0;
  std::uint32_t field_bytes = 0;  ///< with the head
  std::uint32_t data_bytes = 0;

  std::uint64_t data_at() const { return at + field_bytes; }
  std::uint64_t end() const { return data_at() + data_bytes; }
};

OniRecording::OniRecording(DataFile file) : file_(std::move(file)) {
  const std::string head = file_.read(0, kFileHead);
  if (!head.starts_with(kOniMagic))
    throw Error(file_.path() + ": no recording of OpenNI, expected it to begin with NI10");
  ByteReader in(head, file_.path());
  in.take(kOniMagic.size(), "mark");
  const unsigned major = in.number<std::uint8_t>("version"), minor = in.number<std::uint8_t>("version");
  const unsigned maintenance = in.number<std::uint16_t>("version"), build = in.number<std::uint32_t>("version");
  if (major != 1 || minor != 0 || maintenance > 1) {
    throw Error(fmt::format("{}: version {}.{}.{}.{} of OpenNI's recordings, expected 1.0.0.4 to 1.0.1.0", file_.path(),
                            major, minor, maintenance, build));
  }
  is_old_ = maintenance == 0;
  walk();
}

std::string OniRecording::read(const OniStream& stream, const OniPicture& picture) const {
  const std::optional<Head> head = head_at(picture.at);
  if (!head || head->kind != Kind::data || head->stream != stream.id) {
    throw Error(fmt::format("{}: damaged at byte {}: no picture of {}", file_.path(), picture.at, stream.name));
  }
  return file_.read(head->data_at(), head->data_bytes);
}

/// Returns nothing where no whole record stands.
std::optional<OniRecording::Head> OniRecording::head_at(std::uint64_t at) const {
  Head head;
  head.at = at;
  head.head_bytes = is_old_ ? kOldHead : kHead;
  const std::string bytes = file_.read(at, head.head_bytes);
  if (bytes.size() < head.head_bytes) return std::nullopt;
  ByteReader in(bytes, file_.path());
  if (in.number<std::uint32_t>("record") != kRecordMagic) return std::nullopt;
  head.kind = static_cast<Kind>(in.number<std::uint32_t>("kind of a record"));
  head.stream = in.number<std::uint32_t>("stream of a record");
  head.field_bytes = in.number<std::uint32_t>("length of a record");
  head.data_bytes = in.number<std::uint32_t>("length of data");
  const bool fits =
      head.field_bytes >= head.head_bytes && head.field_bytes <= kMostFields && head.end() <= file_.size();
  return fits ? std::optional(head) : std::nullopt;
}

void OniRecording::walk() {
  for (std::uint64_t at = kFileHead;;) {
    const std::optional<Head> head = head_at(at);
    if (!head) {
      notes_.push_back(
          fmt::format("{}: cut short or damaged at byte {}; the whole frames before it are read", file_.path(), at));
      return;
    }
    if (!take(*head)) return;
    at = head->end();
  }
}

bool OniRecording::take(const Head& head) {
  switch (head.kind) {
    case Kind::stream_1004:
    case Kind::stream_1005:
    case Kind::stream:
      add_stream(head);
      return true;
    case Kind::integer:
    case Kind::real:
    case Kind::text:
    case Kind::general:
      set_property(head);
      return true;
    case Kind::data: {
      if (use_tables()) return false;
      OniStream* stream = stream_of(head.stream);
      if (stream == nullptr) return true;
      const std::string fields = file_.read(head.at + head.head_bytes, sizeof(std::uint64_t));
      const auto time_us = ByteReader(fields, file_.path()).number<std::uint64_t>("time of a picture");
      stream->pictures.push_back(
          {head.at, static_cast<std::int64_t>(time_us), stream->integer("xnMirror").value_or(0) != 0});
      return true;
    }
    default:
      return head.kind != Kind::end;
  }
}

void OniRecording::add_stream(const Head& head) {
  const std::string fields = file_.read(head.at + head.head_bytes, head.field_bytes - head.head_bytes);
  ByteReader in(fields, file_.path());
  OniStream stream;
  stream.id = head.stream;
  stream.name = name_in(in, "name of a stream");
  stream.kind = static_cast<OniKind>(in.number<std::uint32_t>("kind of a stream"));
  stream.codec = in.take(4, "codec of a stream");
  if (stream_of(stream.id) != nullptr) return;
  streams_.push_back(std::move(stream));
  if (head.kind != Kind::stream || is_old_) return;
  in.take(sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t), "number and times of pictures");
  const auto table = in.number<std::uint64_t>("place of a table");
  if (table != 0) tables_[head.stream] = table;
}

void OniRecording::set_property(const Head& head) {
  OniStream* stream = stream_of(head.stream);
  if (stream == nullptr) return;
  const std::string fields = file_.read(head.at + head.head_bytes, head.field_bytes - head.head_bytes);
  ByteReader in(fields, file_.path());
  const std::string name = name_in(in, "name of a property");
  // What changes later is of use only where each picture can have its own.
  if (!stream->pictures.empty() && name != "xnMirror") return;
  stream->properties[name] = in.text("property");
}

/// Takes the pictures from the tables, if all streams of pictures have one and no property changes among them. Returns
/// whether it did.
bool OniRecording::use_tables() {
  const bool begun = std::ranges::any_of(streams_, [](const OniStream& s) { return !s.pictures.empty(); });
  if (begun || tables_.empty()) return false;
  std::vector<OniStream> filled = streams_;
  std::optional<std::uint32_t> state;
  for (OniStream& stream : filled) {
    const bool has_pictures =
        stream.kind == OniKind::depth || stream.kind == OniKind::colour || stream.kind == OniKind::infrared;
    const auto table = tables_.find(stream.id);
    if (has_pictures && (table == tables_.end() || !read_table(stream, table->second, state))) {
      tables_.clear();
      return false;
    }
  }
  streams_ = std::move(filled);
  return true;
}

/// `state` numbers the properties that hold; all pictures must have one.
bool OniRecording::read_table(OniStream& stream, std::uint64_t at, std::optional<std::uint32_t>& state) const {
  constexpr std::size_t kEntry = 20;
  const std::optional<Head> head = head_at(at);
  if (!head || head->kind != Kind::table || head->stream != stream.id) return false;
  if (head->data_bytes < kEntry || head->data_bytes % kEntry != 0) return false;
  const bool mirrored = stream.integer("xnMirror").value_or(0) != 0;
  const std::string entries = file_.read(head->data_at(), head->data_bytes);
  ByteReader in(entries, file_.path());
  in.take(kEntry, "table of pictures");  // of a picture 0 that there is not
  while (in.left() > 0) {
    OniPicture picture;
    picture.time_us = static_cast<std::int64_t>(in.number<std::uint64_t>("time of a picture"));
    const auto its_state = in.number<std::uint32_t>("state of a picture");
    picture.at = in.number<std::uint64_t>("place of a picture");
    picture.mirrored = mirrored;
    if (state.value_or(its_state) != its_state) return false;
    state = its_state;
    stream.pictures.push_back(picture);
  }
  return true;
}

OniStream* OniRecording::stream_of(std::uint32_t id) {
  const auto found = std::ranges::find(streams_, id, &OniStream::id);
  return found == streams_.end() ? nullptr : &*found;
}

}  // namespace vesalius
