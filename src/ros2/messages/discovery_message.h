#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace vesalius::ros2 {

/// Number by which DDS knows an endpoint.
using Gid = std::array<std::uint8_t, 16>;

/// A node and what it reads and writes.
struct NodeEntities {
  std::string name_space, name;
  std::vector<Gid> readers, writers;
};

/// Bytes of a gid in messages: 24 up to ROS 2 Humble, of which 8 are zero, 16 from Iron on.
inline constexpr std::size_t kGidBytes = 16, kOldGidBytes = 24;

/// Returns the rmw_dds_common/ParticipantEntitiesInfo of a process with one node as CDR: what `ros2 node list` reads.
std::string discovery_message(const Gid& participant, const NodeEntities& node, std::size_t gid_bytes);

}  // namespace vesalius::ros2
