#include "vesalius/fit/flesh_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr const char* kFlesh =
#include "flesh.inc"
    ;

constexpr std::size_t kMaxBones = 64;
constexpr std::int64_t kMaxShapes = 16;
constexpr std::size_t kMaxComponents = 32;
constexpr double kMostLength_m = 10.0;
constexpr double kMostAngle = 4.0 * std::numbers::pi;

std::vector<double> read_numbers(const TomlReader& reader, const toml::table& table, std::string_view key,
                                 std::size_t count, double most) {
  const toml::array& array = reader.array(table, key);
  if (array.size() != count) {
    reader.fail(array, std::string(key) + ": expected " + std::to_string(count) + " numbers, found " +
                           std::to_string(array.size()));
  }
  std::vector<double> numbers;
  for (const toml::node& node : array) numbers.push_back(reader.number(node, key, -most, most));
  return numbers;
}

template <std::size_t kCount>
std::array<float, kCount> read_array(const TomlReader& reader, const toml::table& table, std::string_view key,
                                     double most) {
  std::array<float, kCount> out{};
  const std::vector<double> numbers = read_numbers(reader, table, key, kCount, most);
  std::ranges::transform(numbers, out.begin(), [](double number) { return float(number); });
  return out;
}

int read_bone_name(const TomlReader& reader, const FleshModel& model, const toml::node& node, std::string_view what) {
  const std::string name = reader.string(node, what);
  const int bone = model.find_bone(name);
  if (bone < 0) reader.fail(node, std::string(what) + " " + in_quotes(name) + ": expected a bone above");
  return bone;
}

/// Returns "r_foot" for "l_foot" and nothing for bones on the middle line.
std::string other_side(const std::string& name) { return name.starts_with("l_") ? "r_" + name.substr(2) : ""; }

FleshBone mirrored_bone(const FleshModel& model, const FleshBone& left) {
  FleshBone right = left;
  right.name = other_side(left.name);
  const std::string parent = other_side(model.bones[left.parent].name);
  if (!parent.empty()) right.parent = model.find_bone(parent);
  right.mean = mirrored(left.mean, left.axis);
  for (FleshBone::Numbers& shape : right.shapes) shape = mirrored(shape, left.axis);
  for (const int i : {1, 2}) {  // a mirrored rotation vector keeps x and turns y and z
    right.low[i] = -left.high[i];
    right.high[i] = -left.low[i];
  }
  return right;
}

void read_bone(const TomlReader& reader, const toml::table& table, FleshModel& model) {
  reader.expect_keys(table, {"name", "parent", "axis", "stations", "mean", "shapes", "low", "high"});
  FleshBone bone;
  bone.name = reader.string(reader.need(table, "name"), "name");
  if (bone.name.starts_with("r_")) reader.fail(table, "name: expected no right side, which mirrors the left");
  if (model.find_bone(bone.name) >= 0) reader.fail(table, "name " + in_quotes(bone.name) + ": given twice");
  if (model.bones.empty() && !other_side(bone.name).empty()) {
    reader.fail(table, "name: expected the first bone, the root, on the middle line");
  }
  if (!model.bones.empty()) bone.parent = read_bone_name(reader, model, reader.need(table, "parent"), "parent");
  const std::string axis = reader.string(reader.need(table, "axis"), "axis");
  constexpr std::string_view kAxes = "xyz";
  if (axis.size() != 1 || kAxes.find(axis) == std::string_view::npos) {
    reader.fail(table, "axis " + in_quotes(axis) + ": expected x, y or z");
  }
  bone.axis = int(kAxes.find(axis));
  bone.stations = read_array<FleshBone::kStations>(reader, table, "stations", kMostLength_m);
  if (!std::ranges::is_sorted(bone.stations, std::less_equal<>())) {
    reader.fail(table, "stations: expected rising numbers");
  }
  bone.mean = read_array<FleshBone::kNumbers>(reader, table, "mean", kMostLength_m);
  if (std::abs(bone.mean[3 + bone.axis]) < 1e-3F) reader.fail(table, "mean: expected a tail away from the head");
  const toml::array& shapes = reader.array(table, "shapes");
  if (shapes.size() != static_cast<std::size_t>(model.shapes)) {
    reader.fail(shapes, "shapes: expected " + std::to_string(model.shapes) + " lists");
  }
  for (const toml::node& node : shapes) {
    const toml::array& list = reader.array(node, "shapes");
    if (list.size() != FleshBone::kNumbers) {
      reader.fail(list, "shapes: expected lists of " + std::to_string(FleshBone::kNumbers) + " numbers");
    }
    FleshBone::Numbers& numbers = bone.shapes.emplace_back();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = reader.number(*list.get(i), "shapes", -kMostLength_m, kMostLength_m);
    }
  }
  bone.low = read_array<3>(reader, table, "low", kMostAngle);
  bone.high = read_array<3>(reader, table, "high", kMostAngle);
  for (std::size_t i = 0; i < bone.low.size(); ++i) {
    if (bone.low[i] > bone.high[i]) reader.fail(table, "low: expected at most \"high\"");
  }
  model.bones.push_back(bone);
  if (!other_side(bone.name).empty()) model.bones.push_back(mirrored_bone(model, bone));
}

/// Returns the symmetric matrix with this lower triangle, row after row.
Eigen::MatrixXd symmetric(const std::vector<double>& triangle, Eigen::Index size) {
  Eigen::MatrixXd matrix(size, size);
  std::size_t next = 0;
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      matrix(row, column) = matrix(column, row) = triangle[next++];
    }
  }
  return matrix;
}

