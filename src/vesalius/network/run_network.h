#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "vesalius/base/pool.h"
#include "vesalius/network/convolve_kernels.h"
#include "vesalius/network/network.h"

namespace vesalius {

/// kNetworkInputs numbers a pixel, pixel after pixel, row after row; sides of a multiple of kNetworkMultiple.
struct NetworkInput {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> values = {};
};

/// Throws Error if `input` has not the size that NetworkInput says.
void check(const NetworkInput& input);

/// `channels` numbers a pixel, pixel after pixel, row after row.
struct WideImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::int16_t> values = {};

  const std::int16_t* at(int u, int v) const {
    return values.data() + (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + std::size_t(u)) *
                               static_cast<std::size_t>(channels);
  }
};

/// What a network's heads say.
struct NetworkResult {
  WideImage classes;  ///< half the size; unit kLogitUnit
  WideImage person;   ///< a quarter of the size
  WideImage centres;  ///< an eighth of the size, in mm; empty if the network does not say
};

/// Runs a network on all allowed threads, by rows, one convolution after the other. The result is the same for any
/// number of them and from every instruction set.
class NetworkRunner {
 public:
  /// Arranges the weights for this processor. Throws what `check` throws.
  NetworkRunner(const Network& network, int parts);

  /// Writes to `out`, whose memory it reuses. May be called from several threads at once. Throws Error if `input` has
  /// not the size that NetworkInput says.
  void run(const NetworkInput& input, NetworkResult& out) const;

 private:
  struct Layer {
    int input;
    int added;
    std::int64_t products;  ///< of a pixel
    std::unique_ptr<const Convolver> convolver;
  };
  /// The pictures of one run, numbered as in Convolution::input. The heads lie in the result.
  struct Workspace {
    int width = 0;
    int height = 0;
    std::vector<PictureView> views = {};
    std::vector<std::vector<std::int16_t>> memory = {};
  };

  bool is_head(std::size_t picture) const;
  int narrow_bytes() const { return layers_.front().convolver->narrow_bytes(); }
  void prepare(int width, int height, Workspace& space) const;
  void lay_out_head(std::size_t picture, Workspace& space, WideImage& head) const;
  void run_layer(const Layer& layer, const std::vector<PictureView>& views, const PictureView& out) const;

  std::vector<NetworkPicture> pictures_;
  std::vector<Layer> layers_;
  std::size_t classes_of_;  ///< picture
  std::size_t person_of_;   ///< picture
  std::size_t centres_of_;  ///< picture; 0: none
  mutable Pool<Workspace> spaces_;
};

}  // namespace vesalius
