#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius::synth {

/// A motion file and its description.
struct MotionFile {
  std::string path;         ///< ends in .bvh or .amc
  std::string skeleton;     ///< the .asf of an .amc; empty if there is none
  std::string description;  ///< such as "walk on uneven terrain"; the file's name if there is no description
  float fps = 120.F;        ///< frame rate of an .amc, which does not state it; CMU and HDM05 recorded at 120
};

/// Returns the motions among some paths, in order of their paths. The skeleton of an .amc is the .asf in the same
/// folder that has its name, or else the longest beginning of its name that ends before a "_": 02_01.amc has 02.asf.
std::vector<MotionFile> list_motions(std::span<const std::string> paths);

/// Adds the descriptions of a CSV file to the motions that it names. Its columns are file, description and optionally
/// fps, in any order; others are ignored. A row applies to every path that ends in the named file. `name` is used as
/// the CSV file's path in errors. Throws Error naming line and expectation.
void describe_motions(std::vector<MotionFile>& motions, std::string_view csv, const std::string& name);

/// A choice of motions by words in their descriptions, in upper or lower case.
struct MotionChoice {
  std::vector<std::string> include;  ///< at least one must occur; if empty, all motions are wanted
  /// None of these may occur. The default excludes what people do not do in a room on an ordinary day.
  std::vector<std::string> exclude = {"acrobatic",  "cartwheel",    "flip",         "somersault", "handstand",
                                      "breakdance", "martial",      "karate",       "swordplay",  "heian",
                                      "arabesque",  "attitude",     "jete",         "rond de",    "derriere",
                                      "glissade",   "dance - lean", "dance - fold", "playground"};
};

/// Returns the motions that are wanted, in order.
std::vector<MotionFile> choose_motions(std::span<const MotionFile> motions, const MotionChoice& choice);

}  // namespace vesalius::synth
