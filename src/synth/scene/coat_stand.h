#pragma once

#include "synth/scene/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a stand with one or two hanging coats, perhaps a hat: it resembles a person.
Furniture make_coat_stand(Random& random);
/// Returns a torso on a pole, perhaps with a head: it resembles a person.
Furniture make_mannequin(Random& random);

}  // namespace vesalius::synth
