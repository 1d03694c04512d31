#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/data_file.h"

namespace vesalius {

/// First bytes of a recording of OpenNI (.oni).
inline constexpr std::string_view kOniMagic = "NI10";

/// What a stream of pictures shows.
enum class OniKind : std::uint32_t { depth = 2, colour = 3, infrared = 4 };

/// One picture in the file.
struct OniPicture {
  std::uint64_t at = 0;      ///< of its record
  std::int64_t time_us = 0;  ///< since its stream began
  bool mirrored = false;     ///< left and right are exchanged
};

/// A stream of pictures, with its properties as they were before the first picture.
struct OniStream {
  std::uint32_t id = 0;
  std::string name;  ///< e.g. "Depth1"
  OniKind kind{};
  std::string codec;                              ///< four characters, e.g. "16zT"
  std::map<std::string, std::string> properties;  ///< bytes by name
  std::vector<OniPicture> pictures;               ///< in the order of the file

  std::optional<std::uint64_t> integer(const std::string& property) const;
  /// Returns nothing unless the property has exactly `count` numbers.
  std::vector<double> reals(const std::string& property, std::size_t count) const;
};

/// A recording of OpenNI 1 or 2, of format 1.0.0.4 to 1.0.1.0: Kinect v1, Xtion, Carmine and what else their drivers
/// knew. Where it has tables of its pictures only those are read, else the heads of all records.
class OniRecording {
 public:
  /// Throws Error naming the file if it is none, or of another version.
  explicit OniRecording(DataFile file);

  const std::vector<OniStream>& streams() const { return streams_; }
  /// Returns the bytes of a picture. Throws Error naming the file if there is none in its place.
  std::string read(const OniStream& stream, const OniPicture& picture) const;
  /// Returns a line for a file that is cut short or damaged, of which the whole pictures before that are read.
  std::vector<std::string> notes() const { return notes_; }

 private:
  struct Head;
  std::optional<Head> head_at(std::uint64_t at) const;
  void walk();
  /// Handles a record; returns whether more are to be looked at.
  bool take(const Head& head);
  void add_stream(const Head& head);
  void set_property(const Head& head);
  bool use_tables();
  bool read_table(OniStream& stream, std::uint64_t at, std::optional<std::uint32_t>& state) const;
  OniStream* stream_of(std::uint32_t id);

  DataFile file_;
  bool is_old_ = false;  ///< positions of 32 bits
  std::vector<OniStream> streams_;
  std::map<std::uint32_t, std::uint64_t> tables_;  ///< their places by the numbers of streams
  std::vector<std::string> notes_;
};

}  // namespace vesalius
