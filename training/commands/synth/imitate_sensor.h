#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "synth/recipe.h"
#include "synth/sensor/depth_statistics.h"

namespace vesalius::cli {

/// The pictures of one camera, measured.
struct MeasuredCamera {
  Camera camera;
  int frames = 0;
  synth::DepthFigures figures;
  std::vector<std::string> notes{};  ///< of the source, such as a guessed focal length
};

/// Reads at most so many frames, spread evenly over a source that can seek, and measures them. Throws Error if it has
/// none, if its camera changes its size, or if no pixel has a reading.
MeasuredCamera measure_source(const std::string& uri, int most_frames);

/// Returns how unlike real pictures rendered ones are: the mean absolute logarithm of the ratio of those figures that
/// do not depend on what is in view, where both were measured. 0 is alike; 0.7 is a factor of 2, 1.5 the most. Steps of
/// depth count only where the real ones are no single millimetres: whoever resized or filtered pictures took them away.
double unlikeness(const synth::DepthFigures& rendered, const synth::DepthFigures& real);

/// A sensor's options that make rendered frames like real ones.
struct Imitation {
  synth::SensorOptions sensor;
  synth::DepthFigures preset;   ///< figures of frames with the best preset alone
  synth::DepthFigures figures;  ///< figures with these options
};

/// Finds the options whose frames are least unlike the measured ones, one after the other, from `preset` on, or from
/// the best preset of each kind of sensor if that is empty. For each of these, at most 123 times `frames` rooms with
/// people are rendered, the same ones each time. `recipe` says of what; its sensor's options are not used. Options of
/// which pictures tell nothing keep their defaults: focal-error, stray-light-max. Throws UsageError for an unknown
/// preset, and Error when the user interrupts.
Imitation imitate(const MeasuredCamera& real, const std::string& preset, const synth::Recipe& recipe, int frames,
                  std::uint64_t seed, bool shown);

/// Returns the options as TOML that --recipe reads, below a table of figures in comments: the real frames', those of
/// the preset alone and those of the options.
std::string imitation_toml(const std::string& uri, const MeasuredCamera& real, const Imitation& imitation);

}  // namespace vesalius::cli
