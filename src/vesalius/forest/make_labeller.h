#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "vesalius/forest/forest.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {

/// A kind of device besides the processor that labels pixels.
struct LabellerDevice {
  std::string name;  ///< as users write it: "cuda"
  /// Returns a labeller on device `number`, from 0 on, of this kind. Throws Error for an inconsistent forest and
  /// DeviceError where the device is not there or cannot take the forest.
  std::function<std::shared_ptr<const PixelLabeller>(Forest forest, int number)> make;
};

/// The name of a device in parts: "cuda:1" is number 1 of kind "cuda".
struct DeviceName {
  std::string kind;
  int number = 0;
};
/// Returns an empty kind for what is no name of a device.
DeviceName parse_device(const std::string& name);

/// The devices that a program was built with, and where it hears of what "auto" decided.
struct LabellerDevices {
  std::vector<LabellerDevice> kinds;
  std::function<void(const std::string&)> note = {};  ///< may be called from any thread
};

/// Throws UsageError, which says what is known.
[[noreturn]] void throw_unknown_device(const std::string& device, const LabellerDevices& devices);

/// Returns a labeller with `forest` on `device`:
///   "cpu"               the processor
///   "NAME", "NAME:N"    the first or N-th device (from 0 on) of a kind, e.g. "cuda:1"
///   "auto"              the first device that can be had, otherwise the processor. A device that fails later is left
///                       for good, with a note, and its pictures are labelled on the processor: with a gate above 1 the
///                       same bits.
/// All programs get their labellers here. Throws Error for an inconsistent forest, UsageError for a device that this
/// build does not know and DeviceError for one that this machine does not have.
std::shared_ptr<const PixelLabeller> make_labeller(Forest forest, const std::string& device = "cpu",
                                                   const LabellerDevices& devices = {});

}  // namespace vesalius
