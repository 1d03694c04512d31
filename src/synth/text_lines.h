#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vesalius::synth {

/// Reads a text line by line and word by word; words are cut at blanks.
class TextLines {
 public:
  TextLines(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  /// Goes to the next line; false at the end.
  bool next_line();
  /// Next word of the line, empty at its end.
  std::string_view word();
  /// Next word as a finite number whose size is below `limit`.
  float number(float limit);
  /// Next word as a whole number from 0.
  std::uint32_t index();
  /// Throws Error "name:line: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view text_;
  const std::string& name_;
  std::string_view line_;
  std::size_t begin_ = 0;
  std::size_t number_ = 0;
};

/// A stranger's text cut to a length and characters fit for a one-line message.
std::string shown(std::string_view text);

}  // namespace vesalius::synth
