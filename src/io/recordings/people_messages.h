#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns a visualization_msgs/MarkerArray as CDR that shows people and nothing from before: of each the links between
/// its parts, the parts as balls in their colours (predicted ones paler), and above the head its index and score, or id
/// and state of those who are followed; without those who are lost.
std::string markers_message(const TrackedFrame& people, const BodyModel& body, std::int64_t time_ns,
                            std::string_view frame);

/// Returns the fields of a ROS 2 type that is recorded, and of all that it is made of, as ROS 2 describes them.
std::string message_definition(std::string_view type);

}  // namespace vesalius
