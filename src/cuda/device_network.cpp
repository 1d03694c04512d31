#include "cuda/device_network.h"

#include <utility>

namespace vesalius::gpu {
namespace {

constexpr unsigned kThreads = 128;
static_assert(kNetworkInputs % kReadChannels == 0, "the network's input goes to the device as it is");

int groups_of(int channels, int of) { return (channels + of - 1) / of; }

/// Returns a convolution's weights in the order in which kernels read them.
std::vector<FourWords> packed(const Convolution& c) {
  const int places = c.side * c.side, words = groups_of(c.inputs, kReadChannels) * kReadChannels / 4;
  const auto weight = [&](int output, int place, int input) -> std::uint32_t {
    if (output >= c.outputs || input >= c.inputs) return 0;
    return static_cast<std::uint8_t>(c.weights[static_cast<std::size_t>((output * places + place) * c.inputs + input)]);
  };
  std::vector<FourWords> to;
  for (int i = 0; i < places * words; ++i) {
    for (int output = 0; output < c.outputs; output += kConvolveChannels) {
      FourWords& of = to.emplace_back();
      for (int k = 0; k < 16; ++k) {
        of.word[k / 4] |= weight(output + k / 4, i / words, i % words * 4 + k % 4) << (k % 4 * 8);
      }
    }
  }
  return to;
}

void fetch(Stream& stream, const NetworkValues& head, WideImage& to) {
  to.width = head.width;
  to.height = head.height;
  to.channels = head.room;
  to.values.resize(head.place(0, head.height));
  stream.copy_to_host(to.values.data(), head.wide, to.values.size() * sizeof(*head.wide));
}

}  // namespace

DeviceNetwork::DeviceNetwork(const Network& network, int parts, std::shared_ptr<Device> device)
    : device_(std::move(device)),
      classes_of_(static_cast<std::size_t>(network.classes_of) + 1),
      person_of_(static_cast<std::size_t>(network.person_of) + 1),
      centres_of_(static_cast<std::size_t>(network.centres_of) + 1) {
  check(network, parts);
  pictures_ = pictures_of(network);
  const std::unique_ptr<Stream> stream = device_->make_stream();
  for (const Convolution& c : network.layers) {
    const std::vector<FourWords> weights = packed(c);
    layers_.push_back({c, uploaded(device_, *stream, weights), uploaded(device_, *stream, c.scale),
                       uploaded(device_, *stream, c.offset)});
    stream->wait();
    Convolution& kept = layers_.back().convolution;
    kept.weights = {};
    kept.scale = kept.offset = {};
  }
}

/// Returns where the pictures of a run lie.
std::vector<NetworkValues> DeviceNetwork::make_room(int width, int height, Workspace& space) const {
  space.pictures.resize(pictures_.size());
  std::vector<NetworkValues> all;
  for (const NetworkPicture& p : pictures_) {
    DeviceArray<std::uint8_t>& memory = space.pictures[all.size()];
    NetworkValues& values = all.emplace_back();
    values.width = width >> p.halvings;
    values.height = height >> p.halvings;
    values.room = p.wide ? p.channels : groups_of(p.channels, kReadChannels) * kReadChannels;
    memory.fit(device_, values.place(0, values.height) * (p.wide ? sizeof(*values.wide) : 1));
    values.narrow = p.wide ? nullptr : memory.data();
    values.wide = p.wide ? reinterpret_cast<std::int16_t*>(memory.data()) : nullptr;
  }
  return all;
}

void DeviceNetwork::run(const NetworkInput& input, NetworkResult& out) const {
  check(input);
  Workspace space = spaces_.take();
  if (space.stream == nullptr) space.stream = device_->make_stream();
  const std::vector<NetworkValues> pictures = make_room(input.width, input.height, space);
  space.stream->copy_to_device(pictures[0].narrow, input.values.data(), input.values.size());
  for (std::size_t n = 0; n < layers_.size(); ++n) {
    const auto& [c, weights, scale, offset] = layers_[n];
    const ConvolveArguments told{
        .in = pictures[static_cast<std::size_t>(c.input)],
        .out = pictures[n + 1],
        .added = c.added >= 0 ? pictures[static_cast<std::size_t>(c.added)] : NetworkValues{},
        .added_scale = c.added_scale,
        .outside_word = c.input == 0 ? 0x01010101U * kNetworkZero : 0,
        .side = c.side,
        .stride = c.stride,
        .outputs = c.outputs,
        .weights = weights.data(),
        .scale = scale.data(),
        .offset = offset.data(),
    };
    const int threads = groups_of(told.out.width, kConvolvePixels) * groups_of(c.outputs, kConvolveChannels);
    space.stream->launch(
        told, {blocks_for(static_cast<unsigned>(threads), kThreads), static_cast<unsigned>(told.out.height), kThreads});
  }
  fetch(*space.stream, pictures[classes_of_], out.classes);
  fetch(*space.stream, pictures[person_of_], out.person);
  if (centres_of_ == 0) {
    out.centres = {};
  } else {
    fetch(*space.stream, pictures[centres_of_], out.centres);
  }
  space.stream->wait();
  spaces_.give_back(std::move(space));
}

}  // namespace vesalius::gpu
