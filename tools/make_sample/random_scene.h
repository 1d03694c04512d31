#pragma once

#include <cstdint>

#include "capsule/capsule_person.h"
#include "vesalius/frame.h"

namespace vesalius {

/// A random room with none to three capsule people: standing, walking, waving, reaching, sitting; furniture that may
/// hide parts of them; a camera at 0.6 to 2 m. Same (seed, index), same scene.
CapsuleScene random_scene(std::uint64_t seed, std::uint64_t index);

/// Its picture with truth, without colour; every second one with sensor noise.
LabelledFrame random_frame(const Camera& camera, std::uint64_t seed, std::uint64_t index);

}  // namespace vesalius
