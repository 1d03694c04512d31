#pragma once

namespace vesalius::cli {

/// After this call, Ctrl-C, a closed terminal and `kill` end the work after the current frame, so that no temporary
/// file remains. A second signal ends the program at once. Signals that the caller ignores (nohup, a background job)
/// stay ignored.
void watch_interrupts();

/// Returns whether a signal has arrived.
bool interrupted();

}  // namespace vesalius::cli
