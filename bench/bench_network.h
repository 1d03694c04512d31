#pragma once

namespace vesalius {

/// Registers the benchmarks of running networks of two sizes and random weights on 320x256 pixels: on all processors,
/// and on one of them for every instruction set of this machine.
void add_network_benchmarks();

}  // namespace vesalius
