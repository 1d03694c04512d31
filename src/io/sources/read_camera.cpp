#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <tuple>

#include "io/files/plain_text.h"
#include "io/recordings/k4a_messages.h"
#include "io/sources/camera_file.h"
#include "io/sources/fact_tree.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// One fact under all names that tools give it, as plain_name has them; those of depth alone are tried too.
using Spellings = std::vector<std::string_view>;

const Spellings kFx{"fx", "focallengthx", "focalx", "flx", "fu"};
const Spellings kFy{"fy", "focallengthy", "focaly", "fly", "fv"};
const Spellings kCx{"cx", "ppx", "principalpointx", "cu", "u0", "centerx", "mx"};
const Spellings kCy{"cy", "ppy", "principalpointy", "cv", "v0", "centery", "my"};
const Spellings kMatrix{"k",         "cameramatrix", "intrinsicmatrix",  "camk", "intrinsics",
                        "intrinsic", "kmatrix",      "cameraintrinsics", "mint", "mtx"};
const Spellings kFocal{"focal", "focallength", "f"};
const Spellings kCentre{"principalpoint", "center", "pp", "c"};
const Spellings kView{"hfov", "fovx", "fovh", "horizontalfov"};
const Spellings kWidth{"width", "imagewidth", "w", "imgwidth", "resolutionwidth", "resx"};
const Spellings kHeight{"height", "imageheight", "h", "imgheight", "resolutionheight", "resy"};
const Spellings kSize{"resolution", "imagesize", "size", "imageresolution", "imgsize"};
const Spellings kDistortion{"distortioncoefficients", "distortion",           "distcoeffs", "coeffs", "d",
                            "distortioncoeffs",       "distortionparameters", "distcoef",   "dist",   "coefficients"};
const Spellings kModel{"distortionmodel", "model", "cameramodel", "type"};
const Spellings kProjection{"projectionmatrix", "p"};
const Spellings kScale{"scale",       "depthscale", "depthmapfactor", "pngdepthscale", "depthfactor",
                       "mdepthshift", "depthunits", "unitspermeter",  "depthunit",     "units"};
constexpr std::array<const char*, 8> kCoefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};

/// What stands before and after names of facts, the likeliest first.
using Affixes = std::vector<std::array<std::string_view, 2>>;
const Affixes kOfDepth{{"depth", ""}, {"", "depth"}, {"mdepth", ""}, {"mcalibrationdepth", ""}, {"", "d"}, {"ir", ""},
                       {"", "ir"},    {"", ""},      {"m", ""}};
const Affixes kOfColour{{"color", ""}, {"", "color"},  {"colour", ""},           {"rgb", ""},
                        {"", "rgb"},   {"mcolor", ""}, {"mcalibrationcolor", ""}};
const Affixes kOfFirst{{"", "1"}}, kOfSecond{{"", "2"}};

/// An object of the tree with those around it.
struct Scope {
  const FactTree* object;
  std::map<std::string, std::pair<std::string, const FactTree*>> named;  ///< by plain name: the name and its value
  std::string path;                                                      ///< plain names of the objects around it
  int above = -1;                                                        ///< index of the one around it
  const Affixes* affixes = &kOfDepth;                                    ///< whose facts are looked for
};

/// What a name of several leads to.
struct Fact {
  std::string key;
  const FactTree* value = nullptr;
  explicit operator bool() const { return value != nullptr; }
};

Fact find(const Scope& scope, const Spellings& spellings) {
  for (const auto& [before, after] : *scope.affixes) {
    for (const std::string_view spelling : spellings) {
      const auto found = scope.named.find(fmt::format("{}{}{}", before, spelling, after));
      if (found != scope.named.end()) return {found->second.first, found->second.second};
    }
  }
  return {};
}

/// Returns how likely a name is that of depth's camera: 0 it says so, 1 it says nothing, 2 it is that of colour.
int rank_of(std::string_view path) {
  const auto has = [&](std::string_view word) { return path.find(word) != path.npos; };
  if (has("depth") || has("/ir") || has("infra")) return 0;
  return has("color") || has("colour") || has("rgb") ? 2 : 1;
}

