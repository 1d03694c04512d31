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
  std::vector<TimedAcceleration> measured;
  bool is_first = true;
  each_line(without_byte_order(text), kBetween, [&](std::string_view line, int number) {
    if (const auto numbers = numbers_of(line)) {
      const auto& values = *numbers;
      measured.push_back({clock_seconds(values[0]), {values[1], values[2], values[3]}});
    } else if (!is_first) {
      throw Error(fmt::format("{}:{}: expected \"time_s,x,y,z\", four numbers", name, number));
    }
    is_first = false;
  });
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
