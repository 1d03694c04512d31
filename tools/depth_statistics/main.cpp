// Compares depth sensors, or a sensor with its imitation: a Markdown table with a column for each source.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "../run_tool.h"
#include "depth_statistics.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

DepthFigures measure(const std::string& uri, int most_frames) {
  DepthStatistics statistics;
  const auto source = open_source(uri);
  int count = 0;
  while (count < most_frames) {
    const auto frame = source->next();
    if (!frame) break;
    statistics.add(frame->depth);
    ++count;
  }
  if (count == 0) throw Error(uri + ": no frames");
  return statistics.figures();
}

template <class Get>
void print_row(const std::string& what, const std::vector<DepthFigures>& columns, const char* format, Get get) {
  std::cout << "| " << what;
  for (const DepthFigures& column : columns) std::cout << " | " << fmt::format(fmt::runtime(format), get(column));
  std::cout << " |\n";
}

void print(const std::vector<std::string>& names, const std::vector<DepthFigures>& columns) {
  std::cout << "| figure";
  for (const std::string& name : names) std::cout << " | " << name;
  std::cout << " |\n|---";
  for (std::size_t i = 0; i < names.size(); ++i) std::cout << "|---";
  std::cout << "|\n";
  print_row("pixels without reading, %", columns, "{:.1f}", [](const auto& f) { return 100 * f.holes; });
  print_row("empty columns at the borders", columns, "{:.1f}", [](const auto& f) { return f.border_px; });
  print_row("edge pixels, % of readings", columns, "{:.1f}", [](const auto& f) { return 100 * f.edge_pixels; });
  print_row("steps with a hole, %", columns, "{:.0f}", [](const auto& f) { return 100 * f.holes_at_steps; });
  print_row("median width of those, px", columns, "{:.0f}", [](const auto& f) { return f.hole_width_px; });
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    print_row(fmt::format("noise at {} m, mm", kDistances_m[i]), columns, "{:.1f}",
              [i](const auto& f) { return f.noise_mm[i]; });
  }
  for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
    print_row(fmt::format("depth step at {} m, mm", kDistances_m[i]), columns, "{:.0f}",
              [i](const auto& f) { return f.step_mm[i]; });
  }
}

int run(int argc, char** argv) {
  CLI::App app("Noise, holes and steps of depth pictures, as a table with a column for each source");
  std::vector<std::string> sources;
  int frames = 200;
  app.add_option("SOURCE", sources, "What `vesalius detect` reads")->required();
  app.add_option("--frames", frames, "Most frames read of each source")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  std::vector<DepthFigures> columns;
  for (const std::string& source : sources) columns.push_back(measure(source, frames));
  print(sources, columns);
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_depth_statistics", [&] { return vesalius::run(argc, argv); });
}
