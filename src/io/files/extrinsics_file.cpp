#include "io/files/extrinsics_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr float kRigid = 1e-3F;  // largest difference of a product of rows from that of a rotation

void check_rigid(const Eigen::Isometry3f& pose, const std::string& what) {
  const Eigen::Matrix3f turn = pose.linear();
  const bool is_rotation = (turn * turn.transpose()).isIdentity(kRigid) && turn.determinant() > 0.F;
  if (is_rotation && pose.translation().allFinite()) return;
  throw Error(what + ": expected a rotation and a place in metres, which keep lengths and hands");
}

}  // namespace

nlohmann::ordered_json pose_json(const Eigen::Isometry3f& pose) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector4f r = pose.matrix().row(row);
    rows.push_back({r[0], r[1], r[2], r[3]});
  }
  return rows;
}

Eigen::Isometry3f parse_pose(const nlohmann::ordered_json& json, const std::string& what) {
  const std::string expected = what + ": expected three rows of four numbers";
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  if (!json.is_array() || json.size() != 3) throw Error(expected);
  for (int row = 0; row < 3; ++row) {
    if (!json[row].is_array() || json[row].size() != 4) throw Error(expected);
    for (int column = 0; column < 4; ++column) {
      if (!json[row][column].is_number()) throw Error(expected);
      pose.matrix()(row, column) = json[row][column].get<float>();
    }
  }
  return pose;
}

std::vector<CameraExtrinsics> parse_extrinsics(std::string_view text, const std::string& source, std::size_t count) {
  const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  const auto list = json.is_object() ? json.find("cameras") : json.end();
  if (!json.is_object() || list == json.end() || !list->is_array()) {
    throw Error(source + R"(: expected JSON with "cameras", as vesalius detect --extrinsics writes it)");
  }
  if (list->size() != count) {
    throw Error(fmt::format("{}: {} cameras, expected {}, one for each source", source, list->size(), count));
  }
  std::vector<CameraExtrinsics> cameras;
  for (const nlohmann::ordered_json& camera : *list) {
    const std::string what = fmt::format("{}: camera {}: first_from_this", source, cameras.size());
    const auto pose = camera.is_object() ? camera.find("first_from_this") : camera.end();
    if (!camera.is_object() || pose == camera.end()) throw Error(what + " is missing");
    CameraExtrinsics& known = cameras.emplace_back();
    if (const auto name = camera.find("source"); name != camera.end() && name->is_string()) known.source = *name;
    known.first_from_this = parse_pose(*pose, what);
    check_rigid(known.first_from_this, what);
    // What is a little off in the file shall not grow.
    known.first_from_this.linear() = Eigen::Quaternionf(known.first_from_this.linear()).normalized().matrix();
  }
  if (!cameras.empty() && !cameras.front().first_from_this.isApprox(Eigen::Isometry3f::Identity(), kRigid)) {
    throw Error(source + ": camera 0: expected the identity, since all places are in its frame");
  }
  return cameras;
}

std::string extrinsics_json(const std::vector<CameraExtrinsics>& cameras) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const CameraExtrinsics& camera : cameras) {
    list.push_back({{"source", camera.source}, {"first_from_this", pose_json(camera.first_from_this)}});
  }
  const nlohmann::ordered_json json = {{"cameras", std::move(list)}};
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace vesalius
