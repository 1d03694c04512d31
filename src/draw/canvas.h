#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "vesalius/base/image.h"

namespace vesalius {

/// Factor by which pictures of this width are enlarged, so that text on them is legible.
int legible_scale(int width);

/// Every pixel repeated `scale` x `scale` times.
template <class T>
Image<T> enlarge(const Image<T>& image, int scale) {
  if (scale == 1) return image;
  Image<T> result(image.width() * scale, image.height() * scale);
  for (int v = 0; v < result.height(); ++v)
    for (int u = 0; u < result.width(); ++u) result(u, v) = image(u / scale, v / scale);
  return result;
}

/// `weight` of `over` on top of `under`, 0-1.
Rgb mix(Rgb under, Rgb over, float weight);

/// The picture's own pixels for OpenCV, in RGB order. Valid while `image` lives.
cv::Mat view(ColourImage& image);
cv::Scalar scalar(Rgb colour);

/// Height of a line of text and its plate, pixels.
inline constexpr int kTextRow = 17;
int text_width(const std::string& text);

/// One line of text (ASCII) whose lower left corner is (u, v), pixels; what leaves the picture is cut off.
void draw_text(ColourImage& image, const std::string& text, int u, int v, Rgb colour);

/// Text on a plate of `plate` colour, black or white to be read on it, moved into the picture as far as it fits.
void draw_tag(ColourImage& image, const std::string& text, int u, int v, Rgb plate);

}  // namespace vesalius
