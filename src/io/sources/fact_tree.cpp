#include "io/sources/fact_tree.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <vector>

#include "io/files/known_kind.h"
#include "io/files/plain_text.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr int kMostNodes = 100'000;  // aliases of YAML multiply
constexpr std::string_view kBetweenNumbers = " \t\r\n,;[](){}";

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

FactTree tree_of(const YAML::Node& node, int levels, int& nodes) {
  if (--nodes < 0 || levels < 0) throw Error("too many values or levels");
  FactTree tree;
  if (node.IsScalar()) return node.Scalar();
  if (node.IsSequence()) {
    for (const YAML::Node& value : node) tree.push_back(tree_of(value, levels - 1, nodes));
  } else if (node.IsMap()) {
    for (const auto& entry : node) tree[entry.first.Scalar()] = tree_of(entry.second, levels - 1, nodes);
  }
  return tree;
}

/// Returns all words of a text as numbers; nothing if one is none.
std::vector<double> all_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (text = trimmed(text, kBetweenNumbers); !text.empty(); text = trimmed(text, kBetweenNumbers)) {
    const std::size_t end = std::min(text.find_first_of(kBetweenNumbers), text.size());
    const std::optional<double> number = number_of(text.substr(0, end));
    if (!number) return {};
    numbers.push_back(*number);
    text.remove_prefix(end);
  }
  return numbers;
}

/// Plain text, line by line.
class PlainText {
 public:
  FactTree read(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      line(trimmed(text.substr(0, end)));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    return std::move(root_);
  }

 private:
  FactTree& here() {
    if (section_.empty()) return root_;
    FactTree& section = root_[section_];
    if (!section.is_object()) section = FactTree::object();
    return section;
  }

  void line(std::string_view text) {
    if (text.empty() || text.front() == '#' || text.front() == '%' || text.starts_with("//")) return;
    const std::vector<double> numbers = all_numbers(text);
    if (!numbers.empty()) return row(numbers);
    if (text.front() == '[' && text.back() == ']' && text.find_first_of("[]", 1) == text.size() - 1) {
      section_ = trimmed(text, "[] ");
    } else if (realsense(text) || colmap(text)) {
    } else if (std::count_if(text.begin(), text.end(), [](char c) { return c == ':' || c == '='; }) > 1) {
      for (const std::string_view piece : pieces(text)) pair(piece);
    } else {
      pair(text);
    }
  }

  void row(const std::vector<double>& numbers) {
    if (numbers.size() > 1 && titles_.size() == numbers.size()) {
      for (std::size_t i = 0; i < numbers.size(); ++i) here()[titles_[i]] = numbers[i];
    }
    FactTree& rows = (is_ost() ? root_ : here())[rows_name_.empty() ? kNumberRows : rows_name_];
    if (!rows.is_array()) rows = FactTree::array();
    rows.push_back(numbers);
    if (rows_name_ == "width" || rows_name_ == "height") rows = numbers.front();
    titles_.clear();
  }

