#pragma once

#include <csignal>
#include <thread>
#include <utility>

namespace vesalius {

/// Starts a thread that leaves all signals to the other threads of the program.
template <class Work>
std::jthread quiet_thread(Work work) {
  return std::jthread([work = std::move(work)] {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    work();
  });
}

}  // namespace vesalius
