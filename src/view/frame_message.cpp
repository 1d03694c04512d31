#include "view/frame_message.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/recordings/depth_codecs.h"
#include "stream/json_numbers.h"
#include "vesalius/find_clusters.h"
#include "vesalius/fit/flesh_sections.h"
#include "vesalius/image_file.h"
#include "vesalius/person_json.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/upright.h"

namespace vesalius {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kJpegQuality = 85;

Json point_json(const Eigen::Vector3f& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

/// The pictures of a message, and the list that describes them.
class Pictures {
 public:
  void add(const char* name, const char* codec, int width, int height, std::string bytes) {
    list_.push_back({{"name", name},
                     {"codec", codec},
                     {"width", width},
                     {"height", height},
                     {"at", bytes_.size()},
                     {"bytes", bytes.size()}});
    bytes_ += bytes;
  }
  void add_labels(const char* name, const Image<std::uint8_t>& labels) {
    if (!labels.empty()) add(name, "runs", labels.width(), labels.height(), pack_runs(labels));
  }
  const Json& list() const { return list_; }
  const std::string& bytes() const { return bytes_; }

 private:
  Json list_ = Json::array();
  std::string bytes_;
};

/// The floor over time; that of this frame alone while there is none.
Json floor_json(const ViewedFrame& viewed) {
  if (viewed.people.floor) {
    const FloorView& floor = *viewed.people.floor;
    return {{"normal", point_json(-floor.up)}, {"offset_m", rounded(floor.height_m)}, {"lasting", true}};
  }
  const std::optional<Plane> floor = find_floor(viewed.planes, viewed.frame->up, guessed_up(*viewed.frame));
  if (!floor) return {};
  return {{"normal", point_json(floor->normal)}, {"offset_m", rounded(floor->offset)}, {"lasting", false}};
}

Json section_json(const FleshSection& section) {
  Json numbers = Json::array();
  for (const Eigen::Vector3f* vector : {&section.centre, &section.first, &section.second}) {
    for (const float number : *vector) numbers.push_back(rounded(number, 1e3));
  }
  return numbers;
}

/// The flesh of people's bodies by index; null for people without.
Json flesh_json(const TrackedFrame& tracked) {
  Json people = Json::array();
  for (const TrackedPerson& person : tracked.people) {
    Json& bones = people.emplace_back();
    if (!person.body || person.state == TrackState::lost) continue;
    for (const BoneSections& bone : flesh_sections(builtin_flesh(), *person.body)) {
      Json& sections = bones.emplace_back();
      for (const FleshSection& section : bone) sections.push_back(section_json(section));
    }
  }
  return people;
}

Json times_json(const StageTimes& times) {
  Json all = Json::object();
  for (std::size_t s = 0; s < kStageNames.size(); ++s) all[kStageNames[s]] = rounded(times.ms[s]);
  return all;
}

Json skeleton_json(const Skeleton& skeleton) {
  Json parts = Json::array();
  for (const SkeletonPart& part : skeleton.parts) {
    parts.push_back(part.state == State::observed ? point_json(part.centre) : Json());
  }
  return {{"score", rounded(skeleton.score)}, {"found", skeleton.found}, {"parts", std::move(parts)}};
}

/// Labels of the pixels that are in a proposal.
LabelImage proposed_labels(const Clusters& clusters) {
  LabelImage labels(clusters.index.width(), clusters.index.height(), kBackground);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::int32_t item = clusters.index[i];
    if (item >= 0) labels[i] = static_cast<std::uint8_t>(clusters.items[static_cast<std::size_t>(item)].label);
  }
  return labels;
}

/// Adds the candidates' masks and labels; where two share a pixel, the surer one has it.
void add_candidates(const std::vector<Trace::Candidate>& candidates, int width, int height, Pictures& pictures) {
  Image<std::uint8_t> grown(width, height, kBackground);
  LabelImage labels(width, height, kBackground);
  for (std::size_t c = std::min<std::size_t>(candidates.size(), kBackground); c-- > 0;) {
    const Trace::Candidate& candidate = candidates[c];
    for (std::size_t i = 0; i < candidate.grown.size(); ++i) {
      if (candidate.grown[i] == 0) continue;
      grown[i] = static_cast<std::uint8_t>(c);
      if (!candidate.labels.empty()) labels[i] = candidate.labels[i];
    }
  }
  pictures.add_labels("grown", grown);
  pictures.add_labels("second_pass", labels);
}

Json stages_json(const Trace& trace, int width, int height, Pictures& pictures) {
  pictures.add_labels("raw_labels", trace.raw_labels);
  pictures.add_labels("labels", trace.labels);
  pictures.add_labels("proposals", proposed_labels(trace.clusters));
  pictures.add_labels("flat", trace.flat);
  add_candidates(trace.candidates, width, height, pictures);
  Json proposals = Json::array();
  for (const PartCluster& cluster : trace.clusters.items) {
    proposals.push_back(
        {{"label", cluster.label}, {"xyz_m", point_json(cluster.centroid)}, {"pixels", cluster.pixels}});
  }
  Json rough = Json::array();
  for (const Skeleton& skeleton : trace.rough) rough.push_back(skeleton_json(skeleton));
  Json candidates = Json::array();
  for (const Trace::Candidate& candidate : trace.candidates) {
    candidates.push_back({{"score", rounded(candidate.score)},
                          {"accepted", candidate.accepted},
                          {"rough", skeleton_json(candidate.rough)},
                          {"refined", skeleton_json(candidate.refined)}});
  }
  return {{"proposals", std::move(proposals)}, {"rough", std::move(rough)}, {"candidates", std::move(candidates)}};
}

/// `found` is the frame's line of JSON, which stands in the text as it is.
std::string message_of(Json head, const std::string& found, const Pictures& pictures) {
  head["pictures"] = pictures.list();
  std::string text = head.dump();
  text.pop_back();  // its brace
  text += ",\"found\":" + found + "}";
  std::string message;
  message.reserve(4 + text.size() + pictures.bytes().size());
  for (int shift = 0; shift < 32; shift += 8) message += static_cast<char>(text.size() >> shift & 0xFF);
  return message + text + pictures.bytes();
}

constexpr int kDigitBits = 7;
constexpr unsigned kMore = 1U << kDigitBits;

}  // namespace