  /// Splits "fx: 1, coeffs: [0, 0]" at the commas outside of brackets.
  static std::vector<std::string_view> pieces(std::string_view text) {
    std::vector<std::string_view> all;
    int depth = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= text.size(); ++i) {
      const char c = i < text.size() ? text[i] : ',';
      depth += (c == '[' || c == '(' ? 1 : 0) - (c == ']' || c == ')' ? 1 : 0);
      if (i < text.size() && (c != ',' || depth > 0)) continue;
      all.push_back(trimmed(text.substr(begin, i - begin)));
      begin = i + 1;
    }
    return all;
  }

  /// What pyrealsense2 prints: [ 640x480  p[320 240]  f[380 380]  Brown Conrady [0 0 0 0 0] ].
  bool realsense(std::string_view text) {
    const std::size_t centre = text.find(" p["), focal = text.find(" f[");
    if (centre == text.npos || focal == text.npos) return false;
    const auto list = [&](std::size_t at) { return all_numbers(text.substr(at, text.find(']', at) - at)); };
    here()["focal"] = list(focal + 2);
    here()["principal point"] = list(centre + 2);
    here()["resolution"] = trimmed(text.substr(0, centre), "[ ");
    const std::size_t name = std::min(text.find(']', focal), text.size() - 1) + 1;
    const std::size_t coefficients = text.find('[', name);
    if (coefficients == text.npos) return true;
    here()["model"] = trimmed(text.substr(name, coefficients - name));
    here()["coeffs"] = list(coefficients);
    return true;
  }

  /// COLMAP's cameras.txt: 1 PINHOLE 640 480 FX FY CX CY. A pixel's middle has halves there.
  bool colmap(std::string_view text) {
    const std::size_t begin = std::min(text.find(' '), text.size());
    const std::string_view rest = trimmed(text.substr(begin)), model = rest.substr(0, rest.find(' '));
    const std::vector<double> numbers = all_numbers(rest.substr(model.size()));
    if (!number_of(text.substr(0, begin)) || numbers.size() < 5) return false;
    const bool is_simple = model.starts_with("SIMPLE_") || model == "RADIAL";
    const std::size_t centre = is_simple ? 3 : 4;
    if (numbers.size() < centre + 2 || !std::isupper(static_cast<unsigned char>(model.front()))) return false;
    FactTree& camera = root_["camera" + std::string(text.substr(0, begin))];
    camera = {{"width", numbers[0]},
              {"height", numbers[1]},
              {"fx", numbers[2]},
              {"fy", numbers[centre - 1]},
              {"cx", numbers[centre] - 0.5},
              {"cy", numbers[centre + 1] - 0.5},
              {"coeffs", std::vector<double>(numbers.begin() + std::ptrdiff_t(centre) + 2, numbers.end())}};
    if (model.ends_with("FISHEYE")) camera["model"] = "kannala_brandt";
    return true;
  }

  /// "name: value", "name = value", "name 1 2 3"; a name alone begins a section, several are titles of columns.
  void pair(std::string_view text) {
    std::size_t gap = text.find_first_of(":=");
    if (gap == text.npos) {
      gap = std::min(text.find_first_of(" \t,"), text.size());
      if (all_numbers(text.substr(gap)).empty()) return name(text);
    }
    const std::string key(trimmed(text.substr(0, gap)));
    const std::string_view value = trimmed(text.substr(std::min(gap + 1, text.size())), " \t\r,;\"");
    if (value.empty()) return name(key);
    const std::vector<double> numbers = all_numbers(value);
    here()[key] = numbers.size() > 1 ? FactTree(numbers) : FactTree(value);
  }

  void name(std::string_view text) {
    titles_.clear();
    // librealsense: the rows of a rotation in a section. ROS's ost.txt: all facts so.
    rows_name_ = letters_and_digits(text).starts_with("rotation") ? text : "";
    for (const char* of_ost : {"width", "height", "camera matrix", "distortion", "projection"}) {
      if (text == of_ost) rows_name_ = text == "projection" ? "projection matrix" : of_ost;
    }
    if (!rows_name_.empty()) return;
    section_ = text;
    for (const std::string_view title : pieces(text)) titles_.emplace_back(title);
  }

  bool is_ost() const { return !rows_name_.empty() && !letters_and_digits(rows_name_).starts_with("rotation"); }

  FactTree root_ = FactTree::object();
  std::string section_, rows_name_;
  std::vector<std::string> titles_;
};

std::optional<FactTree> as_json(const std::string& text) {
  FactTree tree = FactTree::parse(text, nullptr, false);
  return tree.is_discarded() ? std::nullopt : std::optional(std::move(tree));
}

/// Returns the tree of a map in YAML; nothing for other texts. `why` receives what is wrong.
std::optional<FactTree> as_yaml(const std::string& text, std::string& why) try {
  const YAML::Node node = YAML::Load(text);
  int nodes = kMostNodes;
  if (node.IsMap()) return tree_of(node, kFactLevels, nodes);
  why = "expected a map";
  return std::nullopt;
} catch (const std::exception& e) {
  why = first_line(e.what());
  return std::nullopt;
}

