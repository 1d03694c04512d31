#pragma once

#include "synth/sensor/render.h"

namespace vesalius::synth {

/// Adds the light that scatters in the lens and window of a time-of-flight camera: every surface of the rendering gets
/// the depth of its own light mixed with a share of that of the surfaces around it, within an eighth of the picture's
/// width. Dark surfaces before bright ones come to lie farther, as real ones do. Depths that differ much would wrap
/// around in a real camera, which this leaves out.
void add_stray_light(float share, Rendering& rendering);

}  // namespace vesalius::synth
