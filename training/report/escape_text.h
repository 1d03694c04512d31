#pragma once

#include <string>
#include <string_view>

namespace vesalius {

/// Returns `text` on one line: control characters become spaces.
std::string one_line_text(std::string_view text);

/// Escapes text for HTML's text and quoted attributes. Line breaks and tabs are kept.
std::string escape_html(std::string_view text);

/// Escapes text for a line of Markdown, such that no character is read as markup, even at the line's start or in a
/// table's cell.
std::string escape_markdown(std::string_view text);

/// Encodes bytes in base64 (RFC 4648) with padding.
std::string base64(std::string_view bytes);

}  // namespace vesalius
