#pragma once

#include "synth/furniture/furniture.h"

namespace vesalius::synth {

/// Returns something flat with a picture on it: a poster, a painting in a frame or a screen, which hang at a wall, or a
/// banner that stands there. It shows people, a landscape, a page of writing or shapes. People in pictures are nobody.
/// To the depth camera it is a board, of which a screen sends back next to nothing.
Furniture make_picture(Random& random);

}  // namespace vesalius::synth
