#include "view/viewer_messages.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/files/options_file.h"
#include "stream/json_numbers.h"
#include "vesalius/base/options.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/person_json.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

/// Paths need not be UTF-8; JSON must.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

double hundredths(double value) { return rounded(value, 100.0); }

Json optional_json(const std::optional<double>& value) { return value ? Json(hundredths(*value)) : Json(); }

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

Json described(PeopleOptions options, bool track) {
  Describer describer;
  if (track) {
    visit_options("", options, describer);
  } else {
    visit_options("", options.detect, describer);
  }
  return std::move(describer.list);
}

/// Names and parents of the bones of fitted bodies.
Json bones_json() {
  Json bones = Json::array();
  for (const FleshBone& bone : builtin_flesh().bones) bones.push_back({{"name", bone.name}, {"parent", bone.parent}});
  return bones;
}

}  // namespace

std::string hello_message(const ViewerFacts& facts, const BodyModel& body) {
  Json known = Json::parse(part_table_json(body));
  Json links = Json::array();
  for (const BodyLink& link : body.links) links.push_back({link.parent, link.child});
  known["links"] = std::move(links);
  return text_of({{"type", "hello"},
                  {"source", facts.source},
                  {"model", facts.model},
                  {"folder", facts.folder},
                  {"track", facts.track},
                  {"choice", facts.choice.empty() ? Json() : Json(facts.choice)},
                  {"after", facts.after},
                  {"bones", bones_json()},
                  {"body", std::move(known)}});
}

std::string state_message(const ViewerState& state, const PlayerState& player) {
  Json saved;
  if (state.saved) {
    saved = {{"path", state.saved->path}, {"frames", state.saved->frames}, {"bytes", state.saved->bytes}};
  }
  const auto pair_of = [](const std::optional<TimeSpan>& span) {
    return span ? Json{span->first_s, span->last_s} : Json();
  };
  return text_of({{"type", "state"},
                  {"live", player.live},
                  {"playing", player.playing},
                  {"at_end", player.at_end},
                  {"repeat", player.repeat},
                  {"speed", player.speed},
                  {"at_s", player.at_s},
                  {"span_s", pair_of(player.span)},
                  {"loop_s", pair_of(player.loop)},
                  {"frames_per_s", hundredths(state.frames_per_s)},
                  {"frames", state.frames},
                  {"dropped", state.dropped},
                  {"result_ms", optional_json(state.result_ms)},
                  {"page_ms", optional_json(state.page_ms)},
                  {"pages", state.clients},
                  {"recording", state.recording},
                  {"recorded", state.recorded},
                  {"saved", std::move(saved)}});
}

std::string options_message(const PeopleOptions& options, const PeopleOptions& first, bool track) {
  Json list = described(options, track);
  const Json defaults = described(first, track);
  for (std::size_t i = 0; i < list.size(); ++i) list[i]["default"] = defaults[i]["value"];
  return text_of({{"type", "options"}, {"options", std::move(list)}});
}

std::string happenings_message(const Happenings& happenings) {
  Json events = Json::array();
  for (const Happening& event : happenings.events()) {
    events.push_back({{"at_s", rounded(event.at_s, 1e6)},
                      {"id", event.id},
                      {"what", event.what},
                      {"before", to_string(event.before)}});
  }
  return text_of({{"type", "happened"},
                  {"events", std::move(events)},
                  {"seen_s", happenings.seen().list()},
                  {"known_s", happenings.known().list()}});
}

std::string notice_message(const std::string& text) { return text_of({{"type", "notice"}, {"text", text}}); }

std::string sources_message(const ChoiceList& list, const std::vector<SensorInfo>& cameras) {
  Json entries = Json::array();
  for (const ChoiceEntry& entry : list.entries) {
    entries.push_back({{"name", entry.name}, {"folder", entry.is_folder}, {"opens", entry.opens}});
    if (entry.bytes) entries.back()["bytes"] = *entry.bytes;
  }
  Json plugged_in = Json::array();
  for (const SensorInfo& camera : cameras) plugged_in.push_back({{"source", camera.id}, {"name", camera.name}});
  return text_of({{"type", "sources"},
                  {"folder", list.folder},
                  {"entries", std::move(entries)},
                  {"left_out", list.left_out},
                  {"cameras", std::move(plugged_in)}});
}

std::string no_sources_message(const std::string& folder, const std::string& why) {
  return text_of({{"type", "sources"}, {"folder", folder}, {"error", why}});
}

void set_option(PeopleOptions& options, const std::string& name, const std::string& value_json) {
  const Json value = Json::parse(value_json);
  if (value.is_structured() || value.is_null()) {
    throw Error(fmt::format("option {}: found {}, expected a number, a text, true or false", name, value_json));
  }
  if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") != name.npos) {
    throw Error("option " + name + ": no such option");
  }
  PeopleOptions changed = options;
  const VisitAll visit = [&](OptionVisitor& visitor) { visit_options("", changed, visitor); };
  // A number, a text or a truth value of JSON is one of TOML too.
  parse_options(name + " = " + value.dump(), "option", visit);
  RangeCheck check;
  visit(check);
  options = changed;
}

}  // namespace vesalius
