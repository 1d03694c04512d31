#include "cuda/device_labeller.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "vesalius/error.h"
#include "vesalius/forest/background_gate.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/smooth_window.h"
#include "vesalius/forest/tree_walk.h"

namespace vesalius::gpu {
namespace {

static_assert(kGateStep == BackgroundGate::kStep && kGuideMm == BackgroundGate::kGuideMm, "as kernels gate");

}  // namespace

std::vector<std::uint8_t> groups_of(const LogitLayout& layout) {
  std::vector<std::uint8_t> groups = layout.side;
  if (layout.background) groups.push_back(kSides);
  for (int s = 0; s < kSides; ++s)
    groups.insert(groups.end(), layout.headings, static_cast<std::uint8_t>(kSides + 1 + s));
  return groups;
}

DeviceForest::DeviceForest(const Forest& forest, const std::shared_ptr<Device>& device)
    : convention_(forest.convention), logit_unit_(forest.logit_unit), headings_(forest.headings) {
  static_assert(TreeLeaf::kClasses == kLeafClasses && sizeof(TreeLeaf) == 2 * kLeafClasses, "as kernels read leaves");
  std::vector<TreePlace> places;
  std::vector<std::uint32_t> words;
  std::vector<TreeLeaf> leaves;
  std::vector<std::int8_t> logits;
  std::uint32_t leaf_count = 0;
  for (const Tree& tree : forest.trees) {
    const PackedTree packed = pack(tree, convention_);
    if (packed.wide) words.resize((words.size() + 3) / 4 * 4);  // nodes of four words are read at once
    places.push_back({static_cast<std::uint32_t>(words.size()), leaf_count,
                      packed.wide ? 0U : static_cast<std::uint32_t>(packed.link_bits)});
    words.insert(words.end(), packed.words.begin(), packed.words.end());
    leaf_count += static_cast<std::uint32_t>(packed.leaves.size());
    if (!has_logits()) leaves.insert(leaves.end(), packed.leaves.begin(), packed.leaves.end());
    leaf_bytes_ = static_cast<std::uint32_t>(packed.lines_per_leaf * sizeof(PackedTree::LogitLine));
    const auto* first = reinterpret_cast<const std::int8_t*>(packed.logits.data());
    logits.insert(logits.end(), first, first + packed.logits.size() * sizeof(PackedTree::LogitLine));
  }
  const std::vector<std::uint8_t> groups = groups_of({forest.body, forest.has_background, forest.headings});
  const std::unique_ptr<Stream> stream = device->make_stream();
  places_ = uploaded(device, *stream, places);
  words_ = uploaded(device, *stream, words);
  leaves_ = uploaded(device, *stream, leaves);
  logits_ = uploaded(device, *stream, logits);
  groups_ = uploaded(device, *stream, groups);
  stream->wait();
}

void DeviceForest::describe(WalkArguments& walk) const {
  walk.trees = places_.data();
  walk.words = words_.data();
  walk.clip_mm = convention_.clip_mm;
  walk.hole_mm = convention_.hole_mm;
  walk.outside_mm = convention_.outside_mm;
}

void DeviceForest::describe(AddArguments& add) const {
  add.trees = trees();
  add.leaves = reinterpret_cast<const std::uint8_t*>(leaves_.data());
}

void DeviceForest::describe(LogitArguments& read) const {
  read.trees = trees();
  read.logits = logits_.data();
  read.leaf_bytes = leaf_bytes_;
  read.groups = groups_.data();
  read.places = int(groups_.size());
  read.headings = headings_;
  read.unit = logit_unit_;
  read.whole = 255.F * float(trees());
}

/// Pictures of one size that are worked on together.
struct DeviceLabeller::Batch {
  int width = 0, height = 0, count = 0;

  std::uint32_t picture_pixels() const { return static_cast<std::uint32_t>(width * height); }
  std::uint32_t pixels() const { return picture_pixels() * static_cast<std::uint32_t>(count); }
  /// Returns the pixels on every `step`-th column and row.
  std::uint32_t pixels(int step) const {
    return static_cast<std::uint32_t>((width + step - 1) / step * ((height + step - 1) / step) * count);
  }
};

/// A stream with the memory of a batch. Its functions only start work, in their order.
class DeviceLabeller::Workspace {
 public:
  Workspace(std::shared_ptr<Device> device, const DeviceForest& forest, const DeviceLabellerOptions& options)
      : device_(std::move(device)), forest_(forest), options_(options), stream_(device_->make_stream()) {}

  Stream& stream() const { return *stream_; }

