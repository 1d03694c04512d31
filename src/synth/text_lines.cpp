#include "synth/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {

bool TextLines::next_line() {
  if (begin_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
  line_ = text_.substr(begin_, end - begin_);
  begin_ = end + 1;
  ++number_;
  return true;
}

std::string_view TextLines::word() {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  const std::size_t first = line_.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return line_ = {};
  line_.remove_prefix(first);
  const std::string_view found = line_.substr(0, line_.find_first_of(kBlanks));
  line_.remove_prefix(found.size());
  return found;
}

float TextLines::number(float limit) {
  const std::string_view text = word();
  float value = 0.F;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) < limit)) {
    fail(fmt::format("\"{}\": expected a number between -{} and {}", shown(text), limit, limit));
  }
  return value;
}

std::uint32_t TextLines::index() {
  const std::string_view text = word();
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    fail(fmt::format("\"{}\": expected a whole number from 0", shown(text)));
  }
  return value;
}

void TextLines::fail(const std::string& what) const { throw Error(fmt::format("{}:{}: {}", name_, number_, what)); }

std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out(text.substr(0, kLongest));
  std::ranges::replace_if(
      out, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kLongest ? out + "..." : out;
}

}  // namespace vesalius::synth
