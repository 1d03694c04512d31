#pragma once

// Whether a pixel is a body, decided anew from what the forest says of its surroundings (auto-context, Tu and Bai
// 2010). The forest looks at each pixel by itself (section 4); a chair's back that resembles a chest has no neck above
// it and no hips below.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/boosted_trees.h"
#include "vesalius/camera.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius {

/// Returns the name of each kind of part (part_slots): that of its first part.
std::vector<std::string> kind_names(const BodyModel& body);

/// The surroundings of pixels as numbers: means over boxes of metric size of what the posteriors say. It looks at
/// cells, every few pixels of every few rows.
class BodySurroundings {
 public:
  /// Least body share of the posterior at which a cell is asked about. What is less stays background.
  static constexpr double kLeastBody = 0.03;

  /// All three have the same size. Posteriors have a background class, and only their pixels at cells are looked at.
  BodySurroundings(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera, const BodyModel& body);

  /// Returns how many features a cell has with a body of these parts.
  static int feature_count(const BodyModel& body);
  /// Returns the name of each in model files: "body", "part:neck", "about 0.3 m: body", "0.45 m right, -0.45 m down:
  /// beyond".
  static std::vector<std::string> feature_names(const BodyModel& body);

  int step() const { return step_; }  ///< pixels from one cell to the next
  int columns() const { return columns_; }
  int rows() const { return rows_; }

  /// Returns whether a cell has a reading that may be a body.
  bool is_open(int column, int row) const;
  /// Writes feature_count() numbers. Of the pixel: the share of the body, of the two likeliest parts, the depth in
  /// metres, and the share of each kind of part (a part and its mirror partner). Of boxes about it and around it: the
  /// body's mean share, the share of readings, and the mean depth beyond the pixel's in metres, at most 1.5 either way;
  /// of those about it also the mean share of each kind of part. The cell is open.
  void features(int column, int row, float* out) const;

 private:
  struct Box4;
  Box4 box(int column, int row, float du_m, float dv_m, float radius_m, float cells_per_m) const;
  const std::uint32_t* sums(int column, int row) const {
    return sums_.data() + (static_cast<std::size_t>(row) * (columns_ + 1) + column) * channels_;
  }

  const Posteriors& posteriors_;
  const DepthImage& depth_;
  Camera camera_;
  std::vector<int> slots_;  ///< [part]: its kind
  int kinds_;
  int step_, columns_, rows_;
  std::size_t channels_;
  std::vector<std::uint32_t> sums_;  ///< [row][column][channel]: sums over all cells above and to the left, modulo 2^32
};

/// Writes the posteriors to `out` and reuses its memory. Those of pixels that may be a body are corrected: body and
/// background are shared out as the trees say for the cells around, and the parts keep their proportions. Headings are
/// not copied.
void correct_bodies(const BoostedTrees& context, const DepthImage& depth, const Camera& camera, const BodyModel& body,
                    const Posteriors& posteriors, Posteriors& out);

}  // namespace vesalius
