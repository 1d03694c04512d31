#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vesalius {

/// One line of a plot. A point with a number that is not finite breaks the line.
struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y in the order in which they are joined
};

struct PlotRange {
  double low = 0.0;
  double high = 1.0;
};

/// Lines over a common axis. Texts are plain UTF-8.
struct LinePlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;    ///< with a legend where there are several
  std::optional<PlotRange> x_range;  ///< else that of the points
  std::optional<PlotRange> y_range;
  bool log_x = false;  ///< all x must be positive then
};

/// The plot as SVG, 720 x 440 pixels, made by the program gnuplot (Debian: gnuplot-nox); lines differ in dashes and
/// marks, so that it can be read in black and white. Throws Error where gnuplot is missing, fails or takes longer than
/// 30 s, and UsageError for a plot without a finite point, an empty or infinite range, or x <= 0 on a log axis.
std::string plot_svg(const LinePlot& plot);

}  // namespace vesalius