  /// Makes room for a batch; the work on the one before must be done. Without headings only posteriors are found.
  void begin(const Batch& batch, int classes, int headings) {
    batch_ = batch;
    classes_ = classes;
    turn_count_ = std::size_t{kSides} * headings;
    fit(depth_, batch.pixels());
    fit(units_, batch.count);
    fit(done_, batch.pixels());
    fit(settled_, batch.pixels());
    fit(asked_, batch.pixels());
    fit(asked_count_, 1);
    fit(leaves_, std::size_t{batch.pixels()} * forest_.trees());
    fit(sums_, std::size_t{batch.pixels()} * classes);
    fit(turns_, std::size_t{batch.pixels()} * turn_count_);
    fit(states_, batch.pixels(BackgroundGate::kStep));
    host_units_.resize(batch.count);
  }

  /// Sends picture `i`.
  void send(int i, const std::uint16_t* depth, const Camera& camera) {
    const OffsetScaler scaler(forest_.convention(), camera);
    host_units_[i] = {scaler.unit_u(), scaler.unit_v()};
    const std::size_t pixels = batch_.picture_pixels();
    stream_->copy_to_device(depth_.data() + i * pixels, depth, pixels * sizeof(*depth));
  }

  /// Finds the posteriors of all pixels that were sent. `enough`: the sum of a certain background; nothing: no gate.
  void label(std::optional<long> enough) {
    stream_->copy_to_device(units_.data(), host_units_.data(), host_units_.size() * sizeof(OffsetUnits));
    stream_->clear(done_.data(), batch_.pixels());
    stream_->clear(sums_.data(), std::size_t{batch_.pixels()} * classes_ * sizeof(std::uint16_t));
    // All are copied back, and those of pixels that the forest is not asked about would be another picture's.
    if (has_turns()) stream_->clear(turns_.data(), std::size_t{batch_.pixels()} * turn_count_ * sizeof(std::uint16_t));
    has_settled_ = enough.has_value();
    if (has_settled_) {
      ask(BackgroundGate::kStep);
      launch(GateArguments{pictures(), sums_.data(), classes_, static_cast<std::int32_t>(*enough), states_.data()},
             batch_.pixels(BackgroundGate::kStep));
      launch(SettleArguments{pictures(), states_.data(), sums_.data(), classes_, done_.data(), settled_.data()},
             batch_.pixels());
    }
    ask(1);
  }

  void smooth(const SmoothWindow& window) {
    fit(means_, std::size_t{batch_.pixels()} * classes_);
    const auto most = static_cast<unsigned>(window.most());
    const unsigned pixels = pixels_in_block(options_.threads, kMeanLanes, most, kSharedNeighbours);
    MeanArguments mean{pictures(), sums_.data(), settled(), classes_};
    mean.each_way = window.each_way;
    mean.spacing = window.spacing;
    mean.gate_mm = window.gate_mm;
    mean.bits = excess_bits(255 * forest_.trees(), window);
    mean.pixels_in_block = int(pixels);
    mean.means = means_.data();
    stream_->launch(mean, {blocks_for(batch_.pixels(), pixels), 1, options_.threads});
  }

  /// Chooses labels from the means.
  void choose(int parts, const ChoiceWeights& weights) {
    fit(first_, batch_.pixels());
    fit(unsure_, batch_.pixels());
    fit(labels_, batch_.pixels());
    const ChoiceArguments choice{pictures(),   means_.data(),      settled(),      parts,        classes_,
                                 weights.part, weights.background, weights.margin, first_.data()};
    launch(ChooseAloneArguments{choice, unsure_.data()}, batch_.pixels());
    launch(AskNeighboursArguments{choice, unsure_.data(), labels_.data()}, batch_.pixels());
  }

  void fetch_posteriors(Posteriors& out) {
    stream_->copy_to_host(out.sums.data(), sums_.data(), out.sums.size() * sizeof(out.sums[0]));
    if (has_turns()) stream_->copy_to_host(out.turns.data(), turns_.data(), out.turns.size() * sizeof(out.turns[0]));
    if (has_settled_) stream_->copy_to_host(out.settled.data(), settled_.data(), out.settled.size());
  }
  void fetch_means(Posteriors& out) {
    stream_->copy_to_host(out.sums.data(), means_.data(), out.sums.size() * sizeof(out.sums[0]));
  }
  void fetch_labels(std::uint8_t* out) { stream_->copy_to_host(out, labels_.data(), batch_.pixels()); }