/// Returns whether a value is a number, a text or a list of those rather than objects.
bool holds_numbers(const FactTree& value) {
  if (value.is_object()) return value.contains("data");
  if (value.is_array()) return value.empty() || !value.front().is_object();
  return value.is_number() || !numbers_of(value).empty();
}

/// Focal length in pixels of no camera; rotations have 1 at most, and focal lengths in millimetres are less.
constexpr double kShortest = 10.0;

/// Returns whether a principal point is near the middle of a picture.
bool is_middle(double centre, double side) { return side >= 16.0 && std::abs(2.0 * centre / side - 1.0) < 0.2; }

/// A matrix of intrinsics by rows, of 3x3, 3x4 or 4x4.
struct Matrix {
  double fx, fy, cx, cy;
  bool is_pinhole;  ///< whether all else in it is as in a matrix of pixels
};

std::optional<Matrix> matrix_of(const std::vector<double>& m) {
  if (m.size() != 9 && m.size() != 12 && m.size() != 16) return std::nullopt;
  const std::size_t columns = m.size() == 9 ? 3 : 4;
  const auto at = [&](std::size_t row, std::size_t column) { return m[row * columns + column]; };
  // Open3D and MATLAB write it column by column.
  const bool by_columns = at(0, 2) == 0.0 && at(1, 2) == 0.0 && m.size() != 12 && (at(2, 0) != 0.0 || at(2, 1) != 0.0);
  Matrix matrix{at(0, 0), at(1, 1), by_columns ? at(2, 0) : at(0, 2), by_columns ? at(2, 1) : at(1, 2), true};
  const double below = by_columns ? std::abs(at(0, 2)) + std::abs(at(1, 2)) : std::abs(at(2, 0)) + std::abs(at(2, 1));
  matrix.is_pinhole = matrix.fx > kShortest && matrix.fy > kShortest && below == 0.0 && at(2, 2) == 1.0 &&
                      at(1, 0) == 0.0 && std::abs(at(0, 1)) < kShortest;
  return matrix;
}

/// Reads one file.
class CameraReader {
 public:
  CameraReader(const FactTree& root, std::string name) : name_(std::move(name)) { collect(root, "", -1, kFactLevels); }

  CameraFacts read() {
    std::vector<std::tuple<int, std::size_t, CameraFacts>> cameras;
    for (const Scope& scope : scopes_) {
      for (CameraFacts& facts : cameras_of(scope)) {
        const int rank = facts.role == CameraRole::depth ? 0 : facts.role == CameraRole::colour ? 2 : 1;
        cameras.emplace_back(rank, scope.path.size(), std::move(facts));
      }
    }
    const auto order = [](const auto& camera) { return std::pair(std::get<0>(camera), std::get<1>(camera)); };
    std::ranges::stable_sort(cameras, {}, order);
    CameraFacts facts;
    if (cameras.empty()) {
      facts = without_focal();
    } else {
      facts = std::move(std::get<2>(cameras.front()));
      for (std::size_t i = 1; i < cameras.size(); ++i) facts.others.push_back(std::move(std::get<2>(cameras[i])));
    }
    const auto unsaid = [](const CameraFacts& camera) { return camera.role == CameraRole::unsaid; };
    if (unsaid(facts) && std::ranges::all_of(facts.others, unsaid)) {
      facts.role = role_in(letters_and_digits(std::filesystem::path(name_).stem().string()));
      for (CameraFacts& other : facts.others) other.role = facts.role;
    }
    add_depth(facts);
    return facts;
  }