LimbPrior::Component read_component(const TomlReader& reader, const toml::table& table, Eigen::Index size) {
  reader.expect_keys(table, {"weight", "mean", "covariance"});
  LimbPrior::Component component;
  component.weight = reader.number(table, "weight", 1e-6, 1.0);
  const std::vector<double> mean = read_numbers(reader, table, "mean", size, kMostAngle);
  component.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), size);
  const std::vector<double> triangle = read_numbers(reader, table, "covariance", size * (size + 1) / 2, 1e3);
  const Eigen::LLT<Eigen::MatrixXd> covariance(symmetric(triangle, size));
  if (covariance.info() != Eigen::Success) reader.fail(table, "covariance: expected a positive definite matrix");
  const Eigen::MatrixXd lower = covariance.matrixL();
  // covariance = L L^T, so that L^-1 (x - mean) has length 1 at one standard deviation.
  component.whitening = lower.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size)).eval();
  component.log_density = std::log(double(component.weight)) - lower.diagonal().array().log().sum();
  return component;
}

LimbPrior mirrored_limb(const FleshModel& model, LimbPrior limb) {
  for (int& bone : limb.bones) bone = model.bones[bone].mirror;
  for (LimbPrior::Component& component : limb.components) {
    for (Eigen::Index i = 0; i < component.mean.size(); ++i) {
      if (i % 3 == 0) continue;
      component.mean[i] = -component.mean[i];
      component.whitening.col(i) = -component.whitening.col(i);
    }
  }
  return limb;
}

void read_limb(const TomlReader& reader, const toml::table& table, FleshModel& model) {
  reader.expect_keys(table, {"bones", "component"});
  LimbPrior limb;
  for (const toml::node& node : reader.array(table, "bones")) {
    limb.bones.push_back(read_bone_name(reader, model, node, "bones"));
  }
  if (limb.bones.empty()) reader.fail(table, "bones: expected at least one");
  const toml::array& components = reader.array(table, "component");
  if (components.empty() || components.size() > kMaxComponents) {
    reader.fail(components, "component: expected 1 to " + std::to_string(kMaxComponents));
  }
  const auto size = static_cast<Eigen::Index>(3 * limb.bones.size());
  for (const toml::node& node : components) {
    limb.components.push_back(read_component(reader, reader.table(node, "component"), size));
  }
  std::ranges::stable_sort(limb.components, std::greater<>(), &LimbPrior::Component::weight);
  const bool is_left = model.bones[limb.bones.front()].mirror != limb.bones.front();
  model.limbs.push_back(limb);
  if (is_left) model.limbs.push_back(mirrored_limb(model, std::move(limb)));
}

}  // namespace

int FleshModel::find_bone(std::string_view name) const {
  const auto found = std::ranges::find(bones, name, &FleshBone::name);
  return found == bones.end() ? -1 : int(found - bones.begin());
}

FleshModel parse_flesh_model(std::string_view toml, const std::string& source) {
  const TomlReader reader(source);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"shapes", "bone", "limb"});
  FleshModel model;
  model.shapes = int(reader.integer(reader.need(root, "shapes"), "shapes", 1, kMaxShapes));
  const toml::array& bones = reader.array(root, "bone");
  if (bones.empty() || bones.size() > kMaxBones) {
    reader.fail(bones, "bone: expected 1 to " + std::to_string(kMaxBones));
  }
  for (const toml::node& node : bones) read_bone(reader, reader.table(node, "bone"), model);
  for (FleshBone& bone : model.bones) {
    const std::string right = other_side(bone.name);
    const bool is_right = bone.name.starts_with("r_");
    bone.mirror = model.find_bone(is_right ? "l_" + bone.name.substr(2) : right.empty() ? bone.name : right);
  }
  for (const toml::node& node : reader.array(root, "limb")) read_limb(reader, reader.table(node, "limb"), model);
  return model;
}

const FleshModel& builtin_flesh() {
  static const FleshModel model = parse_flesh_model(kFlesh, "flesh");
  return model;
}

FleshBone::Numbers numbers_of(const FleshBone& bone, const Eigen::VectorXd& shape) {
  FleshBone::Numbers numbers = bone.mean;
  for (std::size_t k = 0; k < bone.shapes.size(); ++k) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] += float(shape[static_cast<Eigen::Index>(k)]) * bone.shapes[k][i];
    }
  }
  return numbers;
}

double stature(const FleshModel& flesh, const Eigen::VectorXd& shape) {
  double low = 0.0, high = 0.0;
  std::vector<double> heads;
  for (const FleshBone& bone : flesh.bones) {
    const FleshBone::Numbers numbers = numbers_of(bone, shape);
    const double head = (bone.parent < 0 ? 0.0 : heads[bone.parent]) + double(numbers[1]);
    heads.push_back(head);
    if (bone.axis == 0) continue;  // arms are stretched to the sides
    for (int s = 0; s < FleshBone::kStations; ++s) {
      const FleshEllipse<float> ellipse = ellipse_of(bone, numbers, s);
      const double at = head + double(ellipse.centre.y());
      const double half = bone.axis == 1 ? 0.0 : double(ellipse.half[ellipse.across[0] == 1 ? 0 : 1]);
      low = std::min({low, at - half, at + half});
      high = std::max({high, at - half, at + half});
    }
  }
  return high - low;
}

FleshBone::Numbers mirrored(FleshBone::Numbers numbers, int axis) {
  numbers[0] = -numbers[0];
  numbers[3] = -numbers[3];
  if (axis == 0) return numbers;  // x is along the bone: what is across it stays
  for (int station = 0; station < FleshBone::kStations; ++station) {
    numbers[6 + 4 * station] = -numbers[6 + 4 * station];  // x is the first axis across
  }
  return numbers;
}

}  // namespace vesalius