  /// Memory through which depth and labels of a batch go, so that copies need no help of the processor.
  std::uint16_t* pinned_depth() {
    fit(pinned_depth_, batch_.pixels());
    return pinned_depth_.data();
  }
  std::uint8_t* pinned_labels() {
    fit(pinned_labels_, batch_.pixels());
    return pinned_labels_.data();
  }

 private:
  template <class Array>
  void fit(Array& array, std::size_t count) {
    array.fit(device_, count);
  }

  bool has_turns() const { return turn_count_ > 0; }
  Pictures pictures() const { return {depth_.data(), batch_.width, batch_.height, batch_.count, batch_.width}; }
  const std::uint8_t* settled() const { return has_settled_ ? settled_.data() : nullptr; }

  void launch(const KernelCall& call, std::uint32_t threads, unsigned blocks_y = 1) {
    stream_->launch(call, {blocks_for(threads, options_.threads), blocks_y, options_.threads});
  }

  /// Asks the forest about the pixels of a grid that are not done.
  void ask(int step) {
    const std::uint32_t most = batch_.pixels(step);
    const AskedPixels asked{asked_.data(), asked_count_.data()};
    stream_->clear(asked_count_.data(), sizeof(std::uint32_t));
    launch(SelectArguments{pictures(), units_.data(), step, done_.data(), asked}, most);
    WalkArguments walk{pictures(), asked};
    walk.leaves = leaves_.data();
    walk.most_asked = most;
    forest_.describe(walk);
    launch(walk, most, static_cast<unsigned>(forest_.trees()));
    if (!forest_.has_logits()) {
      AddArguments add{pictures(), asked, leaves_.data(), most};
      forest_.describe(add);
      add.sums = sums_.data();
      add.classes = classes_;
      launch(add, most);
      return;
    }
    LogitArguments read{pictures(), asked, leaves_.data(), most};
    forest_.describe(read);
    read.classes = classes_;
    read.sums = sums_.data();
    read.turns = has_turns() ? turns_.data() : nullptr;
    const unsigned pixels =
        pixels_in_block(options_.threads, kLogitLanes, static_cast<unsigned>(read.places), kSharedLogits);
    read.pixels_in_block = int(pixels);
    stream_->launch(read, {blocks_for(most, pixels), 1, options_.threads});
  }

