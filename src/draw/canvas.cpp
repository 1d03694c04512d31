#include "draw/canvas.h"

#include <agg_conv_stroke.h>
#include <agg_ellipse.h>
#include <agg_gsv_text.h>
#include <agg_path_storage.h>
#include <agg_pixfmt_rgb.h>
#include <agg_rasterizer_scanline_aa.h>
#include <agg_renderer_base.h>
#include <agg_renderer_scanline.h>
#include <agg_scanline_u.h>

#include <algorithm>
#include <cmath>

namespace vesalius {
namespace {

constexpr double kTextSize = 9.0;  // height of capitals, pixels
constexpr double kTextStroke = 1.3;
constexpr int kLegibleWidth = 480;  // in narrower pictures the font takes more than a fifteenth of the height
constexpr int kPadding = 3;
constexpr double kMiddle = 0.5;  // AGG counts from the corner of the first pixel

bool is_light(Rgb colour) { return 0.299 * colour.r + 0.587 * colour.g + 0.114 * colour.b > 140.0; }

/// Fills the area of an AGG path.
template <class Path>
void fill(ColourImage& image, Path& path, Rgb colour) {
  static_assert(sizeof(Rgb) == 3);
  agg::rendering_buffer buffer(reinterpret_cast<agg::int8u*>(image.data()), unsigned(image.width()),
                               unsigned(image.height()), image.width() * 3);
  agg::pixfmt_rgb24 pixels(buffer);
  agg::renderer_base<agg::pixfmt_rgb24> renderer(pixels);
  agg::rasterizer_scanline_aa<> area;
  area.clip_box(0.0, 0.0, image.width(), image.height());
  area.add_path(path);
  agg::scanline_u8 scanline;
  agg::render_scanlines_aa_solid(area, scanline, renderer, agg::rgba8(colour.r, colour.g, colour.b));
}

/// Draws along an AGG path.
template <class Path>
void stroke(ColourImage& image, Path& path, double width, Rgb colour) {
  agg::conv_stroke<Path> line(path);
  line.width(width);
  line.line_cap(agg::round_cap);
  line.line_join(agg::round_join);
  fill(image, line, colour);
}

agg::ellipse circle(const Eigen::Vector2f& centre, float radius) {
  constexpr unsigned kCorners = 64;
  return {centre.x() + kMiddle, centre.y() + kMiddle, radius, radius, kCorners};
}

/// Text as AGG's strokes.
struct TextPath : agg::gsv_text {
  explicit TextPath(const std::string& of) {
    size(kTextSize);
    flip(true);
    text(of.c_str());
  }
};

}  // namespace

int legible_scale(int width) { return width < kLegibleWidth ? 2 : 1; }

Rgb mix(Rgb under, Rgb over, float weight) {
  const auto channel = [weight](std::uint8_t a, std::uint8_t b) {
    const auto from = float(a);
    return static_cast<std::uint8_t>(std::lround(from + (float(b) - from) * weight));
  };
  return {channel(under.r, over.r), channel(under.g, over.g), channel(under.b, over.b)};
}

void fill_rectangle(ColourImage& image, const Box& box, Rgb colour) {
  const int left = std::max(0, box.u), right = std::min(image.width(), box.u + box.width);
  for (int v = std::max(0, box.v); v < std::min(image.height(), box.v + box.height) && left < right; ++v)
    std::fill(image.row(v) + left, image.row(v) + right, colour);
}

void draw_line(ColourImage& image, const Eigen::Vector2f& from, const Eigen::Vector2f& to, float width, Rgb colour) {
  agg::path_storage path;
  path.move_to(from.x() + kMiddle, from.y() + kMiddle);
  path.line_to(to.x() + kMiddle, to.y() + kMiddle);
  stroke(image, path, width, colour);
}

void draw_disc(ColourImage& image, const Eigen::Vector2f& centre, float radius, Rgb colour) {
  agg::ellipse path = circle(centre, radius);
  fill(image, path, colour);
}

void draw_ring(ColourImage& image, const Eigen::Vector2f& centre, float radius, float width, Rgb colour) {
  agg::ellipse path = circle(centre, radius);
  stroke(image, path, width, colour);
}

int text_width(const std::string& text) { return int(std::ceil(TextPath(text).text_width())); }

void draw_text(ColourImage& image, const std::string& text, int u, int v, Rgb colour) {
  TextPath path(text);
  path.start_point(u + kMiddle, v + kMiddle);
  stroke(image, path, kTextStroke, colour);
}

void draw_tag(ColourImage& image, const std::string& text, int u, int v, Rgb plate) {
  const int width = text_width(text) + 2 * kPadding;
  const int left = std::clamp(u, 0, std::max(0, image.width() - width));
  const int bottom = std::clamp(v, std::min(kTextRow, image.height()), image.height());
  fill_rectangle(image, {left, bottom - kTextRow, width, kTextRow}, plate);
  const Rgb ink = is_light(plate) ? Rgb{0, 0, 0} : Rgb{255, 255, 255};
  draw_text(image, text, left + kPadding, bottom - kPadding - 1, ink);
}

}  // namespace vesalius
