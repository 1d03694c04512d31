#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/frame.h"

namespace vesalius {

/// How the 16 bits of depth are stored: as they are, with their bytes swapped, or rotated three to the left as in SUN
/// RGB-D.
enum class DepthBits { plain, swapped, rotated };

/// Facts that the files of a source may not state, and what to do where a camera is lost. Values given here replace
/// those in files.
struct SourceOptions {
  std::optional<float> fx, fy, cx, cy;      ///< pixels; fy defaults to fx, cx and cy to the picture's centre
  std::optional<float> depth_scale;         ///< stored units per metre (1000 = millimetres, 5000 = TUM); floats: 1
  DepthBits depth_bits = DepthBits::plain;  ///< of pictures; of floats only the order of bytes counts
  /// Degrees clockwise, 0, 90, 180 or 270, by which pictures are turned to be upright; nothing: as Frame::up tells. The
  /// frames stay as they are and say it (Frame::quarter_turns).
  std::optional<int> turn;
  std::string camera_file;        ///< path of a meta.json or ROS camera_info YAML
  std::string colour_file;        ///< path of the colour picture for a single depth PNG
  std::string depth_topic;        ///< or stream, of a recording; empty = chosen
  std::string colour_topic;       ///< or stream, of a recording; empty = one registered to depth, or none
  std::optional<double> start_s;  ///< first frame to give, in seconds from the source's first; not of a camera
  bool reconnect = false;         ///< whether a camera that is lost is waited for; otherwise that is an error
  /// Gets one line when such a camera is lost and one when it is back, in the thread that calls `next`; may be empty.
  std::function<void(const std::string&)> say = {};
};

/// Frames a second of a source whose frames have no times, where nobody says otherwise.
inline constexpr double kUsualRate = 30.0;

/// Times of the first and of the last frame of a source, in seconds as Frame::time_s counts them. Frame number i of a
/// source without times counts as taken at i / kUsualRate.
struct TimeSpan {
  double first_s = 0.0;
  double last_s = 0.0;
};

/// Something that a source holds: a topic of a recording, the pictures of a folder, a calibration.
struct SourceItem {
  std::string name;   ///< of the topic, stream, file or folder
  std::string holds;  ///< type, encoding and size, as "sensor_msgs/Image 16UC1 640x480"
  long count = -1;    ///< messages or files; -1 where nobody counted
  std::string use;    ///< what it is taken for, as "depth"; empty if it is not taken
  std::string why;    ///< of what is not taken: why, and the flag that takes it, if one does; of what is: remarks
};

/// Returns a line for each item, aligned, or nothing for none.
std::string to_text(const std::vector<SourceItem>& items);

/// A stream of frames: a folder, a file, a sensor.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Returns the next frame, or nothing at the end. Throws Error if the frame cannot be read; the next call then
  /// continues after it.
  virtual std::optional<Frame> next() = 0;
  /// Returns the total number of frames, or -1 if it is not known.
  virtual int size() const = 0;
  /// Returns where the frames lie if `seek` can go to any of them; nothing where it cannot.
  virtual std::optional<TimeSpan> span() const { return std::nullopt; }
  /// Goes to the first frame that is not before `time_s`, which `next` then returns; to the end where there is none.
  /// May be called only where there is a span.
  virtual void seek(double /*time_s*/) {}
  /// Returns remarks for the user, one line each, such as guessed intrinsics or depth pictures without colour.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Returns what the source holds, taken or not. A source that cannot be opened tells it in its error.
  virtual std::vector<SourceItem> contents() const { return {}; }
  /// Returns whether the frames are one camera's over time, so that people can be followed. Pictures without times may
  /// have nothing to do with each other.
  virtual bool is_sequence() const { return true; }
  /// Returns whether the frames come from a camera as they are taken: whoever is late misses some, and the stream ends
  /// only when it is told to.
  virtual bool is_live() const { return false; }
  /// Returns the number of frames of a live source that were missed, since nobody asked for them in time.
  virtual int missed() const { return 0; }
  /// Makes a call of `next` that waits for a camera end soon, and every later one at once: they return nothing. May be
  /// called from any thread, and cannot be taken back. Other sources than live ones do not wait, and ignore it.
  virtual void stop() {}
};

}  // namespace vesalius
