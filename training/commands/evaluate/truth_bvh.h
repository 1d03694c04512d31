#pragma once

#include <memory>
#include <string>

#include "dataset/truth_source.h"
#include "vesalius/base/options.h"

namespace vesalius::cli {

/// The options in truth_bvh.toml, which adds motion capture of one person to a folder of frames (docs/metrics.md).
/// Paths of files are relative to the folder.
struct BvhTruthOptions {
  std::string motion;             ///< BVH file
  float unit_m = 0.01F;           ///< the file's unit of length in metres
  std::string camera_from_world;  ///< for a fixed camera: the rows of [R | t], twelve numbers with t in metres
  std::string camera_trajectory;  ///< for a moving camera: its poses in a file like TUM RGB-D's groundtruth.txt
  std::string frames;             ///< table with a line for each picture; empty means that times decide
  int frames_column = 3;          ///< the column with the motion's frame; columns count from 1, frames from 0
  std::string start_s = "0";      ///< time of the motion's first frame; a string, since a float is too short for a date
  std::string joints;             ///< pairs of our joint and the BVH's: "head=Head l_hand=LeftHand"
  std::string joint_set;          ///< joint set of the body with which the joints are compared
};
void visit_options(const std::string& prefix, BvhTruthOptions& options, OptionVisitor& visitor);

/// Opens the truth for `evaluate`: a folder with truth_bvh.toml, or anything that open_truth opens.
std::unique_ptr<TruthSource> open_evaluation_truth(const std::string& uri, int step);

}  // namespace vesalius::cli
