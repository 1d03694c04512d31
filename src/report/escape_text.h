#pragma once

#include <string>
#include <string_view>

namespace vesalius {

/// `text` on one line: control characters become spaces.
std::string one_line_text(std::string_view text);

/// For HTML's text and quoted attributes; line breaks and tabs stay.
std::string escape_html(std::string_view text);

/// For a line of Markdown: nothing in it is markup, also not at the line's start or in a table's cell.
std::string escape_markdown(std::string_view text);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace vesalius
