#include "dataset/labelled_export.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "dataset/labelled_frame_codec.h"
#include "io/files/atomic_file.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Rounds to a tenth of a millimetre, which keeps the text short.
double rounded(float value) { return std::round(value * 1e4) / 1e4; }

Json point_json(const Eigen::Vector3f& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

Json parts_json(const std::vector<Eigen::Vector3f>& parts, const BodyModel& body) {
  Json json = Json::object();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    json[body.parts[p].name] = parts[p].hasNaN() ? Json() : point_json(parts[p]);  // null: the body lacks the part
  }
  return json;
}

/// Returns the rows of [turn | place], in full precision: distances grow with errors of the turn.
Json pose_json(const Eigen::Isometry3f& pose) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector4f r = pose.matrix().row(row);
    rows.push_back({r[0], r[1], r[2], r[3]});
  }
  return rows;
}

std::string truth_json(const LabelledFrame& labelled, const BodyModel& body, const std::vector<std::string>& joints) {
  Json people = Json::array();
  for (std::size_t i = 0; i < labelled.parts.size(); ++i) {
    Json person = {{"index", i}, {"parts_m", parts_json(labelled.parts[i], body)}};
    if (!labelled.joints.empty()) {
      for (std::size_t j = 0; j < joints.size(); ++j) person["joints_m"][joints[j]] = point_json(labelled.joints[i][j]);
    }
    if (!labelled.postures.empty()) person["posture"] = labelled.postures[i];
    people.push_back(std::move(person));
  }
  Json json = {{"frame", labelled.frame.name}, {"people", std::move(people)}};
  if (labelled.frame.time_s) json["time_s"] = *labelled.frame.time_s;
  if (labelled.camera_height_m) json["camera_height_m"] = *labelled.camera_height_m;
  if (labelled.world_from_camera) json["world_from_camera"] = pose_json(*labelled.world_from_camera);
  if (labelled.up) json["up"] = {labelled.up->x(), labelled.up->y(), labelled.up->z()};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Of clips the rate is written, which gives times to whoever reads the folder as mere pictures.
WriteOptions options_for(const ClipLayout& clips) {
  WriteOptions options;
  if (clips.rate_hz > 0.0) options.frame_rate = float(clips.rate_hz);
  return options;
}

}  // namespace

LabelledExporter::LabelledExporter(const std::string& folder, const BodyModel& body, std::vector<std::string> joints,
                                   const ClipLayout& clips)
    : folder_(folder),
      body_(body),
      joints_(std::move(joints)),
      frames_(make_frame_writer(FrameFormat::folder, folder, options_for(clips))) {
  for (const char* kind : {"labels", "person", "truth"}) {
    std::error_code error;
    fs::create_directories(fs::path(folder) / kind, error);
    if (error)
      throw Error(fmt::format("{}: folder cannot be made: {}", (fs::path(folder) / kind).string(), error.message()));
  }
  write_file_atomically((fs::path(folder) / "body.toml").string(), body.toml);
  if (clips.frames_per_clip == 0) return;
  const Json json = {{"frames_per_clip", clips.frames_per_clip}, {"rate_hz", clips.rate_hz}};
  write_file_atomically((fs::path(folder) / "clips.json").string(), json.dump(1) + "\n");
}

void LabelledExporter::write(const LabelledFrame& labelled) {
  const std::string& name = labelled.frame.name;
  with_context(folder_ + ": frame " + name, [&] {
    check_truth(labelled, body_.part_count());
    for (const auto& joints : labelled.joints) {
      if (joints.size() != joints_.size()) {
        throw Error(fmt::format("person with {} joints, expected {}", joints.size(), joints_.size()));
      }
    }
  });
  frames_->write(labelled.frame);
  const auto path = [&](const char* kind, const char* extension) {
    return (fs::path(folder_) / kind / (name + extension)).string();
  };
  write_png(labelled.labels, path("labels", ".png"));
  write_png(labelled.person, path("person", ".png"));
  write_file_atomically(path("truth", ".json"), truth_json(labelled, body_, joints_));
}

}  // namespace vesalius
