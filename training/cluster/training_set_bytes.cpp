#include "cluster/training_set_bytes.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "cluster/message.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kMagic = 0x53545356;  // "VSTS"
constexpr std::uint32_t kVersion = 3;

/// Returns how many bytes after byte `at` the next multiple of a cache line is.
std::size_t to_line(std::size_t at) { return (kLineBytes - at % kLineBytes) % kLineBytes; }

/// A frame whose depth stands behind the message.
struct FrameHeader {
  Camera camera;
  std::uint64_t words = 0;

  static void visit_fields(auto&& visit, auto&... of) { visit("camera", of.camera...)("words", of.words...); }
};

}  // namespace

std::string training_set_bytes(const TrainingSet& set) {
  const TrainingSet::Contents& contents = set.contents();
  std::vector<FrameHeader> frames;
  for (std::size_t f = 0; f < contents.frames.size(); ++f) {
    frames.push_back({contents.frames.camera(f), contents.frames.words(f).size()});
  }
  MessageWriter out;
  std::string& bytes = out.bytes();
  bytes.reserve(set.bytes() + set.bytes() / 64);
  for (const std::uint32_t number : {kMagic, kVersion}) out.number(number);
  out.number(std::uint64_t{0});  // the checksum's place
  const std::size_t header = bytes.size();
  out("contents", contents);
  out("frames", frames);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::span<const std::uint32_t> words = contents.frames.words(f);
    bytes.append(to_line(bytes.size()), '\0');
    bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  }
  const auto checksum = static_cast<std::uint64_t>(XXH64(bytes.data() + header, bytes.size() - header, 0));
  std::memcpy(bytes.data() + header - sizeof(checksum), &checksum, sizeof(checksum));
  return std::move(bytes);
}

void append_training_set(HugeBuffer buffer, const std::string& name, TrainingSet::Contents& contents) {
  const std::string_view bytes(reinterpret_cast<const char*>(buffer.data()), buffer.size());
  MessageReader in(bytes, name);
  if (in.number<std::uint32_t>("the mark of a shard") != kMagic) throw Error(name + ": no shard of a training");
  if (const auto version = in.number<std::uint32_t>("version"); version != kVersion) {
    throw Error(fmt::format("{}: shard of version {}, expected {}", name, version, kVersion));
  }
  const auto checksum = in.number<std::uint64_t>("checksum");
  const std::string_view rest = bytes.substr(bytes.size() - in.left());
  if (checksum != XXH64(rest.data(), rest.size(), 0)) {
    throw Error(name + ": damaged, its checksum does not match; --restart makes all shards anew");
  }
  TrainingSet::Contents more{.frames = FrameStore(contents.frames.convention())};
  std::vector<FrameHeader> frames;
  in("contents", more);
  in("frames", frames);
  std::vector<FrameStore::InBlock> blocks;
  for (const FrameHeader& frame : frames) {
    in.take(to_line(bytes.size() - in.left()), "zeros before depth");
    blocks.push_back({frame.camera, bytes.size() - in.left(), frame.words});
    if (frame.words > in.left() / sizeof(std::uint32_t)) in.fail(fmt::format("{} words of depth", frame.words));
    in.take(frame.words * sizeof(std::uint32_t), "depth");
  }
  in.expect_end();

  const auto first_frame = static_cast<std::uint32_t>(contents.frames.size());
  const auto first_person = static_cast<std::uint32_t>(contents.people_samples.size());
  for (auto samples : {&TrainingSet::Contents::samples, &TrainingSet::Contents::pool, &TrainingSet::Contents::held_out,
                       &TrainingSet::Contents::people_samples}) {
    for (TrainingSample& sample : more.*samples) sample.frame += first_frame;
    (contents.*samples).insert((contents.*samples).end(), (more.*samples).begin(), (more.*samples).end());
  }
  for (const PersonSamples& person : more.people) {
    contents.people.push_back({person.heading, person.begin + first_person, person.end + first_person});
  }
  contents.class_pixels.resize(std::max(contents.class_pixels.size(), more.class_pixels.size()), 0);
  for (std::size_t k = 0; k < more.class_pixels.size(); ++k) contents.class_pixels[k] += more.class_pixels[k];
  contents.frames.add_block(std::move(buffer), blocks);
}

}  // namespace vesalius
