#include "io/sources/depth_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <exception>
#include <limits>
#include <utility>
#include <variant>

#include "io/sources/source_around.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kLeastRead = 500;  // pixels of those that are looked at
/// Kinect v1 as it is stored by some: 11 bits of disparity, of which the largest is no reading.
constexpr std::uint16_t kNoDisparity = 2047, kMostDisparity = 1100;

/// What a picture of depth tells at a glance.
struct DepthLook {
  std::size_t pixels = 0, readings = 0;
  std::array<int, 3> mm{};  ///< distances that 5, 50 and 95 % of the readings do not exceed
  /// How much neighbours differ against how much all readings do. Where bytes are swapped it is some ten times as much.
  double roughness = 1.0;
  bool in_fives = false, in_tens = false;  ///< whether all readings are multiples of 5, or of 10
  /// Steps between values that occur, over those of the coarsest camera, a Kinect v1, at such a distance. Where it is
  /// above 1, the distance is a larger one.
  double coarseness = 1.0;
  bool disparity = false;
};

/// Returns the median over readings, which are sorted, of the step to the next value, over that of a Kinect v1.
double coarseness_of(const std::vector<std::uint16_t>& read) {
  constexpr double kSteps_mm = 348000.0;  // an eighth of a pixel of disparity, with 580 pixels and 75 mm
  std::vector<double> all;
  for (auto here = read.begin(); here != read.end();) {
    const auto next = std::upper_bound(here, read.end(), *here);
    const double step = next == read.end() ? 0.0 : double(*next - *here);
    all.insert(all.end(), std::size_t(next - here), step / std::max(1.0, double(*here) * *here / kSteps_mm));
    here = next;
  }
  const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

DepthLook look_at(const DepthImage& depth) {
  constexpr double kEnough = 3e4;  // pixels
  const int stride = std::max(1, int(std::sqrt(double(depth.size()) / kEnough)));
  DepthLook look;
  std::vector<std::uint16_t> read, steps;
  for (int v = 0; v < depth.height(); v += stride) {
    for (int u = 0; u < depth.width(); u += stride) {
      const std::uint16_t here = depth(u, v), beside = u > 0 ? depth(u - 1, v) : std::uint16_t{0};
      ++look.pixels;
      if (here != 0) read.push_back(here);
      if (here != 0 && beside != 0) steps.push_back(static_cast<std::uint16_t>(std::abs(here - beside)));
    }
  }
  look.readings = read.size();
  if (read.size() < kLeastRead) return look;
  std::ranges::sort(read);
  const auto at = [&](std::size_t percent) { return int(read[(read.size() - 1) * percent / 100]); };
  look.mm = {at(5), at(50), at(95)};
  double sum = 0.0;
  for (const std::uint16_t step : steps) sum += step;
  if (!steps.empty()) look.roughness = sum / double(steps.size()) / std::max(1.0, double(look.mm[2] - look.mm[0]));
  look.in_fives = std::ranges::all_of(read, [](std::uint16_t value) { return value % 5 == 0; });
  look.in_tens = std::ranges::all_of(read, [](std::uint16_t value) { return value % 10 == 0; });
  look.coarseness = coarseness_of(read);
  const auto none = std::ranges::lower_bound(read, kNoDisparity);
  look.disparity = none != read.begin() && read.back() == kNoDisparity && *(none - 1) <= kMostDisparity &&
                   std::size_t(read.end() - none) > read.size() / 200;
  return look;
}

/// Returns whether rooms look so to cameras that see people.
bool is_room(const DepthLook& look) {
  constexpr std::array kLeast_mm = {300, 500, 1000}, kMost_mm = {4000, 7000, 15000};
  for (std::size_t i = 0; i < look.mm.size(); ++i) {
    if (look.mm[i] < kLeast_mm[i] || look.mm[i] > kMost_mm[i]) return false;
  }
  return true;
}

/// What depth is if it is none of a room.
enum class Oddity { none, missing, too_near, near, far };

Oddity oddity_of(const DepthLook& look) {
  constexpr int kTooNear_mm = 300, kNear_mm = 2000, kFar_mm = 8000;
  if (20 * look.readings < look.pixels) return Oddity::missing;
  if (look.mm[1] < kTooNear_mm) return Oddity::too_near;
  if (look.mm[2] < kNear_mm) return Oddity::near;
  return look.mm[1] > kFar_mm ? Oddity::far : Oddity::none;
}

std::string metres(const DepthLook& look) {
  return fmt::format("{:.2f} to {:.2f} m", 1e-3 * look.mm[0], 1e-3 * look.mm[2]);
}

std::string words(Oddity oddity, const DepthLook& look) {
  if (oddity == Oddity::missing) return "there is hardly any depth in the first frames";
  return fmt::format("depth is {} than in rooms, {}", oddity == Oddity::far ? "farther" : "nearer", metres(look));
}

/// Options that may be the right ones, and the flag that gives them.
struct Remedy {
  SourceOptions options;
  std::string flag, value;
  DepthLook look = {};
  bool is_of_bits() const { return flag == "--depth-bits"; }
};

/// A unit that programs store, those that most do in front.
struct Unit {
  float per_m;
  const char* of;
};
constexpr std::array<Unit, 8> kUnits{{{1000.F, ""},
                                      {5000.F, " (TUM)"},
                                      {10000.F, ""},
                                      {4000.F, " (Matterport)"},
                                      {6553.5F, " (Replica)"},
                                      {100.F, " (centimetres)"},
                                      {256.F, " (KITTI)"},
                                      {1.F, " (metres)"}}};

/// Returns whether a unit comes into question. Whole millimetres that were multiplied tell by what.
bool may_be(const Unit& unit, Oddity oddity, const DepthLook& odd, bool is_tum) {
  constexpr double kCoarse = 2.5;
  if (oddity == Oddity::near && is_tum) return unit.per_m == 1000.F;
  if (oddity == Oddity::near) return odd.coarseness > kCoarse && (unit.per_m == 100.F || unit.per_m == 256.F);
  if (oddity == Oddity::missing) return unit.per_m == 1000.F || unit.per_m == 100.F || unit.per_m == 1.F;  // floats
  if (oddity != Oddity::far || !odd.in_fives) return true;
  return unit.per_m == (odd.in_tens ? 10000.F : 5000.F);
}

std::vector<Remedy> remedies(const SourceOptions& given, Oddity oddity, const DepthLook& odd, bool is_tum) {
  std::vector<Remedy> all;
  const auto add_bits = [&](DepthBits bits, const char* name) {
    if (given.depth_bits == bits) return;
    all.push_back({given, "--depth-bits", name});
    all.back().options.depth_bits = bits;
  };
  if (oddity != Oddity::near) {
    add_bits(DepthBits::swapped, "swapped");
    add_bits(DepthBits::rotated, "rotated");
  }
  for (const Unit& unit : kUnits) {
    if (given.depth_scale == unit.per_m || !may_be(unit, oddity, odd, is_tum)) continue;
    all.push_back({given, "--depth-scale", fmt::format("{}{}", unit.per_m, unit.of)});
    all.back().options.depth_scale = unit.per_m;
  }
  return all;
}

/// Returns whether depth is a room's with a remedy. `odd` is the depth without.
bool mends(const Remedy& remedy, Oddity oddity, const DepthLook& odd, bool is_tum) {
  constexpr double kSmoother = 0.5, kAsSmooth = 1.1;
  constexpr int kFar_mm = 6000, kVeryFar_mm = 15000;
  const DepthLook& now = remedy.look;
  if (!is_room(now) || now.readings < odd.readings / 2) return false;
  if (oddity == Oddity::missing) return now.readings > 3 * odd.readings;
  if (remedy.is_of_bits()) {
    const bool swapped = remedy.options.depth_bits == DepthBits::swapped;
    return now.roughness < (swapped ? kSmoother : kAsSmooth) * odd.roughness;
  }
  // Kinects give whole millimetres, of which five thousandths of a metre are multiples.
  if (oddity == Oddity::near) return now.mm[1] > odd.mm[1] && !(now.in_fives && is_tum);
  return oddity == Oddity::too_near || (odd.mm[0] > kFar_mm && odd.mm[1] > kVeryFar_mm);
}

using Opener = std::function<std::unique_ptr<FrameSource>(const SourceOptions&)>;
using Reread = std::function<DepthImage(const SourceOptions&)>;

/// Returns the depth of the first frame that has some, or of the last of those that are looked at.
DepthImage first_depth(FrameSource& source) {
  DepthImage depth;
  for (int i = 0; i < kFirstFrames && !has_depth(depth); ++i) {
    std::optional<Frame> frame = source.next();
    if (!frame) break;
    depth = std::move(frame->depth);
  }
  return depth;
}

/// Returns whether depth counts as fifths of a millimetre, as in the TUM benchmark: many bring such folders of
/// millimetres. Other sources that are near may look at a table.
bool is_of_tum(const DepthLook& look, SourceOptions options, const Reread& reread) {
  options.depth_scale = 5000.F;
  return look_at(reread(options)).mm == look.mm;
}

/// Returns the remedies that help. Bytes and bits that fit are no chance; of units several may.
std::vector<Remedy> remedies_of(Oddity oddity, const DepthLook& odd, const SourceOptions& given, const Reread& reread) {
  const bool is_tum = oddity == Oddity::near && is_of_tum(odd, given, reread);
  std::vector<Remedy> all;
  for (Remedy& remedy : remedies(given, oddity, odd, is_tum)) {
    try {
      remedy.look = look_at(reread(remedy.options));
    } catch (const Error&) {
      continue;
    }
    if (!mends(remedy, oddity, odd, is_tum)) continue;
    if (remedy.is_of_bits()) return {remedy};
    all.push_back(remedy);
  }
  return all;
}

/// Returns "--depth-scale 5000 (TUM), 10000 or 4000 (Matterport)".
std::string flag_of(const std::vector<Remedy>& remedies) {
  std::string text = remedies.front().flag + " " + remedies.front().value;
  for (std::size_t i = 1; i < remedies.size(); ++i) {
    text += (i + 1 == remedies.size() ? " or " : ", ") + remedies[i].value;
  }
  return text;
}

/// Returns whether depth is none that any camera gives, whatever it looks at.
bool cannot_be(const DepthLook& look) {
  constexpr int kNearest_mm = 300, kFarthest_mm = 20000;
  return look.readings < kLeastRead || look.mm[2] < kNearest_mm || look.mm[0] > kFarthest_mm;
}

}  // namespace

