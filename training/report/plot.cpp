#include "report/plot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "report/plot_process.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr double kLimit_s = 30.0;
constexpr std::size_t kMarks = 12;  ///< approximate number of marks on a line, so that they stay apart

struct Style {
  const char* colour;
  int dash;   ///< gnuplot's dashtype
  int point;  ///< gnuplot's pointtype
};
/// Dark colours that also differ for the colour-blind (Okabe, Ito). Dash and mark identify a line without colour.
constexpr std::array<Style, 8> kStyles{{{"#000000", 1, 7},
                                        {"#0072b2", 2, 4},
                                        {"#d55e00", 4, 9},
                                        {"#007a5a", 3, 6},
                                        {"#a3447f", 5, 5},
                                        {"#6b4d00", 1, 8},
                                        {"#3d6fb6", 2, 11},
                                        {"#555555", 4, 12}}};

/// Returns a gnuplot string in single quotes, where only the quote itself needs escaping.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\'') result += '\'';
    result += byte < ' ' || byte == 0x7f ? ' ' : c;
  }
  return result + "'";
}

bool is_finite(const std::pair<double, double>& point) {
  return std::isfinite(point.first) && std::isfinite(point.second);
}

bool has_points(const PlotSeries& series) { return std::ranges::any_of(series.points, is_finite); }

void check_range(const std::optional<PlotRange>& range, const LinePlot& plot, bool positive) {
  if (!range) return;
  if (std::isfinite(range->low) && std::isfinite(range->high) && range->low < range->high &&
      (!positive || range->low > 0.0)) {
    return;
  }
  throw UsageError(fmt::format("plot {}: range {} to {}, expected a {}finite one that is not empty", plot.title,
                               range->low, range->high, positive ? "positive, " : ""));
}

void check(const LinePlot& plot) {
  check_range(plot.x_range, plot, plot.log_x);
  check_range(plot.y_range, plot, false);
  if (std::ranges::none_of(plot.series, has_points)) {
    throw UsageError(fmt::format("plot {}: no points, expected at least one", plot.title));
  }
  if (!plot.log_x) return;
  for (const PlotSeries& series : plot.series) {
    for (const auto& point : series.points) {
      if (!is_finite(point) || point.first > 0.0) continue;
      throw UsageError(
          fmt::format("plot {}: {}: x = {}, expected more than 0 on a log axis", plot.title, series.name, point.first));
    }
  }
}

std::string header(const LinePlot& plot) {
  std::string script =
      "set encoding utf8\n"
      "set terminal svg size 720,440 dynamic noenhanced background rgb 'white' font 'sans-serif,13'\n"
      "set grid lc rgb '#cccccc' lw 0.6 dt 1\nset border 3\nset tics nomirror\n";
  script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", in_quotes(plot.title), in_quotes(plot.x_label),
                        in_quotes(plot.y_label));
  script += plot.series.size() > 1 ? "set key outside right top reverse Left samplen 4\n" : "set key off\n";
  if (plot.log_x) script += "set logscale x\n";
  if (plot.x_range) script += fmt::format("set xrange [{}:{}]\n", plot.x_range->low, plot.x_range->high);
  if (plot.y_range) script += fmt::format("set yrange [{}:{}]\n", plot.y_range->low, plot.y_range->high);
  return script;
}

/// Returns the block `$s0 << END ... END`. A blank line in it breaks the line of the plot.
std::string data_block(const PlotSeries& series, std::size_t index) {
  std::string block = fmt::format("$s{} << END\n", index);
  for (const auto& point : series.points) {
    block += is_finite(point) ? fmt::format("{} {}\n", point.first, point.second) : "\n";
  }
  return block + "END\n";
}

std::string drawn(const PlotSeries& series, std::size_t index) {
  const Style& style = kStyles[index % kStyles.size()];
  const std::string look =
      fmt::format("with linespoints lw 1.6 dt {} pt {} ps 0.6 lc rgb '{}'", style.dash, style.point, style.colour);
  if (!has_points(series)) return fmt::format("keyentry {} title {}", look, in_quotes(series.name));
  return fmt::format("$s{} using 1:2 {} pointinterval {} title {}", index, look, series.points.size() / kMarks + 1,
                     in_quotes(series.name));
}

