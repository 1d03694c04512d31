#pragma once

#include <memory>
#include <optional>
#include <string>

#include "view/people_log.h"
#include "view/web_server.h"

namespace vesalius {

/// Answers a request for what is known of people: /people.json for who there is (docs/formats.md), /people.csv and
/// other endings of `vesalius export` for a file, /people-3.bvh for that of person 3 where a file has one. Nothing for
/// other paths. What is not there gets status 404 with the reason in a line. All is made when it is called for
/// (WebResponse::make).
std::optional<WebResponse> people_response(const std::shared_ptr<const PeopleLog>& log, const std::string& path);

}  // namespace vesalius
