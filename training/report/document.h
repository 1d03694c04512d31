#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vesalius {

/// One line of a plot. A point whose y is not finite breaks the line, one whose x is not is left out.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x and y; the line goes along x
};

/// A plot of lines over a common axis.
struct LinePlot {
  std::string caption;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;
  std::optional<std::pair<double, double>> x_range{};  ///< low and high; if empty, the range of the points
  std::optional<std::pair<double, double>> y_range{};
  bool log_x = false;  ///< requires all x to be positive
};

/// A matrix of shares with the same names for rows and columns, such as a confusion matrix.
struct MatrixPlot {
  std::string caption;
  std::vector<std::string> names;
  std::vector<std::vector<double>> shares;  ///< [row][column], 0 to 1
};

/// Bars of shares: for each name one of every series.
struct BarPlot {
  std::string caption;
  std::vector<std::string> names;
  std::vector<std::pair<std::string, std::vector<double>>> series;  ///< name, and 0 to 1 for each of `names`, or NaN
};

/// A report that is composed once and written as one web page, which holds its pictures, its style and the scripts that
/// draw its plots (web/report): it opens offline. All text is plain UTF-8 and is shown as it is.
class Document {
 public:
  explicit Document(std::string title);

  /// Adds a heading of level 2 to 6; the title has level 1. The page begins with a list of those of level 2. Throws
  /// Error for any other level.
  void heading(int level, std::string_view text);
  void paragraph(std::string_view text);
  /// Adds a command or listing, whose spaces and line breaks are kept.
  void preformatted(std::string_view text);
  /// Adds a table. A column is aligned at the right if all its cells are numbers or empty. Throws Error if the header
  /// has no columns or a row has another length.
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  /// Adds a picture. Throws Error for bytes that are not PNG.
  void picture(std::string_view png, std::string_view caption);
  /// Adds a plot and its values; nothing where no point is finite.
  void plot(const LinePlot& plot);
  /// Adds a matrix, coloured by its shares, with percents in the cells of half a percent and more. Throws Error unless
  /// there are as many rows and columns as names.
  void matrix(const MatrixPlot& matrix);

  /// Adds bars with their percents. Throws Error unless each series has as many shares as there are names.
  void bars(const BarPlot& plot);

  std::string html() const;

 private:
  std::string title_;
  std::string blocks_;  ///< JSON of what was added, separated by commas
};

/// Makes the folder of a report unless it is there. Throws Error naming it if it cannot be made. It is called before
/// what takes long.
void make_report_folder(const std::string& folder);

/// Writes `folder`/report.html atomically. Throws Error naming the file if it cannot be written.
void write_report_page(const Document& document, const std::string& folder);

}  // namespace vesalius
