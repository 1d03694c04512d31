#pragma once

namespace vesalius::cli {

/// From here on Ctrl-C, a closed terminal and `kill` end the work after the frame at hand, so that no temporary file
/// stays; the second one ends it at once. What the caller ignores (nohup, a job in the background) stays ignored.
void watch_interrupts();

/// Whether one has come.
bool interrupted();

}  // namespace vesalius::cli
