#include "io/sources/acceleration_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "io/files/plain_text.h"
#include "io/sources/fact_tree.h"
#include "io/sources/picture_files.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kBetween = " \t\r,";

/// Returns the four numbers of a line; nothing of other lines.
std::optional<std::array<double, 4>> numbers_of(std::string_view line) {
  std::array<double, 4> numbers{};
  for (double& number : numbers) {
    const std::size_t end = std::min(line.find_first_of(kBetween), line.size());
    const auto value = number_of(line.substr(0, end));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    number = *value;
    line = trimmed(line.substr(end), kBetween);
  }
  return line.empty() ? std::optional(numbers) : std::nullopt;
}

}  // namespace

std::vector<TimedAcceleration> parse_accelerations(std::string_view text, const std::string& name) {
  const std::string plain = without_byte_order(text);
  std::string_view rest = plain;
  std::vector<TimedAcceleration> measured;
  bool is_first = true;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trimmed(rest.substr(0, end), kBetween);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line.front() == '#') continue;
    const auto numbers = numbers_of(line);
    if (numbers) {
      const auto& [time_s, x, y, z] = *numbers;
      measured.push_back({clock_seconds(time_s), {x, y, z}});
    } else if (!is_first) {
      throw Error(fmt::format("{}:{}: expected \"time_s,x,y,z\", four numbers", name, number));
    }
    is_first = false;
  }
  std::ranges::stable_sort(measured, {}, &TimedAcceleration::time_s);
  return measured;
}

std::string serialise_accelerations(const std::vector<TimedAcceleration>& measured) {
  std::string text = "time_s,x,y,z\n";
  for (const TimedAcceleration& one : measured)
    text += fmt::format("{},{:.4f},{:.4f},{:.4f}\n", one.time_s, one.m_s2.x(), one.m_s2.y(), one.m_s2.z());
  return text;
}

}  // namespace vesalius
