#pragma once

#include <string>
#include <string_view>

struct ddsi_serdata;
struct ddsi_sertype;

namespace vesalius::ros2 {

/// Returns a type for Cyclone DDS whose samples are messages as CDR, bytes that pass as they are: writers take a
/// std::string_view. `name` is the type's on the wire (type_on_wire). Whoever creates a topic with it owns it then.
ddsi_sertype* make_byte_type(const std::string& name);

/// Returns the message of a sample that was taken; valid as long as the sample is.
std::string_view message_of(const ddsi_serdata& sample);

}  // namespace vesalius::ros2
