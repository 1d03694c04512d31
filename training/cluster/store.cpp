#include "cluster/store.h"

#include <fmt/format.h>

#include <algorithm>

#include "vesalius/error.h"

namespace vesalius {
namespace {

bool is_allowed(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

bool is_part(std::string_view part) {
  return !part.empty() && part != "." && part != ".." && std::all_of(part.begin(), part.end(), is_allowed);
}

}  // namespace

bool is_temporary_name(const std::string& name) { return name.find(".tmp") != name.npos; }

bool is_store_name(std::string_view name) {
  for (std::size_t slash = name.find('/'); slash != name.npos; slash = name.find('/')) {
    if (!is_part(name.substr(0, slash))) return false;
    name.remove_prefix(slash + 1);
  }
  return is_part(name);
}

void check_store_name(const std::string& name) {
  if (is_temporary_name(name)) throw UsageError(fmt::format("\"{}\": .tmp is kept for files being written", name));
  if (!is_store_name(name)) {
    throw UsageError(fmt::format("\"{}\": expected a relative name of letters, digits, '.', '_' and '-'", name));
  }
}

void check_store_folder(const std::string& name) {
  if (!name.empty()) check_store_name(name);
}

}  // namespace vesalius
