#pragma once

#include "vesalius/image.h"
#include "vesalius/network/run_network.h"

namespace vesalius {

/// Steps of a network's input channels in 1.
inline constexpr float kNetworkSteps = 32.F;
/// Finer steps of how near a pixel is in one of its coarse ones.
inline constexpr int kNearFiner = 4;

/// Writes what a network sees of a depth picture in millimetres, padded to whole kNetworkMultiple: of every pixel with
/// a reading how near it is (twice the pixels a metre over 285, minus .7; in coarse steps, then what is left of it in
/// finer ones), that there is a reading, and how steep the surface is across and down (metres a metre across; 0 beside
/// holes). So pictures of every focal length are of one scale, and nothing else is known of the camera.
void fill_network_input(const DepthImage& depth, float focal_px, NetworkInput& input);

}  // namespace vesalius
