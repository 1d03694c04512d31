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

}  // namespace vesalius
