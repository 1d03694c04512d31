#include "io/sensors/sensor.h"

#include <fmt/format.h>

#include <algorithm>

#include "vesalius/error.h"

namespace vesalius {

std::string source_of(std::string_view scheme, const std::string& id) {
  return id.empty() ? std::string(scheme) : fmt::format("{}:{}", scheme, id);
}

void expect_plugged_in(std::string_view scheme, const std::vector<SensorInfo>& cameras, const std::string& id) {
  const bool known = std::ranges::find(cameras, id, &SensorInfo::id) != cameras.end();
  if (known || (id.empty() && cameras.size() == 1)) return;
  const std::string place = source_of(scheme, id);
  if (cameras.empty()) {
    throw Error(place + ": no camera is plugged in, expected one that `vesalius cameras` lists");
  }
  std::string sources;
  for (const SensorInfo& one : cameras) sources += (sources.empty() ? "" : ", ") + source_of(scheme, one.id);
  const std::string why = id.empty() ? fmt::format("{} cameras", cameras.size()) : "no such camera";
  throw Error(fmt::format("{}: {}, expected one of {}", place, why, sources));
}

void fail_to_open(const std::string& source, const std::string& reason) {
  throw Error(fmt::format(
      "{} cannot be opened{}{}; end any other program that uses it, or see docs/cameras.md on the right to use it",
      source, reason.empty() ? "" : ": ", reason));
}

}  // namespace vesalius
