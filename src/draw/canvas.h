#pragma once

#include <opencv2/core.hpp>
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

/// Returns the picture's own pixels for OpenCV, in RGB order. They are valid as long as `image` lives.
cv::Mat view(ColourImage& image);
cv::Scalar scalar(Rgb colour);

/// Height of a line of text with its background plate, in pixels.
inline constexpr int kTextRow = 17;
int text_width(const std::string& text);

/// Draws one line of text (ASCII) with its lower left corner at pixel (u, v). Parts outside the picture are cut off.
void draw_text(ColourImage& image, const std::string& text, int u, int v, Rgb colour);

/// Draws text on a background of colour `plate`, in black or white, whichever is more legible. Both are moved into the
/// picture as far as they fit.
void draw_tag(ColourImage& image, const std::string& text, int u, int v, Rgb plate);

}  // namespace vesalius
