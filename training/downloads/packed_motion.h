#pragma once

#include <string>
#include <string_view>

namespace vesalius {

/// Returns the file of the package mocap that is made from a published one, whose motion has 120 frames a second: its
/// every 4th frame, beginning with the first, with numbers of at most two decimals (three on lines of an AMC's root).
/// `name` is the package's file and its ending the format: of a .bvh all before the frames is kept; an .amc gets a head
/// of three lines that names `skeleton`, and frames are counted from 1; others are returned as they are. Lines end in
/// LF. Throws Error naming `name` and the line if there is no motion or a number is none.
std::string packed_motion(std::string_view original, const std::string& name, const std::string& skeleton);

}  // namespace vesalius
