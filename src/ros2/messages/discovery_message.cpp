#include "ros2/messages/discovery_message.h"

#include "io/recordings/message_fields.h"

namespace vesalius::ros2 {
namespace {

void write_gid(CdrWriter& out, const Gid& gid, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) out.u8(i < gid.size() ? gid[i] : std::uint8_t{0});
}

void write_gids(CdrWriter& out, const std::vector<Gid>& gids, std::size_t bytes) {
  out.u32(static_cast<std::uint32_t>(gids.size()));
  for (const Gid& gid : gids) write_gid(out, gid, bytes);
}

}  // namespace

std::string discovery_message(const Gid& participant, const NodeEntities& node, std::size_t gid_bytes) {
  CdrWriter out;
  write_gid(out, participant, gid_bytes);
  out.u32(1);  // nodes
  out.text(node.name_space);
  out.text(node.name);
  write_gids(out, node.readers, gid_bytes);
  write_gids(out, node.writers, gid_bytes);
  return out.message();
}

}  // namespace vesalius::ros2
