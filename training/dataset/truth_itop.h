#pragma once

#include <memory>
#include <string>

#include "dataset/truth_source.h"

namespace vesalius {

/// Returns whether a path names depth maps of ITOP, such as "ITOP_side_test_depth_map.h5".
bool is_itop(const std::string& path);

/// Opens frames of ITOP (Haque et al. 2016, "Towards Viewpoint Invariant 3D Human Pose Estimation"; side or top view,
/// unpacked HDF5) from the depth maps and the labels beside them, "..._labels.h5". Each frame has one person with 15
/// joints (joint set itop15) and the pixels of the segmentation. Frames without valid labels are left out; the others
/// are named by their row. The first of every `step` remaining frames is given. Throws Error naming file and data set
/// for files of another form.
std::unique_ptr<TruthSource> open_itop(const std::string& depth_path, int step);

}  // namespace vesalius