 private:
  /// Returns the cameras that an object has: one, or those of depth and colour, or two that are numbered.
  std::vector<CameraFacts> cameras_of(const Scope& scope) const {
    using enum CameraRole;
    std::vector<CameraFacts> cameras;
    const auto take = [&](CameraFacts facts, CameraRole role) {
      if (!facts.fx) return;
      facts.role = role;
      cameras.push_back(std::move(facts));
    };
    const std::array<std::pair<CameraRole, const Affixes*>, 3> others{
        {{colour, &kOfColour}, {first, &kOfFirst}, {second, &kOfSecond}}};
    for (const auto& [role, affixes] : others) {
      const std::string_view digit = affixes->front()[1];
      const auto of_it = [&, role = role](const auto& named) {  // clang 14 captures no structured binding
        return role == colour ? role_in(named.first) == colour : named.first.ends_with(digit);
      };
      if (std::ranges::any_of(scope.named, of_it)) take(camera_of({scope.object, scope.named, "", -1, affixes}), role);
    }
    const std::array<CameraRole, 3> ranked{depth, unsaid, colour};
    const CameraRole said = scope.path.ends_with("/cam0")   ? first
                            : scope.path.ends_with("/cam1") ? second  // Kalibr
                                                            : ranked[std::size_t(rank_of(scope.path))];
    CameraFacts facts = camera_of(scope);
    CameraFacts rows;
    rows.origin = name_;
    take_rows(scope, rows, 0);
    if (rows.width) take(std::move(rows), colour);
    const auto same = [&](const CameraFacts& other) {
      return other.fx == facts.fx && other.fy == facts.fy && other.cx == facts.cx && other.cy == facts.cy;
    };
    if (facts.fx && std::ranges::none_of(cameras, same)) {
      take(std::move(facts), said == unsaid && !cameras.empty() && cameras.front().role == colour ? depth : said);
    }
    return cameras;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& expected) const {
    throw Error(fmt::format("{}: \"{}\": expected {}", name_, key, expected));
  }

  void collect(const FactTree& value, const std::string& path, int above, int levels) {
    constexpr std::size_t kMostScopes = 2000;
    if (levels == 0 || value.is_primitive() || scopes_.size() == kMostScopes) return;
    if (value.is_array()) {
      for (const FactTree& inner : value) collect(inner, path, above, levels - 1);
      return;
    }
    const int index = int(scopes_.size());
    Scope scope{&value, {}, path, above};
    for (const auto& [key, inner] : value.items()) {
      const std::string plain = plain_name(key);
      if (!inner.is_null()) scope.named.emplace(plain, std::pair(key, &inner));
      for (const char* naming : {"name", "stream", "purpose", "camera"}) {
        if (plain == naming && inner.is_string()) scope.path += "/" + plain_name(inner.get_ref<const std::string&>());
      }
    }
    const std::string path_here = scope.path;
    scopes_.push_back(std::move(scope));
    for (const auto& [key, inner] : value.items()) {
      collect(inner, path_here + "/" + plain_name(key), index, levels - 1);
    }
  }

  const Scope* above(const Scope& scope) const {
    return scope.above < 0 ? nullptr : &scopes_[std::size_t(scope.above)];
  }

  double number(const Fact& fact) const {
    const std::optional<double> value = number_of(*fact.value);
    if (!value) fail(fact.key, "a number");
    return *value;
  }
  float focal(double value, const std::string& key) const {
    if (!(value > 0.0 && value < 1e6)) fail(key, "a positive number of pixels");
    return float(value);
  }
  float centre(double value, const std::string& key) const {
    if (!(std::abs(value) < 1e6)) fail(key, "a number of pixels");
    return float(value);
  }
  /// Returns nothing for 0, which messages have that nobody filled in.
  std::optional<int> side(double value, const std::string& key) const {
    constexpr double kMostSide = 1 << 16;
    if (!(value >= 0.0 && value <= kMostSide) || std::floor(value) != value) fail(key, "a number of pixels");
    return value == 0.0 ? std::nullopt : std::optional(int(value));
  }

  void take(const Matrix& matrix, const std::string& key, CameraFacts& facts) const {
    facts.fx = focal(matrix.fx, key);
    facts.fy = focal(matrix.fy, key);
    facts.cx = centre(matrix.cx, key);
    facts.cy = centre(matrix.cy, key);
  }

