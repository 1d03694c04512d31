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

/// Returns the four words of a line; nothing of other lines.
std::optional<std::array<std::string_view, 4>> four_words(std::string_view line) {
  std::array<std::string_view, 4> words;
  for (std::string_view& word : words) {
    word = line.substr(0, line.find_first_of(kBetween));
    line = trimmed(line.substr(word.size()), kBetween);
    if (word.empty()) return std::nullopt;
  }
  return line.empty() ? std::optional(words) : std::nullopt;
}

/// Returns the four numbers of a line; nothing of other lines.
std::optional<std::array<double, 4>> four_numbers(std::string_view line) {
  const auto words = four_words(line);
  if (!words) return std::nullopt;
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto value = number_of((*words)[i]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    numbers[i] = *value;
  }
  return numbers;
}

bool is_name(std::string_view word) { return is_letter(word.front()); }

/// Returns whether a line has four names: "time_s,x,y,z".
bool has_names(std::string_view line) {
  const auto words = four_words(line);
  return words && std::ranges::all_of(*words, is_name);
}

}  // namespace

std::vector<TimedAcceleration> parse_accelerations(std::string_view text, const std::string& name) {
  std::vector<TimedAcceleration> measured;
  bool is_first = true;
  each_line(without_byte_order(text), kBetween, [&](std::string_view line, int number) {
    if (const auto numbers = four_numbers(line)) {
      const auto& values = *numbers;
      measured.push_back({clock_seconds(values[0]), {values[1], values[2], values[3]}});
    } else if (!is_first || !has_names(line)) {
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
