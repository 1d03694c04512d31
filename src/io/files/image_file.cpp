#include "vesalius/image_file.h"

#include <fmt/format.h>
#include <spng.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <cstdlib>
#include <memory>
#include <utility>

#include "io/files/atomic_file.h"
#include "io/files/av_pictures.h"
#include "io/files/data_file.h"
#include "io/files/image_bytes.h"
#include "io/files/known_kind.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Png = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;
using Jpeg = std::unique_ptr<void, decltype(&tjDestroy)>;

[[noreturn]] void fail_to_decode(const std::string& name) {
  throw Error(name + ": damaged picture: it cannot be decoded");
}

/// Decodes a PNG that check_png took, as `format` says, which gives pixels of T.
template <class T>
Image<T> decode_png(const PngBytes& png, spng_format format, const std::string& name) {
  const Png context(spng_ctx_new(0), &spng_ctx_free);
  Image<T> image(png.width, png.height);
  if (!context || spng_set_png_buffer(context.get(), png.pixels.data(), png.pixels.size()) != 0 ||
      spng_decode_image(context.get(), image.data(), image.size() * sizeof(T), format, 0) != 0) {
    fail_to_decode(name);
  }
  return image;
}

template <class T>
Image<T> decode_grey_png(std::string_view bytes, const std::string& name, const char* expected) {
  const PngBytes png = check_png(bytes, name);
  if (png.colour_type != 0 || png.bit_depth != 8 * int(sizeof(T))) {
    const char* kind = png.colour_type == 0 ? "grey" : png.colour_type == 4 ? "grey and alpha" : "colour";
    throw Error(fmt::format("{}: {}-bit {} PNG, expected {}", name, png.bit_depth, kind, expected));
  }
  return decode_png<T>(png, SPNG_FMT_PNG, name);
}

ColourImage decode_jpeg(std::string_view bytes, const std::string& name) {
  const Jpeg decoder(tjInitDecompress(), &tjDestroy);
  const auto* jpeg = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (!decoder ||
      tjDecompressHeader3(decoder.get(), jpeg, bytes.size(), &width, &height, &subsampling, &colours) != 0) {
    fail_to_decode(name);
  }
  if (colours == TJCS_CMYK || colours == TJCS_YCCK) throw Error(name + ": JPEG of CMYK, expected RGB or grey");
  ColourImage image(width, height);
  auto* rgb = reinterpret_cast<unsigned char*>(image.data());
  // Cameras write JPEG of which libjpeg warns, but that it decodes.
  if (tjDecompress2(decoder.get(), jpeg, bytes.size(), rgb, width, 0, height, TJPF_RGB, 0) != 0 &&
      tjGetErrorCode(decoder.get()) != TJERR_WARNING) {
    fail_to_decode(name);
  }
  return image;
}

ColourImage decode_ppm(std::string_view bytes, const std::string& name) {
  const PnmHeader header = check_pnm(bytes, 3, name);
  if (header.most > 0xFF) throw Error(name + ": PPM of 16 bits, expected 8");
  ColourImage image(header.width, header.height);
  copy_rows(bytes.data() + header.begin, std::size_t(header.width) * sizeof(Rgb), image);
  return image;
}

/// Fast rather than small: most of such files are frames.
template <class T>
std::string encode(const Image<T>& image, spng_color_type colours, int bits) {
  const Png context(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width());
  header.height = static_cast<std::uint32_t>(image.height());
  header.bit_depth = static_cast<std::uint8_t>(bits);
  header.color_type = static_cast<std::uint8_t>(colours);
  int error = context ? spng_set_ihdr(context.get(), &header) : SPNG_EMEM;
  for (const auto& [option, value] : {std::pair(SPNG_ENCODE_TO_BUFFER, 1),
                                      {SPNG_IMG_COMPRESSION_LEVEL, Z_BEST_SPEED},
                                      {SPNG_IMG_COMPRESSION_STRATEGY, Z_RLE},
                                      {SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB}}) {
    if (error == 0) error = spng_set_option(context.get(), option, value);
  }
  if (error == 0) {
    error =
        spng_encode_image(context.get(), image.data(), image.size() * sizeof(T), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  }
  std::size_t size = 0;
  const auto free = [](void* bytes) { std::free(bytes); };
  const std::unique_ptr<void, decltype(free)> bytes(
      error == 0 ? spng_get_png_buffer(context.get(), &size, &error) : nullptr, free);
  if (!bytes) throw Error(fmt::format("picture cannot be encoded as PNG: {}", spng_strerror(error)));
  return {static_cast<const char*>(bytes.get()), size};
}

template <class T>
void write(const Image<T>& image, const std::string& path) {
  write_file_atomically(path, with_context(path, [&] { return encode_png(image); }));
}

}  // namespace

