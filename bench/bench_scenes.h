#pragma once

#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/detect.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// A frame, a forest that was made for such frames, and what every stage of the detector receives for them.
struct BenchScene {
  std::string name;
  Frame frame;
  Forest forest;
  Posteriors posteriors;
  LabelImage labels;  ///< smoothed
  Clusters clusters;
  std::vector<Skeleton> rough;
};

/// Two capsule people in a room, 640x480 with sensor noise, and the sample's forest; and where VESALIUS_SHARED or the
/// folder `shared` beside the repository has them, a real frame with the reference trees and, where
/// VESALIUS_BENCH_MODEL names one, with that model ("model"). Throws Error for a file that cannot be read.
std::vector<BenchScene> bench_scenes();

}  // namespace vesalius
