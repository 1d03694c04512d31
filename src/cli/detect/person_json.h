#pragma once

#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// One line of JSON about a frame (docs/formats.md): people with box (pixels), parts and joints (metres, optical
/// frame). Every part and joint is listed; where the state is "none" xyz_m is null.
std::string frame_json(const Frame& frame, const std::vector<Person>& people, const BodyModel& body);

/// The table that goes with label pictures: number, name, colour and mirror partner of each part.
std::string part_table_json(const BodyModel& body);

}  // namespace vesalius::cli
