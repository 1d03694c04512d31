#include "synth/scene/obj_model.h"

#include <fmt/format.h>

#include <charconv>
#include <map>
#include <set>

#include "synth/scene/cut_polygon.h"
#include "synth/text/text_scanner.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMostCorners = 128;
constexpr std::size_t kMostMaterials = 10'000;
constexpr std::size_t kMostMaterialFiles = 16;

Vector3f three(TextScanner& scan, std::string_view what) {
  Vector3f p;
  for (float& x : p) {
    if (scan.at_line_end()) scan.fail(fmt::format("expected three numbers, {}, found the end of the line", what));
    x = static_cast<float>(scan.number(what));
  }
  return p;
}

/// Returns the remaining words of the line, with a space between them.
std::string rest_of_line(TextScanner& scan) {
  std::string rest;
  while (!scan.at_line_end()) rest.append(rest.empty() ? "" : " ").append(scan.word("a name"));
  return rest;
}

class ObjReader {
 public:
  ObjReader(ModelFiles& files, ModelMesh& mesh) : files_(files), mesh_(mesh) {}

  void read() {
    const std::string text = files_.model();
    TextScanner scan(text, files_.path());
    while (!scan.at_end()) {
      const std::string_view what = scan.word("a word");
      if (what == "v") {
        mesh_.add_vertex(three(scan, "a coordinate"));
      } else if (what == "f") {
        face(scan);
        continue;
      } else if (what == "usemtl") {
        use(rest_of_line(scan));
      } else if (what == "mtllib") {
        const std::string name = rest_of_line(scan);
        if (!libraries_.insert(name).second) continue;
        if (libraries_.size() > kMostMaterialFiles) {
          scan.fail(fmt::format("more than {} material files", kMostMaterialFiles));
        }
        read_materials(name);
      }
      rest_of_line(scan);
    }
  }

 private:
  void read_materials(const std::string& file) {
    const std::optional<std::string> text = files_.beside(file);
    if (!text) return;
    TextScanner scan(*text, file);
    std::string name;
    while (!scan.at_end()) {
      const std::string_view what = scan.word("a word");
      if (what == "newmtl") {
        name = rest_of_line(scan);
        if (colours_.size() == kMostMaterials) scan.fail(fmt::format("more than {} materials", kMostMaterials));
        colours_[name] = kPlainGrey;
      } else if (what == "Kd" && !name.empty() && !scan.at_line_end() && scan.peek() != "spectral" &&
                 scan.peek() != "xyz") {
        colours_[name] = colour_of(three(scan, "a colour"));
      }
      rest_of_line(scan);
    }
  }

  void use(const std::string& name) {
    const auto [at, is_new] = materials_.try_emplace(name);
    if (is_new) {
      const auto colour = colours_.find(name);
      at->second = mesh_.add_material(colour == colours_.end() ? kPlainGrey : colour->second);
    }
    material_ = at->second;
  }

  /// Returns the vertex of a face's corner: "12", "12/3", "12//4" or "12/3/4". Numbers count from 1, or backwards from
  /// -1.
  std::uint32_t corner(const TextScanner& scan, std::string_view word) const {
    const std::string_view digits = word.substr(0, word.find('/'));
    const auto count = std::ssize(mesh_.vertices());
    std::ptrdiff_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value == 0 || value > count || value < -count) {
      scan.fail(fmt::format("expected the number of one of the {} vertices before, found {}", count, in_quotes(word)));
    }
    return static_cast<std::uint32_t>(value > 0 ? value - 1 : count + value);
  }

  /// Reads a face to the end of its line. A backslash at the end continues the line.
  void face(TextScanner& scan) {
    std::vector<std::uint32_t> vertices;
    std::vector<Vector3f> points;
    bool goes_on = false;
    while (!scan.at_end() && (goes_on || !scan.at_line_end())) {
      const std::string_view word = scan.word("a vertex");
      goes_on = word == "\\";
      if (goes_on) continue;
      vertices.push_back(corner(scan, word));
      points.push_back(mesh_.vertices()[vertices.back()]);
      if (vertices.size() > kMostCorners) scan.fail(fmt::format("a face of more than {} corners", kMostCorners));
    }
    if (vertices.size() < 3) scan.fail(fmt::format("a face of {} corners, expected at least 3", vertices.size()));
    if (materials_.empty()) use("");
    for (const Triangle& t : cut_polygon(points)) {
      mesh_.add_triangle({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, material_);
    }
  }

  ModelFiles& files_;
  ModelMesh& mesh_;
  std::set<std::string> libraries_;
  std::map<std::string, Rgb> colours_;
  std::map<std::string, std::uint8_t> materials_;  ///< materials in use by their names
  std::uint8_t material_ = 0;
};

}  // namespace

void read_obj_model(ModelFiles& files, ModelMesh& mesh) { ObjReader(files, mesh).read(); }

}  // namespace vesalius::synth
