#include "io/sources/rigid_facts.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "io/files/plain_text.h"

namespace vesalius {
namespace {

using Eigen::Isometry3d;

/// Returns the last place in a text of one of some words; npos where there is none.
std::size_t last_of(std::string_view text, std::initializer_list<std::string_view> words) {
  std::size_t last = text.npos;
  for (const std::string_view word : words) {
    const std::size_t at = text.rfind(word);
    if (at != text.npos && (last == text.npos || at > last)) last = at;
  }
  return last;
}

std::size_t colour_in(std::string_view text) {
  const std::size_t at = last_of(text, {"color", "colour", "rgb"});
  const std::string_view word = at == text.npos ? "" : text.substr(at);
  return word.starts_with("rgbd") && !word.starts_with("rgbdepth") ? text.npos : at;
}

std::size_t depth_in(std::string_view text) {
  return text.starts_with("ir") ? 0 : last_of(text, {"depth", "infra", "tof", "calibir", "/ir", "toir", "2ir"});
}

/// Says what a text tells of where points come from and go to. Nothing for one that tells nothing.
std::optional<std::pair<CameraRole, CameraRole>> direction_in(std::string_view text) {
  using enum CameraRole;
  if (text.find("d2c") != text.npos) return std::pair(depth, colour);
  if (text.find("c2d") != text.npos) return std::pair(colour, depth);
  const std::size_t of_depth = depth_in(text), of_colour = colour_in(text);
  if (of_depth == text.npos && of_colour == text.npos) return std::nullopt;
  if (of_colour == text.npos) return std::pair(unsaid, depth);
  if (of_depth == text.npos) return std::pair(unsaid, colour);
  const std::size_t begin = std::min(of_depth, of_colour), end = std::max(of_depth, of_colour);
  const bool backwards = text.substr(begin, end - begin).find("from") != text.npos;
  return (of_depth < of_colour) != backwards ? std::pair(depth, colour) : std::pair(colour, depth);
}

/// Makes a transform, in metres, of a rotation by rows and a translation; nothing where two cameras of a device do not
/// stand so. Baselines are centimetres, so what is more than a metre counts millimetres.
std::optional<Isometry3d> rigid(const Eigen::Matrix3d& rotation, Eigen::Vector3d translation) {
  constexpr double kRounded = 0.01, kMost_m = 1.0, kMostTurned = 0.5, kMillimetre = 1e-3;
  const Eigen::Matrix3d near_one = rotation * rotation.transpose();
  if (!((near_one - Eigen::Matrix3d::Identity()).norm() < kRounded) || rotation.determinant() < 0.0)
    return std::nullopt;
  if (translation.norm() > kMost_m) translation *= kMillimetre;
  const double cosine = (rotation.trace() - 1.0) / 2.0;
  if (!(translation.norm() <= kMost_m) || cosine < kMostTurned) return std::nullopt;
  Isometry3d transform = Isometry3d::Identity();
  transform.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  transform.translation() = translation;
  return transform;
}

using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Returns a rotation of 3x3 numbers, or a quaternion as ROS prints it.
std::optional<Eigen::Matrix3d> rotation_of(const FactTree& value) {
  if (value.is_object() && value.contains("w")) {
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < q.size(); ++i) {
      const char* key = std::array{"x", "y", "z", "w"}[i];
      q[i] = value.contains(key) ? number_of(value[key]).value_or(0.0) : 0.0;
    }
    return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  }
  const std::vector<double> numbers = numbers_of(value);
  if (numbers.size() != 9) return std::nullopt;
  return Eigen::Map<const Rows>(numbers.data());
}

std::optional<Eigen::Vector3d> translation_of(const FactTree& value) {
  std::vector<double> numbers = numbers_of(value);
  if (value.is_object() && value.contains("x") && value.contains("y") && value.contains("z")) {
    numbers.clear();
    for (const char* key : {"x", "y", "z"}) numbers.push_back(number_of(value[key]).value_or(0.0));
  }
  if (numbers.size() != 3) return std::nullopt;
  return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

/// Returns a transform of 3x4 or 4x4 numbers by rows, or by columns where the translation is in the last row.
std::optional<Isometry3d> pose_matrix_of(const std::vector<double>& m) {
  if (m.size() != 12 && m.size() != 16) return std::nullopt;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(m.data());
  if (m.size() == 16 && m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0) {
    const auto columns = Eigen::Map<const Eigen::Matrix4d>(m.data());
    return rigid(columns.topLeftCorner<3, 3>(), columns.topRightCorner<3, 1>());
  }
  return rigid(rows.leftCols<3>(), rows.col(3));
}

class RigidReader {
 public:
  explicit RigidReader(const std::string& name)
      : name_(name), file_(letters_and_digits(std::filesystem::path(name).stem().string())) {}

  void read(const FactTree& value, const std::string& path, int levels) {
    constexpr std::size_t kMost = 100;
    if (levels == 0 || value.is_primitive() || found_.size() > kMost) return;
    if (value.is_array()) {
      for (const FactTree& inner : value) read(inner, path, levels - 1);
      return;
    }
    // ScanNet's pictures lie on each other already, whatever its colorToDepthExtrinsics is (its authors, issue 92).
    if (value.contains("axisAlignment"))
      found_.push_back({CameraRole::depth, CameraRole::colour, Isometry3d::Identity(), name_, false});
    const std::string here = path + frames_of(value);
    pair(value, here);
    for (const auto& [key, inner] : value.items()) {
      const std::string path_here = here + "/" + letters_and_digits(key);
      matrix(inner, path_here);
      read(inner, path_here, levels - 1);
    }
  }
  std::vector<RigidFact> take() { return std::move(found_); }

 private:
  /// Returns the frames of a message of ROS: points go from the child's to that of the header.
  static std::string frames_of(const FactTree& object) {
    std::string text;
    const auto add = [&](const FactTree& of, const char* key) {
      const auto found = of.is_object() ? of.find(key) : of.end();
      if (found != of.end() && found->is_string()) text += found->get_ref<const std::string&>();
    };
    add(object, "child_frame_id");
    const auto header = object.find("header");
    if (header != object.end()) add(*header, "frame_id");
    return text.empty() ? text : "/" + letters_and_digits(text);
  }

  /// A rotation and a translation beside each other.
  void pair(const FactTree& object, const std::string& path) {
    const FactTree *rotation = nullptr, *translation = nullptr;
    for (const auto& [key, value] : object.items()) {
      const std::string name = letters_and_digits(key);
      if (name == "r" || name == "rot" || name.starts_with("rotation")) rotation = &value;
      if (name == "t" || name.starts_with("trans") || name == "tvec") translation = &value;
    }
    if (rotation == nullptr || translation == nullptr) return;
    const auto turned = rotation_of(*rotation);
    const auto moved = translation_of(*translation);
    const auto transform = turned && moved ? rigid(*turned, *moved) : std::nullopt;
    const bool in_one_list = rotation->is_array() && rotation->size() == 9;
    if (transform) add(*transform, path, in_one_list);
  }

  void matrix(const FactTree& value, const std::string& path) {
    const bool rows = path.ends_with(letters_and_digits(kNumberRows));
    const std::string all = file_ + path, name = rows ? all : path.substr(path.rfind('/'));
    const bool named = name.find("extrinsic") != name.npos || name.find("tcncnm1") != name.npos ||
                       (direction_in(name) && direction_in(name)->first != CameraRole::unsaid);
    if (rows && value.is_array() && value.size() >= kInfinitamRows) {
      std::vector<double> last;
      for (std::size_t i = 6; i < 9; ++i) {
        const std::vector<double> row = numbers_of(value[i]);
        last.insert(last.end(), row.begin(), row.end());
      }
      // Its first camera is that of colour, and the matrix takes points from it to depth.
      if (const auto transform = pose_matrix_of(last)) {
        found_.push_back({CameraRole::colour, CameraRole::depth, *transform, name_, false});
      }
    } else if (const auto transform = named ? pose_matrix_of(numbers_of(value)) : std::nullopt) {
      add(*transform, path, false);
    }
  }

  void add(const Isometry3d& transform, const std::string& path, bool in_one_list) {
    const auto direction = direction_in(path);
    const auto said = direction ? direction : direction_in(file_);
    const auto [from, to] = said.value_or(std::pair(CameraRole::unsaid, CameraRole::unsaid));
    found_.push_back({from, to, transform, name_, in_one_list});
  }

  static constexpr std::size_t kInfinitamRows = 9;
  std::string name_, file_;
  std::vector<RigidFact> found_;
};

}  // namespace

CameraRole role_in(std::string_view text) {
  const std::size_t of_depth = depth_in(text), of_colour = colour_in(text);
  if (of_depth != text.npos && (of_colour == text.npos || of_depth > of_colour)) return CameraRole::depth;
  return of_colour == text.npos ? CameraRole::unsaid : CameraRole::colour;
}

std::vector<RigidFact> rigid_facts(const FactTree& root, const std::string& name) {
  RigidReader reader(name);
  reader.read(root, "", kFactLevels);
  return reader.take();
}

}  // namespace vesalius
