#include "view/viewer_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/files/options_file.h"
#include "vesalius/base/error.h"
#include "vesalius/base/options.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

/// Paths need not be UTF-8; JSON must.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

double rounded(double value, double steps = 100) { return std::round(value * steps) / steps; }

Json optional_json(const std::optional<double>& value) { return value ? Json(rounded(*value)) : Json(); }

/// A float as its shortest text says it: 0.3, not 0.30000001192092896.
double shortest(float value) { return std::stod(fmt::format("{}", value)); }

/// Describes every option with its value and its default.
class Describer : public OptionVisitor {
 public:
  Json list = Json::array();

  void option(const std::string& name, float& value, const OptionInfo& info) override {
    add(name, "number", shortest(value), info);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    add(name, "integer", value, info);
  }
  void option(const std::string& name, bool& value, const OptionInfo& info) override {
    add(name, "boolean", value, info);
  }
  void option(const std::string& name, std::string& value, const OptionInfo& info) override {
    add(name, "text", value, info);
  }

 private:
  void add(const std::string& name, const char* type, Json value, const OptionInfo& info) {
    list.push_back({{"name", name},
                    {"type", type},
                    {"value", std::move(value)},
                    {"low", info.low},
                    {"high", info.high},
                    {"unit", info.unit},
                    {"help", info.help}});
  }
};

Json described(DetectOptions options) {
  Describer describer;
  visit_options("", options, describer);
  return std::move(describer.list);
}

}  // namespace

std::string hello_message(const ViewerFacts& facts, const BodyModel& body) {
  Json parts = Json::array();
  for (const BodyPart& part : body.parts) {
    parts.push_back(
        {{"name", part.name}, {"colour", {part.colour.r, part.colour.g, part.colour.b}}, {"mirror", part.mirror}});
  }
  Json links = Json::array();
  for (const BodyLink& link : body.links) links.push_back({link.parent, link.child});
  return text_of({{"type", "hello"},
                  {"source", facts.source},
                  {"model", facts.model},
                  {"folder", facts.folder},
                  {"body", {{"name", body.name}, {"parts", std::move(parts)}, {"links", std::move(links)}}}});
}

std::string state_message(const ViewerState& state, const PlayerState& player) {
  Json span;
  if (player.span) span = {player.span->first_s, player.span->last_s};
  return text_of({{"type", "state"},
                  {"live", player.live},
                  {"playing", player.playing},
                  {"at_end", player.at_end},
                  {"repeat", player.repeat},
                  {"speed", player.speed},
                  {"at_s", player.at_s},
                  {"span_s", std::move(span)},
                  {"frames_per_s", rounded(state.frames_per_s)},
                  {"frames", state.frames},
                  {"dropped", state.dropped},
                  {"result_ms", optional_json(state.result_ms)},
                  {"page_ms", optional_json(state.page_ms)},
                  {"pages", state.clients},
                  {"stages", state.stages},
                  {"recording", state.recording},
                  {"recorded", state.recorded}});
}

std::string options_message(const DetectOptions& options) {
  Json list = described(options);
  const Json defaults = described({});
  for (std::size_t i = 0; i < list.size(); ++i) list[i]["default"] = defaults[i]["value"];
  return text_of({{"type", "options"}, {"options", std::move(list)}});
}

std::string notice_message(const std::string& text) { return text_of({{"type", "notice"}, {"text", text}}); }

void set_option(DetectOptions& options, const std::string& name, const std::string& value_json) {
  const Json value = Json::parse(value_json);
  if (value.is_structured() || value.is_null()) {
    throw Error(fmt::format("option {}: found {}, expected a number, a text, true or false", name, value_json));
  }
  if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") != name.npos) {
    throw Error("option " + name + ": no such option");
  }
  DetectOptions changed = options;
  const VisitAll visit = [&](OptionVisitor& visitor) { visit_options("", changed, visitor); };
  // A number, a text or a truth value of JSON is one of TOML too.
  parse_options(name + " = " + value.dump(), "option", visit);
  RangeCheck check;
  visit(check);
  options = changed;
}

}  // namespace vesalius
