#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vesalius {

/// One convolution of a Network, in integers. Pictures inside a network are its input or what a convolution made;
/// narrow ones have values of 0 to 255, wide ones 16 bits with a sign. The result at a pixel and an output channel is
///
///     round(scale * sum + offset + added_scale * added)      rounded to even, then clamped to the result's range
///
/// where `sum` is that of weights times values, exact in 32 bits, and each operation is one of IEEE singles: the same
/// bytes on every processor, for any order of the sum. Outside of the picture values are 0, those of the network's
/// input kNetworkZero. With stride 2 the result has every second pixel of every second row, the first included.
struct Convolution {
  int input = 0;    ///< what it reads, narrow: 0 is the network's input, n what convolution n - 1 made
  int side = 3;     ///< width and height of its window, 1 or 3
  int stride = 1;   ///< 1 or 2
  int inputs = 0;   ///< channels of what it reads
  int outputs = 0;  ///< channels of what it makes
  /// What is added, an earlier result (numbered as `input`) of the same channels; of half the size it is enlarged by
  /// doubling pixels. -1: none.
  int added = -1;
  float added_scale = 0.F;
  bool wide = false;                           ///< whether the result is wide; narrow results are thereby rectified
  std::vector<std::int8_t> weights = {};       ///< [output][row][column][input]
  std::vector<float> scale = {}, offset = {};  ///< of each output
  friend bool operator==(const Convolution&, const Convolution&) = default;
};

/// Channels of a network's input, which stand for a depth picture and the camera's focal length (network_input.h).
inline constexpr int kNetworkInputs = 8;
/// What stands for no reading, in all of them.
inline constexpr int kNetworkZero = 88;
/// Pictures are padded to a multiple of this with pixels that have no reading.
inline constexpr int kNetworkMultiple = 32;

/// Unit of logits of classes, nats.
inline constexpr float kLogitUnit = 1.F / 256.F;

/// A network of convolutions that labels depth pictures, and knows of each pixel where its person's middle is. Some
/// know of each pixel where all parts of its person are.
struct Network {
  std::vector<Convolution> layers;
  int classes_of = -1;  ///< layer, at half the size: logits of the body's parts and, last, of the background; wide
  /// Layer, at a quarter of the size: the numbers of a PersonVote (labeller.h); wide.
  int person_of = -1;
  /// Layer, at an eighth of the size: of each part the way (x, y, z in mm) from the pixel's point to the part's centre,
  /// also of a hidden part; wide. -1: the network does not say.
  int centres_of = -1;
  std::string made_from;  ///< how it was learned; free text
};

/// The numbers of a PersonVote (labeller.h).
inline constexpr int kPersonNumbers = 5;
/// Those of a way to a part's centre.
inline constexpr int kCentreNumbers = 3;

/// A picture inside a network; its width and height are those of the input, halved so many times.
struct NetworkPicture {
  int channels = 0;
  int halvings = 0;
  bool wide = false;

  friend bool operator==(const NetworkPicture&, const NetworkPicture&) = default;
};

/// Returns what a network's pictures are: first its input, then what each convolution makes. Throws Error naming the
/// layer if one reads what is not there yet, if sizes, channels or numbers of weights do not fit each other or are
/// beyond what the program computes (sums then stay within 32 bits), or if a scale is not finite or very large.
std::vector<NetworkPicture> pictures_of(const Network& network);

/// Throws what `pictures_of` throws, and Error if a head has not the size or the outputs of `parts` parts.
void check(const Network& network, int parts);

}  // namespace vesalius
