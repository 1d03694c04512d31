#include "synth/text/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kMaxShown = 40;
constexpr double kMaxNumber = 1e6;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Removes a plus sign, which from_chars does not accept.
std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

}  // namespace

std::string shown(std::string_view text) {
  std::string out(text.substr(0, kMaxShown));
  std::ranges::replace_if(
      out, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text.size() > kMaxShown ? out + "..." : out;
}

std::string in_quotes(std::string_view text) { return fmt::format("\"{}\"", shown(text)); }

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

void TextScanner::fail(const std::string& what) const {
  throw Error(fmt::format("{}:{}: {}", name_, word_line_, what));
}

bool TextScanner::at_end() {
  for (; at_ < text_.size() && is_space(text_[at_]); ++at_) {
    if (text_[at_] == '\n') ++line_;
  }
  return at_ == text_.size();
}

bool TextScanner::at_line_end() { return at_end() || line_ != word_line_; }

std::string_view TextScanner::peek() {
  if (at_end()) return {};
  const auto* end = std::find_if(text_.begin() + at_, text_.end(), is_space);
  return text_.substr(at_, static_cast<std::size_t>(end - text_.begin()) - at_);
}

std::string_view TextScanner::word(std::string_view what) {
  const std::string_view found = peek();
  word_line_ = line_;
  if (found.empty()) fail(fmt::format("expected {}, found the end of the file", what));
  at_ += found.size();
  return found;
}

void TextScanner::expect(std::string_view expected) {
  const std::string_view found = word(expected);
  if (found != expected) fail(fmt::format("expected {}, found {}", expected, in_quotes(found)));
}

double TextScanner::number(std::string_view what) {
  const std::string_view found = without_plus(word(what));
  double value = 0.0;
  const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
  // For from_chars a number too small for a double ("1e-400") is out of range; it means 0.
  if (error == std::errc::result_out_of_range && end == found.data() + found.size() &&
      found.find("e-") != std::string_view::npos) {
    return 0.0;
  }
  if (error != std::errc() || end != found.data() + found.size() || !(std::abs(value) <= kMaxNumber)) {
    fail(fmt::format("expected {} (a number up to {:g}), found {}", what, kMaxNumber, in_quotes(found)));
  }
  return value;
}

int TextScanner::whole(std::string_view what, int low, int high) {
  const std::string_view found = without_plus(word(what));
  int value = 0;
  const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
  if (error != std::errc() || end != found.data() + found.size() || value < low || value > high) {
    fail(fmt::format("expected {} (a whole number from {} to {}), found {}", what, low, high, in_quotes(found)));
  }
  return value;
}

void TextScanner::skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

}  // namespace vesalius::synth
