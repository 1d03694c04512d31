#include "view/people_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "export/stand_upright.h"
#include "export/write_people.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kPeople = "/people";

WebResponse no_people(const std::string& why) { return {"text/plain; charset=utf-8", why + "\n", false, {}, 404, {}}; }

WebResponse who_there_is(const PeopleLog& log) {
  nlohmann::ordered_json people = nlohmann::ordered_json::array();
  for (const LoggedPerson& person : log.people()) {
    people.push_back({{"id", person.id}, {"frames", person.frames}, {"bodies", person.bodies}});
  }
  const nlohmann::ordered_json all{{"frames", log.frames()},
                                   {"forgotten", log.forgotten()},
                                   {"most_bytes", log.most_bytes()},
                                   {"people", std::move(people)}};
  return {"application/json", all.dump(), false, {}};
}

WebResponse file_of(const PeopleLog& log, const ExportFormat& format, std::optional<int> person,
                    const std::string& name) {
  const std::vector<LoggedPerson> people = log.people();
  if (people.empty()) return no_people("nobody was found yet, so there is no one to save");
  const bool bodies = format.joints.empty();
  if (bodies && std::ranges::none_of(people, [](const LoggedPerson& one) { return one.bodies > 0; })) {
    return no_people("nobody has a fitted body yet, expected people who are followed over frames");
  }
  if (person && std::ranges::count(people, *person, &LoggedPerson::id) == 0) {
    return no_people(fmt::format("person {} is not known, or not any more", *person));
  }
  try {
    PeopleRecord record = log.record(bodies);
    if (format.stands) stand_upright(record);
    if (format.files != nullptr && !person) {
      const std::vector<int> ids = format.files(record);
      if (ids.size() > 1)
        return no_people(format.name + " has one person in a file: expected people-ID" + format.ending);
      person = ids.front();
    }
    return {"application/octet-stream", format.write(record, {0, person, name, name}), false, name};
  } catch (const Error& e) {
    return no_people(e.what());
  }
}

/// Returns the person of "-3", nothing of "".
std::optional<int> person_of(std::string_view text) {
  int id = 0;
  if (text.empty() || std::from_chars(text.data() + 1, text.data() + text.size(), id).ec != std::errc()) return {};
  return id;
}

}  // namespace

std::optional<WebResponse> people_response(const std::shared_ptr<const PeopleLog>& log, const std::string& path) {
  if (!path.starts_with(kPeople)) return std::nullopt;
  WebResponse later;
  if (path == "/people.json") {
    later.make = [log] { return who_there_is(*log); };
    return later;
  }
  const std::string ending = std::filesystem::path(path).extension().string();
  const std::string middle = path.substr(kPeople.size(), path.size() - kPeople.size() - ending.size());
  const auto format = std::ranges::find(export_formats(), ending, &ExportFormat::ending);
  const std::optional<int> person = person_of(middle);
  const bool is_whole = middle == (person ? fmt::format("-{}", *person) : "");
  if (ending.empty() || format == export_formats().end() || !is_whole || (person && !format->of_one))
    return std::nullopt;
  later.make = [log, &format = *format, person, name = path.substr(1)] { return file_of(*log, format, person, name); };
  return later;
}

}  // namespace vesalius