  std::shared_ptr<Device> device_;
  const DeviceForest& forest_;
  DeviceLabellerOptions options_;
  Batch batch_;
  int classes_ = 0;
  std::size_t turn_count_ = 0;  ///< of a pixel
  bool has_settled_ = false;
  std::vector<OffsetUnits> host_units_;
  DeviceArray<std::uint16_t> depth_;
  DeviceArray<OffsetUnits> units_;
  DeviceArray<std::uint8_t> done_, settled_, states_, first_, unsure_, labels_;
  DeviceArray<AskedPixel> asked_;
  DeviceArray<std::uint32_t> asked_count_, leaves_;
  DeviceArray<std::uint16_t> sums_, turns_, means_;
  PinnedArray<std::uint16_t> pinned_depth_;
  PinnedArray<std::uint8_t> pinned_labels_;
  std::unique_ptr<Stream> stream_;  // the last: it ends before the memory that it uses
};

DeviceLabeller::DeviceLabeller(const Forest& forest, std::shared_ptr<Device> device, DeviceLabellerOptions options)
    : TrainedLabeller(forest), options_(options), device_(std::move(device)), forest_(forest, device_) {
  if (options.threads < kLeastThreads || options.threads > kMostThreads) {
    throw Error(std::to_string(options.threads) + " threads a block, expected 32 to 1024");
  }
  if (layout().size() > int(kSharedLogits)) {
    throw DeviceError(device_->name() + ": leaves with " + std::to_string(layout().size()) +
                      " logits, expected at most 2048");
  }
}

DeviceLabeller::~DeviceLabeller() = default;

std::unique_ptr<DeviceLabeller::Workspace> DeviceLabeller::take() const {
  std::unique_ptr<Workspace> space = free_.take();
  return space != nullptr ? std::move(space) : std::make_unique<Workspace>(device_, forest_, options_);
}

namespace {

/// Returns the sum from which on the background is certain; nothing where no gate is asked for.
std::optional<long> gate_sum(const TrainedLabeller& labeller, float gate, int whole) {
  if (gate > 1.F || !labeller.layout().background) return std::nullopt;
  return std::max(0L, BackgroundGate::enough(gate, whole));
}

}  // namespace

/// Makes room in `out` and starts finding the posteriors. Returns where that is done; null for an empty picture.
std::unique_ptr<DeviceLabeller::Workspace> DeviceLabeller::start(const Frame& frame, float gate,
                                                                 Posteriors& out) const {
  const DepthImage& depth = frame.depth;
  prepare(depth, out);
  const std::optional<long> enough = gate_sum(*this, gate, whole());
  if (enough) out.settled = Mask(depth.width(), depth.height(), 0);
  if (depth.empty()) return nullptr;
  std::unique_ptr<Workspace> space = take();
  space->begin({depth.width(), depth.height(), 1}, out.classes, out.headings);
  space->send(0, depth.data(), frame.camera);
  space->label(enough);
  return space;
}

void DeviceLabeller::label_into(const Frame& frame, float gate, Posteriors& out) const {
  std::unique_ptr<Workspace> space = start(frame, gate, out);
  if (space == nullptr) return;
  space->fetch_posteriors(out);
  space->stream().wait();
  free_.give_back(std::move(space));
}

bool DeviceLabeller::label_and_smooth_into(const Frame& frame, float gate, const SmoothOptions& options,
                                           Posteriors& out, Posteriors& smooth) const {
  std::unique_ptr<Workspace> space = start(frame, gate, out);
  smooth.resize_like(out);
  if (space == nullptr) return true;
  space->smooth(smooth_window(options, frame.camera));
  space->fetch_posteriors(out);
  space->fetch_means(smooth);
  space->stream().wait();
  smooth.settled = out.settled;
  free_.give_back(std::move(space));
  return true;
}

std::vector<LabelImage> DeviceLabeller::label_pictures(const std::vector<DepthImage>& pictures,
                                                       const std::vector<Camera>& cameras, const LabelOptions& label,
                                                       const SmoothOptions& smooth) const {
  if (pictures.size() != cameras.size()) {
    throw Error(std::to_string(pictures.size()) + " pictures with " + std::to_string(cameras.size()) + " cameras");
  }
  const int classes = layout().classes();
  const std::optional<long> enough = gate_sum(*this, label.gate, whole());
  const ChoiceWeights weights = choice_weights(label, whole());
  std::vector<LabelImage> labels(pictures.size());
  for (const DepthImage& picture : pictures) check_sides(picture);

  /// Returns how many of the pictures from `first` on fit into one batch.
  const auto fitting = [&](std::size_t first) {
    const std::size_t most =
        std::max<std::size_t>(1, options_.batch_pixels / std::max<std::size_t>(1, pictures[first].size()));
    std::size_t count = 1;
    while (count < most && first + count < pictures.size() && pictures[first + count].same_size(pictures[first]) &&
           smooth_window(smooth, cameras[first + count]).spacing == smooth_window(smooth, cameras[first]).spacing) {
      ++count;
    }
    return count;
  };
  struct InWork {
    std::unique_ptr<Workspace> space;
    std::size_t first = 0, count = 0;
  };
  std::array<InWork, 2> slots;
  const auto finish = [&](InWork& slot) {
    if (slot.count == 0) return;
    slot.space->stream().wait();
    const std::uint8_t* from = slot.space->pinned_labels();
    for (std::size_t i = slot.first; i < slot.first + slot.count; ++i) {
      labels[i] = LabelImage(pictures[i].width(), pictures[i].height());
      std::copy_n(from, labels[i].size(), labels[i].data());
      from += labels[i].size();
    }
    slot.count = 0;
  };
  std::size_t next = 0;
  for (int turn = 0; next < pictures.size(); turn = 1 - turn) {
    InWork& slot = slots[turn];
    finish(slot);
    const std::size_t first = next, count = fitting(first);
    next += count;
    if (pictures[first].empty()) {
      for (std::size_t i = first; i < next; ++i) labels[i] = LabelImage(pictures[i].width(), pictures[i].height());
      continue;
    }
    if (slot.space == nullptr) slot.space = take();
    Workspace& space = *slot.space;
    space.begin({pictures[first].width(), pictures[first].height(), int(count)}, classes, 0);
    std::uint16_t* to = space.pinned_depth();
    for (std::size_t i = 0; i < count; ++i) {
      const DepthImage& picture = pictures[first + i];
      std::copy_n(picture.data(), picture.size(), to);
      space.send(int(i), to, cameras[first + i]);
      to += picture.size();
    }
    space.label(enough);
    space.smooth(smooth_window(smooth, cameras[first]));
    space.choose(layout().parts, weights);
    space.fetch_labels(space.pinned_labels());
    slot.first = first;
    slot.count = count;
  }
  for (InWork& slot : slots) {
    finish(slot);
    if (slot.space != nullptr) free_.give_back(std::move(slot.space));
  }
  return labels;
}

}  // namespace vesalius::gpu
