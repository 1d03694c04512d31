#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/network/network.h"
#include "vesalius/network/run_network.h"

namespace vesalius::test {

/// Adds a convolution of random weights, whose results use much of their range, and returns its picture's number.
inline int add_random(Network& network, Random& random, Convolution c) {
  const int values = c.side * c.side * c.inputs;
  for (int i = 0; i < values * c.outputs; ++i) {
    c.weights.push_back(static_cast<std::int8_t>(int(random.below(256)) - 128));
  }
  for (int o = 0; o < c.outputs; ++o) {
    c.scale.push_back(float(random.uniform(0.5, 2.0)) * (c.wide ? 4.F : .01F) / std::sqrt(float(values)));
    c.offset.push_back(float(random.uniform(-50.0, 100.0)));
  }
  network.layers.push_back(std::move(c));
  return int(network.layers.size());
}

/// The shape of an encoder and decoder: channels at 1/2, 1/4 and so on, pairs of convolutions at each with what they
/// read added, channels of the decoder from the smallest to 1/2.
struct NetworkShape {
  std::vector<int> encoder;
  std::vector<int> pairs;
  std::vector<int> decoder;
};
inline const NetworkShape kSmallShape = {{12, 24, 40, 64, 96}, {0, 1, 1, 2, 2}, {64, 40, 24, 16}};
inline const NetworkShape kLargeShape = {{16, 32, 64, 112, 160}, {0, 1, 2, 3, 3}, {112, 64, 32, 16}};

/// With all three heads.
inline Network random_network(Random& random, const NetworkShape& shape, int parts) {
  Network network;
  const auto add = [&](const Convolution& c) { return add_random(network, random, c); };
  const auto add_pair = [&](int at, int channels) {
    const int first = add({.input = at, .inputs = channels, .outputs = channels});
    return add({.input = first, .inputs = channels, .outputs = channels, .added = at, .added_scale = 0.7F});
  };
  int at = 0, channels = kNetworkInputs;
  std::vector<int> levels;
  for (std::size_t i = 0; i < shape.encoder.size(); ++i) {
    at = add({.input = at, .stride = 2, .inputs = channels, .outputs = shape.encoder[i]});
    channels = shape.encoder[i];
    for (int n = 0; n < shape.pairs[i]; ++n) at = add_pair(at, channels);
    levels.push_back(at);
  }
  int quarter = 0, quarter_channels = 0, eighth = 0, eighth_channels = 0;
  for (std::size_t j = 0; j < shape.decoder.size(); ++j) {
    const int to = shape.decoder[j];
    const std::size_t level = shape.encoder.size() - 2 - j;
    const int up = add({.input = at, .side = 1, .inputs = channels, .outputs = to, .wide = true});
    at = add({.input = levels[level],
              .side = 1,
              .inputs = shape.encoder[level],
              .outputs = to,
              .added = up,
              .added_scale = 0.004F});
    at = add_pair(at, channels = to);
    if (level == 1) quarter = at, quarter_channels = channels;
    if (level == 2) eighth = at, eighth_channels = channels;
  }
  const int classes = parts + 1;
  network.classes_of = add({.input = at, .side = 1, .inputs = channels, .outputs = classes, .wide = true}) - 1;
  network.person_of =
      add({.input = quarter, .side = 1, .inputs = quarter_channels, .outputs = kPersonNumbers, .wide = true}) - 1;
  const int centres = kCentreNumbers * parts;
  network.centres_of =
      add({.input = eighth, .side = 1, .inputs = eighth_channels, .outputs = centres, .wide = true}) - 1;
  return network;
}

/// Takes away the last head.
inline Network without_centres(Network network) {
  network.layers.pop_back();
  network.centres_of = -1;
  return network;
}

/// Random convolutions between the input and the heads: every one reads one of those before, and may add one. Half
/// of them have a head of centres.
inline Network random_tangle(Random& random, int parts, int most_channels) {
  Network network;
  const auto any = [&](int count) { return int(random.below(static_cast<std::uint32_t>(count))); };
  const auto add = [&](Convolution c, int channels) {
    const std::vector<NetworkPicture> pictures = pictures_of(network);
    const NetworkPicture& read = pictures[static_cast<std::size_t>(c.input)];
    c.inputs = read.channels;
    c.outputs = channels > 0 ? channels : 1 + any(most_channels);
    const int halvings = read.halvings + c.stride - 1;
    const int other = any(int(pictures.size()));
    const NetworkPicture& added = pictures[static_cast<std::size_t>(other)];
    if (other > 0 && (added.halvings == halvings || added.halvings == halvings + 1) &&
        (channels == 0 || channels == added.channels)) {
      c.added = other;
      c.outputs = added.channels;
      c.added_scale = float(random.uniform(-1.0, 1.0));
    }
    return add_random(network, random, c);
  };
  const int half = add({.stride = 2}, 0);
  const int quarter = add({.input = half, .stride = 2}, 0);
  for (int n = 0; n < 12; ++n) {
    const std::vector<NetworkPicture> pictures = pictures_of(network);
    int input = any(int(pictures.size()));
    while (pictures[static_cast<std::size_t>(input)].wide) input = any(int(pictures.size()));
    const bool halve = pictures[static_cast<std::size_t>(input)].halvings < 5 && any(3) == 0;
    add({.input = input, .side = 1 + 2 * any(2), .stride = halve ? 2 : 1, .wide = any(4) == 0}, 0);
  }
  // The heads read, if there is one, a picture made last.
  const std::vector<NetworkPicture> pictures = pictures_of(network);
  int last_half = half, last_quarter = quarter;
  for (int n = quarter; n < int(pictures.size()); ++n) {
    const NetworkPicture& p = pictures[static_cast<std::size_t>(n)];
    if (!p.wide && p.halvings == 1) last_half = n;
    if (!p.wide && p.halvings == 2) last_quarter = n;
  }
  network.classes_of = add({.input = last_half, .side = 3, .wide = true}, parts + 1) - 1;
  network.person_of = add({.input = last_quarter, .side = 1, .wide = true}, kPersonNumbers) - 1;
  if (any(2) == 0) return network;
  const int eighth = add({.input = last_quarter, .stride = 2}, 0);
  network.centres_of = add({.input = eighth, .side = 1, .wide = true}, kCentreNumbers * parts) - 1;
  return network;
}

inline NetworkInput random_input(Random& random, int width, int height) {
  NetworkInput input{width, height, {}};
  for (int i = 0; i < width * height * kNetworkInputs; ++i) {
    input.values.push_back(static_cast<std::uint8_t>(random.below(256)));
  }
  return input;
}

}  // namespace vesalius::test
