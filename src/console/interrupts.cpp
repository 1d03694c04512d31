#include "console/interrupts.h"

#include <csignal>
#include <initializer_list>

namespace vesalius::cli {
namespace {

volatile std::sig_atomic_t came = 0;

}  // namespace

void watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { came = 1; };
  action.sa_flags = SA_RESETHAND;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

bool interrupted() { return came != 0; }

}  // namespace vesalius::cli
