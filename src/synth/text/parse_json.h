#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace vesalius::synth {

/// Parses JSON that a stranger wrote: at most 4 million values, nested at most 100 deep. `name` stands for the file in
/// errors. Throws Error naming the line and what was expected.
nlohmann::json parse_json(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
