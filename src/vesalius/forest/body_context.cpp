#include "vesalius/forest/body_context.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// The first channels; then follow the kinds of parts.
enum Channel : std::size_t { kReadings, kDepth_mm, kBody, kFirstKind };

/// A square box beside a pixel, metres at the pixel's depth, in the picture's directions.
struct Around {
  float right_m, down_m, radius_m;
};
/// Boxes about the pixel itself: the neighbourhood, a limb, a torso, half a person.
constexpr std::array kAbout{0.06F, 0.15F, 0.3F, 0.6F};
/// Boxes around it: the next limb, then what is half a person away in eight directions, then what is above and below
/// one.
constexpr std::array<Around, 14> kBeside{{{0.3F, 0.F, 0.15F},
                                          {-0.3F, 0.F, 0.15F},
                                          {0.F, 0.3F, 0.15F},
                                          {0.F, -0.3F, 0.15F},
                                          {0.6F, 0.F, 0.25F},
                                          {-0.6F, 0.F, 0.25F},
                                          {0.F, 0.6F, 0.25F},
                                          {0.F, -0.6F, 0.25F},
                                          {0.45F, 0.45F, 0.25F},
                                          {-0.45F, 0.45F, 0.25F},
                                          {0.45F, -0.45F, 0.25F},
                                          {-0.45F, -0.45F, 0.25F},
                                          {0.F, 1.1F, 0.3F},
                                          {0.F, -1.1F, 0.3F}}};
constexpr int kOfPixel = 4;  ///< features of the pixel besides the kinds of parts
constexpr int kOfBox = 3;
constexpr float kMostBeyond_m = 1.5F;

std::string short_text(float number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

}  // namespace

std::vector<std::string> kind_names(const BodyModel& body) {
  const std::vector<int> slots = part_slots(body);
  std::vector<std::string> names(kind_count(slots));
  for (std::size_t p = slots.size(); p-- > 0;) names[slots[p]] = body.parts[p].name;
  return names;
}

/// The corners of a box of cells in the sums.
struct BodySurroundings::Box4 {
  const std::uint32_t *top_left, *top_right, *bottom_left, *bottom_right;
  float cells;  ///< within the picture, at least 1

  std::uint32_t operator[](std::size_t channel) const {
    return bottom_right[channel] - top_right[channel] - bottom_left[channel] + top_left[channel];
  }
};

BodySurroundings::BodySurroundings(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                                   const BodyModel& body)
    : posteriors_(posteriors),
      depth_(depth),
      camera_(camera),
      slots_(part_slots(body)),
      kinds_(kind_count(slots_)),
      step_(spaced(SmoothOptions{}, camera).spacing),
      columns_((depth.width() + step_ - 1) / step_),
      rows_((depth.height() + step_ - 1) / step_),
      channels_(kFirstKind + kinds_),
      sums_(static_cast<std::size_t>(columns_ + 1) * (rows_ + 1) * channels_) {
  const std::size_t stride = static_cast<std::size_t>(columns_ + 1) * channels_;
  std::vector<std::array<int, 2>> parts_of(kinds_, {-1, -1});
  for (std::size_t p = 0; p < slots_.size(); ++p) {
    std::array<int, 2>& parts = parts_of[slots_[p]];
    parts[parts[0] < 0 ? 0 : 1] = int(p);
  }
  parallel_ranges(rows_, kRowGrain, [&](int begin, int end) {
    std::vector<std::uint32_t> run(channels_);
    for (int row = begin; row < end; ++row) {
      std::ranges::fill(run, 0U);
      std::uint32_t* out = sums_.data() + (static_cast<std::size_t>(row) + 1) * stride + channels_;
      for (int column = 0; column < columns_; ++column, out += channels_) {
        const int z_mm = depth_(column * step_, row * step_);
        if (z_mm != 0) {
          run[kReadings] += 1;
          run[kDepth_mm] += static_cast<std::uint32_t>(z_mm);
          const std::uint16_t* of = posteriors_.at(column * step_, row * step_);
          for (int k = 0; k < kinds_; ++k) {
            const auto [one, other] = parts_of[k];
            const auto share = static_cast<std::uint32_t>(of[one] + (other >= 0 ? of[other] : 0));
            run[kFirstKind + k] += share;
            run[kBody] += share;
          }
        }
        std::ranges::copy(run, out);
      }
    }
  });
  for (int row = 1; row < rows_; ++row) {
    const std::uint32_t* above = sums_.data() + static_cast<std::size_t>(row) * stride;
    std::uint32_t* here = sums_.data() + (static_cast<std::size_t>(row) + 1) * stride;
    for (std::size_t i = 0; i < stride; ++i) here[i] += above[i];
  }
}

