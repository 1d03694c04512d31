#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commands/train/model_recipe.h"

namespace vesalius::cli {

/// Where a network is learned.
struct NetworkRun {
  std::vector<std::string> frames, held_out;  ///< datasets, whole
  std::string folder;                         ///< where the training stands, and network.npz is left
  std::string device = "cpu";                 ///< cpu, cuda, cuda:N or auto
  std::uint64_t max_bytes = 0;                ///< for frames, of the processor's memory
  bool restart = false;                       ///< whether to forget the training in the folder
  bool shown = true;                          ///< whether to pass progress on to standard error
};

/// Throws Error if there is no Python with what the tool (training/network) needs, or the training cannot begin with
/// what it is to.
void expect_network_tool(const NetworkOptions& options);

/// Learns a network by the tool, in a process of its own, or goes on with what is in the folder. Returns the path of
/// the network. Throws Error with what the tool says where it fails, and when the user interrupts; the training is kept
/// then.
std::string learn_network(const NetworkOptions& options, const NetworkRun& run);

}  // namespace vesalius::cli
