#pragma once

#include <memory>
#include <string>

#include "dataset/truth_source.h"
#include "vesalius/base/options.h"

namespace vesalius::cli {

/// truth_bvh.toml in a folder of frames: motion capture of the one person in them (docs/metrics.md). Files are relative
/// to the folder.
struct BvhTruthOptions {
  std::string motion;             ///< BVH file
  float unit_m = 0.01F;           ///< its unit of length
  std::string camera_from_world;  ///< rows of [R | t] of a camera that stands still: twelve numbers, t in metres
  std::string camera_trajectory;  ///< or its poses over time, as TUM RGB-D's groundtruth.txt
  std::string frames;             ///< table with a line for each picture; empty = by time
  int frames_column = 3;          ///< of the table, from 1: the motion's frame, from 0 (as in Berkeley MHAD)
  std::string start_s = "0";      ///< by time: that of the motion's first frame (a float cannot hold a date)
  std::string joints;             ///< "head=Head l_hand=LeftHand": ours and the BVH's
  std::string joint_set;          ///< of the body, to compare with
};
void visit_options(const std::string& prefix, BvhTruthOptions& options, OptionVisitor& visitor);

/// Opens what `evaluate` measures against: a folder with truth_bvh.toml, else what open_truth opens.
std::unique_ptr<TruthSource> open_evaluation_truth(const std::string& uri, int step);

}  // namespace vesalius::cli
