#include "io/sources/list_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <queue>
#include <system_error>
#include <tuple>

#include "io/files/data_file.h"
#include "io/files/depth_picture.h"
#include "io/files/plain_text.h"
#include "io/files/stored_depth.h"
#include "io/recordings/imu_messages.h"
#include "io/sources/acceleration_file.h"
#include "io/sources/colour_camera.h"
#include "io/sources/fact_tree.h"
#include "io/sources/source_items.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

bool is_of_size(const auto& image, const Camera& camera) {
  return image.width() == camera.width && image.height() == camera.height;
}

/// Returns whether a path says that its pictures lie on those of another camera.
bool is_registered(const std::string& path) {
  const std::string text = lower(path);
  return text.find("align") != text.npos || text.find("register") != text.npos;
}

/// Returns the first picture of depth that can be read. Whoever asks for one before it hears of that.
DepthPicture first_depth_of(const FrameList& list) {
  constexpr std::size_t kMostLookedAt = 20;
  std::exception_ptr failed;
  for (std::size_t i = 0; i < std::min(list.frames.size(), kMostLookedAt); ++i) {
    try {
      return read_depth(list.frames[i].depth);
    } catch (const Error&) {
      if (!failed) failed = std::current_exception();
    }
  }
  std::rethrow_exception(failed);
}

class ListSource final : public FrameSource {
 public:
  explicit ListSource(FrameList list) : reader_(std::move(list)) {}

  std::optional<Frame> next() override {
    if (next_ == reader_.size()) return std::nullopt;
    return reader_.read(next_++);
  }
  int size() const override { return int(reader_.size()); }
  std::optional<TimeSpan> span() const override { return TimeSpan{time_of(0), time_of(reader_.size() - 1)}; }
  void seek(double time_s) override {
    next_ = first_not_before(time_s, reader_.size(), [this](std::size_t i) { return time_of(i); });
  }
  std::vector<std::string> notes() const override { return reader_.list().notes; }
  std::vector<SourceItem> contents() const override { return reader_.list().items; }
  bool is_sequence() const override { return reader_.list().frames.front().time_s.has_value(); }

 private:
  double time_of(std::size_t index) const { return reader_.list().frames[index].time_s.value_or(usual_time_s(index)); }

  FrameListReader reader_;
  std::size_t next_ = 0;
};

namespace fs = std::filesystem;

constexpr float kTumUnitsPerM = 5000.F;  // the benchmark's file format page
constexpr std::size_t kMaxListBytes = 64 << 20;
constexpr std::string_view kBetweenWords = " \t\r,";

/// Returns where the time ends that a line begins with. A comma with digits up to a blank behind it is the point of
/// German or French numbers: "1305031102,160 depth/a.png".
std::size_t end_of_time(std::string_view line) {
  constexpr const char* kDigits = "0123456789";
  const std::size_t end = line.find_first_of(" \t,");
  if (end >= line.size() || line[end] != ',') return std::min(end, line.size());
  const std::size_t decimals = line.find_first_not_of(kDigits, end + 1);
  const bool is_point =
      decimals != line.npos && decimals > end + 1 && (line[decimals] == ' ' || line[decimals] == '\t');
  return is_point ? decimals : end;
}

TumEntry parse_line(std::string_view line, const std::string& name, int number) {
  const std::size_t gap = end_of_time(line);
  TumEntry entry;
  entry.stamp = std::string(line.substr(0, gap));
  std::ranges::replace(entry.stamp, ',', '.');
  entry.file = std::string(trimmed(line.substr(gap), kBetweenWords));
  const char* end = entry.stamp.data() + entry.stamp.size();
  const auto [stop, error] = std::from_chars(entry.stamp.data(), end, entry.time_s);
  const bool is_number =
      number_of(std::string_view(entry.file).substr(0, entry.file.find_first_of(kBetweenWords))).has_value();
  const bool named = !entry.file.empty() && !is_number && entry.file.find('\0') == entry.file.npos;
  if (error != std::errc() || stop != end || !std::isfinite(entry.time_s) || !named) {
    throw Error(fmt::format("{}:{}: expected \"timestamp file\"", name, number));
  }
  entry.time_s = clock_seconds(entry.time_s);
  return entry;
}

const std::vector<std::string> kDepthLists{"depth.txt"}, kColourLists{"rgb.txt", "color.txt"},
    kAssociations{"associations.txt", "associate.txt", "association.txt", "assoc.txt", "associated.txt"};

/// Returns the path of the first of some files, whatever the case of its name; empty where there is none.
std::string find_list(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    for (const fs::path& path : list_files(folder.string(), {".txt"})) {
      if (lower(path.filename().string()) == name) return path.string();
    }
  }
  return {};
}

struct TumLists {
  std::vector<TumEntry> depth, colour;
  std::string name;  ///< path of the list that depth is in
};

