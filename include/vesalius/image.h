#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vesalius {

/// 8-bit colour, sRGB.
struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// A row-major picture of `width` x `height` values; u counts columns from the left, v rows from the top.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  std::size_t size() const { return pixels_.size(); }

  T& operator()(int u, int v) { return pixels_[index(u, v)]; }
  const T& operator()(int u, int v) const { return pixels_[index(u, v)]; }
  T& operator[](std::size_t i) { return pixels_[i]; }
  const T& operator[](std::size_t i) const { return pixels_[i]; }

  T* row(int v) { return pixels_.data() + index(0, v); }
  const T* row(int v) const { return pixels_.data() + index(0, v); }
  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }

  /// The comparison is unsigned, so negative coordinates are huge numbers. This halves the tests of the innermost
  /// loops.
  bool contains(int u, int v) const {
    return static_cast<unsigned>(u) < static_cast<unsigned>(width_) &&
           static_cast<unsigned>(v) < static_cast<unsigned>(height_);
  }
  template <class U>
  bool same_size(const Image<U>& other) const {
    return width_ == other.width() && height_ == other.height();
  }
  void fill(T value) { std::fill(pixels_.begin(), pixels_.end(), value); }

  auto begin() { return pixels_.begin(); }
  auto end() { return pixels_.end(); }
  auto begin() const { return pixels_.begin(); }
  auto end() const { return pixels_.end(); }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<T> pixels_;
};

/// An upright rectangle of pixels.
struct Box {
  int u = 0, v = 0, width = 0, height = 0;
};

/// Returns the smallest box around two; an empty one does not count.
inline Box around(const Box& a, const Box& b) {
  if (a.width == 0 || a.height == 0) return b;
  if (b.width == 0 || b.height == 0) return a;
  const int u = std::min(a.u, b.u), v = std::min(a.v, b.v);
  return {u, v, std::max(a.u + a.width, b.u + b.width) - u, std::max(a.v + a.height, b.v + b.height) - v};
}

/// Returns the part of a picture inside a box, which must lie within it.
template <class T>
Image<T> crop(const Image<T>& image, const Box& box) {
  Image<T> part(box.width, box.height);
  for (int v = 0; v < box.height; ++v) std::copy_n(image.row(box.v + v) + box.u, box.width, part.row(v));
  return part;
}

/// Millimetres along the optical axis; 0 = no reading.
using DepthImage = Image<std::uint16_t>;
/// Index of a body part; `kBackground` where there is none.
using LabelImage = Image<std::uint8_t>;
/// Non-zero inside.
using Mask = Image<std::uint8_t>;
using ColourImage = Image<Rgb>;

/// Returns the smallest box around the pixels inside the mask, or an empty box if there are none. All are `within` a
/// box.
inline Box bounding_box(const Mask& mask, const Box& within) {
  int left = mask.width(), right = -1, top = mask.height(), bottom = -1;
  const auto inside = [](std::uint8_t value) { return value != 0; };
  for (int v = within.v; v < within.v + within.height; ++v) {
    const std::uint8_t *row = mask.row(v), *begin = row + within.u, *end = begin + within.width;
    std::uint8_t any = 0;
    for (const std::uint8_t* at = begin; at != end; ++at) any |= *at;  // most rows, on vectors
    if (any == 0) continue;
    const std::uint8_t* first = std::find_if(begin, end, inside);
    const std::uint8_t* last = end - 1;
    while (*last == 0) --last;
    left = std::min(left, int(first - row));
    right = std::max(right, int(last - row));
    top = std::min(top, v);
    bottom = v;
  }
  return right < 0 ? Box{} : Box{left, top, right - left + 1, bottom - top + 1};
}
inline Box bounding_box(const Mask& mask) { return bounding_box(mask, {0, 0, mask.width(), mask.height()}); }

/// Label of pixels that belong to no body part, and body index of pixels that belong to no person.
inline constexpr std::uint8_t kBackground = 255;

}  // namespace vesalius
