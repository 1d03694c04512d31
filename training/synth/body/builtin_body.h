#pragma once

#include "synth/body/body_mesh.h"
#include "synth/body/builtin_shape.h"

namespace vesalius::synth {

/// Returns a smooth parametric body of our own that needs no files. It is labelled by the surface rules of `body`, has
/// about 14,000 triangles, and stands on y = 0. Left and right are exact mirror images. Values outside their range are
/// clamped. Lengths follow Drillis and Contini (1966) as quoted by Winter (Biomechanics and Motor Control of Human
/// Movement, fig. 4.1), girths follow ANSUR II (2012).
BodyMesh make_builtin_body(const BuiltinShape& shape, const BodyModel& body);

}  // namespace vesalius::synth
