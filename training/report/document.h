#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// A report that is composed once and written as a web page or as Markdown. All text is plain UTF-8: characters that
/// HTML or Markdown would read as markup are escaped, and control characters become spaces.
class Document {
 public:
  /// A picture file that belongs to the Markdown text.
  struct Picture {
    std::string file;   ///< "detection.svg": letters, digits, '-' and '_', then the extension; unique
    std::string bytes;  ///< SVG text or PNG
    std::string caption;
  };

  explicit Document(std::string title);

  /// Adds a heading of level 2 to 6; the title has level 1. Throws Error for any other level.
  void heading(int level, std::string_view text);
  void paragraph(std::string_view text);
  /// Adds a table. A column is aligned at the right if all its cells are numbers or empty. Throws Error if the header
  /// has no columns or a row has another length.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  /// Adds a picture. `name` becomes its file name: characters unsuited for file names are replaced by '_', and a number
  /// is appended if the name is taken. Throws Error for bytes that are not SVG or PNG.
  void svg(std::string_view name, std::string bytes, std::string_view caption);
  void picture(std::string_view name, std::string png, std::string_view caption);
  /// Adds a command or listing, whose spaces and line breaks are kept.
  void preformatted(std::string_view text);

  /// Returns one page that contains its pictures (data URIs) and its style, so it can be opened offline.
  std::string html() const;
  /// Returns GitHub's Markdown. It links pictures as `folder`/file, or as file if `folder` is empty.
  std::string markdown(const std::string& folder = "") const;
  /// The pictures in the order of their appearance.
  const std::vector<Picture>& pictures() const { return pictures_; }

 private:
  enum class Kind { heading, paragraph, table, picture, preformatted };
  struct Block {
    Kind kind = Kind::paragraph;
    int level = 0;                               ///< level of a heading
    std::string text;                            ///< text of a heading, paragraph or preformatted block
    std::vector<std::vector<std::string>> rows;  ///< rows of a table, header first
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
