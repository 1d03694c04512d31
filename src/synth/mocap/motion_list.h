#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius::synth {

/// A motion file and what is known of it.
struct MotionFile {
  std::string path;         ///< ends in .bvh or .amc
  std::string skeleton;     ///< .asf of an .amc; empty where there is none
  std::string description;  ///< "walk on uneven terrain"; the file's name where nobody described it
  float fps = 120.F;        ///< of an .amc, which does not say; 120 is what CMU and HDM05 recorded at
};

/// The motions among some paths, in order of their paths. The skeleton of an .amc is the .asf in the same folder with
/// its name or the longest beginning of it that ends before a "_": 02_01.amc has 02.asf.
std::vector<MotionFile> list_motions(std::span<const std::string> paths);

/// Adds what a CSV file says of the motions that it names: columns file, description and fps (if any) in any order,
/// others are read past. A path matches where it ends in the named file. `name` stands for the CSV file in errors;
/// throws Error naming line and expectation.
void describe_motions(std::vector<MotionFile>& motions, std::string_view csv, const std::string& name);

/// Chooses motions by words in their descriptions, in upper or lower case.
struct MotionChoice {
  std::vector<std::string> include;  ///< at least one must be there; empty: all are wanted
  /// None may be there. Unless told otherwise: what people do not do in a room on an ordinary day.
  std::vector<std::string> exclude = {"acrobatic",  "cartwheel",    "flip",         "somersault", "handstand",
                                      "breakdance", "martial",      "karate",       "swordplay",  "heian",
                                      "arabesque",  "attitude",     "jete",         "rond de",    "derriere",
                                      "glissade",   "dance - lean", "dance - fold", "playground"};
};

/// Returns the motions that are wanted, in order.
std::vector<MotionFile> choose_motions(std::span<const MotionFile> motions, const MotionChoice& choice);

}  // namespace vesalius::synth
