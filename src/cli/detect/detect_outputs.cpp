#include "cli/detect/detect_outputs.h"

#include <fmt/format.h>

#include <filesystem>

#include "io/files/ply.h"
#include "vesalius/draw.h"
#include "vesalius/image_file.h"
#include "vesalius/person_json.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
}

/// Tells how many parts are observed and their mean distance along the optical axis.
std::string describe(const Skeleton& skeleton) {
  if (skeleton.found == 0) return "no parts";
  double sum_m = 0.0;
  for (const SkeletonPart& part : skeleton.parts) {
    if (part.state == State::observed) sum_m += double(part.centre.z());
  }
  return fmt::format("{} parts at {:.2f} m", skeleton.found, sum_m / skeleton.found);
}

}  // namespace

void check(const OutputRequest& request) {
  if (!request.save.empty() && request.folder.empty()) throw UsageError("--save needs --out, the folder to save in");
}

DetectOutputs::DetectOutputs(OutputRequest request, const BodyModel& body)
    : request_(std::move(request)), kinds_(request_.save.begin(), request_.save.end()), body_(body) {
  const std::string& joints = request_.json_options.joints;
  if (!joints.empty()) request_.osc_options.joints = joints;
  if (!joints.empty() || !request_.osc.empty())
    (void)find_joint_set(body, request_.osc_options.joints);  // there is one
  if (!request_.folder.empty()) {
    if (kinds_.empty()) kinds_.insert("overlay");
    make_folder(request_.folder);
    for (const std::string& kind : kinds_) {
      if (kind != "video") make_folder(fs::path(request_.folder) / kind);
    }
    const auto in_folder = [&](const char* name) { return (fs::path(request_.folder) / name).string(); };
    if (wants("labels")) write_file_atomically(in_folder("labels.json"), part_table_json(body));
    if (wants("video")) video_.emplace(in_folder("overlay.avi"), request_.video_rate);
  }
  if (!request_.json.empty()) json_.emplace(request_.json);
  if (!request_.udp.empty()) udp_.emplace(request_.udp);
  if (!request_.osc.empty()) osc_.emplace(request_.osc);
}

void DetectOutputs::send(const TrackedFrame& people, const std::string& json) {
  if (udp_) {
    for (const std::string& datagram : json_datagrams(json, UdpSender::kMost)) udp_->send(datagram);
  }
  if (!osc_) return;
  for (const std::string& bundle : osc_bundles(people, body_, request_.osc_options)) osc_->send(bundle);
}

std::string DetectOutputs::path(const char* kind, const Frame& frame, const char* extension) const {
  if (frame.name.empty() || frame.name.find('/') != std::string::npos) {
    throw Error(fmt::format("frame \"{}\": its name cannot be a file's", frame.name));
  }
  return (fs::path(request_.folder) / kind / (frame.name + extension)).string();
}

void DetectOutputs::write(const FoundFrame& found) {
  const Frame& frame = *found.frame;
  if (!kinds_.empty()) write_pictures(frame, found.people);
  const std::string json =
      json_ || udp_ ? frame_json(frame, found.people, body_, found.latency_ms, request_.json_options) : "";
  send(found.people, json);
  if (json_) json_->line(json);
  if (request_.lines()) print(one_line(describe(frame, found.people)) + "\n");
  ++frames_;
}

void DetectOutputs::write_pictures(const Frame& frame, const TrackedFrame& found) {
  const std::vector<Person> people = people_of(found);  // in the order of the JSON
  std::vector<int> ids;
  for (const TrackedPerson& person : found.people) {
    if (found.followed) ids.push_back(person.id);
  }
  const int width = frame.depth.width();
  const int height = frame.depth.height();
  if (!names_.insert(frame.name).second) {
    throw Error(
        fmt::format("frame \"{}\": its pictures would replace those of another frame of this name", frame.name));
  }
  if (wants("overlay") || video_) {
    const ColourImage overlay = draw_people(frame, people, body_, ids);
    if (wants("overlay")) write_png(overlay, path("overlay", frame, ".png"));
    if (video_) video_->write(overlay);
  }
  if (wants("colour")) {
    write_png(frame.colour.empty() ? draw_depth(frame.depth) : frame.colour, path("colour", frame, ".png"));
  }
  if (wants("parts")) {
    write_png(draw_labels(part_label_map(people, width, height), frame.depth, body_, true),
              path("parts", frame, ".png"));
  }
  if (wants("mask")) write_png(body_index_map(people, width, height), path("mask", frame, ".png"));
  if (wants("labels")) write_png(part_label_map(people, width, height), path("labels", frame, ".png"));
  if (wants("cloud")) {
    write_cloud(frame, part_label_map(people, width, height), body_index_map(people, width, height), body_,
                path("cloud", frame, ".ply"));
  }
}

void DetectOutputs::finish(const std::string& why_not_all) {
  if (json_) {
    json_->line(closing_json(frames_, why_not_all.empty(), why_not_all));
    json_->finish();
  }
  if (video_ && (frames_ > 0 || why_not_all.empty())) video_->close();
  if (request_.lines()) finish_stdout();
}

std::vector<std::string> DetectOutputs::losses() const {
  std::vector<std::string> lines;
  for (const std::optional<UdpSender>* sender : {&udp_, &osc_}) {
    if (*sender && (*sender)->lost() > 0) lines.push_back((*sender)->why_lost());
  }
  return lines;
}

std::string describe(const Frame& frame, const TrackedFrame& people) {
  std::string text;
  for (const TrackedPerson& person : people.people) {
    const Person& found = person.person;
    text += text.empty() ? "" : ", ";
    text += people.followed ? fmt::format("{} {} at {:.2f} m", person.id, to_string(person.state), person.position.z())
                            : describe(found.skeleton);
    if (is_found(person)) text += fmt::format(" (score {:.2f})", found.score);
  }
  const std::size_t count = people.people.size();
  if (count == 0) return frame.name + ": nobody";
  return fmt::format("{}: {} {}: {}", frame.name, count, count == 1 ? "person" : "people", text);
}

}  // namespace vesalius::cli