/// Splits lines "time file time file"; of the two files depth's has the word in its path.
TumLists split_associations(const std::string& path) {
  TumLists lists{{}, {}, path};
  for (const TumEntry& both : parse_tum_list(read_file(path, kMaxListBytes), path)) {
    const std::size_t gap = std::min(both.file.find_first_of(" \t,"), both.file.size());
    const TumEntry first{both.time_s, both.stamp, both.file.substr(0, gap)};
    const std::string rest(trimmed(std::string_view(both.file).substr(gap), kBetweenWords));
    const std::vector<TumEntry> others = parse_tum_list(rest, path);
    if (others.size() != 1) throw Error(path + ": expected lines \"timestamp file timestamp file\"");
    const TumEntry& second = others.front();
    const bool depth_first = lower(first.file).find("depth") != std::string::npos;
    lists.depth.push_back(depth_first ? first : second);
    lists.colour.push_back(depth_first ? second : first);
  }
  for (auto* list : {&lists.depth, &lists.colour}) std::ranges::stable_sort(*list, {}, &TumEntry::time_s);
  return lists;
}

TumLists read_lists(const fs::path& root) {
  const std::string depth = find_list(root, kDepthLists), colour = find_list(root, kColourLists);
  if (depth.empty()) {
    const std::string both = find_list(root, kAssociations);
    if (!both.empty()) return split_associations(both);
  }
  const std::string depth_list = depth.empty() ? (root / kDepthLists.front()).string() : depth;
  TumLists lists{parse_tum_list(read_file(depth_list, kMaxListBytes), depth_list), {}, depth_list};
  if (!colour.empty()) lists.colour = parse_tum_list(read_file(colour, kMaxListBytes), colour);
  return lists;
}

/// Returns where a picture of a list lies: as written, with slashes for the backslashes of Windows, or by its last
/// folder's name where the whole path is that of another machine.
std::string path_of(const fs::path& root, const std::string& file) {
  std::string slashed = file;
  std::ranges::replace(slashed, '\\', '/');
  const fs::path path(slashed);
  std::error_code none;
  for (const fs::path& one : {fs::path(file), path, path.parent_path().filename() / path.filename()}) {
    if (fs::exists(root / one, none)) return (root / one).string();
  }
  return (root / file).string();
}

/// Returns whether a list counts frames instead of telling times, as those of ICL-NUIM do: "0 depth/0.png".
bool counts_frames(const std::vector<TumEntry>& entries) {
  constexpr std::size_t kMostDigits = 7;
  return std::ranges::all_of(entries, [](const TumEntry& entry) {
    return entry.stamp.size() <= kMostDigits && entry.stamp.find_first_not_of("0123456789") == entry.stamp.npos;
  });
}

/// Times beyond those of 64 bits count as the ends.
std::int64_t clamped_nanoseconds(double time_s) { return std::llround(std::clamp(time_s, -9e9, 9e9) * 1e9); }

/// Both lists merged by time as a linked list. When a pair is taken out, the entries beside it become neighbours; so
/// the closest remaining pair is always a pair of neighbours.
struct Merged {
  struct Item {
    double time_s;
    int index;
    bool is_depth;
    int before, after;
    bool taken;
  };
  std::vector<Item> items;

  Merged(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour) {
    for (int i = 0; i < int(depth.size()); ++i) items.push_back({depth[i].time_s, i, true, 0, 0, false});
    for (int i = 0; i < int(colour.size()); ++i) items.push_back({colour[i].time_s, i, false, 0, 0, false});
    std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.time_s < b.time_s; });
    const int count = int(items.size());
    for (int i = 0; i < count; ++i) {
      items[i].before = i - 1;
      items[i].after = i + 1 < count ? i + 1 : -1;
    }
  }

  void take_out(int i) {
    Item& item = items[i];
    item.taken = true;
    if (item.before >= 0) items[item.before].after = item.after;
    if (item.after >= 0) items[item.after].before = item.before;
  }
};

}  // namespace

FrameListReader::FrameListReader(FrameList list) : list_(std::move(list)) {
  try {
    look_at_first();
  } catch (const UsageError&) {
    throw;
  } catch (const Error& e) {
    throw Error(with_items(e.what(), list_.items));
  }
}

