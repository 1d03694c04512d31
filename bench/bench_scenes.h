#pragma once

#include <string>
#include <vector>

#include "vesalius/detect.h"
#include "vesalius/find_clusters.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"

namespace vesalius {

/// A frame, a forest made for such frames, and the input of every stage of the detector for them.
struct BenchScene {
  std::string name;
  Frame frame;
  Forest forest;
  Posteriors posteriors;
  LabelImage labels;  ///< smoothed labels
  Clusters clusters;
  std::vector<Skeleton> rough;
};

/// Returns the scenes of the benchmarks. There is always one of two capsule people in a room, 640x480 with sensor
/// noise, with the sample's forest. If the developers' real frames are there (in VESALIUS_SHARED or the folder `shared`
/// beside the repository), there is also a real frame with the reference trees and, if VESALIUS_BENCH_MODEL names a
/// model, with that one ("model"). Throws Error for a file that cannot be read.
std::vector<BenchScene> bench_scenes();

}  // namespace vesalius
