#include "cluster/training_set_bytes.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "cluster/message.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kMagic = 0x53545356;  // "VSTS"
constexpr std::uint16_t kVersion = 1;

}  // namespace

std::string training_set_bytes(const TrainingSet& set) {
  MessageWriter body;
  const TrainingSet::Contents& contents = set.contents();
  body.bytes().reserve(set.bytes());
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
    body.array(contents.frames.words(f));
  }
  ByteWriter out;
  out.number(kMagic);
  out.number(kVersion);
  out.number(static_cast<std::uint64_t>(XXH64(body.bytes().data(), body.bytes().size(), 0)));
  out.bytes() += body.bytes();
  return std::move(out.bytes());
}

void append_training_set(std::string_view bytes, const std::string& name, TrainingSet::Contents& contents) {
  MessageReader in(bytes, name);
  if (in.number<std::uint32_t>("the mark of a shard") != kMagic) throw Error(name + ": no shard of a training");
  if (const auto version = in.number<std::uint16_t>("version"); version != kVersion) {
    throw Error(fmt::format("{}: shard of version {}, expected {}", name, version, kVersion));
  }
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
  std::vector<std::uint32_t> words;
  const auto frames = in.number<std::uint64_t>("frames");
  for (std::uint64_t f = 0; f < frames; ++f) {
    Camera camera;
    camera.width = static_cast<int>(in.number<std::uint32_t>("width"));
    camera.height = static_cast<int>(in.number<std::uint32_t>("height"));
    for (float* number : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *number = in.real32("camera");
    in.array_into(words, "depth");
    contents.frames.add_packed(camera, words);
  }
  in.expect_end();
}

}  // namespace vesalius
