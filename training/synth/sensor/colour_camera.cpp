#include "synth/sensor/colour_camera.h"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "synth/sensor/noise_field.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr int kNoJpeg = 100;
constexpr float kLeastBlur_px = 0.2F;  ///< what is narrower reaches no neighbour

using JpegCoder = std::unique_ptr<void, decltype(&tjDestroy)>;

/// The values of a channel by those of the scene, and of a camera's three channels.
using Levels = std::array<std::uint8_t, 256>;
using Gains = std::array<Levels, 3>;

Levels levels(double gain) {
  Levels values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<std::uint8_t>(std::min(255.0, std::round(gain * double(i))));
  }
  return values;
}

constexpr double kExposure = 0.15;                 // sigma of the logarithm of the gain
constexpr double kBalance = 0.04;                  // sigma of the logarithm between channels
constexpr double kQuietest = 2.0, kLoudest = 6.0;  // sigma of a pixel, of 255

std::uint8_t clipped(int value) { return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value); }

Gains draw_gains(Random& random) {
  const double exposure = random.normal(0.0, kExposure);
  Gains gained{};
  for (Levels& channel : gained) channel = levels(std::exp(exposure + random.normal(0.0, kBalance)));
  return gained;
}

void apply(const Gains& gained, float sigma, ColourImage& colour, Random& random) {
  const auto noise = [&] { return int(std::lround(sigma * quick_normal(random))); };
  for (Rgb& pixel : colour) {
    pixel.r = clipped(gained[0][pixel.r] + noise());
    pixel.g = clipped(gained[1][pixel.g] + noise());
    pixel.b = clipped(gained[2][pixel.b] + noise());
  }
}

/// Returns what is left of a picture after JPEG with halved colour, as cameras and recordings use it.
void through_jpeg(int quality, ColourImage& colour) {
  const JpegCoder encoder(tjInitCompress(), &tjDestroy), decoder(tjInitDecompress(), &tjDestroy);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  auto* rgb = reinterpret_cast<unsigned char*>(colour.data());
  const int width = colour.width(), height = colour.height();
  const bool encoded = encoder && decoder &&
                       tjCompress2(encoder.get(), rgb, width, 0, height, TJPF_RGB, &bytes, &size, TJSAMP_420, quality,
                                   TJFLAG_ACCURATEDCT) == 0;
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(bytes, &tjFree);
  if (!encoded || tjDecompress2(decoder.get(), bytes, size, rgb, width, 0, height, TJPF_RGB, TJFLAG_ACCURATEDCT) != 0) {
    throw Error("colour picture: libjpeg cannot encode it");
  }
}

void move_by(int right, int down, ColourImage& colour) {
  const ColourImage before = colour;
  for (int v = 0; v < colour.height(); ++v) {
    const int from_v = std::clamp(v - down, 0, colour.height() - 1);
    for (int u = 0; u < colour.width(); ++u) {
      colour(u, v) = before(std::clamp(u - right, 0, colour.width() - 1), from_v);
    }
  }
}

}  // namespace

void visit_options(const std::string& prefix, ColourCameraOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "exposure-max", o.exposure_max,
                 {"stops", 0, 5, "Greatest error of the colour camera's exposure, too dark or too bright."});
  visitor.option(
      prefix + "balance-max", o.balance_max,
      {"", 0, 0.9, "Greatest error of its white balance: red gains this share and blue loses it, or the reverse."});
  visitor.option(prefix + "noise-max", o.noise_max, {"", 1, 20, "Greatest factor of its noise, as in weak light."});
  visitor.option(prefix + "blur-max", o.blur_max_px,
                 {"pixels", 0, 20, "Greatest standard deviation of the blur of lens and focus."});
  visitor.option(prefix + "jpeg-worst", o.jpeg_worst,
                 {"", 1, 100, "Worst quality of JPEG that colour was kept in; 100: it never was."});
  visitor.option(prefix + "offset-max", o.offset_max_px,
                 {"pixels", 0, 100, "How far colour may lie off depth, along rows and along columns."});
}

ColourCamera draw_colour_camera(const ColourCameraOptions& options, Random random) {
  ColourCamera drawn;
  const auto exposure = float(std::exp2(options.exposure_max * random.uniform(-1.0, 1.0)));
  const auto warm = float(options.balance_max * random.uniform(-1.0, 1.0));
  drawn.red_gain = exposure * (1.F + warm);
  drawn.green_gain = exposure;
  drawn.blue_gain = exposure * (1.F - warm);
  drawn.noise = float(std::pow(options.noise_max, random.uniform()));
  drawn.blur_px = float(options.blur_max_px * random.uniform());
  drawn.jpeg = kNoJpeg - int(random.below(static_cast<std::uint32_t>(kNoJpeg - options.jpeg_worst + 1)));
  const auto offset = [&] {
    return int(random.below(static_cast<std::uint32_t>(2 * options.offset_max_px + 1))) - options.offset_max_px;
  };
  drawn.right = offset();
  drawn.down = offset();
  return drawn;
}

void expose(const ColourCamera& camera, ColourImage& colour) {
  if (camera.blur_px >= kLeastBlur_px) {
    cv::Mat view(colour.height(), colour.width(), CV_8UC3, colour.data());
    cv::GaussianBlur(view, view, {}, double(camera.blur_px));
  }
  if (camera.red_gain == 1.F && camera.green_gain == 1.F && camera.blue_gain == 1.F) return;
  const Levels red = levels(camera.red_gain), green = levels(camera.green_gain), blue = levels(camera.blue_gain);
  for (Rgb& pixel : colour) pixel = {red[pixel.r], green[pixel.g], blue[pixel.b]};
}

void add_colour_noise(ColourImage& colour, Random random, float louder) {
  const Gains gained = draw_gains(random);
  const auto sigma = louder * float(random.uniform(kQuietest, kLoudest));
  apply(gained, sigma, colour, random);
}

void add_colour_noise(ColourImage& colour, Random look, Random noise, float louder) {
  const Gains gained = draw_gains(look);
  const auto sigma = louder * float(look.uniform(kQuietest, kLoudest));
  apply(gained, sigma, colour, noise);
}

void record(const ColourCamera& camera, ColourImage& colour) {
  if (camera.jpeg < kNoJpeg) through_jpeg(camera.jpeg, colour);
  if (camera.right != 0 || camera.down != 0) move_by(camera.right, camera.down, colour);
}

}  // namespace vesalius::synth
