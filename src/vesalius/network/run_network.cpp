#include "vesalius/network/run_network.h"

#include <algorithm>
#include <utility>

#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Products that are worth a task of their own: about 20 microseconds of a core with VNNI, where starting one takes 1.
constexpr std::int64_t kTaskProducts = 2'000'000;

/// Lays out a picture whose width and height `view` has, with everything that PictureView promises.
void lay_out(const NetworkPicture& picture, int narrow_bytes, int fill, PictureView& view,
             std::vector<std::int16_t>& memory) {
  const int border = picture.wide ? 0 : 1;
  const int padded = (picture.channels + kChannelStep - 1) / kChannelStep * kChannelStep;
  view.wide = picture.wide;
  view.pixel_bytes = picture.wide ? 2 * picture.channels : padded * narrow_bytes;
  view.row_bytes = (view.width + 2 * border) * view.pixel_bytes;
  const std::ptrdiff_t bytes = (view.height + 2 * border) * view.row_bytes + border * kReadAhead * view.pixel_bytes;
  memory.resize(static_cast<std::size_t>(bytes / 2), static_cast<std::int16_t>(narrow_bytes == 1 ? 257 * fill : fill));
  view.first = reinterpret_cast<std::uint8_t*>(memory.data()) + border * (view.row_bytes + view.pixel_bytes);
}

void copy_input(const NetworkInput& input, int value_bytes, const PictureView& to) {
  const int row = input.width * kNetworkInputs;
  const std::uint8_t* from = input.values.data();
  for (int y = 0; y < input.height; ++y, from += row) {
    if (value_bytes == 1) {
      std::copy_n(from, row, to.at(0, y));
    } else {
      std::copy_n(from, row, reinterpret_cast<std::int16_t*>(to.at(0, y)));
    }
  }
}

}  // namespace

void check(const NetworkInput& input) {
  const auto fits = [](int side) { return side > 0 && side % kNetworkMultiple == 0; };
  const std::size_t values =
      static_cast<std::size_t>(input.width) * static_cast<std::size_t>(input.height) * kNetworkInputs;
  if (fits(input.width) && fits(input.height) && input.values.size() == values) return;
  throw Error("network: input of " + std::to_string(input.width) + "x" + std::to_string(input.height) + " pixels and " +
              std::to_string(input.values.size()) + " values, expected multiples of " +
              std::to_string(kNetworkMultiple) + " and " + std::to_string(kNetworkInputs) + " values a pixel");
}

NetworkRunner::NetworkRunner(const Network& network, int parts)
    : classes_of_(static_cast<std::size_t>(network.classes_of) + 1),
      person_of_(static_cast<std::size_t>(network.person_of) + 1),
      centres_of_(static_cast<std::size_t>(network.centres_of) + 1) {
  check(network, parts);
  pictures_ = pictures_of(network);
  for (const Convolution& c : network.layers) {
    layers_.push_back({c.input, c.added, static_cast<std::int64_t>(c.weights.size()), Convolver::make(c)});
  }
}

bool NetworkRunner::is_head(std::size_t picture) const {
  return picture == classes_of_ || picture == person_of_ || (picture == centres_of_ && centres_of_ != 0);
}

void NetworkRunner::prepare(int width, int height, Workspace& space) const {
  if (space.width == width && space.height == height) return;
  space = {width, height, std::vector<PictureView>(pictures_.size()), {}};
  space.memory.resize(pictures_.size());
  for (std::size_t n = 0; n < pictures_.size(); ++n) {
    space.views[n].width = width >> pictures_[n].halvings;
    space.views[n].height = height >> pictures_[n].halvings;
    if (is_head(n)) continue;
    lay_out(pictures_[n], narrow_bytes(), n == 0 ? kNetworkZero : 0, space.views[n], space.memory[n]);
  }
}

void NetworkRunner::lay_out_head(std::size_t picture, Workspace& space, WideImage& head) const {
  PictureView& view = space.views[picture];
  lay_out(pictures_[picture], narrow_bytes(), 0, view, head.values);
  head.width = view.width;
  head.height = view.height;
  head.channels = pictures_[picture].channels;
}

void NetworkRunner::run_layer(const Layer& layer, const std::vector<PictureView>& views, const PictureView& out) const {
  const auto view = [&](int n) { return &views[static_cast<std::size_t>(n)]; };
  const PictureView* added = layer.added < 0 ? nullptr : view(layer.added);
  const auto rows = [&](int begin, int end) { layer.convolver->run(*view(layer.input), added, begin, end, out); };
  const int grain = int(kTaskProducts / (layer.products * out.width)) + 1;
  if (grain >= out.height || thread_count() == 1) return rows(0, out.height);
  parallel_ranges(out.height, grain, rows);
}

void NetworkRunner::run(const NetworkInput& input, NetworkResult& out) const {
  check(input);
  Workspace space = spaces_.take();
  prepare(input.width, input.height, space);
  lay_out_head(classes_of_, space, out.classes);
  lay_out_head(person_of_, space, out.person);
  if (centres_of_ == 0) {
    out.centres = {};
  } else {
    lay_out_head(centres_of_, space, out.centres);
  }
  copy_input(input, narrow_bytes(), space.views[0]);
  for (std::size_t n = 0; n < layers_.size(); ++n) run_layer(layers_[n], space.views, space.views[n + 1]);
  spaces_.give_back(std::move(space));
}

}  // namespace vesalius