FrameMessages frame_messages(const ViewedFrame& viewed, const BodyModel& body) {
  const Frame& frame = *viewed.frame;
  const int width = frame.depth.width(), height = frame.depth.height();
  Pictures pictures;
  pictures.add("depth", "rvl", width, height, pack_rvl(frame.depth));
  if (!frame.colour.empty()) pictures.add("colour", "jpeg", width, height, encode_jpeg(frame.colour, kJpegQuality));
  const std::vector<Person> people = people_of(viewed.people);
  pictures.add_labels("people", body_index_map(people, width, height));
  pictures.add_labels("parts", part_label_map(people, width, height));
  Json head = {{"number", viewed.number},
               {"at_s", viewed.at_s},
               {"times_ms", times_json(viewed.times)},
               {"detect_ms", rounded(viewed.times.total())},
               {"track_ms", rounded(viewed.track_ms)},
               {"floor", floor_json(viewed)}};
  if (viewed.people.followed) head["flesh"] = flesh_json(viewed.people);
  const std::string found = frame_json(frame, viewed.people, body, viewed.latency_ms);
  FrameMessages messages{message_of(head, found, pictures), {}};
  if (viewed.trace) {
    head["stages"] = stages_json(*viewed.trace, width, height, pictures);
    messages.with_stages = message_of(head, found, pictures);
  }
  return messages;
}

std::string pack_runs(const Image<std::uint8_t>& image) {
  std::string packed;
  const std::uint8_t* const end = image.data() + image.size();
  for (const std::uint8_t* at = image.data(); at != end;) {
    const std::uint8_t value = *at;
    const std::uint8_t* const next = std::find_if(at, end, [value](std::uint8_t v) { return v != value; });
    packed += static_cast<char>(value);
    auto length = static_cast<std::size_t>(next - at);
    for (; length >= kMore; length >>= kDigitBits) packed += static_cast<char>(length % kMore + kMore);
    packed += static_cast<char>(length);
    at = next;
  }
  return packed;
}

}  // namespace vesalius
