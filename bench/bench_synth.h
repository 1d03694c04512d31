#pragma once

namespace vesalius {

/// Registers the benchmarks of making synthetic frames: a whole frame and its stages at 320x240 and 640x480 with Kinect
/// v1 noise and no colour, and the steps that a new body takes; with built-in bodies, and with MakeHuman's and captured
/// poses where `vesalius assets` put both packages (VESALIUS_ASSETS names another folder).
void add_synth_benchmarks();

}  // namespace vesalius
