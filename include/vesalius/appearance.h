#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// What pixels look like: a class for each, out of few enough that a person's few hundred pixels fill a histogram of
/// them. People are grown by their histograms (section 7), whatever the classes mean. It is shared by threads.
class Appearance {
 public:
  virtual ~Appearance() = default;
  Appearance() = default;
  Appearance(const Appearance&) = delete;
  Appearance& operator=(const Appearance&) = delete;

  /// Returns the number of classes, 1-65536.
  virtual int classes() const = 0;
  /// Returns the class of each pixel, in the picture's order. Returns nothing if the frame lacks what it takes (a
  /// colour picture, for one); then looks hold back no growth.
  virtual std::vector<std::uint16_t> describe(const Frame& frame) const = 0;
  /// Spreads the number of pixels of each class over classes that look alike.
  virtual void blur(std::vector<float>& counts) const = 0;
};

/// Hue in steps of 5 degrees, and lightness in 32 steps for colours that are too grey to have a hue.
class HueAppearance : public Appearance {
 public:
  static constexpr int kHues = 72;
  static constexpr int kGreys = 32;
  static constexpr int kClasses = kHues + kGreys;

  static int class_of(Rgb colour);

  int classes() const override { return kClasses; }
  std::vector<std::uint16_t> describe(const Frame& frame) const override;
  void blur(std::vector<float>& counts) const override;
};

/// Hue as above, apart for plain, rough and striped surroundings: the paper's example of another feature.
class TextureAppearance : public Appearance {
 public:
  static constexpr int kLevels = 3;  ///< levels of the mean step of lightness between neighbours

  int classes() const override { return kLevels * HueAppearance::kClasses; }
  std::vector<std::uint16_t> describe(const Frame& frame) const override;
  void blur(std::vector<float>& counts) const override;

 private:
  HueAppearance hue_;
};

/// Returns the appearance of a name: "hue" or "texture"; nothing for "none". Throws UsageError for any other.
std::shared_ptr<const Appearance> make_appearance(const std::string& name);

/// How often each class of an appearance occurs in some pixels, such as a person's.
class AppearanceHistogram {
 public:
  void add(std::uint16_t look) {
    if (look >= counts_.size()) counts_.resize(look + std::size_t{1}, 0);
    ++counts_[look];
    ++samples_;
  }
  /// Takes a pixel out that was added.
  void remove(std::uint16_t look) {
    --counts_[look];
    --samples_;
  }
  /// Adds the pixels of another histogram of the same appearance.
  void add(const AppearanceHistogram& other);
  /// Lets the pixels added so far count as `factor` of them, 0-1, each class rounded down.
  void scale(float factor);
  /// Returns the number of added pixels.
  long samples() const { return samples_; }
  /// Returns the probability of each class: blurred, with a share for classes that were never seen. Without samples all
  /// are the same.
  std::vector<float> probabilities(const Appearance& appearance) const;

 private:
  std::vector<std::uint32_t> counts_;
  long samples_ = 0;
};

/// What the pixels of one frame look like, which all who grow in it share.
struct Looks {
  const Appearance* appearance = nullptr;  ///< none if looks do not matter
  std::vector<std::uint16_t> classes;      ///< Appearance::describe; empty without an appearance
  AppearanceHistogram all;                 ///< of the whole picture
};
/// Returns the looks of a frame; `appearance` may be null, or must outlive them.
Looks look_at(const Frame& frame, const Appearance* appearance);

/// Returns what the pixels inside `mask`, which has the frame's size, look like; nothing if the frame lacks what the
/// appearance takes.
AppearanceHistogram learn_appearance(const Frame& frame, const Mask& mask, const Appearance& appearance);

}  // namespace vesalius
