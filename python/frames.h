#pragma once

#include <nanobind/nanobind.h>

#include <memory>

#include "vesalius/frame.h"

namespace vesalius {

/// A frame whose pictures numpy arrays may show.
struct PythonFrame {
  std::shared_ptr<Frame> frame;
};

/// Defines Camera, Frame, Source and open.
void bind_frames(nanobind::module_& m);

}  // namespace vesalius
