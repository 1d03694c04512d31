#include "assets/asset_list.h"

#define TOML_EXCEPTIONS 1
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "assets/unpack.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr std::string_view kAssets =
#include "assets.inc"
    ;

constexpr std::int64_t kMaxBytes = std::int64_t{1} << 40;
constexpr std::size_t kSumDigits = 64;

class Reader {
 public:
  explicit Reader(const std::string& source) : source_(source) {}

  [[noreturn]] void fail(const toml::node& at, const std::string& what) const {
    throw Error(fmt::format("{}:{}: {}", source_, at.source().begin.line, what));
  }
  void expect_keys(const toml::table& table, std::initializer_list<std::string_view> known) const {
    for (const auto& [key, node] : table) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      fail(node, fmt::format("unknown key, expected {}", fmt::join(known, ", ")));
    }
  }
  const toml::node& need(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table, fmt::format("missing key \"{}\"", key));
    return *node;
  }
  const toml::array& array(const toml::node& node, std::string_view what) const {
    if (!node.is_array()) fail(node, fmt::format("{}: expected an array", what));
    return *node.as_array();
  }
  std::string line(const toml::node& node, std::string_view what) const {
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty() || std::ranges::any_of(*value, [](unsigned char c) { return c < ' '; })) {
      fail(node, fmt::format("{}: expected a text of one line", what));
    }
    return *value;
  }
  std::string line(const toml::table& table, std::string_view key) const { return line(need(table, key), key); }

 private:
  const std::string& source_;
};

AssetFile read_file_row(const Reader& reader, const toml::node& node, std::string_view what) {
  const toml::array& row = reader.array(node, what);
  if (row.size() != 3) reader.fail(row, fmt::format("{}: expected [path, bytes, SHA-256]", what));
  AssetFile file;
  file.path = reader.line(row[0], what);
  if (!stays_inside(file.path)) reader.fail(row, fmt::format("{}: expected a path that leads nowhere else", what));
  const auto bytes = row[1].value_exact<std::int64_t>();
  if (!bytes || *bytes < 0 || *bytes > kMaxBytes) {
    reader.fail(row, fmt::format("{}: expected a number of bytes from 0 to {}", what, kMaxBytes));
  }
  file.digest.bytes = static_cast<std::uint64_t>(*bytes);
  file.digest.sha256 = reader.line(row[2], what);
  const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (file.digest.sha256.size() != kSumDigits || !std::ranges::all_of(file.digest.sha256, is_hex)) {
    reader.fail(row, fmt::format("{}: expected a SHA-256 of {} small hexadecimal digits", what, kSumDigits));
  }
  return file;
}

std::string read_name(const Reader& reader, const toml::table& table) {
  std::string name = reader.line(table, "name");
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (!std::ranges::all_of(name, allowed)) {
    reader.fail(table, "name: expected letters, digits, '_' and '-'");
  }
  return name;
}

AssetPackage read_package(const Reader& reader, const toml::node& node) {
  if (!node.is_table()) reader.fail(node, "package: expected a table");
  const toml::table& table = *node.as_table();
  reader.expect_keys(table, {"name", "licence", "credit", "page", "homes", "archive", "files"});
  AssetPackage package;
  package.name = read_name(reader, table);
  package.licence = reader.line(table, "licence");
  package.credit = reader.line(table, "credit");
  package.page = reader.line(table, "page");
  for (const toml::node& home : reader.array(reader.need(table, "homes"), "homes")) {
    package.homes.push_back(reader.line(home, "homes"));
  }
  package.archive = read_file_row(reader, reader.need(table, "archive"), "archive");
  std::set<std::string> paths;
  for (const toml::node& row : reader.array(reader.need(table, "files"), "files")) {
    package.files.push_back(read_file_row(reader, row, "files"));
    if (!paths.insert(package.files.back().path).second) reader.fail(row, "files: this path is listed twice");
  }
  return package;
}

}  // namespace

std::uint64_t AssetPackage::bytes() const {
  return std::accumulate(files.begin(), files.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const AssetFile& file) { return sum + file.digest.bytes; });
}

std::vector<AssetPackage> parse_asset_list(std::string_view toml, const std::string& name) {
  toml::table root;
  try {
    root = toml::parse(toml);
  } catch (const toml::parse_error& e) {
    throw Error(fmt::format("{}:{}: not valid TOML: {}", name, e.source().begin.line, e.description()));
  }
  const Reader reader(name);
  reader.expect_keys(root, {"package"});
  std::vector<AssetPackage> packages;
  std::set<std::string> names;
  for (const toml::node& node : reader.array(reader.need(root, "package"), "package")) {
    packages.push_back(read_package(reader, node));
    if (!names.insert(packages.back().name).second) reader.fail(node, "package: this name is used twice");
  }
  return packages;
}

const std::vector<AssetPackage>& asset_packages() {
  static const std::vector<AssetPackage> packages = parse_asset_list(kAssets, "data/assets.toml");
  return packages;
}

const AssetPackage& asset_package(std::string_view name) {
  std::string known;
  for (const AssetPackage& package : asset_packages()) {
    if (package.name == name) return package;
    known += (known.empty() ? "" : ", ") + package.name;
  }
  throw UsageError(fmt::format("no assets are called \"{}\", expected {}", name, known));
}

}  // namespace vesalius