void FrameListReader::look_at_first() {
  const DepthPicture first = first_depth_of(list_);
  CameraFacts& facts = list_.facts;
  const CameraFacts& fallback = list_.fallback;
  if (!facts.has_focal() && facts.sensor.empty() && fallback.fx && fallback.width == first.width() &&
      fallback.height == first.height()) {
    facts.fill_from(fallback);
    list_.notes.push_back(fmt::format("{}: no intrinsics given; those of {} assumed", list_.place, fallback.origin));
  }
  const bool registered = std::any_of(list_.frames.begin(), list_.frames.end(),
                                      [](const FrameFiles& files) { return !files.colour.empty(); });
  for (SourceItem& item : list_.items) {
    if (item.use == "depth") item.holds += fmt::format(" {}x{}", first.width(), first.height());
    const auto is_it = [&](const std::string& origin) { return origin.ends_with("/" + item.name); };
    const bool used = (facts.has_focal() && is_it(facts.origin)) ||
                      std::ranges::any_of(facts.others, is_it, &CameraFacts::origin) ||
                      std::ranges::any_of(facts.transforms, is_it, &RigidFact::origin);
    if (used && item.use.empty()) item.use = "calibration";
  }
  camera_ = resolve_camera(facts, first.width(), first.height(), registered, list_.place, list_.notes);
  rectification_ = make_rectification(facts.distorted, camera_);
  look_at_colour();
}

void FrameListReader::look_at_colour() {
  const auto with = std::ranges::find_if(list_.frames, [](const FrameFiles& files) { return !files.colour.empty(); });
  if (with == list_.frames.end()) return;
  ColourImage first;
  try {
    first = read_colour(with->colour);
  } catch (const Error&) {
    return;  // that frame says so
  }
  const bool same_size = is_of_size(first, camera_),
             said_registered = is_registered(with->depth) || is_registered(with->colour);
  std::string missing;
  const auto colour = same_size && said_registered
                          ? std::nullopt
                          : find_colour_camera(list_.facts, camera_, first.width(), first.height(), missing);
  const bool same_camera = same_size && colour && colour->lens.camera == camera_ &&
                           colour->colour_from_depth.isApprox(Eigen::Isometry3d::Identity());
  if (colour && !same_camera) registration_.emplace(camera_, colour->lens, colour->colour_from_depth);
  if (colour && same_size && !same_camera) {
    list_.notes.push_back(
        fmt::format("{}: colour is put on the grid of depth, as {} says; a --camera of depth alone "
                    "leaves it as it is",
                    list_.place, list_.facts.origin));
  }
  if (colour || same_size) return;
  const std::string why =
      fmt::format("no colour, since that has {}x{} pixels and depth {}x{}{}", first.width(), first.height(),
                  camera_.width, camera_.height, missing.empty() ? "" : ", and " + missing);
  list_.notes.push_back(fmt::format("{}: {}", list_.place, why));
  for (SourceItem& item : list_.items) {
    if (item.use != "colour") continue;
    item.use.clear();
    item.why = why;
  }
}

Frame FrameListReader::read(std::size_t index, bool with_colour) const {
  const FrameFiles& files = list_.frames[index];
  DepthPicture stored = read_depth(files.depth);
  restore(stored.whole, list_.facts.depth_bits);
  if (!is_of_size(stored, camera_)) {
    throw Error(fmt::format("{}: {}x{} pixels, expected the size of the first, {}x{}", files.depth, stored.width(),
                            stored.height(), camera_.width, camera_.height));
  }
  const std::optional<float> scale = list_.facts.depth_scale;
  Frame frame{files.name,
              files.time_s,
              camera_,
              to_millimetres(stored, scale.value_or(list_.default_scale), scale.has_value()),
              {}};
  frame.up = files.up;
  if (rectification_) frame.depth = rectification_->depth(frame.depth);
  if (!with_colour || files.colour.empty()) return frame;
  ColourImage colour = read_colour(files.colour);
  if (registration_ && registration_->fits(colour)) {
    frame.colour = (*registration_)(frame.depth, colour);
  } else if (is_of_size(colour, camera_)) {
    frame.colour = rectified(rectification_, std::move(colour));
  }
  return frame;
}

void add_items(FrameList& list) {
  std::vector<std::string> depths, colours;
  for (const FrameFiles& files : list.frames) {
    depths.push_back(files.depth);
    if (!files.colour.empty()) colours.push_back(files.colour);
  }
  list.items = items_of(list.place, depths, colours);
}

void add_up(FrameList& list, const std::vector<std::string>& folders) {
  std::string path;
  for (const std::string& folder : folders) {
    const fs::path here = fs::path(folder) / kAccelerationFile;
    std::error_code none;
    if (path.empty() && fs::exists(here, none)) path = here.string();
  }
  if (path.empty()) return;
  const std::vector<TimedAcceleration> measured = parse_accelerations(read_file(path, kMaxListBytes), path);
  const bool has_times = list.frames.front().time_s.has_value();
  const std::string why =
      has_times ? "" : "frames have no times, expected names that are times, or rate_hz in meta.json";
  if (!has_times) list.notes.push_back(fmt::format("{}: not used: {}", path, why));
  for (SourceItem& item : list.items) {
    if (item.name != kAccelerationFile) continue;
    item.use = has_times ? "up" : "";
    item.why = why;
  }
  if (!has_times) return;
  UpHistory history;
  auto next = measured.begin();
  for (FrameFiles& frame : list.frames) {
    const std::int64_t time_ns = clamped_nanoseconds(*frame.time_s);
    for (; next != measured.end() && clamped_nanoseconds(next->time_s) <= time_ns; ++next)
      history.add(clamped_nanoseconds(next->time_s), next->m_s2);
    frame.up = history.up_at(time_ns);
  }
}

