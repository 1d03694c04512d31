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
constexpr std::uint16_t kVersion = 2;

/// Returns how many bytes after byte `at` the next multiple of a cache line is.
std::size_t to_line(std::size_t at) { return (kLineBytes - at % kLineBytes) % kLineBytes; }

}  // namespace

std::string training_set_bytes(const TrainingSet& set) {
  MessageWriter body;
  const TrainingSet::Contents& contents = set.contents();
  body.bytes().reserve(set.bytes() + set.bytes() / 64);
  body.number(kMagic);
  body.number(kVersion);
  body.number(std::uint16_t{0});
  body.number(std::uint64_t{0});  // the checksum's place
  const std::size_t header = body.bytes().size();
  body.array(contents.samples);
  body.array(contents.pool);
  body.array(contents.held_out);
  body.array(contents.people_samples);
  std::vector<std::uint32_t> people;  // the struct has bytes without meaning
  for (const PersonSamples& person : contents.people) {
    people.insert(people.end(), {person.heading, person.begin, person.end});
  }
  body.array(people);
  body.array(contents.class_pixels);
  body.number(static_cast<std::uint64_t>(contents.frames.size()));
  for (std::size_t f = 0; f < contents.frames.size(); ++f) {
    const Camera& camera = contents.frames.camera(f);
    for (const int side : {camera.width, camera.height}) body.number(static_cast<std::uint32_t>(side));
    for (const float number : {camera.fx, camera.fy, camera.cx, camera.cy}) body.real(number);
    const std::span<const std::uint32_t> words = contents.frames.words(f);
    body.number(static_cast<std::uint64_t>(words.size()));
    body.bytes().append(to_line(body.bytes().size()), '\0');
    body.bytes().append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  }
  std::string& bytes = body.bytes();
  const auto checksum = static_cast<std::uint64_t>(XXH64(bytes.data() + header, bytes.size() - header, 0));
  std::memcpy(bytes.data() + header - sizeof(checksum), &checksum, sizeof(checksum));
  return std::move(bytes);
}

void append_training_set(HugeBuffer buffer, const std::string& name, TrainingSet::Contents& contents) {
  const std::string_view bytes(reinterpret_cast<const char*>(buffer.data()), buffer.size());
  MessageReader in(bytes, name);
  if (in.number<std::uint32_t>("the mark of a shard") != kMagic) throw Error(name + ": no shard of a training");
  if (const auto version = in.number<std::uint16_t>("version"); version != kVersion) {
    throw Error(fmt::format("{}: shard of version {}, expected {}", name, version, kVersion));
  }
  in.number<std::uint16_t>("zero");
  const auto checksum = in.number<std::uint64_t>("checksum");
  const std::string_view rest = bytes.substr(bytes.size() - in.left());
  if (checksum != XXH64(rest.data(), rest.size(), 0)) {
    throw Error(name + ": damaged, its checksum does not match; --restart makes all shards anew");
  }
  const auto first_frame = static_cast<std::uint32_t>(contents.frames.size());
  const auto append_samples = [&](std::vector<TrainingSample>& all, const char* what) {
    std::vector<TrainingSample> more = in.array<TrainingSample>(what);
    for (TrainingSample& sample : more) sample.frame += first_frame;
    all.insert(all.end(), more.begin(), more.end());
  };
  const auto first_person = static_cast<std::uint32_t>(contents.people_samples.size());
  append_samples(contents.samples, "samples");
  append_samples(contents.pool, "background");
  append_samples(contents.held_out, "held-out samples");
  append_samples(contents.people_samples, "people's samples");
  const auto people = in.array<std::uint32_t>("people");
  for (std::size_t i = 0; i + 2 < people.size(); i += 3) {
    contents.people.push_back(
        {static_cast<std::uint8_t>(people[i]), people[i + 1] + first_person, people[i + 2] + first_person});
  }
  const auto pixels = in.array<std::uint64_t>("pixels");
  contents.class_pixels.resize(std::max(contents.class_pixels.size(), pixels.size()), 0);
  for (std::size_t k = 0; k < pixels.size(); ++k) contents.class_pixels[k] += pixels[k];
  std::vector<FrameStore::InBlock> frames;
  for (auto left = in.number<std::uint64_t>("frames"); left > 0; --left) {
    FrameStore::InBlock& frame = frames.emplace_back();
    Camera& camera = frame.camera;
    camera.width = static_cast<int>(in.number<std::uint32_t>("width"));
    camera.height = static_cast<int>(in.number<std::uint32_t>("height"));
    for (float* number : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *number = in.real32("camera");
    frame.words = in.number<std::uint64_t>("words of depth");
    in.take(to_line(bytes.size() - in.left()), "zeros before depth");
    frame.at = bytes.size() - in.left();
    if (frame.words > in.left() / sizeof(std::uint32_t)) in.fail(fmt::format("{} words of depth", frame.words));
    in.take(frame.words * sizeof(std::uint32_t), "depth");
  }
  in.expect_end();
  contents.frames.add_block(std::move(buffer), frames);
}

}  // namespace vesalius
