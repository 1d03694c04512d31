#include "report/escape_text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace vesalius {
namespace {

constexpr std::string_view kDigits = "0123456789";

bool is_word(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') || byte >= 0x80;
}

/// Returns whether character `i` would be read as markup. An underscore inside a word would not.
bool is_markdown(std::string_view text, std::size_t i) {
  const char c = text[i];
  if (c == '_') return i == 0 || i + 1 == text.size() || !is_word(text[i - 1]) || !is_word(text[i + 1]);
  if (std::string_view("\\`*[]<>|~&").find(c) != std::string_view::npos) return true;
  if (i == 0) {
    const bool number = text.size() > 1 && kDigits.find(text[1]) != std::string_view::npos;
    return !number && std::string_view("#-+=").find(c) != std::string_view::npos;
  }
  const bool numbered = (c == '.' || c == ')') && (i + 1 == text.size() || text[i + 1] == ' ');  // "1. " begins a list
  return numbered && text.substr(0, i).find_first_not_of(kDigits) == std::string_view::npos;
}

}  // namespace

std::string one_line_text(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  return line;
}

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default: {
        const auto byte = static_cast<unsigned char>(c);
        const bool control = (byte < ' ' && c != '\n' && c != '\t') || byte == 0x7f;
        escaped += control ? ' ' : c;
      }
    }
  }
  return escaped;
}

std::string escape_markdown(std::string_view text) {
  std::string line = one_line_text(text);
  line.erase(0, line.find_first_not_of(' '));  // four spaces would begin a listing
  std::string escaped;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (is_markdown(line, i)) escaped += '\\';
    escaped += line[i];
  }
  return escaped;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kAlphabet[group >> (18U - 6U * k) & 63U] : '=';
  }
  return text;
}

}  // namespace vesalius