std::unique_ptr<FrameSource> open_list(FrameList list) { return std::make_unique<ListSource>(std::move(list)); }

std::vector<TumEntry> parse_tum_list(std::string_view bytes, const std::string& name) {
  std::vector<TumEntry> entries;
  each_line(without_byte_order(bytes), kBetweenWords,
            [&](std::string_view line, int number) { entries.push_back(parse_line(line, name, number)); });
  std::stable_sort(entries.begin(), entries.end(),
                   [](const TumEntry& a, const TumEntry& b) { return a.time_s < b.time_s; });
  return entries;
}

std::vector<int> associate(const std::vector<TumEntry>& depth, const std::vector<TumEntry>& colour,
                           double max_difference_s) {
  Merged merged(depth, colour);
  // Candidates are sorted by difference, then by times as in the benchmark's tool, then by indices.
  using Candidate = std::tuple<double, double, double, int, int>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  const auto consider = [&](int a, int b) {
    if (a < 0 || b < 0 || merged.items[a].is_depth == merged.items[b].is_depth) return;
    const double difference = merged.items[b].time_s - merged.items[a].time_s;
    if (!(difference < max_difference_s)) return;
    const auto& d = merged.items[merged.items[a].is_depth ? a : b];
    const auto& c = merged.items[merged.items[a].is_depth ? b : a];
    candidates.emplace(difference, d.time_s, c.time_s, a, b);
  };
  for (int i = 0; i + 1 < int(merged.items.size()); ++i) consider(i, i + 1);

  std::vector<int> partner(depth.size(), -1);
  while (!candidates.empty()) {
    const auto [difference, depth_s, colour_s, a, b] = candidates.top();
    candidates.pop();
    if (merged.items[a].taken || merged.items[b].taken) continue;
    const auto& first = merged.items[a];
    const auto& second = merged.items[b];
    partner[first.is_depth ? first.index : second.index] = first.is_depth ? second.index : first.index;
    const int before = first.before;
    const int after = second.after;
    merged.take_out(a);
    merged.take_out(b);
    consider(before, after);
  }
  return partner;
}

bool is_tum_folder(const std::string& folder) {
  return !find_list(folder, kDepthLists).empty() || !find_list(folder, kAssociations).empty();
}

FrameList list_tum(const std::string& folder, const SourceOptions& options) {
  const fs::path root(folder);
  FrameList list;
  list.place = folder;
  list.default_scale = kTumUnitsPerM;
  list.fallback.fx = list.fallback.fy = 525.F;
  list.fallback.cx = 319.5F;
  list.fallback.cy = 239.5F;
  list.fallback.width = 640;
  list.fallback.height = 480;
  list.fallback.origin = "the TUM benchmark (525, 525, 319.5, 239.5)";

  auto [depth, colour, depth_list] = read_lists(root);
  if (depth.empty()) throw Error(depth_list + ": no frames, expected lines \"timestamp file\"");
  list.facts = find_camera_facts(options, {folder});
  if (counts_frames(depth) && counts_frames(colour)) {
    const double rate_hz = list.facts.rate_hz.value_or(kUsualRate);
    for (auto* entries : {&depth, &colour}) {
      for (TumEntry& entry : *entries) entry.time_s /= rate_hz;
    }
    list.notes.push_back(
        fmt::format("{}: numbers of frames, no times; they count as {} a second", depth_list, rate_hz));
  }
  const std::vector<int> partner = associate(depth, colour, kMaxTimeDifferenceS);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::string colour_file = partner[i] < 0 ? "" : path_of(root, colour[partner[i]].file);
    list.frames.push_back({depth[i].stamp, depth[i].time_s, path_of(root, depth[i].file), colour_file});
  }
  const auto lonely = std::count(partner.begin(), partner.end(), -1);
  if (lonely != 0 && !colour.empty()) {
    list.notes.push_back(fmt::format("{}: {} of {} depth pictures have no colour within {} s", folder, lonely,
                                     depth.size(), kMaxTimeDifferenceS));
  }
  add_items(list);
  for (SourceItem& item : list.items) {
    for (const auto* lists : {&kDepthLists, &kColourLists, &kAssociations}) {
      if (std::ranges::find(*lists, lower(item.name)) != lists->end()) item.use = "list of frames";
    }
  }
  add_up(list, {folder});
  return list;
}

}  // namespace vesalius