int BodySurroundings::feature_count(const BodyModel& body) {
  const int kinds = kind_count(part_slots(body));
  return kOfPixel + kinds + int(kAbout.size()) * (kOfBox + kinds) + int(kBeside.size()) * kOfBox;
}

std::vector<std::string> BodySurroundings::feature_names(const BodyModel& body) {
  std::vector<std::string> kinds = kind_names(body);
  for (std::string& kind : kinds) kind.insert(0, "part:");
  std::vector<std::string> names{"body", "likeliest", "second", "depth"};
  const auto add = [&](const std::string& where, const std::vector<std::string>& what) {
    for (const std::string& name : what) names.push_back(where + name);
  };
  const std::vector<std::string> of_box{"body", "readings", "beyond"};
  add("", kinds);
  for (const float radius_m : kAbout) {
    const std::string where = "about " + short_text(radius_m) + " m: ";
    add(where, of_box);
    add(where, kinds);
  }
  for (const Around& beside : kBeside) {
    add(short_text(beside.right_m) + " m right, " + short_text(beside.down_m) + " m down: ", of_box);
  }
  return names;
}

bool BodySurroundings::is_open(int column, int row) const {
  const int u = column * step_, v = row * step_;
  if (depth_(u, v) == 0 || (!posteriors_.settled.empty() && posteriors_.settled(u, v) != 0)) return false;
  const auto share = body_share(posteriors_, u, v, int(slots_.size()));
  return share && *share >= kLeastBody;
}

BodySurroundings::Box4 BodySurroundings::box(int column, int row, float du_m, float dv_m, float radius_m,
                                             float cells_per_m) const {
  const int u = column + int(std::lround(du_m * cells_per_m));
  const int v = row + int(std::lround(dv_m * cells_per_m));
  const int radius = std::max(1, int(std::lround(radius_m * cells_per_m)));
  const int left = std::clamp(u - radius, 0, columns_), right = std::clamp(u + radius + 1, 0, columns_);
  const int top = std::clamp(v - radius, 0, rows_), bottom = std::clamp(v + radius + 1, 0, rows_);
  return {sums(left, top), sums(right, top), sums(left, bottom), sums(right, bottom),
          float(std::max(1, (right - left) * (bottom - top)))};
}

void BodySurroundings::features(int column, int row, float* out) const {
  const int u = column * step_, v = row * step_;
  const auto parts = int(slots_.size());
  const std::uint16_t* of = posteriors_.at(u, v);
  const auto whole = float(std::accumulate(of, of + posteriors_.classes, 0));
  const float z_m = 1e-3F * float(depth_(u, v));
  float* kind = out + kOfPixel;
  std::fill_n(kind, kinds_, 0.F);
  int body = 0, first = 0, second = 0;
  for (int p = 0; p < parts; ++p) {
    body += of[p];
    kind[slots_[p]] += float(of[p]);
    second = std::max(second, std::min<int>(first, of[p]));
    first = std::max<int>(first, of[p]);
  }
  for (int k = 0; k < kinds_; ++k) kind[k] /= whole;
  out[0] = float(body) / whole;
  out[1] = float(first) / whole;
  out[2] = float(second) / whole;
  out[3] = z_m;
  out += kOfPixel + kinds_;
  // What a box's sum of posteriors must be divided by besides its cells.
  const auto unit = float(posteriors_.whole);
  const float cells_per_m = camera_.fx / (z_m * float(step_));
  const auto of_box = [&](const Box4& box) {
    *out++ = float(box[kBody]) / (unit * box.cells);
    const auto readings = float(box[kReadings]);
    *out++ = readings / box.cells;
    const float beyond_m = readings > 0.F ? 1e-3F * float(box[kDepth_mm]) / readings - z_m : 0.F;
    *out++ = std::clamp(beyond_m, -kMostBeyond_m, kMostBeyond_m);
  };
  for (const float radius_m : kAbout) {
    const Box4 about = box(column, row, 0.F, 0.F, radius_m, cells_per_m);
    of_box(about);
    for (int k = 0; k < kinds_; ++k) *out++ = float(about[kFirstKind + k]) / (unit * about.cells);
  }
  for (const Around& beside : kBeside) {
    of_box(box(column, row, beside.right_m, beside.down_m, beside.radius_m, cells_per_m));
  }
}

