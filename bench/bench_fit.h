#pragma once

namespace vesalius {

/// Registers the benchmarks of fitting a body to one person on one thread: the first fit of the people in data/rooms,
/// and fits that go on from the last frame's body of those in data/sample. Times are means over all people and frames.
void add_fit_benchmarks();

}  // namespace vesalius
