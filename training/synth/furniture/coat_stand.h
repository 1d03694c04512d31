#pragma once

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a stand with one or two hanging coats and perhaps a hat, which resembles a person.
Furniture make_coat_stand(Random& random);
/// Returns a torso on a pole, perhaps with a head, which resembles a person.
Furniture make_mannequin(Random& random);

}  // namespace vesalius::synth
