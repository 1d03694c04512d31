#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "io/lens/lens.h"
#include "vesalius/frame.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {

/// Largest side of a picture, pixels.
inline constexpr int kMostSide = 16000;

/// What undoes the lenses of the last cameras: working that out takes longer than doing it.
class Rectifications {
 public:
  /// Returns what turns pictures of `camera` into those of its pinhole camera. It may be called from several threads.
  std::shared_ptr<const Rectification> of(const LensCamera& camera) const;

 private:
  struct Entry {
    LensCamera camera;
    std::shared_ptr<const Rectification> rectification;
  };
  mutable std::mutex mutex_;
  mutable std::vector<Entry> entries_;  ///< the last one used is the last
};

/// Returns a camera of the interface. Throws UsageError for NULL and for what is no camera.
LensCamera read_camera(const vesalius_camera* given);

/// Returns a frame of the interface, with the lens undone. Throws UsageError for NULL and for what is no frame.
Frame read_frame(const vesalius_frame* given, const vesalius_camera* camera, const Rectifications& rectifications);

}  // namespace vesalius::c