  /// Returns the matrix of a scope: the one of a known name, else the first that can be nothing else.
  std::optional<std::pair<Matrix, std::string>> find_matrix(const Scope& scope) const {
    const bool of_depth = scope.affixes == &kOfDepth;
    if (const Fact fact = find(scope, kMatrix); fact && holds_numbers(*fact.value)) {
      const std::vector<double> values = numbers_of(*fact.value);
      if (const auto matrix = matrix_of(values)) return std::pair(*matrix, fact.key);
      if (!of_depth) return std::nullopt;  // k1 and k2 are of a lens too
      if (values.size() == 4) return std::pair(Matrix{values[0], values[1], values[2], values[3], true}, fact.key);
      fail(fact.key, "3x3 numbers, or fx, fy, cx, cy");
    }
    std::optional<std::pair<Matrix, std::string>> best;
    for (const auto& [plain, named] : scope.named) {
      const auto matrix = matrix_of(numbers_of(*named.second));
      if (!matrix || !matrix->is_pinhole || plain.starts_with('p')) continue;
      if (!of_depth && !plain.ends_with(scope.affixes->front()[1])) continue;
      if (scope.affixes == &kOfColour && role_in(plain) != CameraRole::colour) continue;
      if (!best || rank_of(plain) < rank_of(plain_name(best->second))) best.emplace(*matrix, named.first);
    }
    return best;
  }

  /// Plain numbers: fx fy cx cy (and a lens), or InfiniTAM's blocks of size, focal lengths and centre, depth last.
  void take_rows(const Scope& scope, CameraFacts& facts, std::size_t last) const {
    const auto found = scope.named.find(plain_name(kNumberRows));
    if (found == scope.named.end() || !found->second.second->is_array()) return;
    const FactTree& rows = *found->second.second;
    std::vector<double> first = numbers_of(rows.front());
    // Matterport and ARKitScenes: width, height, fx, fy, cx, cy and perhaps a lens.
    if (first.size() >= 6 && is_middle(first[4], first[0]) && is_middle(first[5], first[1])) {
      facts.width = side(first[0], "width");
      facts.height = side(first[1], "height");
      first.erase(first.begin(), first.begin() + 2);
    }
    if (first.size() >= 4 && first.size() <= 9 && first[0] > kShortest && first[1] > kShortest) {
      take({first[0], first[1], first[2], first[3], true}, "fx fy cx cy", facts);
    }
    for (std::size_t i = 0; i + 2 < rows.size() && i <= last; i += 3) {
      const std::vector<double> size = numbers_of(rows[i]), f = numbers_of(rows[i + 1]), c = numbers_of(rows[i + 2]);
      if (size.size() != 2 || f.size() != 2 || c.size() != 2) break;
      take({f[0], f[1], c[0], c[1], true}, "fx fy", facts);
      facts.width = side(size[0], "width");
      facts.height = side(size[1], "height");
    }
  }

  CameraFacts camera_of(const Scope& scope) const {
    CameraFacts facts;
    facts.origin = name_;
    if (const Fact fx = find(scope, kFx)) facts.fx = focal(number(fx), fx.key);
    if (const Fact fy = find(scope, kFy)) facts.fy = focal(number(fy), fy.key);
    if (const Fact cx = find(scope, kCx)) {
      facts.cx = centre(number(cx), cx.key);
      facts.from_librealsense = plain_name(cx.key) == "ppx";
    }
    if (const Fact cy = find(scope, kCy)) facts.cy = centre(number(cy), cy.key);
    if (!facts.fx) {
      if (const auto matrix = find_matrix(scope)) take(matrix->first, matrix->second, facts);
    }
    if (!facts.fx && scope.affixes == &kOfDepth) take_rows(scope, facts, 3);
    if (!facts.fx) take_pairs(scope, facts);
    add_size(scope, facts);
    if (const Fact view = find(scope, kView); !facts.fx && view && facts.width) {
      const double degrees = number(view);
      constexpr double kLeast = 10.0, kMost = 170.0;  // what is less may be radians
      if (degrees > kLeast && degrees < kMost) {
        facts.fx = float(*facts.width / 2.0 / std::tan(degrees * std::numbers::pi / 360.0));
      }
    }
    if (facts.fx) add_lens(scope, facts);
    return facts;
  }

  /// Focal length and centre as lists of two, or one focal length for both.
  void take_pairs(const Scope& scope, CameraFacts& facts) const {
    const Fact both = find(scope, kFocal);
    if (!both) return;
    const std::vector<double> f = numbers_of(*both.value);
    if (f.empty() || f.size() > 2 || !(f.front() > kShortest)) return;
    facts.fx = focal(f.front(), both.key);
    facts.fy = focal(f.back(), both.key);
    const Fact centres = find(scope, kCentre);
    const std::vector<double> c = centres ? numbers_of(*centres.value) : std::vector<double>();
    if (c.size() != 2) return;
    facts.cx = centre(c[0], centres.key);
    facts.cy = centre(c[1], centres.key);
  }

