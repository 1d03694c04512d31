#pragma once

#include <string>
#include <string_view>

namespace vesalius::synth {

/// Reads the words of a text one by one and knows the line of each, for errors of the form "name:line: what".
class TextScanner {
 public:
  /// `text` must outlive the scanner; `name` stands for the file in errors.
  TextScanner(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  /// Throws Error naming the line of the last word.
  [[noreturn]] void fail(const std::string& what) const;

  /// Returns whether no word is left.
  bool at_end();
  /// Returns whether no word is left on the line of the last word.
  bool at_line_end();
  /// The next word without taking it; empty at the end.
  std::string_view peek();
  /// Takes the next word; `what` was expected if there is none.
  std::string_view word(std::string_view what);
  /// Takes the next word, which must be this one.
  void expect(std::string_view expected);
  /// Takes a finite number with |value| <= 1e6.
  double number(std::string_view what);
  /// Takes a whole number from `low` to `high`.
  int whole(std::string_view what, int low, int high);
  void skip_line();

  /// Bytes not read yet: bounds what a file can still hold before memory is set aside for it.
  std::size_t bytes_left() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;       ///< of at_
  int word_line_ = 1;  ///< of the last word
};

/// A stranger's text cut to a length and characters fit for a one-line message, bare and between quotes.
std::string shown(std::string_view text);
std::string in_quotes(std::string_view text);

/// Returns whether the two are the same but for the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

}  // namespace vesalius::synth
