#include "vesalius/prior.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/error.h"

namespace vesalius {

float shared_pixels(const Mask& a, const Mask& b) {
  constexpr std::size_t kAtOnce = 255;  // what a byte can count: vectors then hold most
  std::uint32_t both = 0, either = 0;
  const std::uint8_t *of_a = a.data(), *of_b = b.data();
  for (std::size_t begin = 0; begin < a.size(); begin += kAtOnce) {
    std::uint8_t some_both = 0, some_either = 0;
    for (std::size_t i = begin; i < std::min(begin + kAtOnce, a.size()); ++i) {
      const auto in_a = static_cast<std::uint8_t>(of_a[i] != 0), in_b = static_cast<std::uint8_t>(of_b[i] != 0);
      some_both = static_cast<std::uint8_t>(some_both + (in_a & in_b));
      some_either = static_cast<std::uint8_t>(some_either + (in_a | in_b));
    }
    both += some_both;
    either += some_either;
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

void check(const PictureRegion& region, const Frame& frame) {
  const auto& [u, v, width, height] = region.box;
  const int picture_width = frame.depth.width(), picture_height = frame.depth.height();
  const bool within = u >= 0 && v >= 0 && u <= picture_width - width && v <= picture_height - height;
  if (width > 0 && height > 0 && within) return;
  throw Error("region: " + std::to_string(width) + "x" + std::to_string(height) + " pixels at (" + std::to_string(u) +
              ", " + std::to_string(v) + "), expected some within the frame's " + std::to_string(picture_width) + "x" +
              std::to_string(picture_height));
}

Prior cropped(Prior prior, const Box& box) {
  for (Prior::KnownPerson& known : prior.people) {
    if (!known.mask.empty()) known.mask = crop(known.mask, box);
  }
  return prior;
}

Prior every_nth(const Prior& prior, int step) {
  Prior coarse = prior;
  for (Prior::KnownPerson& known : coarse.people) known.mask = every_nth(known.mask, step);
  return coarse;
}

}  // namespace vesalius
