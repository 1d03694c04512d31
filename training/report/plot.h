#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vesalius {

/// One line of a plot. A point that is not finite breaks the line.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x and y, in the order in which a line joins them
};

struct PlotRange {
  double low = 0.0;
  double high = 1.0;
};

/// A plot of lines over a common axis. Texts are plain UTF-8.
struct LinePlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;    ///< if there are several, the plot has a legend
  std::optional<PlotRange> x_range;  ///< if empty, the range of the points
  std::optional<PlotRange> y_range;
  bool log_x = false;  ///< requires all x to be positive
};

/// Draws the plot as SVG of 720 x 440 pixels with the program gnuplot (Debian: gnuplot-nox). Lines differ in dashes and
/// marks, so the plot can be read in black and white. Throws Error if gnuplot is missing, fails or takes longer than 30
/// s, and UsageError for a plot without a finite point, an empty or infinite range, or x <= 0 on a log axis.
std::string plot_svg(const LinePlot& plot);

/// A matrix of shares with the same names for rows and columns, such as a confusion matrix.
struct MatrixPlot {
  std::string title;  ///< for messages; the picture has none
  std::string row_label;
  std::string column_label;
  std::vector<std::string> names;
  std::vector<std::vector<double>> shares;  ///< [row][column], 0 to 1
};

/// Draws the matrix as SVG, dark for large shares, with percents in the cells of half a percent and more. Throws as the
/// function above does; UsageError also for shares outside 0 to 1 and rows of another length than the names.
std::string plot_svg(const MatrixPlot& plot);

}  // namespace vesalius
