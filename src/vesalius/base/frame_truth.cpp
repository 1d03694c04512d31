#include "vesalius/base/frame_truth.h"

namespace vesalius {

const char* to_string(Heading heading) {
  switch (heading) {
    case Heading::front:
      return "front";
    case Heading::side:
      return "side";
    default:
      return "back";
  }
}

}  // namespace vesalius
