#include "io/model/model_contents.h"

#include <fmt/format.h>

#include "io/files/data_file.h"
#include "io/model/model_trees.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {

void write_forest(ByteWriter& out, const Forest& forest) {
  const bool logits = forest.logit_unit != 0.F;
  out.number(
      static_cast<std::uint16_t>((forest.has_background ? kForestBackground : 0U) | (logits ? kForestLogits : 0U)));
  out.real(forest.convention.offset_unit);
  out.real(forest.convention.reference_focal_px);
  out.number(forest.convention.hole_mm);
  out.number(forest.convention.outside_mm);
  out.number(forest.convention.clip_mm);
  write_trees(out, forest.trees);
  if (!logits) return;
  out.real(forest.logit_unit);
  out.number(static_cast<std::uint16_t>(forest.headings));
  write_logits(out, forest.trees);
}

void read_forest(ByteReader& in, unsigned flags, Forest& forest) {
  if (flags > (kForestBackground | kForestLogits)) in.fail(fmt::format("unknown flags {}", flags));
  forest.has_background = (flags & kForestBackground) != 0;
  forest.convention.offset_unit = in.real32("convention");
  forest.convention.reference_focal_px = in.real32("convention");
  forest.convention.hole_mm = in.number<std::uint16_t>("convention");
  forest.convention.outside_mm = in.number<std::uint16_t>("convention");
  forest.convention.clip_mm = in.number<std::uint16_t>("convention");
  forest.trees = read_trees(in);
  if ((flags & kForestLogits) == 0) return;
  forest.logit_unit = in.real32("unit of logits");
  forest.headings = in.number<std::uint16_t>("headings");
  const LogitLayout layout(forest.body, forest.has_background, forest.headings);
  read_logits(in, static_cast<std::size_t>(layout.size()), forest.trees);
}

void write_network(ByteWriter& out, const Network& network) {
  out.number(static_cast<std::uint16_t>(network.layers.size()));
  for (const Convolution& layer : network.layers) {
    out.number(static_cast<std::uint16_t>(layer.input));
    out.number(static_cast<std::uint8_t>(layer.side));
    out.number(static_cast<std::uint8_t>(layer.stride));
    out.number(static_cast<std::uint16_t>(layer.inputs));
    out.number(static_cast<std::uint16_t>(layer.outputs));
    out.number(static_cast<std::uint16_t>(layer.added + 1));
    out.real(layer.added_scale);
    out.number(static_cast<std::uint8_t>(layer.wide ? 1 : 0));
    for (const float scale : layer.scale) out.real(scale);
    for (const float offset : layer.offset) out.real(offset);
    for (const std::int8_t weight : layer.weights) out.number(static_cast<std::uint8_t>(weight));
  }
  out.number(static_cast<std::uint16_t>(network.classes_of));
  out.number(static_cast<std::uint16_t>(network.person_of));
  out.number(static_cast<std::uint16_t>(network.centres_of + 1));
}

namespace {

Convolution read_convolution(ByteReader& in) {
  Convolution layer;
  layer.input = in.number<std::uint16_t>("layer's input");
  layer.side = in.number<std::uint8_t>("side of windows");
  layer.stride = in.number<std::uint8_t>("stride");
  layer.inputs = in.number<std::uint16_t>("channels");
  layer.outputs = in.number<std::uint16_t>("channels");
  layer.added = in.number<std::uint16_t>("what is added") - 1;
  layer.added_scale = in.real32("scale of what is added");
  layer.wide = in.number<std::uint8_t>("width of results") != 0;
  for (std::vector<float>* numbers : {&layer.scale, &layer.offset}) {
    for (int i = 0; i < layer.outputs; ++i) numbers->push_back(in.real32("scales and offsets"));
  }
  const auto count = static_cast<std::size_t>(layer.side * layer.side) * static_cast<std::size_t>(layer.inputs) *
                     static_cast<std::size_t>(layer.outputs);
  for (const char weight : in.take(count, "weights")) layer.weights.push_back(static_cast<std::int8_t>(weight));
  return layer;
}

}  // namespace

Network read_network(ByteReader& in, bool centres) {
  Network network;
  const int layers = in.number<std::uint16_t>("number of layers");
  for (int i = 0; i < layers; ++i) network.layers.push_back(read_convolution(in));
  network.classes_of = in.number<std::uint16_t>("layer of classes");
  network.person_of = in.number<std::uint16_t>("layer of votes");
  if (centres) network.centres_of = in.number<std::uint16_t>("layer of centres") - 1;
  return network;
}

Network load_network(const std::string& path, int parts) {
  const std::string bytes = read_file(path);
  ByteReader in(bytes, path);
  const std::string made_from(in.text("how the network was made"));
  Network network = read_network(in);
  in.expect_end();
  with_context(path, [&] { check(network, parts); });
  network.made_from = made_from;
  return network;
}

void write_headings(ByteWriter& out, const FacingModel& headings) {
  out.number(static_cast<std::uint32_t>(headings.weights.size()));
  for (const float weight : headings.weights) out.real(weight);
}

FacingModel read_headings(ByteReader& in, int headings, int parts) {
  FacingModel facing{headings, parts, {}};
  const auto count = in.number<std::uint32_t>("weights of headings");
  const std::size_t expected = facing.features() * static_cast<std::size_t>(headings);
  if (count != 0 && count != expected) in.fail(fmt::format("{} weights of headings, expected {}", count, expected));
  for (std::uint32_t i = 0; i < count; ++i) facing.weights.push_back(in.real32("weights of headings"));
  return facing;
}

void write_boosted(ByteWriter& out, const BoostedTrees& boosted) {
  out.number(static_cast<std::uint16_t>(boosted.asks.size()));
  for (const std::string& name : boosted.asks) out.text(name);
  out.number(static_cast<std::uint16_t>(boosted.features));
  out.real(boosted.bias);
  out.number(static_cast<std::uint32_t>(boosted.trees.size()));
  for (const BoostedTree& tree : boosted.trees) {
    for (const std::uint16_t feature : tree.feature) out.number(feature);
    for (const float threshold : tree.threshold) out.real(threshold);
    for (const float value : tree.value) out.real(value);
  }
}

BoostedTrees read_boosted(ByteReader& in, const char* what, bool names) {
  BoostedTrees boosted;
  const int named = names ? in.number<std::uint16_t>(what) : 0;
  for (int i = 0; i < named; ++i) boosted.asks.emplace_back(in.text(what));
  boosted.features = in.number<std::uint16_t>(what);
  boosted.bias = in.real32(what);
  const auto count = in.number<std::uint32_t>(what);
  for (std::uint32_t t = 0; t < count; ++t) {
    BoostedTree& tree = boosted.trees.emplace_back();
    for (std::uint16_t& feature : tree.feature) feature = in.number<std::uint16_t>(what);
    for (float& threshold : tree.threshold) threshold = in.real32(what);
    for (float& value : tree.value) value = in.real32(what);
  }
  return boosted;
}

}  // namespace vesalius