  /// The size of a camera's pictures stands beside its focal length, in an object there, or around it.
  void add_size(const Scope& inner, CameraFacts& facts) const {
    for (const Scope* scope = &inner; scope != nullptr && !facts.width && !facts.height; scope = above(*scope)) {
      if (find(*scope, {"x"}) && find(*scope, {"w"})) continue;  // a quaternion
      const Fact width = find(*scope, kWidth), height = find(*scope, kHeight);
      if (width) facts.width = side(number(width), width.key);
      if (height) facts.height = side(number(height), height.key);
      const Fact size = find(*scope, kSize);
      if (!size || width || height) continue;
      std::vector<double> sides = numbers_of(*size.value);
      if (size.value->is_string()) {  // "640x480"
        std::string text = size.value->get<std::string>();
        std::ranges::replace(text, 'x', ' ');
        sides = numbers_of(FactTree(text));
      } else if (size.value->is_object() && size.value->contains("width") && size.value->contains("height")) {
        sides = {number({size.key, &(*size.value)["width"]}), number({size.key, &(*size.value)["height"]})};
      }
      if (sides.size() != 2) continue;
      facts.width = side(sides[0], size.key);
      facts.height = side(sides[1], size.key);
    }
  }

  /// Returns k1, k2, ... that are facts of their own.
  static std::vector<double> single_coefficients(const Scope& scope, bool fisheye) {
    std::vector<double> all;
    for (const char* key : kCoefficients) {
      const Fact fact = find(scope, {key});
      if (!fisheye || key[0] == 'k') all.push_back(fact ? number_of(*fact.value).value_or(0.0) : 0.0);
    }
    if (fisheye) all.resize(4);
    return all;
  }

  std::string lens_model(const Scope& scope) const {
    const Fact fact = find(scope, kModel);
    if (!fact) return {};
    if (const auto number = number_of(*fact.value)) {  // rs2_distortion
      constexpr std::array<const char*, 6> kRealSense{"",       "Modified Brown Conrady", "Inverse Brown Conrady",
                                                      "ftheta", "Brown Conrady",          "kannala_brandt4"};
      const bool known = *number >= 0.0 && *number < double(kRealSense.size());
      return known ? kRealSense[std::size_t(*number)] : fmt::format("{}", *number);
    }
    std::string model = fact.value->is_string() ? plain_name(fact.value->get_ref<const std::string&>()) : "";
    for (const char* any : {"pinhole", "opencv", "perspective", "none"}) {
      if (model == any) return {};
    }
    if (model.starts_with("kannalabrandt") || model == "opencvfisheye") return "kannala_brandt";
    return model;
  }

  void add_lens(const Scope& scope, CameraFacts& facts) const {
    std::string model = lens_model(scope);
    std::vector<double> coefficients;
    Fact fact = find(scope, kDistortion);
    if (!fact && above(scope) != nullptr) {
      fact = find(*above(scope), kDistortion);
      if (model.empty()) model = lens_model(*above(scope));
    }
    if (fact && holds_numbers(*fact.value)) {
      coefficients = numbers_of(*fact.value);
      if (coefficients.empty() && fact.value->is_array() && !fact.value->empty()) fail(fact.key, "a list of numbers");
    } else {
      const auto inner = std::ranges::find(scopes_, fact.value, &Scope::object);
      coefficients = single_coefficients(inner == scopes_.end() ? scope : *inner, model == "kannala_brandt");
    }
    const std::optional<Lens> lens = make_lens(model, coefficients);
    if (!lens) facts.odd_lens = model.empty() ? "without a name" : model;
    if (!lens || *lens == Lens{}) return;
    facts.distorted = LensCamera{{facts.width.value_or(0), facts.height.value_or(0), *facts.fx,
                                  facts.fy.value_or(*facts.fx), facts.cx.value_or(0.F), facts.cy.value_or(0.F)},
                                 *lens};
    const Fact p = find(scope, kProjection);
    const auto projection = p ? matrix_of(numbers_of(*p.value)) : std::nullopt;
    if (projection && projection->fx != 0.0 && projection->fy != 0.0) take(*projection, p.key, facts);
  }

