#pragma once

// What kernels (kernels.cuh) are told. Pictures of one size are worked on together, a camera each: a kernel's threads
// go over the pixels of all of them. All pointers are to the device's memory.

#include <cstddef>
#include <cstdint>

#include "cuda/kernel_call.h"

namespace vesalius::gpu {

/// Depth in mm, [picture][row][column].
struct Pictures {
  const std::uint16_t* depth = nullptr;
  int width = 0, height = 0;
  int count = 0;
  int stride = 0;  ///< values from one row to the next
};

/// Scale of offsets of a picture's camera at 1 mm (OffsetScaler).
struct OffsetUnits {
  double u = 0.0, v = 0.0;
};

/// A pixel about which the forest is asked.
struct alignas(16) AskedPixel {
  std::uint16_t u = 0, v = 0;
  std::uint32_t picture = 0;
  std::int32_t scale_u = 0, scale_v = 0;
};

struct AskedPixels {
  AskedPixel* pixels = nullptr;
  std::uint32_t* count = nullptr;
};

/// Classes of a leaf with a distribution (TreeLeaf).
inline constexpr int kLeafClasses = 4;

/// Where a tree is among all.
struct TreePlace {
  std::uint32_t word = 0;       ///< the word of its root (PackedTree)
  std::uint32_t leaf = 0;       ///< its first
  std::uint32_t link_bits = 0;  ///< 0 for nodes of four words
};

/// Lists pixels with a reading on every `step`-th column and row that are not yet done, and marks them as done. The
/// order differs from run to run. One thread for each pixel of the grid.
struct SelectArguments {
  static constexpr const char* kName = "select";
  Pictures pictures;
  const OffsetUnits* units = nullptr;  ///< [picture]
  int step = 1;
  std::uint8_t* done = nullptr;  ///< [picture][row][column]
  AskedPixels asked;
};

/// Finds the leaf that each asked pixel reaches in each tree, counted from the first leaf of the first tree. One thread
/// for each asked pixel there may be, blocks_y: trees.
struct WalkArguments {
  static constexpr const char* kName = "walk";
  Pictures pictures;
  AskedPixels asked;
  const TreePlace* trees = nullptr;
  const std::uint32_t* words = nullptr;
  int clip_mm = 0, hole_mm = 0, outside_mm = 0;  ///< FeatureConvention
  std::uint32_t* leaves = nullptr;               ///< [tree][asked]
  std::uint32_t most_asked = 0;
};

/// Adds up the distributions of the leaves that pixels reached (eq. 2); `sums` were 0. One thread for each asked pixel.
struct AddArguments {
  static constexpr const char* kName = "add";
  Pictures pictures;
  AskedPixels asked;
  const std::uint32_t* reached = nullptr;  ///< [tree][asked]
  std::uint32_t most_asked = 0;
  int trees = 0;
  const std::uint8_t* leaves = nullptr;  ///< [leaf]: kLeafClasses labels and their probabilities
  std::uint16_t* sums = nullptr;         ///< [picture][row][column][class]
  int classes = 0;
};

/// Reads posteriors and headings from the logits of the leaves that pixels reached, as LogitReader does. A block has
/// `pixels_in_block` asked pixels with kLogitLanes threads each.
struct LogitArguments {
  static constexpr const char* kName = "logits";
  Pictures pictures;
  AskedPixels asked;
  const std::uint32_t* reached = nullptr;
  std::uint32_t most_asked = 0;
  int trees = 0;
  const std::int8_t* logits = nullptr;  ///< [leaf][leaf_bytes]
  std::uint32_t leaf_bytes = 0;
  const std::uint8_t* groups = nullptr;  ///< [place]: side of a part 0 to 2, background 3, 4 + side of a heading
  int places = 0, classes = 0, headings = 0;
  float unit = 0.F, whole = 0.F;
  int pixels_in_block = 0;
  std::uint16_t* sums = nullptr;
  std::uint16_t* turns = nullptr;  ///< null if nobody asks
};

/// The gate's grid and the largest difference in depth between a pixel and a neighbour whose sums it takes, as
/// BackgroundGate has them.
constexpr int kGateStep = 4;
constexpr int kGuideMm = 50;

/// Tells for every fourth pixel of every fourth row whether the background is certain there. One thread for each.
struct GateArguments {
  static constexpr const char* kName = "gate";
  Pictures pictures;
  const std::uint16_t* sums = nullptr;
  int classes = 0;
  std::int32_t enough = 0;         ///< sum of a certain background
  std::uint8_t* states = nullptr;  ///< [picture][row / 4][column / 4]: 0 no reading, 1 certain, 3 not
};

/// Gives pixels that are shut in by certain ones their nearest neighbour's sums. One thread for each pixel.
struct SettleArguments {
  static constexpr const char* kName = "settle";
  Pictures pictures;
  const std::uint8_t* states = nullptr;
  std::uint16_t* sums = nullptr;
  int classes = 0;
  std::uint8_t* done = nullptr;
  std::uint8_t* settled = nullptr;
};

/// Writes the means over near neighbours of similar depth (mean_filter). A block has `pixels_in_block` pixels with
/// kMeanLanes threads each.
struct MeanArguments {
  static constexpr const char* kName = "mean";
  Pictures pictures;
  const std::uint16_t* sums = nullptr;
  const std::uint8_t* settled = nullptr;  ///< may be null
  int classes = 0;
  int each_way = 0, spacing = 1, gate_mm = 0, bits = 0;
  int pixels_in_block = 0;
  std::uint16_t* means = nullptr;
};

/// What labels are chosen from (choose_labels).
struct ChoiceArguments {
  Pictures pictures;
  const std::uint16_t* sums = nullptr;
  const std::uint8_t* settled = nullptr;  ///< may be null
  int parts = 0, classes = 0;             ///< one more class than parts where there is a background
  std::int64_t part_weight = 0, background_weight = 0, margin = 0;
  std::uint8_t* first = nullptr;  ///< what pixels choose by themselves; the background is class `parts`
};

/// Chooses for every pixel by itself. One thread for each.
struct ChooseAloneArguments {
  static constexpr const char* kName = "choose";
  ChoiceArguments choice;
  std::uint8_t* unsure = nullptr;
};

/// Lets the neighbours decide about unsure pixels. One thread for each pixel.
struct AskNeighboursArguments {
  static constexpr const char* kName = "neighbours";
  ChoiceArguments choice;
  const std::uint8_t* unsure = nullptr;
  std::uint8_t* labels = nullptr;  ///< kBackground where there is no part
};

/// What is read or written at once.
struct alignas(8) TwoWords {
  std::uint32_t word[2];
};
struct alignas(16) FourWords {
  std::uint32_t word[4];
};

/// A picture inside a network, pixel after pixel, row after row: narrow values with room for a multiple of
/// kReadChannels, of which those beyond the picture's channels are undefined, or wide ones.
struct NetworkValues {
  std::uint8_t* narrow = nullptr;
  std::int16_t* wide = nullptr;  ///< one of both is null
  int width = 0, height = 0;
  int room = 0;  ///< values of a pixel