namespace {

/// Returns by how much the log odds of a body rise at each cell; NaN where nobody asked. The cells of a row are asked
/// together, so that each tree is read once for all of them.
Image<float> ask(const BoostedTrees& context, const BodySurroundings& around, const Posteriors& posteriors,
                 const BodyModel& body) {
  Image<float> change(around.columns(), around.rows(), std::nanf(""));
  parallel_ranges(around.rows(), kRowGrain, [&](int begin, int end) {
    const auto length = static_cast<std::size_t>(context.features);
    std::vector<float> features(length * around.columns()), odds(around.columns());
    std::vector<int> open;
    for (int row = begin; row < end; ++row) {
      open.clear();
      for (int column = 0; column < around.columns(); ++column) {
        if (!around.is_open(column, row)) continue;
        around.features(column, row, features.data() + length * open.size());
        open.push_back(column);
      }
      context.log_odds(features.data(), open.size(), odds.data());
      for (std::size_t i = 0; i < open.size(); ++i) {
        const double share = *body_share(posteriors, open[i] * around.step(), row * around.step(), body.part_count());
        const auto before = float(std::max(share, 1e-3) / std::max(1.0 - share, 1e-3));
        change(open[i], row) = odds[i] - std::log(before);
      }
    }
  });
  return change;
}

/// Returns the mean change of the cells around a pixel that lie as far away as it does; 0 if there are none.
float change_at(const Image<float>& change, const DepthImage& depth, int step, int u, int v) {
  const int z_mm = depth(u, v);
  const int within = grid_within_mm(z_mm);
  float sum = 0.F;
  int count = 0;
  for (int row = v / step; row <= v / step + (v % step != 0 ? 1 : 0); ++row) {
    for (int column = u / step; column <= u / step + (u % step != 0 ? 1 : 0); ++column) {
      if (!change.contains(column, row) || std::isnan(change(column, row))) continue;
      if (std::abs(depth(column * step, row * step) - z_mm) > within) continue;
      sum += change(column, row);
      ++count;
    }
  }
  return count > 0 ? sum / float(count) : 0.F;
}

/// Makes the odds of a body so many times as large. The sum of all classes stays.
void multiply_odds(std::uint16_t* of, int parts, int body, int all, float factor) {
  const auto had = float(body);
  const float rest = float(all) - had;
  const float scale = float(all) * factor / (had * factor + rest);
  int left = all;
  for (int p = 0; p < parts; ++p) {
    const float plus_half = float(of[p]) * scale + 0.5F;
    const int share = std::min(left, int(plus_half));
    of[p] = static_cast<std::uint16_t>(share);
    left -= share;
  }
  of[parts] = static_cast<std::uint16_t>(left);
}

}  // namespace

void correct_bodies(const BoostedTrees& context, const DepthImage& depth, const Camera& camera, const BodyModel& body,
                    const Posteriors& posteriors, Posteriors& out) {
  const int parts = body.part_count();
  const BodySurroundings around(posteriors, depth, camera, body);
  const Image<float> change = ask(context, around, posteriors, body);
  out.resize_like(posteriors);
  const std::size_t row = static_cast<std::size_t>(out.width) * out.classes;
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      std::copy_n(posteriors.at(0, v), row, out.at(0, v));
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0 || (!posteriors.settled.empty() && posteriors.settled(u, v) != 0)) continue;
        const float at = change_at(change, depth, around.step(), u, v);
        if (at == 0.F) continue;
        std::uint16_t* of = out.at(u, v);
        const int of_body = std::accumulate(of, of + parts, 0);
        if (of_body > 0) multiply_odds(of, parts, of_body, of_body + of[parts], std::exp(at));
      }
    }
  });
}

}  // namespace vesalius
