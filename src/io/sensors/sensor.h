#pragma once

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/error.h"
#include "vesalius/base/frame_source.h"

namespace vesalius {

/// A camera that is plugged in.
struct SensorInfo {
  std::string id;    ///< what `open` takes: its serial number, or where it is plugged in
  std::string name;  ///< e.g. "PrimeSense PS1080"
};

/// A way to cameras of one kind.
struct SensorDriver {
  std::string_view scheme;  ///< what a source begins with, e.g. "openni2"
  const char* what;         ///< cameras that it opens
  const char* package;      ///< Debian package that a build needs for it
  bool built;               ///< whether this build has it
  /// Returns the cameras that are plugged in. Throws Error where the driver does not start.
  std::vector<SensorInfo> (*list)();
  /// Opens the camera with this id, or the only one where it is empty. Throws Error saying what is missing.
  std::unique_ptr<FrameSource> (*open)(const std::string& id);
};

/// Returns the sources that name these cameras, e.g. "openni2:1, openni2:2".
inline std::string sources_of(std::string_view scheme, const std::vector<SensorInfo>& cameras) {
  std::string text;
  for (const SensorInfo& one : cameras) text += fmt::format("{}{}:{}", text.empty() ? "" : ", ", scheme, one.id);
  return text;
}

/// Returns the time now for Frame::arrived_s.
inline double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Time without a frame after which a camera counts as lost.
inline constexpr int kSensorPatience_ms = 3000;

/// What all cameras have in common as sources.
class LiveSource : public FrameSource {
 public:
  int size() const override { return -1; }
  bool is_live() const override { return true; }
  int missed() const override { return missed_; }
  std::vector<std::string> notes() const override { return notes_; }

 protected:
  LiveSource(std::string_view scheme, const std::string& id)
      : place_(id.empty() ? std::string(scheme) : fmt::format("{}:{}", scheme, id)) {}

  [[noreturn]] void fail_without_frame() const {
    throw Error(
        fmt::format("{}: no frame for {} s; unplugged, or used by another program", place_, kSensorPatience_ms / 1000));
  }

  std::string place_;  ///< for messages
  std::vector<std::string> notes_;
  int missed_ = 0;
};

}  // namespace vesalius