std::optional<FactTree> as_toml(const std::string& text) try {
  std::ostringstream json;
  const toml::table table = toml::parse(text);
  json << toml::json_formatter{table};
  return table.empty() ? std::nullopt : as_json(json.str());
} catch (const toml::parse_error&) {
  return std::nullopt;
}

/// Reads elements within elements, as OpenCV writes XML; attributes are passed over.
FactTree as_xml(std::string_view text, const std::string& name) {
  // Of the elements that are open, the outermost first.
  std::vector<std::string> names(1), texts(1);
  std::vector<FactTree> inner(1);
  while (!text.empty()) {
    const std::size_t begin = std::min(text.find('<'), text.size());
    texts.back() += text.substr(0, begin);
    const std::size_t end = std::min(text.find('>', begin), text.size());
    std::string_view tag = trimmed(text.substr(begin, end - begin), "<> \t\r\n");
    text.remove_prefix(std::min(end + 1, text.size()));
    if (tag.empty() || tag.front() == '?' || tag.front() == '!' || tag.back() == '/') continue;
    if (tag.front() != '/') {
      names.emplace_back(tag.substr(0, tag.find_first_of(" \t\r\n")));
      texts.emplace_back();
      inner.emplace_back();
    } else if (names.size() > 1) {
      FactTree done = inner.back().is_null() ? FactTree(trimmed(texts.back())) : std::move(inner.back());
      inner.pop_back();
      inner.back()[names.back()] = std::move(done);
      names.pop_back();
      texts.pop_back();
    }
    if (names.size() > std::size_t(kFactLevels)) throw Error(name + ": XML of too many levels");
  }
  if (inner.front().is_null()) throw Error(name + ": XML without an element that ends");
  return std::move(inner.front());
}

}  // namespace

std::optional<double> number_of(std::string_view word) {
  word = trimmed(word);
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = !word.empty() && error == std::errc() && stop == word.data() + word.size();
  return whole ? std::optional(value) : std::nullopt;
}

std::optional<double> number_of(const FactTree& value) {
  if (value.is_number()) return value.get<double>();
  return value.is_string() ? number_of(std::string_view(value.get_ref<const std::string&>())) : std::nullopt;
}

std::vector<double> numbers_of(const FactTree& value, int levels) {
  if (value.is_number()) return {value.get<double>()};
  if (value.is_string()) return all_numbers(value.get_ref<const std::string&>());
  if (levels == 0) return {};
  if (value.is_object()) return value.contains("data") ? numbers_of(value["data"], levels - 1) : std::vector<double>();
  std::vector<double> all;
  for (const FactTree& inner : value) {
    const std::vector<double> numbers = inner.is_object() ? std::vector<double>() : numbers_of(inner, levels - 1);
    if (numbers.empty()) return {};
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

std::string plain_name(std::string_view text) {
  return letters_and_digits(text.substr(text.rfind('.') + 1));  // of npos 0
}

FactTree parse_facts(std::string_view bytes, const std::string& name) {
  std::string text = without_byte_order(bytes);
  text.resize(std::min(text.find('\0'), text.size()));  // some of the Azure Kinect end in zeros, as strings of C do
  const bool braces = trimmed(text).starts_with('{');
  const bool is_text = known_kind(bytes.substr(0, kKindBytes)).empty();
  if (!is_text)
    throw Error(fmt::format("{}: {}, expected a calibration", name, known_kind(bytes.substr(0, kKindBytes))));
  if (auto json = as_json(text); json && json->is_object()) return std::move(*json);
  // Those of Gaussian Splatting have a list of cameras.
  if (auto json = as_json(text); json && json->is_array() && !json->empty() && json->front().is_object()) {
    return FactTree{{"cameras", std::move(*json)}};
  }
  if (trimmed(text).starts_with('<')) return as_xml(text, name);
  std::string why;
  if (auto yaml = as_yaml(text, why)) return std::move(*yaml);
  if (braces) throw Error(name + ": not JSON: " + why);
  if (auto toml = as_toml(text)) return std::move(*toml);
  FactTree plain = PlainText().read(text);
  if (plain.empty()) throw Error(fmt::format("{}: no names with values, expected JSON, YAML, TOML or text", name));
  return plain;
}

}  // namespace vesalius