std::string gnuplot_script(const LinePlot& plot) {
  std::string script = header(plot);
  std::string lines;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    if (has_points(plot.series[i])) script += data_block(plot.series[i], i);
    lines += (i == 0 ? "plot " : ", ") + drawn(plot.series[i], i);
  }
  return script + lines + "\n";
}

std::string first_line(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \n\t\r^");
  if (begin == std::string_view::npos) return "no reason given";
  return std::string(text.substr(begin, text.find('\n', begin) - begin));
}

void check(const MatrixPlot& plot) {
  const auto is_share = [](double share) { return share >= 0.0 && share <= 1.0; };
  const auto is_row = [&](const std::vector<double>& row) {
    return row.size() == plot.names.size() && std::ranges::all_of(row, is_share);
  };
  if (!plot.names.empty() && plot.shares.size() == plot.names.size() && std::ranges::all_of(plot.shares, is_row))
    return;
  throw UsageError(
      fmt::format("plot {}: expected {} rows of as many shares from 0 to 1", plot.title, plot.names.size()));
}

std::string gnuplot_script(const MatrixPlot& plot) {
  constexpr int kCell_px = 20;
  constexpr int kLabel_px = 150;  // for names and the label beside them
  const auto size_px = kLabel_px + kCell_px * static_cast<int>(plot.names.size()) + kCell_px;
  const double last = static_cast<double>(plot.names.size()) - 0.5;
  std::string tics;
  std::string rows;
  for (std::size_t i = 0; i < plot.names.size(); ++i) {
    tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", in_quotes(plot.names[i]), i);
    rows += fmt::format("{}\n", fmt::join(plot.shares[i], " "));
  }
  return fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {0},{0} dynamic noenhanced background rgb 'white' font 'sans-serif,11'\n"
      "set palette defined (0 '#ffffff', 1 '#08306b')\nset cbrange [0:1]\nunset colorbox\n"
      "set key off\nset border 0\nset tics scale 0\nset size ratio -1\nunset xtics\n"
      "set xrange [-0.5:{1}]\nset x2range [-0.5:{1}]\nset yrange [{1}:-0.5]\n"
      "set x2tics rotate by 90 ({2})\nset ytics ({2})\nset x2label {3}\nset ylabel {4}\n"
      "$m << END\n{5}END\n"
      // The square root emphasises small shares, which are the interesting ones.
      "plot $m matrix using 1:2:(sqrt($3)) with image pixels, $m matrix using 1:2:($3 >= 0.005 ? sprintf('%.0f', 100 * "
      "$3) : ''):($3 > 0.3 ? 0xffffff : 0) with labels font ',9' tc rgb variable\n",
      size_px, last, tics, in_quotes(plot.column_label), in_quotes(plot.row_label), rows);
}

std::string svg_of(const std::string& title, const std::string& script) {
  ProcessResult result;
  try {
    result = run_process({"gnuplot", "-d"}, script, kLimit_s);  // -d ignores the user's start-up file
  } catch (const Error& e) {
    throw Error(fmt::format("plot {}: {} (Debian: gnuplot-nox)", title, e.what()));
  }
  if (result.exit_code == 0 && result.out.find("</svg>") != std::string::npos) return std::move(result.out);
  throw Error(
      fmt::format("plot {}: gnuplot failed with exit code {}: {}", title, result.exit_code, first_line(result.err)));
}

}  // namespace

std::string plot_svg(const LinePlot& plot) {
  check(plot);
  return svg_of(plot.title, gnuplot_script(plot));
}

std::string plot_svg(const MatrixPlot& plot) {
  check(plot);
  return svg_of(plot.title, gnuplot_script(plot));
}

}  // namespace vesalius
