#include "vesalius/forest/make_labeller.h"

#include <utility>

#include "vesalius/base/error.h"

namespace vesalius {

std::shared_ptr<const PixelLabeller> make_labeller(Forest forest, const std::string& device) {
  if (device != "cpu") throw UsageError("device \"" + device + "\" is not available, expected \"cpu\"");
  return std::make_shared<ForestLabeller>(std::move(forest));
}

}  // namespace vesalius
