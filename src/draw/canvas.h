#pragma once

#include <Eigen/Core>
#include <string>

#include "vesalius/image.h"

namespace vesalius {

/// Returns the factor by which a picture of this width is enlarged so that text on it is legible.
int legible_scale(int width);

/// Returns the picture with every pixel repeated `scale` x `scale` times.
template <class T>
Image<T> enlarge(const Image<T>& image, int scale) {
  if (scale == 1) return image;
  Image<T> result(image.width() * scale, image.height() * scale);
  for (int v = 0; v < result.height(); ++v)
    for (int u = 0; u < result.width(); ++u) result(u, v) = image(u / scale, v / scale);
  return result;
}

/// Returns the colour of `over` drawn on `under` with the opacity `weight`, 0-1.
Rgb mix(Rgb under, Rgb over, float weight);

// Shapes have soft edges but for rectangles, and what is outside the picture is cut off. Places are in pixels, whole
// numbers in the middle of a pixel.

void fill_rectangle(ColourImage& image, const Box& box, Rgb colour);
/// A line with round ends.
void draw_line(ColourImage& image, const Eigen::Vector2f& from, const Eigen::Vector2f& to, float width, Rgb colour);
void draw_disc(ColourImage& image, const Eigen::Vector2f& centre, float radius, Rgb colour);
/// `radius` is that of the middle of the ring's line.
void draw_ring(ColourImage& image, const Eigen::Vector2f& centre, float radius, float width, Rgb colour);

/// Height of a line of text with its background plate, in pixels.
inline constexpr int kTextRow = 17;
int text_width(const std::string& text);

/// Draws one line of text (ASCII) with its lower left corner at pixel (u, v).
void draw_text(ColourImage& image, const std::string& text, int u, int v, Rgb colour);

/// Draws text on a background of colour `plate`, in black or white, whichever is more legible. Both are moved into the
/// picture as far as they fit.
void draw_tag(ColourImage& image, const std::string& text, int u, int v, Rgb plate);

}  // namespace vesalius