bool has_depth(const DepthImage& depth) { return look_at(depth).readings >= kLeastRead; }

std::string doubt_of_depth(const DepthImage& depth, const std::string& place, const SourceOptions& given,
                           const Reread& reread) {
  if (depth.size() < 4 * kLeastRead) return {};
  const DepthLook look = look_at(depth);
  if (look.disparity) {
    return place + ": depth looks like the raw disparity of a Kinect (2047 = none), expected distances";
  }
  const Oddity oddity = oddity_of(look);
  if (oddity == Oddity::none) return {};
  if (const auto remedies = remedies_of(oddity, look, given, reread); !remedies.empty()) {
    return fmt::format("{}: {}; with {} it is a room's{}", place, words(oddity, look), flag_of(remedies),
                       remedies.size() > 1 ? "" : ", " + metres(remedies.front().look));
  }
  if (!cannot_be(look)) return {};
  return fmt::format("{}: {}; expected millimetres, or the unit by --depth-scale", place, words(oddity, look));
}

namespace {

class DepthChecked final : public SourceAround {
 public:
  DepthChecked(std::unique_ptr<FrameSource> around, const std::string& place, const SourceOptions& options,
               const Opener& open)
      : SourceAround(std::move(around)) {
    bool is_found = false;
    while (first_.size() < kFirstFrames && !is_found) {
      try {
        std::optional<Frame> frame = source().next();
        if (!frame) break;
        is_found = has_depth(frame->depth);
        first_.emplace_back(std::move(*frame));
      } catch (const Error&) {
        first_.emplace_back(std::current_exception());
        return;
      }
    }
    if (first_.empty()) return;
    note_ = doubt_of_depth(std::get<Frame>(first_.back()).depth, place, options,
                           [&](const SourceOptions& other) { return first_depth(*open(other)); });
  }

  std::optional<Frame> next() override {
    if (first_.empty()) return source().next();
    std::variant<Frame, std::exception_ptr> one = std::move(first_.front());
    first_.pop_front();
    if (const auto* failed = std::get_if<std::exception_ptr>(&one)) std::rethrow_exception(*failed);
    return std::get<Frame>(std::move(one));
  }
  void seek(double time_s) override {
    first_.clear();
    source().seek(time_s);
  }
  std::vector<std::string> notes() const override {
    std::vector<std::string> all = source().notes();
    if (!note_.empty()) all.push_back(note_);
    return all;
  }

 private:
  std::deque<std::variant<Frame, std::exception_ptr>> first_;
  std::string note_;
};

}  // namespace

std::unique_ptr<FrameSource> with_depth_checked(std::unique_ptr<FrameSource> source, const std::string& place,
                                                const SourceOptions& options, const Opener& open) {
  return std::make_unique<DepthChecked>(std::move(source), place, options, open);
}

}  // namespace vesalius
