#include "downloads/asset_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <set>

#include "downloads/unpack.h"
#include "vesalius/base/toml_reader.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

#include "assets.inc"

constexpr std::int64_t kMaxBytes = std::int64_t{1} << 40;
constexpr std::size_t kSumDigits = 64;

class ListReader : public TomlReader {
 public:
  using TomlReader::TomlReader;

  std::string line(const toml::node& node, std::string_view what) const {
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty() || std::ranges::any_of(*value, [](unsigned char c) { return c < ' '; })) {
      fail(node, fmt::format("{}: expected a text of one line", what));
    }
    return *value;
  }
  std::string line(const toml::table& table, std::string_view key) const { return line(need(table, key), key); }
};

std::string read_path(const ListReader& reader, const toml::node& node, std::string_view what) {
  std::string path = reader.line(node, what);
  if (!stays_inside(path)) reader.fail(node, fmt::format("{}: expected a path that leads nowhere else", what));
  return path;
}

FileDigest read_digest(const ListReader& reader, const toml::node& bytes, const toml::node& sum,
                       std::string_view what) {
  FileDigest digest;
  digest.bytes = reader.integer(bytes, what, 0, kMaxBytes);
  digest.sha256 = reader.line(sum, what);
  const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (digest.sha256.size() != kSumDigits || !std::ranges::all_of(digest.sha256, is_hex)) {
    reader.fail(sum, fmt::format("{}: expected a SHA-256 of {} small hexadecimal digits", what, kSumDigits));
  }
  return digest;
}

AssetFile read_file_row(const ListReader& reader, const toml::node& node, std::string_view what) {
  const toml::array& row = reader.array(node, what);
  if (row.size() != 3) reader.fail(row, fmt::format("{}: expected [path, bytes, SHA-256]", what));
  return {read_path(reader, row[0], what), read_digest(reader, row[1], row[2], what)};
}

std::string read_name(const ListReader& reader, const toml::table& table) {
  std::string name = reader.line(table, "name");
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (!std::ranges::all_of(name, allowed)) {
    reader.fail(table, "name: expected letters, digits, '_' and '-'");
  }
  return name;
}

AssetPackage read_package(const ListReader& reader, const toml::node& node) {
  const toml::table& table = reader.table(node, "package");
  reader.expect_keys(table, {"name", "alias", "licence", "credit", "page", "homes", "archive", "files"});
  AssetPackage package;
  package.name = read_name(reader, table);
  if (table.contains("alias")) package.alias = reader.line(table, "alias");
  package.licence = reader.line(table, "licence");
  package.credit = reader.line(table, "credit");
  package.page = reader.line(table, "page");
  for (const toml::node& home : reader.array(table, "homes")) {
    package.homes.push_back(reader.line(home, "homes"));
  }
  package.archive = read_file_row(reader, reader.need(table, "archive"), "archive");
  std::set<std::string> paths;
  for (const toml::node& row : reader.array(table, "files")) {
    package.files.push_back(read_file_row(reader, row, "files"));
    if (!paths.insert(package.files.back().path).second) reader.fail(row, "files: this path is listed twice");
  }
  return package;
}

AssetSource read_source(const ListReader& reader, const toml::node& node) {
  const toml::table& table = reader.table(node, "source");
  reader.expect_keys(table, {"home", "licence", "credit", "files"});
  AssetSource source;
  source.home = reader.line(table, "home");
  source.licence = reader.line(table, "licence");
  source.credit = reader.line(table, "credit");
  for (const toml::node& each : reader.array(table, "files")) {
    const toml::array& row = reader.array(each, "files");
    const bool is_amc = !row.empty() && reader.line(row[0], "files").ends_with(".amc");
    if (row.size() != (is_amc ? 5 : 4)) {
      reader.fail(row, "files: expected [path, original's path, bytes, SHA-256], and for AMC the skeleton");
    }
    AssetOriginal original{read_path(reader, row[1], "files"), read_digest(reader, row[2], row[3], "files"),
                           is_amc ? reader.line(row[4], "files") : ""};
    if (!source.originals.emplace(reader.line(row[0], "files"), std::move(original)).second) {
      reader.fail(row, "files: this path is listed twice");
    }
  }
  return source;
}

/// Returns the packages of the program with all that it knows of them.
std::vector<AssetPackage> read_program_list() {
  std::vector<AssetPackage> packages = parse_asset_list(kAssets, "data/assets.toml");
  AssetPackage& mocap = *std::ranges::find(packages, "mocap", &AssetPackage::name);
  mocap.sources = parse_source_list(kMotions, "data/motions.toml");
  std::string& manifest = mocap.enclosed["manifest.csv"];
  for (const char c : kMocapManifest) manifest.append(c == '\n' ? "\r\n" : std::string(1, c));
  return packages;
}

}  // namespace

std::uint64_t AssetSource::bytes() const {
  return std::accumulate(originals.begin(), originals.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& each) { return sum + each.second.digest.bytes; });
}

std::uint64_t AssetPackage::bytes() const {
  return std::accumulate(files.begin(), files.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const AssetFile& file) { return sum + file.digest.bytes; });
}

std::vector<AssetPackage> parse_asset_list(std::string_view toml, const std::string& name) {
  const ListReader reader(name);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"package"});
  std::vector<AssetPackage> packages;
  std::set<std::string> names;
  for (const toml::node& node : reader.array(root, "package")) {
    packages.push_back(read_package(reader, node));
    if (!names.insert(packages.back().name).second) reader.fail(node, "package: this name is used twice");
  }
  return packages;
}

std::vector<AssetSource> parse_source_list(std::string_view toml, const std::string& name) {
  const ListReader reader(name);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"source"});
  std::vector<AssetSource> sources;
  for (const toml::node& node : reader.array(root, "source")) sources.push_back(read_source(reader, node));
  return sources;
}

const std::vector<AssetPackage>& asset_packages() {
  static const std::vector<AssetPackage> packages = read_program_list();
  return packages;
}

const AssetPackage& asset_package(std::string_view name) {
  std::string known;
  for (const AssetPackage& package : asset_packages()) {
    if (name == package.name || (!name.empty() && name == package.alias)) return package;
    known += (known.empty() ? "" : ", ") + package.name;
  }
  throw UsageError(fmt::format("no assets are called \"{}\", expected {}", name, known));
}

}  // namespace vesalius
