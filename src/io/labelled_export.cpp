#include "io/labelled_export.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/labelled_frame_codec.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Shortest text at a tenth of a millimetre.
double rounded(float value) { return std::round(value * 1e4) / 1e4; }

Json parts_json(const std::vector<Eigen::Vector3f>& parts, const BodyModel& body) {
  Json json = Json::object();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Json xyz;  // null: the body has no such part
    if (!parts[p].hasNaN()) xyz = {rounded(parts[p].x()), rounded(parts[p].y()), rounded(parts[p].z())};
    json[body.parts[p].name] = std::move(xyz);
  }
  return json;
}

std::string truth_json(const LabelledFrame& labelled, const BodyModel& body) {
  Json people = Json::array();
  for (std::size_t i = 0; i < labelled.parts.size(); ++i) {
    people.push_back({{"index", i}, {"parts_m", parts_json(labelled.parts[i], body)}});
  }
  const Json json = {{"frame", labelled.frame.name}, {"people", std::move(people)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

LabelledExporter::LabelledExporter(const std::string& folder, const BodyModel& body)
    : folder_(folder), body_(body), frames_(make_frame_writer(FrameFormat::folder, folder)) {
  for (const char* kind : {"labels", "person", "truth"}) {
    std::error_code error;
    fs::create_directories(fs::path(folder) / kind, error);
    if (error)
      throw Error(fmt::format("{}: folder cannot be made: {}", (fs::path(folder) / kind).string(), error.message()));
  }
  write_file_atomically((fs::path(folder) / "body.toml").string(), body.toml);
}

void LabelledExporter::write(const LabelledFrame& labelled) {
  const std::string& name = labelled.frame.name;
  with_context(folder_ + ": frame " + name, [&] { check_truth(labelled, body_.part_count()); });
  frames_->write(labelled.frame);
  const auto path = [&](const char* kind, const char* extension) {
    return (fs::path(folder_) / kind / (name + extension)).string();
  };
  write_png(labelled.labels, path("labels", ".png"));
  write_png(labelled.person, path("person", ".png"));
  write_file_atomically(path("truth", ".json"), truth_json(labelled, body_));
}

}  // namespace vesalius