Image<std::uint16_t> decode_depth_png(std::string_view bytes, const std::string& name) {
  return decode_grey_png<std::uint16_t>(bytes, name, "16-bit grey (depth, 0 = no reading)");
}

Image<std::uint16_t> read_png16(const std::string& path) { return decode_depth_png(read_file(path), path); }

Image<std::uint8_t> read_png8(const std::string& path) {
  return decode_grey_png<std::uint8_t>(read_file(path), path, "8-bit grey");
}

static_assert(sizeof(Rgb) == 3);

ColourImage decode_colour(std::string_view bytes, const std::string& name) {
  if (is_png(bytes)) return decode_png<Rgb>(check_png(bytes, name), SPNG_FMT_RGB8, name);
  if (is_ppm(bytes)) return decode_ppm(bytes, name);
  if (const std::string_view kind = av_picture_kind(bytes); !kind.empty()) {
    AvPicture picture = decode_av_picture(bytes, name);
    if (picture.colour.empty()) throw Error(fmt::format("{}: {} of 16 bits or floats, expected colours", name, kind));
    return std::move(picture.colour);
  }
  if (!is_jpeg(bytes)) {
    throw Error(fmt::format("{}: {}, expected a PNG, JPEG, PPM, TIFF or WebP", name,
                            bytes.empty() ? "empty file" : kind_or(bytes, "unknown kind of picture")));
  }
  check_jpeg(bytes, name);
  return decode_jpeg(bytes, name);
}

ColourImage read_colour(const std::string& path) { return decode_colour(read_file(path), path); }

std::string encode_png(const Image<std::uint16_t>& image) { return encode(image, SPNG_COLOR_TYPE_GRAYSCALE, 16); }

std::string encode_png(const Image<std::uint8_t>& image) { return encode(image, SPNG_COLOR_TYPE_GRAYSCALE, 8); }

std::string encode_png(const ColourImage& image) { return encode(image, SPNG_COLOR_TYPE_TRUECOLOR, 8); }

std::string encode_jpeg(const ColourImage& image, int quality) {
  if (image.empty()) throw Error("picture cannot be encoded as JPEG: it is empty");
  const Jpeg encoder(tjInitCompress(), &tjDestroy);
  unsigned char* jpeg = nullptr;
  unsigned long size = 0;
  const auto* rgb = reinterpret_cast<const unsigned char*>(image.data());
  const int error = encoder ? tjCompress2(encoder.get(), rgb, image.width(), 0, image.height(), TJPF_RGB, &jpeg, &size,
                                          TJSAMP_420, quality, 0)
                            : -1;
  const std::unique_ptr<unsigned char, decltype(&tjFree)> bytes(jpeg, &tjFree);
  if (error != 0) throw Error(fmt::format("picture cannot be encoded as JPEG: {}", tjGetErrorStr2(encoder.get())));
  return {reinterpret_cast<const char*>(jpeg), size};
}

void write_png(const Image<std::uint16_t>& image, const std::string& path) { write(image, path); }
void write_png(const Image<std::uint8_t>& image, const std::string& path) { write(image, path); }
void write_png(const ColourImage& image, const std::string& path) { write(image, path); }

}  // namespace vesalius
