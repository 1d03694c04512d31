#include "vesalius/network/network.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kMostLayers = 256;
/// 3 * 3 * 1024 products of 255 and -128 stay within 32 bits.
constexpr int kMostChannels = 1024;
/// No product or sum of these and a sum of 32 bits leaves the range of a float.
constexpr float kMostScale = 1e9F;
constexpr int kMostHalvings = std::countr_zero(static_cast<unsigned>(kNetworkMultiple));

void expect(bool holds, const std::string& what) {
  if (!holds) throw Error(what);
}

bool in_range(std::span<const float> scales) {
  return std::ranges::all_of(scales, [](float s) { return std::abs(s) <= kMostScale; });
}

void check_numbers(const Convolution& c) {
  const auto outputs = static_cast<std::size_t>(c.outputs);
  const auto words = [](std::size_t weights, std::size_t scales, std::size_t offsets) {
    return std::to_string(weights) + " weights, " + std::to_string(scales) + " scales and " + std::to_string(offsets) +
           " offsets";
  };
  const std::string has = words(c.weights.size(), c.scale.size(), c.offset.size());
  const std::string expected = words(static_cast<std::size_t>(c.side * c.side * c.inputs) * outputs, outputs, outputs);
  expect(has == expected, has + ", expected " + expected);
  const bool positive = std::ranges::all_of(c.scale, [](float s) { return s > 0.F; });
  expect(positive && in_range(c.scale), "a scale that is not above 0 and at most 1e9");
  expect(in_range(c.offset) && in_range({&c.added_scale, 1}), "an offset or added scale that is not from -1e9 to 1e9");
}

std::string words(const NetworkPicture& p) {
  return std::string(p.wide ? "wide" : "narrow") + " picture of " + std::to_string(p.channels) + " channels (halved " +
         std::to_string(p.halvings) + " times)";
}

/// Returns what `c` makes of `pictures`, which are those before it.
NetworkPicture made_by(const Convolution& c, std::span<const NetworkPicture> pictures) {
  const auto picture = [&](int n, int least) -> const NetworkPicture& {
    const bool there = n >= least && n < int(pictures.size());
    expect(there, "takes picture " + std::to_string(n) + ", expected one that a layer before it makes");
    return pictures[static_cast<std::size_t>(n)];
  };
  expect(c.side == 1 || c.side == 3, "a window of side " + std::to_string(c.side) + ", expected 1 or 3");
  expect(c.stride == 1 || c.stride == 2, "a stride of " + std::to_string(c.stride) + ", expected 1 or 2");
  expect(c.outputs >= 1 && c.outputs <= kMostChannels, std::to_string(c.outputs) + " outputs, expected 1 to 1024");
  const NetworkPicture& read = picture(c.input, 0);
  expect(!read.wide && read.channels == c.inputs,
         "reads a " + words(read) + ", expected a narrow one of " + std::to_string(c.inputs) + " channels");
  check_numbers(c);
  const NetworkPicture made{c.outputs, read.halvings + c.stride - 1, c.wide};
  expect(made.halvings <= kMostHalvings, "halves pictures more than " + std::to_string(kMostHalvings) + " times");
  if (c.added == -1) return made;
  const NetworkPicture& added = picture(c.added, 1);
  const int halved = added.halvings - made.halvings;
  expect(added.channels == made.channels && (halved == 0 || halved == 1),
         "adds a " + words(added) + " to a " + words(made));
  return made;
}

void check_head(std::span<const NetworkPicture> pictures, const std::string& name, int layer,
                const NetworkPicture& expected) {
  const auto at = static_cast<std::size_t>(layer) + 1;
  expect(layer >= 0 && at < pictures.size(),
         "network: " + name + " come from layer " + std::to_string(layer) + ", which is not there");
  expect(pictures[at] == expected,
         "network: " + name + " are a " + words(pictures[at]) + ", expected a " + words(expected));
}

}  // namespace

std::vector<NetworkPicture> pictures_of(const Network& network) {
  expect(network.layers.size() <= kMostLayers,
         "network: " + std::to_string(network.layers.size()) + " layers, at most " + std::to_string(kMostLayers));
  std::vector<NetworkPicture> pictures = {{.channels = kNetworkInputs}};
  for (std::size_t n = 0; n < network.layers.size(); ++n) {
    pictures.push_back(
        with_context("network: layer " + std::to_string(n), [&] { return made_by(network.layers[n], pictures); }));
  }
  return pictures;
}

void check(const Network& network, int parts) {
  const std::vector<NetworkPicture> pictures = pictures_of(network);
  check_head(pictures, "classes", network.classes_of, {.channels = parts + 1, .halvings = 1, .wide = true});
  check_head(pictures, "votes", network.person_of, {.channels = kPersonNumbers, .halvings = 2, .wide = true});
  if (network.centres_of == -1) return;
  check_head(pictures, "centres", network.centres_of,
             {.channels = kCentreNumbers * parts, .halvings = 3, .wide = true});
}

}  // namespace vesalius
