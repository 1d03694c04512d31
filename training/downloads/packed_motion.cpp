#include "downloads/packed_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kEvery = 4;
constexpr int kDecimals = 2, kRootDecimals = 3, kTimeDecimals = 7;
constexpr std::string_view kSpace = " \t\r\n\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kSpace), text.size());
  return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

/// Takes the next word off a line; returns "" at its end.
std::string_view next_word(std::string_view& line) {
  line = trimmed(line);
  const std::string_view word = line.substr(0, line.find_first_of(kSpace));
  line.remove_prefix(word.size());
  return word;
}

/// The lines of a text that are not empty, without white space around them.
class Lines {
 public:
  Lines(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  /// Returns "" at the end.
  std::string_view next() {
    std::string_view line;
    while (line.empty() && !rest_.empty()) {
      const std::size_t length = std::min(rest_.find('\n'), rest_.size());
      line = trimmed(rest_.substr(0, length));
      rest_.remove_prefix(std::min(length + 1, rest_.size()));
      ++number_;
    }
    return line;
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}:{}: {}", name_, number_, what)); }

  double number(std::string_view word) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail("expected numbers");
    return value;
  }

 private:
  std::string_view rest_;
  const std::string& name_;
  int number_ = 0;
};

/// Returns a number as printf's %.*f has it: a number half-way between two is rounded by its binary value.
std::string fixed(double value, int decimals) {
  std::array<char, 512> digits{};  // the largest double has 309 before the point
  return {digits.data(), std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed, decimals).ptr};
}

std::string rounded(double value, int decimals) {
  std::string text = fixed(value, decimals);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

/// Returns the numbers of a line with one space between.
std::string rounded_line(const Lines& lines, std::string_view line, int decimals) {
  std::string out;
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
    out.append(out.empty() ? "" : " ").append(rounded(lines.number(word), decimals));
  }
  return out;
}

std::string packed_bvh(std::string_view text, const std::string& name) {
  constexpr std::string_view kTime = "Frame Time:";
  Lines lines(text, name);
  std::string_view line = lines.next();
  while (!line.empty() && !line.starts_with(kTime)) line = lines.next();
  if (line.empty()) lines.fail(fmt::format("expected \"{}\" before the end", kTime));
  const double frame_s = lines.number(trimmed(line.substr(kTime.size())));
  std::string frames;
  int count = 0;
  for (line = lines.next(); !line.empty(); line = lines.next()) {
    if (count++ % kEvery == 0) frames += rounded_line(lines, line, kDecimals) + "\n";
  }
  const std::string_view head = text.substr(0, text.find("MOTION"));
  return fmt::format("{}\nMOTION\nFrames: {}\nFrame Time: {}\n{}", head.substr(0, head.find_last_not_of(kSpace) + 1),
                     (count + kEvery - 1) / kEvery, fixed(frame_s * kEvery, kTimeDecimals), frames);
}

std::string packed_amc(std::string_view text, const std::string& name, const std::string& skeleton) {
  std::string out = fmt::format("#!OML:ASF {}\n:FULLY-SPECIFIED\n:DEGREES\n", skeleton);
  Lines lines(text, name);
  int count = 0;
  for (std::string_view line = lines.next(); !line.empty(); line = lines.next()) {
    if (line.starts_with('#') || line.starts_with(':')) continue;
    const bool begins = std::ranges::all_of(line, [](char c) { return c >= '0' && c <= '9'; });
    if (begins) ++count;
    if (count == 0 || (count - 1) % kEvery != 0) continue;
    if (begins) {
      out += fmt::format("{}\n", (count - 1) / kEvery + 1);
      continue;
    }
    const std::string_view bone = next_word(line);
    out.append(bone).append(" ");
    out += rounded_line(lines, line, bone == "root" ? kRootDecimals : kDecimals) + "\n";
  }
  if (count == 0) lines.fail("expected a frame before the end");
  return out;
}

}  // namespace

std::string packed_motion(std::string_view original, const std::string& name, const std::string& skeleton) {
  if (!name.ends_with(".bvh") && !name.ends_with(".amc")) return std::string(original);
  std::string text(original);
  std::erase(text, '\r');
  return name.ends_with(".bvh") ? packed_bvh(text, name) : packed_amc(text, name, skeleton);
}

}  // namespace vesalius
