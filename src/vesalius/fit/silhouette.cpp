#include "vesalius/fit/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius {
namespace {

constexpr int kGrid = 64;         // places along the longer side of a person's outline
constexpr double kBeyond = 0.35;  // how far around the box the grid reaches, as a share of its longer side

}  // namespace

Silhouette::Silhouette(const Frame& frame, const Mask& mask, const Box& box) : frame_(frame), mask_(mask) {
  const int longer = std::max(box.width, box.height);
  const int beyond = int(kBeyond * longer) + 1;
  step_ = std::max(1, (longer + 2 * beyond) / kGrid);
  box_.u = std::max(0, box.u - beyond);
  box_.v = std::max(0, box.v - beyond);
  box_.width = std::min(frame.camera.width, box.u + box.width + beyond) - box_.u;
  box_.height = std::min(frame.camera.height, box.v + box.height + beyond) - box_.v;
  columns_ = (box_.width + step_ - 1) / step_;
  rows_ = (box_.height + step_ - 1) / step_;
  nearest_.assign(static_cast<std::size_t>(columns_) * rows_, -1);
  const auto far = [&](int row, int column, std::int32_t other) {
    const int dr = row - other / columns_, dc = column - other % columns_;
    return dr * dr + dc * dc;
  };
  const auto offer = [&](int row, int column, int from_row, int from_column) {
    if (from_row < 0 || from_row >= rows_ || from_column < 0 || from_column >= columns_) return;
    const std::int32_t other = nearest_[static_cast<std::size_t>(from_row) * columns_ + from_column];
    std::int32_t& own = nearest_[static_cast<std::size_t>(row) * columns_ + column];
    if (other >= 0 && (own < 0 || far(row, column, other) < far(row, column, own))) own = other;
  };
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const std::int32_t at = row * columns_ + column;
      if (mask(box_.u + column * step_, box_.v + row * step_) != 0) nearest_[at] = at;
    }
  }
  // Two passes carry the nearest place along (Danielsson 1980): right to a fraction of a step.
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      for (const auto& [dr, dc] : {std::pair{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}})
        offer(row, column, row + dr, column + dc);
    }
    for (int column = columns_ - 1; column >= 0; --column) offer(row, column, row, column + 1);
  }
  for (int row = rows_ - 1; row >= 0; --row) {
    for (int column = columns_ - 1; column >= 0; --column) {
      for (const auto& [dr, dc] : {std::pair{1, 1}, {1, 0}, {1, -1}, {0, 1}}) offer(row, column, row + dr, column + dc);
    }
    for (int column = 0; column < columns_; ++column) offer(row, column, row, column - 1);
  }
}

Silhouette::Sight Silhouette::look(const Eigen::Vector3d& point, double margin_m) const {
  Sight sight;
  if (point.z() <= 0.05) return sight;
  const Camera& camera = frame_.camera;
  const double u = point.x() / point.z() * double(camera.fx) + double(camera.cx);
  const double v = point.y() / point.z() * double(camera.fy) + double(camera.cy);
  if (!(u >= 0.0 && v >= 0.0 && u <= camera.width - 1 && v <= camera.height - 1)) return sight;
  const int pixel_u = int(std::lround(u)), pixel_v = int(std::lround(v));
  const double depth_m = 1e-3 * frame_.depth(pixel_u, pixel_v);
  if (mask_(pixel_u, pixel_v) != 0) {
    sight.depth_m = depth_m;
    sight.kind = depth_m > 0.0 ? Sight::Kind::on : Sight::Kind::unknown;
    return sight;
  }
  if (depth_m == 0.0) return sight;
  if (depth_m < point.z() - margin_m) {
    sight.kind = Sight::Kind::covered;
    return sight;
  }
  const int column = std::clamp((pixel_u - box_.u) / step_, 0, std::max(0, columns_ - 1));
  const int row = std::clamp((pixel_v - box_.v) / step_, 0, std::max(0, rows_ - 1));
  if (nearest_.empty()) return sight;
  const std::int32_t nearest = nearest_[static_cast<std::size_t>(row) * columns_ + column];
  if (nearest < 0) return sight;
  sight.kind = Sight::Kind::behind;
  sight.aside = {box_.u + nearest % columns_ * step_ - u, box_.v + nearest / columns_ * step_ - v};
  return sight;
}

}  // namespace vesalius
