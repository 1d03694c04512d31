#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace vesalius::synth {

/// Parses untrusted JSON: at most 4 million values, nested at most 100 deep. `name` is used as the path in errors.
/// Throws Error naming the line and what was expected.
nlohmann::json parse_json(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
