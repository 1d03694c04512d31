#pragma once

#include <string>
#include <string_view>

namespace vesalius::synth {

/// Reads the words of a text one by one and knows the line of each, for errors of the form "name:line: what".
class TextScanner {
 public:
  /// `text` must outlive the scanner; `name` is used as the path in errors.
  TextScanner(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  /// Throws Error naming the line of the last word.
  [[noreturn]] void fail(const std::string& what) const;

  /// Returns whether no word is left.
  bool at_end();
  /// Returns whether no word is left on the line of the last word.
  bool at_line_end();
  /// Returns the next word without taking it; empty at the end.
  std::string_view peek();
  /// Takes the next word. If there is none, the error says that `what` was expected.
  std::string_view word(std::string_view what);
  /// Takes the next word, which must be this one.
  void expect(std::string_view expected);
  /// Takes a finite number with |value| <= 1e6.
  double number(std::string_view what);
  /// Takes a whole number from `low` to `high`.
  int whole(std::string_view what, int low, int high);
  void skip_line();

  /// Returns the bytes not yet read. They bound the content that can follow, before memory is allocated for it.
  std::size_t bytes_left() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;       ///< line of at_
  int word_line_ = 1;  ///< line of the last word
};

/// Shortens untrusted text and replaces characters such that it fits in a one-line message, bare or in quotes.
std::string shown(std::string_view text);
std::string in_quotes(std::string_view text);

/// Returns whether two words are equal, ignoring the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

}  // namespace vesalius::synth
