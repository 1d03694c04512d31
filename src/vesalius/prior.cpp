#include "vesalius/prior.h"

#include <cmath>
#include <string>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/error.h"

namespace vesalius {

float shared_pixels(const Mask& a, const Mask& b) {
  std::uint32_t both = 0, either = 0;
  const std::uint8_t *of_a = a.data(), *of_b = b.data();
  for (std::size_t i = 0; i < a.size(); ++i) {  // without branches, for vectors
    const std::uint32_t in_a = of_a[i] != 0 ? 1 : 0, in_b = of_b[i] != 0 ? 1 : 0;
    both += in_a & in_b;
    either += in_a | in_b;
  }
  return either > 0 ? float(both) / float(either) : 0.F;
}

void check(const Prior& prior, const Frame& frame) {
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Prior::KnownPerson& known = prior.people[i];
    for (const auto& [name, number] : {std::pair{"odds", known.odds}, std::pair{"size", known.size}}) {
      if (std::isfinite(number) && number > 0.F) continue;
      throw Error("prior: the " + std::string(name) + " of person " + std::to_string(i) +
                  ": expected a number above 0, found " + std::to_string(number));
    }
    const Mask& mask = known.mask;
    if (mask.empty() || mask.same_size(frame.depth)) continue;
    throw Error("prior: the mask of person " + std::to_string(i) + " has " + std::to_string(mask.width()) + "x" +
                std::to_string(mask.height()) + " pixels, expected the frame's " + std::to_string(frame.depth.width()) +
                "x" + std::to_string(frame.depth.height()));
  }
}

Prior every_nth(const Prior& prior, int step) {
  Prior coarse = prior;
  for (Prior::KnownPerson& known : coarse.people) known.mask = every_nth(known.mask, step);
  return coarse;
}

}  // namespace vesalius
