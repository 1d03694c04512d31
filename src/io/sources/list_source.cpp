#include "io/sources/list_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <queue>
#include <tuple>

#include "io/files/data_file.h"
#include "io/files/stored_depth.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

template <class T>
void expect_size_of(const Image<T>& image, const Camera& camera, const std::string& path, const char* expected) {
  if (image.width() == camera.width && image.height() == camera.height) return;
  throw Error(fmt::format("{}: {}x{} pixels, expected {}, {}x{}", path, image.width(), image.height(), expected,
                          camera.width, camera.height));
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
  bool is_sequence() const override { return reader_.list().frames.front().time_s.has_value(); }

 private:
  double time_of(std::size_t index) const { return reader_.list().frames[index].time_s.value_or(usual_time_s(index)); }

  FrameListReader reader_;
  std::size_t next_ = 0;
};

namespace fs = std::filesystem;

constexpr float kTumUnitsPerM = 5000.F;       // the benchmark's file format page
constexpr double kMaxTimeDifferenceS = 0.02;  // default of the benchmark's associate tool
constexpr std::size_t kMaxListBytes = 64 << 20;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

TumEntry parse_line(std::string_view line, const std::string& name, int number) {
  const std::size_t gap = std::min(line.find_first_of(" \t"), line.size());
  TumEntry entry;
  entry.stamp = std::string(line.substr(0, gap));
  entry.file = std::string(trimmed(line.substr(gap)));
  const char* end = entry.stamp.data() + entry.stamp.size();
  const auto [stop, error] = std::from_chars(entry.stamp.data(), end, entry.time_s);
  const bool named = !entry.file.empty() && entry.file.find('\0') == entry.file.npos;
  if (error != std::errc() || stop != end || !std::isfinite(entry.time_s) || !named) {
    throw Error(fmt::format("{}:{}: expected \"timestamp file\"", name, number));
  }
  return entry;
}

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
  const Image<std::uint16_t> first = read_png16(list_.frames.front().depth);
  CameraFacts& facts = list_.facts;
  const CameraFacts& fallback = list_.fallback;
  if (!facts.fx && facts.sensor.empty() && fallback.fx && fallback.width == first.width() &&
      fallback.height == first.height()) {
    facts.fill_from(fallback);
    list_.notes.push_back(fmt::format("{}: no intrinsics given; those of {} assumed", list_.place, fallback.origin));
  }
  const bool registered = std::any_of(list_.frames.begin(), list_.frames.end(),
                                      [](const FrameFiles& files) { return !files.colour.empty(); });
  camera_ = resolve_camera(facts, first.width(), first.height(), registered, list_.place, list_.notes);
  rectification_ = make_rectification(facts.distorted, camera_);
  units_per_m_ = facts.depth_scale.value_or(list_.default_scale);
}

Frame FrameListReader::read(std::size_t index, bool with_colour) const {
  const FrameFiles& files = list_.frames[index];
  Image<std::uint16_t> stored = read_png16(files.depth);
  restore(stored, list_.facts.depth_bits);
  expect_size_of(stored, camera_, files.depth, "the size of the first");
  Frame frame{files.name, files.time_s, camera_, to_millimetres(stored, units_per_m_), {}};
  if (with_colour && !files.colour.empty()) {
    frame.colour = read_colour(files.colour);
    expect_size_of(frame.colour, camera_, files.colour, "the size of the depth");
    if (rectification_) frame.colour = rectification_->colour(frame.colour);
  }
  if (rectification_) frame.depth = rectification_->depth(frame.depth);
  return frame;
}

std::unique_ptr<FrameSource> open_list(FrameList list) { return std::make_unique<ListSource>(std::move(list)); }

DepthImage to_millimetres(const Image<std::uint16_t>& stored, float units_per_m) {
  if (units_per_m == 1000.F) return stored;
  const double mm_per_unit = 1000.0 / units_per_m;
  DepthImage depth(stored.width(), stored.height());
  std::transform(stored.begin(), stored.end(), depth.begin(), [mm_per_unit](std::uint16_t units) {
    const double mm = std::round(units * mm_per_unit);
    return mm > std::numeric_limits<std::uint16_t>::max() ? std::uint16_t{0} : static_cast<std::uint16_t>(mm);
  });
  return depth;
}

std::vector<TumEntry> parse_tum_list(std::string_view text, const std::string& name) {
  std::vector<TumEntry> entries;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.front() != '#') entries.push_back(parse_line(line, name, number));
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const TumEntry& a, const TumEntry& b) { return a.time_s < b.time_s; });
  const auto twin = std::adjacent_find(entries.begin(), entries.end(),
                                       [](const TumEntry& a, const TumEntry& b) { return a.time_s == b.time_s; });
  if (twin != entries.end()) throw Error(fmt::format("{}: time {} occurs twice, expected once", name, twin->stamp));
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

  const std::string depth_list = (root / "depth.txt").string();
  const std::vector<TumEntry> depth = parse_tum_list(read_file(depth_list, kMaxListBytes), depth_list);
  if (depth.empty()) throw Error(depth_list + ": no frames, expected lines \"timestamp file\"");
  std::vector<TumEntry> colour;
  std::error_code ignored;
  if (const fs::path colour_list = root / "rgb.txt"; fs::exists(colour_list, ignored)) {
    colour = parse_tum_list(read_file(colour_list.string(), kMaxListBytes), colour_list.string());
  }
  const std::vector<int> partner = associate(depth, colour, kMaxTimeDifferenceS);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::string colour_file = partner[i] < 0 ? "" : (root / colour[partner[i]].file).string();
    list.frames.push_back({depth[i].stamp, depth[i].time_s, (root / depth[i].file).string(), colour_file});
  }
  const auto lonely = std::count(partner.begin(), partner.end(), -1);
  if (lonely != 0 && !colour.empty()) {
    list.notes.push_back(fmt::format("{}: {} of {} depth pictures have no colour within {} s", folder, lonely,
                                     depth.size(), kMaxTimeDifferenceS));
  }
  list.facts = find_camera_facts(options, {folder});
  return list;
}

}  // namespace vesalius
