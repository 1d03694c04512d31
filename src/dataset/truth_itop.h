#pragma once

#include <memory>
#include <string>

#include "dataset/truth_source.h"

namespace vesalius {

/// Whether a path names the depth maps of ITOP: "ITOP_side_test_depth_map.h5" and the like.
bool is_itop(const std::string& path);

/// Frames of ITOP (Haque et al. 2016, "Towards Viewpoint Invariant 3D Human Pose Estimation"; side or top view,
/// unpacked HDF5) from its depth maps and the labels beside them, "..._labels.h5": one person a frame with 15 joints
/// (joint set itop15) and the pixels of the segmentation. Frames whose labels are not valid are left out; the others
/// are named by their row. Of every `step` frames that are left the first is given out. Throws Error naming file and
/// data set for files of another form.
std::unique_ptr<TruthSource> open_itop(const std::string& depth_path, int step);

}  // namespace vesalius
