#include "draw/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace vesalius {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.42;
constexpr int kLegibleWidth = 480;  // in narrower pictures the font takes more than a fifteenth of the height
constexpr int kPadding = 3;

bool is_light(Rgb colour) { return 0.299 * colour.r + 0.587 * colour.g + 0.114 * colour.b > 140.0; }

}  // namespace

int legible_scale(int width) { return width < kLegibleWidth ? 2 : 1; }

Rgb mix(Rgb under, Rgb over, float weight) {
  const auto channel = [weight](std::uint8_t a, std::uint8_t b) {
    const auto from = float(a);
    return static_cast<std::uint8_t>(std::lround(from + (float(b) - from) * weight));
  };
  return {channel(under.r, over.r), channel(under.g, over.g), channel(under.b, over.b)};
}

cv::Mat view(ColourImage& image) {
  static_assert(sizeof(Rgb) == 3);
  return {image.height(), image.width(), CV_8UC3, image.data()};
}

cv::Scalar scalar(Rgb colour) { return {double(colour.r), double(colour.g), double(colour.b)}; }

int text_width(const std::string& text) { return cv::getTextSize(text, kFont, kFontScale, 1, nullptr).width; }

void draw_text(ColourImage& image, const std::string& text, int u, int v, Rgb colour) {
  cv::putText(view(image), text, {u, v}, kFont, kFontScale, scalar(colour), 1, cv::LINE_AA);
}

void draw_tag(ColourImage& image, const std::string& text, int u, int v, Rgb plate) {
  const int width = text_width(text) + 2 * kPadding;
  const int left = std::clamp(u, 0, std::max(0, image.width() - width));
  const int bottom = std::clamp(v, std::min(kTextRow, image.height()), image.height());
  cv::rectangle(view(image), cv::Rect(left, bottom - kTextRow, width, kTextRow), scalar(plate), cv::FILLED);
  const Rgb ink = is_light(plate) ? Rgb{0, 0, 0} : Rgb{255, 255, 255};
  draw_text(image, text, left + kPadding, bottom - kPadding - 1, ink);
}

}  // namespace vesalius
