#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace vesalius {

/// Returns a text in lower case.
inline std::string lower(std::string_view text) {
  std::string all(text);
  std::ranges::transform(all, all.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return all;
}

/// Returns the letters and digits of a text in lower case: "Kannala-Brandt_4" and "kannalabrandt4" are the same.
inline std::string letters_and_digits(std::string_view text) {
  std::string all = lower(text);
  std::erase_if(all, [](unsigned char c) { return std::isalnum(c) == 0; });
  return all;
}

/// Returns a number with its noun: "1 frame", "2 frames". `plural` is the noun with an s where it is not given.
inline std::string counted(std::int64_t count, std::string_view noun, std::string_view plural = "") {
  std::string text = std::to_string(count) + ' ';
  if (count == 1) return text.append(noun);
  return plural.empty() ? text.append(noun) + 's' : text.append(plural);
}

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Returns a text without the characters of `of` at its ends.
inline std::string_view trimmed(std::string_view text, std::string_view of = " \t\r\n") {
  const std::size_t begin = text.find_first_not_of(of);
  return begin == text.npos ? std::string_view() : text.substr(begin, text.find_last_not_of(of) - begin + 1);
}

/// Calls use(line, number) for each line that is neither empty nor a comment (#): without the characters of `of` at
/// its ends, numbers counting from 1.
template <class Use>
void each_line(std::string_view text, std::string_view of, const Use& use) {
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end), of);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.front() != '#') use(line, number);
  }
}

/// Returns a text without its byte order mark. Of UTF-16, which PowerShell's ">" writes, the low bytes are kept, since
/// names and numbers have no others.
inline std::string without_byte_order(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const bool high_first = text.starts_with("\xFE\xFF");
  if (!high_first && !text.starts_with("\xFF\xFE")) return std::string(text);
  std::string low;
  for (std::size_t i = high_first ? 3 : 2; i < text.size(); i += 2) low += text[i];
  return low;
}

}  // namespace vesalius
