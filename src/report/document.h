#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// A report that is written once and read as a web page or as Markdown. All text is UTF-8 and plain: what HTML or
/// Markdown would take for markup is escaped, control characters become spaces.
class Document {
 public:
  /// A picture beside the Markdown.
  struct Picture {
    std::string file;   ///< "detection.svg": letters, digits, '-' and '_', then the extension; unique
    std::string bytes;  ///< SVG text or PNG
    std::string caption;
  };

  explicit Document(std::string title);

  /// Level 2 to 6; the title is level 1. Throws Error for another level.
  void heading(int level, std::string_view text);
  void paragraph(std::string_view text);
  /// Columns whose cells are all numbers (or empty) are aligned at the right. Throws Error for a header without columns
  /// and a row of another length.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  /// `name` becomes the file's name beside the Markdown, with what file names should not have as '_', and a number
  /// where it is taken. Throws Error for bytes that are no SVG or PNG.
  void svg(std::string_view name, std::string bytes, std::string_view caption);
  void picture(std::string_view name, std::string png, std::string_view caption);
  /// Commands, listings: spaces and line breaks stay.
  void preformatted(std::string_view text);

  /// One page with its pictures inside (data URIs) and its own style: opens offline.
  std::string html() const;
  /// GitHub's Markdown; pictures are linked as `folder`/file, or beside the text where `folder` is empty.
  std::string markdown(const std::string& folder = "") const;
  /// In the order of their appearance.
  const std::vector<Picture>& pictures() const { return pictures_; }

 private:
  enum class Kind { heading, paragraph, table, picture, preformatted };
  struct Block {
    Kind kind = Kind::paragraph;
    int level = 0;                               ///< of a heading
    std::string text;                            ///< of headings, paragraphs and preformatted blocks
    std::vector<std::vector<std::string>> rows;  ///< of a table, header first
    std::size_t picture = 0;                     ///< index in pictures_
  };

  void add_picture(std::string_view name, const char* extension, std::string bytes, std::string_view caption);
  std::string html_of(const Block& block) const;
  std::string markdown_of(const Block& block, const std::string& folder) const;

  std::string title_;
  std::vector<Block> blocks_;
  std::vector<Picture> pictures_;
};

}  // namespace vesalius
