#pragma once

#include <functional>
#include <memory>

#include "vesalius/labeller.h"
#include "vesalius/network/run_network.h"

namespace vesalius {

/// NetworkRunner::run of the processor, or what does the same on a device.
using RunNetwork = std::function<void(const NetworkInput& input, NetworkResult& out)>;

/// Labels by a network, which sees a picture as a whole, by depth and the focal length alone. It
/// answers for every second pixel of every second row; those between take what the ones around them at their own depth
/// say. It votes for the middles of people.
class NetworkLabeller : public Labeller {
 public:
  /// Throws Error for a network that is inconsistent (check(Network)) or has other classes than `parts` and the
  /// background.
  NetworkLabeller(const Network& network, int parts);
  /// With another than the processor to run the network, which gives a logit for each of `parts` and the background.
  NetworkLabeller(RunNetwork run, int parts);
  ~NetworkLabeller() override;

  /// Throws Error for a picture of more than 16,000 pixels a side.
  void label_into(const Frame& frame, float gate, Posteriors& out) const override;

  /// It has seen a pixel's neighbours: a larger window costs parts (decision 58).
  int smoothing_window() const override { return 3; }

 private:
  struct Working;
  std::unique_ptr<const Working> working_;
};

}  // namespace vesalius
