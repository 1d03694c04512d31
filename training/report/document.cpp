#include "report/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "report/escape_text.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kStyle = R"(
body { font: 16px/1.5 sans-serif; color: #111; background: #fff; max-width: 62em; margin: 2em auto; padding: 0 1em; }
h1, h2, h3 { line-height: 1.2; }
h2 { border-bottom: 1px solid #999; padding-bottom: .2em; margin-top: 2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 1em 0; font-size: 90%; }
th, td { border: 1px solid #bbb; padding: .25em .6em; text-align: left; vertical-align: top; }
th { background: #eee; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
pre { background: #f4f4f4; border: 1px solid #ccc; padding: .6em; overflow-x: auto; }
figure { margin: 1em 0; }
figure img { max-width: 100%; height: auto; }
figcaption { font-size: 90%; color: #333; }
)";

bool is_number(std::string_view cell) {
  if (cell.starts_with('+') || cell.starts_with('-')) cell.remove_prefix(1);
  return !cell.empty() && cell.front() >= '0' && cell.front() <= '9';
}

/// Returns for each column whether its cells below the header are numbers or empty and at least one is a number.
std::vector<bool> number_columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<bool> numbers(rows.front().size(), false);
  for (std::size_t column = 0; column < numbers.size(); ++column) {
    const auto is = [&](const auto& row) { return is_number(row[column]); };
    const auto fits = [&](const auto& row) { return row[column].empty() || is_number(row[column]); };
    numbers[column] = std::any_of(rows.begin() + 1, rows.end(), is) && std::all_of(rows.begin() + 1, rows.end(), fits);
  }
  return numbers;
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  const std::vector<bool> numbers = number_columns(rows);
  std::string html = "<div class=\"wide\"><table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const char* tag = r == 0 ? "th" : "td";
    html += "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      html += fmt::format("<{0}{1}>{2}</{0}>", tag, numbers[c] ? " class=\"number\"" : "", escape_html(rows[r][c]));
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string markdown_table(const std::vector<std::vector<std::string>>& rows) {
  const std::vector<bool> numbers = number_columns(rows);
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const std::string& cell : rows[r]) text += "| " + escape_markdown(cell) + " ";
    text += "|\n";
    if (r > 0) continue;
    for (const bool number : numbers) text += number ? "|---:" : "|---";
    text += "|\n";
  }
  return text;
}

/// Returns a listing, fenced by more backticks than occur in a row in the text.
std::string markdown_listing(const std::string& text) {
  std::size_t longest = 2;
  std::size_t run = 0;
  for (const char c : text) {
    run = c == '`' ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  const std::string fence(longest + 1, '`');
  return fmt::format("{0}\n{1}{2}{0}\n", fence, text, text.ends_with('\n') ? "" : "\n");
}

std::string file_stem(std::string_view name) {
  std::string stem(name);
  const auto odd = [](char c) {
    return !((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_');
  };
  std::ranges::replace_if(stem, odd, '_');
  return stem.empty() ? "picture" : stem;
}

}  // namespace

Document::Document(std::string title) : title_(std::move(title)) {}

void Document::heading(int level, std::string_view text) {
  if (level < 2 || level > 6) throw Error(fmt::format("document: heading of level {}, expected 2 to 6", level));
  Block& block = blocks_.emplace_back();
  block.kind = Kind::heading;
  block.level = level;
  block.text = text;
}

void Document::paragraph(std::string_view text) {
  Block& block = blocks_.emplace_back();
  block.kind = Kind::paragraph;
  block.text = text;
}

void Document::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  if (header.empty()) throw Error("document: a table without columns");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].size() == header.size()) continue;
    throw Error(fmt::format("document: row {} of a table has {} cells, expected {}", r, rows[r].size(), header.size()));
  }
  Block& block = blocks_.emplace_back();
  block.kind = Kind::table;
  block.rows.push_back(header);
  block.rows.insert(block.rows.end(), rows.begin(), rows.end());
}

void Document::svg(std::string_view name, std::string bytes, std::string_view caption) {
  if (bytes.find("<svg") == std::string::npos) throw Error(fmt::format("document: {}: no SVG", name));
  add_picture(name, ".svg", std::move(bytes), caption);
}

void Document::picture(std::string_view name, std::string png, std::string_view caption) {
  if (!png.starts_with("\x89PNG")) throw Error(fmt::format("document: {}: no PNG", name));
  add_picture(name, ".png", std::move(png), caption);
}

void Document::add_picture(std::string_view name, const char* extension, std::string bytes, std::string_view caption) {
  const std::string stem = file_stem(name);
  std::string file = stem + extension;
  const auto taken = [&] { return std::ranges::find(pictures_, file, &Picture::file) != pictures_.end(); };
  for (int number = 2; taken(); ++number) file = fmt::format("{}-{}{}", stem, number, extension);
  Block& block = blocks_.emplace_back();
  block.kind = Kind::picture;
  block.picture = pictures_.size();
  pictures_.push_back({std::move(file), std::move(bytes), std::string(caption)});
}

void Document::preformatted(std::string_view text) {
  Block& block = blocks_.emplace_back();
  block.kind = Kind::preformatted;
  block.text = text;
}

std::string Document::html_of(const Block& block) const {
  switch (block.kind) {
    case Kind::heading:
      return fmt::format("<h{0}>{1}</h{0}>\n", block.level, escape_html(block.text));
    case Kind::table:
      return html_table(block.rows);
    case Kind::picture: {
      const Picture& picture = pictures_[block.picture];
      const char* type = picture.file.ends_with(".svg") ? "image/svg+xml" : "image/png";
      const std::string caption = escape_html(picture.caption);
      return fmt::format("<figure><img alt=\"{0}\" src=\"data:{1};base64,{2}\"><figcaption>{0}</figcaption></figure>\n",
                         caption, type, base64(picture.bytes));
    }
    case Kind::preformatted:
      return fmt::format("<pre>{}</pre>\n", escape_html(block.text));
    default:
      return fmt::format("<p>{}</p>\n", escape_html(block.text));
  }
}

std::string Document::html() const {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      escape_html(title_), kStyle);
  for (const Block& block : blocks_) page += html_of(block);
  return page + "</body>\n</html>\n";
}

std::string Document::markdown_of(const Block& block, const std::string& folder) const {
  switch (block.kind) {
    case Kind::heading:
      return fmt::format("{} {}\n", std::string(static_cast<std::size_t>(block.level), '#'),
                         escape_markdown(block.text));
    case Kind::table:
      return markdown_table(block.rows);
    case Kind::picture: {
      const Picture& picture = pictures_[block.picture];
      const std::string path = folder.empty() ? picture.file : folder + "/" + picture.file;
      const std::string caption = escape_markdown(picture.caption);
      return fmt::format("![{0}](<{1}>)\n\n*{0}*\n", caption, path);
    }
    case Kind::preformatted:
      return markdown_listing(block.text);
    default:
      return escape_markdown(block.text) + "\n";
  }
}

std::string Document::markdown(const std::string& folder) const {
  std::string text = fmt::format("# {}\n", escape_markdown(title_));
  for (const Block& block : blocks_) text += "\n" + markdown_of(block, folder);
  return text;
}

}  // namespace vesalius
