#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "io/sources/camera_file.h"
#include "io/sources/picture_files.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// The files of one frame.
struct FrameFiles {
  std::string name;
  std::optional<double> time_s;                      ///< seconds, as in Frame
  std::string depth;                                 ///< path of a picture that read_depth reads
  std::string colour;                                ///< path of a PNG, JPEG or PPM; empty = none
  std::optional<Eigen::Vector3f> up = std::nullopt;  ///< as in Frame
};

/// Frames whose depth and colour pictures are files of their own, in order. Either all have times, and they rise, or
/// none. Times may be equal.
struct FrameList {
  std::string place;  ///< for messages
  std::vector<FrameFiles> frames;
  CameraFacts facts;
  CameraFacts fallback;          ///< camera where `facts` has none and the size fits; fx empty = none
  float default_scale = 1000.F;  ///< stored units per metre where `facts` has none
  std::vector<std::string> notes;
  std::vector<SourceItem> items;  ///< what the folder holds
};

/// Fills the items of a list with what its folder, the `place`, holds.
void add_items(FrameList& list);

/// Gives frames with times the upward direction at theirs (UpHistory) by the first kAccelerationFile in `folders`, if
/// there is one; without times it adds a note. Throws Error as parse_accelerations does.
void add_up(FrameList& list, const std::vector<std::string>& folders);

/// Reads the frames of a list in any order. It may be used from several threads.
class FrameListReader {
 public:
  /// Throws Error if the first pictures are all unusable or the camera is unknown, with what there is.
  explicit FrameListReader(FrameList list);

  std::size_t size() const { return list_.frames.size(); }
  const FrameList& list() const { return list_; }
  const Camera& camera() const { return camera_; }
  /// Returns whether frames differ from the pictures in the files, since the lens distorts those.
  bool is_rectified() const { return rectification_.has_value(); }

  /// Returns frame `index`, which must be below size(). Colour of another size than depth is left out, unless the
  /// calibration says where it lies. Throws Error naming a picture that cannot be read, or depth that differs in size
  /// from the first.
  Frame read(std::size_t index, bool with_colour = true) const;

 private:
  void look_at_first();
  void look_at_colour();

  FrameList list_;
  Camera camera_;
  std::optional<Rectification> rectification_;
  std::optional<ColourRegistration> registration_;  ///< of colour that is another camera's
  float units_per_m_ = 1000.F;
};

/// Returns a source that reads the pictures one by one. Throws Error as FrameListReader does.
std::unique_ptr<FrameSource> open_list(FrameList list);

/// One line of a TUM list (depth.txt, rgb.txt).
struct TumEntry {
  double time_s = 0.0;
  std::string stamp;  ///< the time as written
  std::string file;   ///< relative to the list's folder
};

/// Reads lines of the form "timestamp file", with blanks, a tab or a comma between. Times are those of clock_seconds.
/// Empty lines and those that begin with # are skipped. The entries are sorted by time; equal times stay in order.
/// Throws Error naming `name` and the line if a line has another form.
std::vector<TumEntry> parse_tum_list(std::string_view text, const std::string& name);

/// Most that times of depth and colour differ, the default of the benchmark's associate tool.
inline constexpr double kMaxTimeDifferenceS = 0.02;

/// Pairs depth with colour as the benchmark's associate tool does: of all pairs less than `max_difference_s` apart the
/// closest is taken first, and each entry is in one pair only. Both lists must be sorted by time. Returns for each
/// entry of `depth` the index in `colour`, or -1. Takes O(n log n) time.
std::vector<int> associate(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour,
                           double max_difference_s);

/// Returns whether a folder has a list of the TUM RGB-D benchmark.
bool is_tum_folder(const std::string& folder);

/// Lists a folder in the layout of the TUM RGB-D benchmark: depth.txt and, if there is colour, rgb.txt, or
/// associations.txt with lines "timestamp file timestamp file", either of them first.
FrameList list_tum(const std::string& folder, const SourceOptions& options);

/// Returns when frame `index` counts as taken where the frames have no times.
inline double usual_time_s(std::size_t index) { return double(index) / kUsualRate; }

/// Returns the index of the first of `count` frames that is not before `time_s`, or `count`. `time_of` gives the time
/// of the frame with an index; times must not fall.
template <class TimeOf>
std::size_t first_not_before(double time_s, std::size_t count, const TimeOf& time_of) {
  std::size_t first = 0;
  while (count > 0) {
    const std::size_t half = count / 2;
    if (time_of(first + half) < time_s) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

}  // namespace vesalius
