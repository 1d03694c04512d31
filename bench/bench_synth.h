#pragma once

namespace vesalius {

/// Registers the benchmarks of making synthetic frames: a whole frame and its stages at 320x240 and 640x480 with Kinect
/// v1 noise and without colour, and the steps that make a new body. They use built-in bodies and, if `vesalius assets`
/// has fetched both packages (into VESALIUS_ASSETS or the default folder), MakeHuman's bodies and captured poses.
void add_synth_benchmarks();

}  // namespace vesalius