  /// Returns the units per metre that "mm", "mm (checked)" and so on name.
  float scale_of_word(const Fact& fact) const {
    const std::string text = fact.value->is_string() ? fact.value->get<std::string>() : "";
    const std::string word = text.substr(0, text.find_first_not_of("abcdefghijklmnopqrstuvwxyz"));
    if (word == "mm") return 1000.F;
    if (word == "cm") return 100.F;
    if (word == "m") return 1.F;
    fail(fact.key, R"("mm", "cm" or "m", or else "depth_scale" in units per metre)");
  }

  /// A scale is units per metre (TUM, ORB-SLAM: 5000), metres per unit (librealsense: 0.001) or millimetres per unit
  /// (BOP: 0.1 or 1).
  std::optional<float> scale_of(const Fact& fact) const {
    const double value = number(fact);
    constexpr double kMostMetres = 0.05, kMostUnits = 1e6, kFewestUnits = 100.0;
    if (plain_name(fact.key) == "scale" && value < kFewestUnits) return std::nullopt;
    const double scale = value > 1.0 ? value : value > kMostMetres ? 1000.0 / value : 1.0 / value;
    if (!(value > 0.0 && scale <= kMostUnits)) fail(fact.key, "stored units per metre, 1 to 1000000");
    return float(scale);
  }

  /// What is not of one camera alone, from wherever it stands.
  void add_depth(CameraFacts& facts) const {
    for (const Scope& scope : scopes_) {
      const Fact scale = find(scope, kScale);
      if (scale && !facts.depth_scale && !scale.value->is_structured()) {
        facts.depth_scale = plain_name(scale.key) == "units" ? std::optional(scale_of_word(scale)) : scale_of(scale);
      }
      // InfiniTAM: metres of a unit, and of 0.
      const Fact affine = find(scope, {"affine"});
      const std::vector<double> line = affine ? numbers_of(*affine.value) : std::vector<double>();
      if (line.size() == 2 && line[0] >= 1e-6 && line[0] <= 0.05 && line[1] == 0.0 && !facts.depth_scale) {
        facts.depth_scale = float(1.0 / line[0]);
      }
      if (const Fact rate = find(scope, {"ratehz"}); rate && !facts.rate_hz) {
        constexpr double kLowest_hz = 0.001, kHighest_hz = 10000.0;
        const double hz = number(rate);
        if (!(hz >= kLowest_hz && hz <= kHighest_hz)) {
          fail(rate.key, fmt::format("frames a second, {} to {}", kLowest_hz, kHighest_hz));
        }
        facts.rate_hz = hz;
      }
      const Fact sensor = find(scope, {"sensor"});
      if (sensor && sensor.value->is_string() && facts.sensor.empty()) facts.sensor = sensor.value->get<std::string>();
    }
  }

  CameraFacts without_focal() const {
    constexpr std::size_t kMostKeys = 12;
    CameraFacts facts = scopes_.empty() ? CameraFacts() : camera_of(scopes_.front());
    facts.origin = name_;
    std::string keys;
    std::size_t count = 0;
    for (const Scope& scope : scopes_) {
      for (const auto& [plain, named] : scope.named) {
        if (++count <= kMostKeys) keys += (keys.empty() ? "" : ", ") + named.first;
      }
    }
    facts.lacks = fmt::format(
        "{}: no focal length found, expected fx, fy, cx, cy (or ppx, ppy), a 3x3 matrix (K, camera_matrix, "
        "intrinsic_matrix) or width and hfov; it has {}{}",
        name_, keys.empty() ? "no names" : keys,
        count > kMostKeys ? fmt::format(" and {} more", count - kMostKeys) : "");
    return facts;
  }

  std::string name_;
  std::vector<Scope> scopes_;
};

}  // namespace

CameraFacts parse_camera(std::string_view text, const std::string& name) {
  const FactTree root = parse_facts(text, name);
  CameraFacts facts;
  if (root.is_object() && root.contains("CalibrationInformation")) {
    facts.k4a = parse_k4a_calibration(text, name);
    facts.origin = name;
    return facts;
  }
  facts = CameraReader(root, name).read();
  facts.transforms = rigid_facts(root, name);
  return facts;
}

}  // namespace vesalius
