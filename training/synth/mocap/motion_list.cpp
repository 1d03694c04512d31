#include "synth/mocap/motion_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr std::size_t kMaxCsvBytes = std::size_t{1} << 24;

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

bool contains(const std::string& text, const std::string& word) { return text.find(lower(word)) != std::string::npos; }

/// Returns the path without its extension, and the extension in lower case.
std::pair<std::string, std::string> split_extension(const std::string& path) {
  const std::size_t dot = path.rfind('.'), slash = path.rfind('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return {path, ""};
  return {path.substr(0, dot), lower(path.substr(dot))};
}

std::string find_skeleton(std::string stem, const std::map<std::string, std::string>& skeletons) {
  const std::size_t slash = stem.rfind('/');
  const std::size_t name_at = slash == std::string::npos ? 0 : slash + 1;
  while (stem.size() > name_at) {
    const auto found = skeletons.find(stem);
    if (found != skeletons.end()) return found->second;
    const std::size_t cut = stem.rfind('_');
    if (cut == std::string::npos || cut < name_at) break;
    stem.resize(cut);
  }
  return {};
}

/// Reads comma-separated rows (RFC 4180). A quoted field may contain commas and doubled quotes.
class CsvRows {
 public:
  CsvRows(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  bool at_end() const { return at_ >= text_.size(); }
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}:{}: {}", name_, line_, what)); }

  std::vector<std::string> row() {
    line_ = next_line_++;
    std::vector<std::string> fields(1);
    while (!at_end() && text_[at_] != '\n') {
      const char c = text_[at_++];
      if (c == ',') {
        fields.emplace_back();
      } else if (c == '"' && fields.back().empty()) {
        quoted_field(fields.back());
      } else if (c != '\r') {
        fields.back() += c;
      }
    }
    ++at_;
    return fields;
  }

 private:
  void quoted_field(std::string& field) {
    for (;; ++at_) {
      if (at_end() || text_[at_] == '\n') fail("expected a closing quote");
      if (text_[at_] != '"') {
        field += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        field += text_[at_++];
      } else {
        ++at_;
        return;
      }
    }
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
  int next_line_ = 1;
};

struct Described {
  std::string description;
  float fps = 0.F;  ///< 0 if not given
};

float fps_of(const CsvRows& rows, const std::string& text) {
  if (text.empty()) return 0.F;
  float fps = 0.F;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fps);
  if (error != std::errc() || end != text.data() + text.size() || !(fps > 0.F && fps <= 1e4F)) {
    rows.fail(fmt::format("fps: expected a number above 0, found {}", in_quotes(text)));
  }
  return fps;
}

std::map<std::string, Described> read_descriptions(std::string_view csv, const std::string& name) {
  if (csv.size() > kMaxCsvBytes) throw Error(fmt::format("{}: expected at most {} bytes", name, kMaxCsvBytes));
  CsvRows rows(csv, name);
  const std::vector<std::string> header = rows.row();
  const auto column = [&](std::string_view wanted) { return std::ranges::find(header, wanted) - header.begin(); };
  const auto count = static_cast<std::ptrdiff_t>(header.size());
  const std::ptrdiff_t file = column("file"), description = column("description"), fps = column("fps");
  if (file == count || description == count) rows.fail("expected a first line that names columns file and description");
  std::map<std::string, Described> out;
  while (!rows.at_end()) {
    const std::vector<std::string> row = rows.row();
    if (row.size() == 1 && row[0].empty()) continue;
    if (row.size() != header.size()) {
      rows.fail(fmt::format("expected {} fields as in the first line, found {}", header.size(), row.size()));
    }
    const auto field = [&](std::ptrdiff_t c) { return row[c]; };
    out[field(file)] = {field(description), fps == count ? 0.F : fps_of(rows, field(fps))};
  }
  return out;
}

}  // namespace

std::vector<MotionFile> list_motions(std::span<const std::string> paths) {
  std::map<std::string, std::string> skeletons;
  for (const std::string& path : paths) {
    const auto [stem, extension] = split_extension(path);
    if (extension == ".asf") skeletons[stem] = path;
  }
  const std::set<std::string> sorted(paths.begin(), paths.end());
  std::vector<MotionFile> motions;
  for (const std::string& path : sorted) {
    const auto [stem, extension] = split_extension(path);
    if (extension != ".bvh" && extension != ".amc") continue;
    MotionFile motion;
    motion.path = path;
    if (extension == ".amc") motion.skeleton = find_skeleton(stem, skeletons);
    motion.description = stem.substr(stem.rfind('/') + 1);
    motions.push_back(std::move(motion));
  }
  return motions;
}

void describe_motions(std::vector<MotionFile>& motions, std::string_view csv, const std::string& name) {
  const std::map<std::string, Described> described = read_descriptions(csv, name);
  for (MotionFile& motion : motions) {
    // The row may name any ending of the path that begins after a slash.
    for (std::size_t at = 0; at != std::string::npos;) {
      const auto found = described.find(motion.path.substr(at));
      if (found != described.end()) {
        motion.description = found->second.description;
        if (found->second.fps > 0.F) motion.fps = found->second.fps;
        break;
      }
      const std::size_t slash = motion.path.find('/', at);
      at = slash == std::string::npos ? slash : slash + 1;
    }
  }
}

std::vector<MotionFile> choose_motions(std::span<const MotionFile> motions, const MotionChoice& choice) {
  std::vector<MotionFile> chosen;
  for (const MotionFile& motion : motions) {
    const std::string text = lower(motion.description);
    const auto is_there = [&](const std::string& word) { return contains(text, word); };
    const bool wanted = choice.include.empty() || std::ranges::any_of(choice.include, is_there);
    if (wanted && std::ranges::none_of(choice.exclude, is_there)) chosen.push_back(motion);
  }
  return chosen;
}

}  // namespace vesalius::synth
