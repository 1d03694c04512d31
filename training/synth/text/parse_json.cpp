#include "synth/text/parse_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "vesalius/error.h"

namespace vesalius::synth {

using nlohmann::json;

json parse_json(std::string_view text, const std::string& name) {
  constexpr std::size_t kMostValues = 4'000'000;
  constexpr int kDeepest = 100;
  std::size_t values = 0;
  const auto within_limits = [&](int depth, json::parse_event_t /*event*/, json& /*value*/) {
    if (depth > kDeepest) throw Error(fmt::format("{}: JSON nested deeper than {} levels", name, kDeepest));
    if (++values > kMostValues) throw Error(fmt::format("{}: more than {} JSON values", name, kMostValues));
    return true;
  };
  try {
    return json::parse(text, within_limits);
  } catch (const json::parse_error& e) {
    const auto line = 1 + std::ranges::count(text.substr(0, std::min(e.byte, text.size())), '\n');
    throw Error(fmt::format("{}:{}: not valid JSON", name, line));
  } catch (const json::out_of_range&) {
    throw Error(fmt::format("{}: not valid JSON: a number beyond all bounds", name));
  }
}

}  // namespace vesalius::synth
