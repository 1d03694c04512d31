#include "io/recordings/recording.h"

#include <fmt/format.h>

#include <cstdlib>

namespace vesalius {

std::string name_of_time(std::int64_t time_ns) {
  return fmt::format("{}.{:09}", time_ns / kNanoseconds, std::abs(time_ns % kNanoseconds));
}

std::string short_type(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = type.find(kMiddle);
  if (middle == type.npos) return std::string(type);
  return fmt::format("{}/{}", type.substr(0, middle), type.substr(middle + kMiddle.size()));
}

}  // namespace vesalius