  constexpr std::size_t place(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(room);
  }
};
inline constexpr int kReadChannels = 8;  ///< that are read at once
/// What a thread makes: pixels beside each other, and channels.
inline constexpr int kConvolvePixels = 4;
inline constexpr int kConvolveChannels = 4;

/// One convolution of a network (vesalius/network/network.h). For every kConvolvePixels pixels of a row a thread for
/// each group of kConvolveChannels channels, blocks_y: rows of the result.
struct ConvolveArguments {
  static constexpr const char* kName = "convolve";
  NetworkValues in, out;
  NetworkValues added;  ///< both of its pointers are null where nothing is; of half the size it is enlarged
  float added_scale = 0.F;
  std::uint32_t outside_word = 0;  ///< four values outside of what is read
  int side = 3, stride = 1, outputs = 0;
  /// [row][column][four inputs][group of outputs], a word for each output; 0 for channels that are not there.
  const FourWords* weights = nullptr;
  const float* scale = nullptr;  ///< [output]
  const float* offset = nullptr;
};

/// All kernels of labelling.
using LabelKernels =
    KernelList<SelectArguments, WalkArguments, AddArguments, LogitArguments, GateArguments, SettleArguments,
               MeanArguments, ChooseAloneArguments, AskNeighboursArguments, ConvolveArguments>;

/// Threads that share a pixel, neighbours so that they read a leaf's logits or a pixel's sums together: four logits
/// each, two classes each.
inline constexpr unsigned kLogitLanes = 16;
inline constexpr unsigned kMeanLanes = 16;
/// What a block has room for in shared memory.
inline constexpr unsigned kSharedLogits = 2048;
inline constexpr unsigned kSharedNeighbours = 2048;

/// Returns how many pixels a block of so many threads takes where each needs `room` of `shared` places: at least 1.
constexpr unsigned pixels_in_block(unsigned threads, unsigned lanes, unsigned room, unsigned shared) {
  const unsigned by_threads = threads / lanes, by_room = shared / room;
  const unsigned most = by_threads < by_room ? by_threads : by_room;
  return most > 0 ? most : 1;
}

}  // namespace vesalius::gpu
