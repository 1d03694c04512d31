#include "commands/synth/contact_sheet.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "draw/canvas.h"
#include "vesalius/draw.h"

namespace vesalius {
namespace {

constexpr int kGap = 4;
constexpr Rgb kPaper{255, 255, 255};
constexpr Rgb kInk{0, 0, 0};

cv::Mat view(ColourImage& image) { return {image.height(), image.width(), CV_8UC3, image.data()}; }

ColourImage resized(ColourImage image, int width) {
  const int height = std::max(1, image.height() * width / image.width());
  ColourImage result(width, height);
  cv::Mat to = view(result);
  cv::resize(view(image), to, to.size(), 0, 0, width < image.width() ? cv::INTER_AREA : cv::INTER_NEAREST);
  return result;
}

void paste(const ColourImage& tile, int left, int top, ColourImage& sheet) {
  for (int v = 0; v < tile.height(); ++v) std::copy_n(tile.row(v), tile.width(), sheet.row(top + v) + left);
}

std::vector<ColourImage> tiles_of(const LabelledFrame& labelled, const BodyModel& body, int width) {
  const Frame& frame = labelled.frame;
  std::vector<ColourImage> tiles{resized(draw_depth(frame.depth), width)};
  if (!frame.colour.empty()) tiles.push_back(resized(frame.colour, width));
  tiles.push_back(resized(draw_labels(labelled.labels, frame.depth, body, false), width));
  return tiles;
}

}  // namespace

ColourImage contact_sheet(const std::vector<LabelledFrame>& frames, const BodyModel& body, int columns,
                          int tile_width) {
  std::vector<std::vector<ColourImage>> cells;
  std::size_t across = 1;
  int height = 1;
  for (const LabelledFrame& frame : frames) {
    cells.push_back(tiles_of(frame, body, tile_width));
    across = std::max(across, cells.back().size());
    for (const ColourImage& tile : cells.back()) height = std::max(height, tile.height());
  }
  const int count = int(frames.size());
  columns = std::clamp(columns, 1, std::max(1, count));
  const int rows = std::max(1, (count + columns - 1) / columns);
  const int cell_width = int(across) * tile_width + kGap * 2;
  const int cell_height = height + kTextRow + kGap * 2;
  ColourImage sheet(columns * cell_width, rows * cell_height, kPaper);
  for (int i = 0; i < count; ++i) {
    const int left = i % columns * cell_width + kGap;
    const int top = i / columns * cell_height + kGap;
    draw_text(sheet, frames[i].frame.name, left, top + kTextRow - kGap, kInk);
    for (std::size_t t = 0; t < cells[i].size(); ++t) {
      paste(cells[i][t], left + int(t) * tile_width, top + kTextRow, sheet);
    }
  }
  return sheet;
}

}  // namespace vesalius
