#include "commands/synth/imitate_sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "commands/synth/frame_maker.h"
#include "console/status_line.h"
#include "io/files/options_file.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace vesalius::cli {
namespace {

using synth::DepthFigures;
using synth::kDistances_m;
using synth::SensorOptions;

/// Presets that differ in what they measure; the others have the same noise.
constexpr std::array<const char*, 5> kPresets = {"kinect-v1", "kinect-v2", "azure-kinect", "d435", "d455"};

/// One figure by its name in tables.
struct Figure {
  std::string name;
  double DepthFigures::*single = nullptr;  ///< else an entry of one of those for four distances
  std::array<double, kDistances_m.size()> DepthFigures::*at = nullptr;
  std::size_t index = 0;
  double scale = 1.0;   ///< for the table
  double floor = 1e-3;  ///< smaller numbers count as this one
  bool compared = true;

  double of(const DepthFigures& figures) const { return single != nullptr ? figures.*single : (figures.*at)[index]; }
};

std::vector<Figure> all_figures() {
  std::vector<Figure> all = {
      {.name = "pixels without reading, %", .single = &DepthFigures::holes, .scale = 100, .compared = false},
      {.name = "edge pixels, % of readings", .single = &DepthFigures::edge_pixels, .scale = 100, .compared = false},
      {.name = "steps with a hole, %", .single = &DepthFigures::holes_at_steps, .scale = 100, .floor = 0.03},
      {.name = "median width of those, px", .single = &DepthFigures::hole_width_px, .floor = 1.0},
      {.name = "readings within steps, px", .single = &DepthFigures::ramp_px, .floor = 0.1},
      {.name = "rims of holes drawn in, %", .single = &DepthFigures::rims_drawn_in, .scale = 100, .floor = 0.01}};
  const auto add = [&](const char* name, const auto member, double scale, double floor) {
    for (std::size_t i = 0; i < kDistances_m.size(); ++i) {
      Figure figure{.name = fmt::format(fmt::runtime(name), kDistances_m[i]), .index = i};
      figure.at = member;
      figure.scale = scale;
      figure.floor = floor;
      all.push_back(figure);
    }
  };
  add("holes on surfaces at {} m, %", &DepthFigures::surface_holes, 100, 0.002);
  add("noise at {} m, mm", &DepthFigures::noise_mm, 1, 0.3);
  add("depth step at {} m, mm", &DepthFigures::step_mm, 1, 1.0);
  return all;
}

constexpr std::array<const char*, 4> kSides = {"left", "right", "top", "bottom"};

VisitAll options_of(synth::Recipe& recipe) {
  return [&recipe](OptionVisitor& visitor) { visit_options("", recipe, visitor); };
}

/// Returns the options of a recipe that differ from the default's.
std::vector<OptionText> changed_options(const SensorOptions& sensor) {
  synth::Recipe usual, changed;
  changed.sensor = sensor;
  const std::vector<OptionText> before = list_options(options_of(usual));
  std::vector<OptionText> after = list_options(options_of(changed));
  std::vector<OptionText> different;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after[i].value != before[i].value) different.push_back(std::move(after[i]));
  }
  return different;
}

/// What all trials have in common.
struct Rooms {
  const MeasuredCamera& real;
  synth::Recipe recipe;
  int frames;
  std::uint64_t seed;
  Progress& progress;

  /// Renders them with the options of a sensor and measures them.
  DepthFigures measure(const SensorOptions& sensor) {
    recipe.sensor = sensor;
    const FrameMaker maker = make_frame_maker(recipe, {}, paper_body(), seed, {});
    synth::DepthStatistics all;
    make_frames(
        maker, 0, frames, progress,
        [](std::uint64_t /*index*/, const LabelledFrame& frame) {
          synth::DepthStatistics one;
          one.add(frame.frame.depth);
          return one;
        },
        [&](std::uint64_t /*index*/, const synth::DepthStatistics& one) { all.add(one); });
    return all.figures();
  }
};

/// A sensor that gets more like the real one.
class Trials {
 public:
  Trials(Rooms& rooms, SensorOptions first) : rooms_(rooms), sensor_(std::move(first)) { remeasure(); }

  /// Sets an option to the value of those with which frames are least unlike the real ones. Fewer changes are better:
  /// another value must gain at least 0.01.
  template <class Set, class Values>
  void choose(const Set& set, const Values& values) {
    constexpr double kGain = 0.01;
    for (const auto& value : values) {
      SensorOptions other = sensor_;
      set(other, value);
      if (other == sensor_) continue;  // it is what it is measured with
      const DepthFigures figures = rooms_.measure(other);
      if (unlikeness(figures, rooms_.real.figures) >= unlike() - kGain) continue;
      figures_ = figures;
      sensor_ = other;
    }
  }

  void set_border(float share) {
    sensor_.variety.border_max = share;
    remeasure();
  }
  double unlike() const { return unlikeness(figures_, rooms_.real.figures); }
  const SensorOptions& sensor() const { return sensor_; }
  const DepthFigures& figures() const { return figures_; }

 private:
  void remeasure() { figures_ = rooms_.measure(sensor_); }

  Rooms& rooms_;
  SensorOptions sensor_;
  DepthFigures figures_;
};

/// Returns the share of the sides that the real borders are wider than the rendered ones, half as much again at most.
float border_share(const MeasuredCamera& real, const DepthFigures& rendered) {
  double widest = 0.0;
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const int side = i < 2 ? real.camera.width : real.camera.height;
    widest = std::max(widest, (real.figures.border_px[i] - rendered.border_px[i]) / side);
  }
  return widest < 0.005 ? 0.F : float(std::min(0.4, std::round(150.0 * widest) / 100.0));
}

SensorOptions seen_by(const Camera& camera) {
  SensorOptions sensor;
  sensor.width = camera.width;
  sensor.height = camera.height;
  sensor.fx = camera.fx;
  sensor.fy = camera.fy;
  sensor.cx = camera.cx;
  sensor.cy = camera.cy;
  sensor.colour = false;
  return sensor;
}

using Option = float& (*)(SensorOptions&);

void choose(Trials& trials, Option option, std::initializer_list<float> values) {
  trials.choose([&](SensorOptions& o, float value) { option(o) = value; }, values);
}

/// Chooses what the driver does to depth: nothing, filling or smoothing alone, or all of it. If the pictures had
/// another size once, each is tried with and without holes blended: one hides or undoes what the other does.
void choose_treatment(bool resampled, Trials& trials) {
  using Treatment = std::pair<synth::DepthFilterOptions, synth::ResamplingOptions>;
  std::array<synth::DepthFilterOptions, 5> filters;
  filters[1].share = filters[2].share = filters[4].share = 1.F;
  filters[3].share = 0.4F;
  filters[1].fill_share = 1.F;
  filters[1].smoothing = filters[1].blur_px = filters[1].far_blur_px = 0.F;
  filters[2].fill_share = filters[2].blur_px = filters[2].far_blur_px = 0.F;
  std::vector<synth::ResamplingOptions> sizes(resampled ? 2 : 1);
  for (std::size_t i = 0; resampled && i < sizes.size(); ++i) {
    sizes[i].share = 1.F;
    sizes[i].holes_blended = float(i);
  }
  std::vector<Treatment> treatments;
  for (const auto& filter : filters) {
    for (const auto& size : sizes) treatments.emplace_back(filter, size);
  }
  const auto set = [](SensorOptions& o, const Treatment& treatment) {
    o.filter = treatment.first;
    o.variety.resampled = treatment.second;
  };
  trials.choose(set, treatments);
}

/// Chooses how much of it.
void choose_amounts(Trials& trials) {
  if (trials.sensor().filter.share > 0.F) {
    choose(trials, [](SensorOptions& o) -> float& { return o.filter.smoothing; }, {0.F, 0.5F, 0.85F});
    choose(trials, [](SensorOptions& o) -> float& { return o.filter.blur_px; }, {0.F, 3.F, 8.F});
    choose(trials, [](SensorOptions& o) -> float& { return o.filter.far_blur_px; }, {0.F, 8.F, 20.F});
  }
  if (trials.sensor().variety.resampled.share > 0.F) {
    choose(trials, [](SensorOptions& o) -> float& { return o.variety.resampled.smallest; }, {0.3F, 0.5F, 0.75F});
    choose(trials, [](SensorOptions& o) -> float& { return o.variety.resampled.holes_blended; },
           {0.F, 0.3F, 0.6F, 1.F});
  }
}

/// Chooses errors that come of light.
void choose_light(Trials& trials) {
  const synth::SensorKind kind = synth::find_sensor(trials.sensor().preset).kind;
  if (kind == synth::SensorKind::stereo) {
    choose(trials, [](SensorOptions& o) -> float& { return o.variety.matching_max; }, {1.F, 2.F, 4.F, 8.F, 16.F});
  }
  if (kind == synth::SensorKind::time_of_flight) {
    choose(trials, [](SensorOptions& o) -> float& { return o.variety.flying_max; }, {1.F, 2.F, 4.F, 8.F});
  }
  choose(trials, [](SensorOptions& o) -> float& { return o.variety.dim_max; }, {1.F, 3.F, 10.F, 30.F});
}

constexpr int kPasses = 2;
/// The most trials of a preset: itself, with its border, in other light; then all that is chosen above, for pictures of
/// their own size and for others.
constexpr int kMostTrials = 2 + 9 + kPasses * (5 + 2 * 5) + 2 * (kPasses * 16 + (kPasses - 1) * 9);

/// Returns the best preset of each kind of sensor.
std::vector<SensorOptions> best_of_kinds(Rooms& rooms) {
  std::map<synth::SensorKind, std::pair<double, SensorOptions>> best;
  for (const char* preset : kPresets) {
    SensorOptions sensor = seen_by(rooms.real.camera);
    sensor.preset = preset;
    const double unlike = unlikeness(rooms.measure(sensor), rooms.real.figures);
    const auto [entry, is_new] = best.try_emplace(synth::find_sensor(preset).kind, unlike, sensor);
    if (!is_new && unlike < entry->second.first) entry->second = {unlike, sensor};
  }
  std::vector<SensorOptions> sensors;
  sensors.reserve(best.size());
  for (auto& [kind, found] : best) sensors.push_back(std::move(found.second));
  return sensors;
}

/// Begins with a preset and goes through the options twice, since what one explains another may explain better: once
/// for pictures of their own size, once for others.
Imitation imitate_with(const SensorOptions& preset, Rooms& rooms) {
  Trials first(rooms, preset);
  const DepthFigures alone = first.figures();
  first.set_border(border_share(rooms.real, alone));
  choose_light(first);
  std::optional<Trials> best;
  for (const bool resampled : {false, true}) {
    Trials trials = first;
    for (int pass = 0; pass < kPasses; ++pass) {
      if (pass > 0) choose_light(trials);
      choose_treatment(resampled, trials);
      choose_amounts(trials);
    }
    if (!best || trials.unlike() < best->unlike()) best.emplace(trials);
  }
  return {.sensor = best->sensor(), .preset = alone, .figures = best->figures()};
}

std::string row(const std::string& name, const std::array<double, 3>& values, double scale) {
  std::string text = fmt::format("# {:<30}", name);
  for (const double value : values) text += std::isnan(value) ? "          " : fmt::format(" {:9.2f}", scale * value);
  return text + "\n";
}

}  // namespace

MeasuredCamera measure_source(const std::string& uri, int most_frames) {
  const auto source = open_source(uri);
  const int stride = std::max(1, source->size() / most_frames);
  synth::DepthStatistics statistics;
  MeasuredCamera measured;
  for (int i = 0; measured.frames < most_frames; ++i) {
    const auto frame = source->next();
    if (!frame) break;
    if (i % stride != 0) continue;
    if (measured.frames == 0) measured.camera = frame->camera;
    if (frame->depth.width() != measured.camera.width || frame->depth.height() != measured.camera.height) {
      throw Error(fmt::format("{}: frame {} has another size than those before, expected one camera", uri, i));
    }
    statistics.add(frame->depth);
    ++measured.frames;
  }
  if (measured.frames == 0) throw Error(uri + ": no frames");
  measured.figures = statistics.figures();
  if (measured.figures.holes == 1.0) throw Error(uri + ": no pixel of any frame has a depth");
  measured.notes = source->notes();
  return measured;
}

double unlikeness(const DepthFigures& rendered, const DepthFigures& real) {
  constexpr double kMost = 1.5;  // one figure, perhaps of few steps, must not outweigh the others
  double sum = 0.0;
  int count = 0;
  for (const Figure& figure : all_figures()) {
    const double x = figure.of(rendered), y = figure.of(real);
    if (!figure.compared || std::isnan(x) || std::isnan(y)) continue;
    if (figure.at == &DepthFigures::step_mm && y <= 1.0) continue;
    const double ratio = std::max(x, figure.floor) / std::max(y, figure.floor);
    sum += std::min(kMost, std::abs(std::log(ratio)));
    ++count;
  }
  return count == 0 ? 0.0 : sum / count;
}

Imitation imitate(const MeasuredCamera& real, const std::string& preset, const synth::Recipe& recipe, int frames,
                  std::uint64_t seed, bool shown) {
  constexpr int kKinds = 3;
  const int trials = preset.empty() ? int(kPresets.size()) + kKinds * kMostTrials : kMostTrials;
  Progress progress(trials * frames, shown, "room", "rooms at most");
  Rooms rooms{.real = real, .recipe = recipe, .frames = frames, .seed = seed, .progress = progress};
  std::vector<SensorOptions> firsts;
  if (preset.empty()) {
    firsts = best_of_kinds(rooms);
  } else {
    firsts.push_back(seen_by(real.camera));
    firsts.back().preset = preset;
  }
  std::optional<Imitation> best;
  for (const SensorOptions& first : firsts) {
    Imitation found = imitate_with(first, rooms);
    if (!best || unlikeness(found.figures, real.figures) < unlikeness(best->figures, real.figures)) {
      best = std::move(found);
    }
  }
  progress.clear();
  return *best;
}

std::string imitation_toml(const std::string& uri, const MeasuredCamera& real, const Imitation& imitation) {
  std::string text = fmt::format("# A sensor like that of {} ({} frames).\n# {:<30} {:>9} {:>9} {:>9}\n", uri,
                                 real.frames, "figure", "real", "preset", "these");
  const std::array<const DepthFigures*, 3> columns = {&real.figures, &imitation.preset, &imitation.figures};
  for (const Figure& figure : all_figures()) {
    text += row(figure.name, {figure.of(*columns[0]), figure.of(*columns[1]), figure.of(*columns[2])}, figure.scale);
  }
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    text += row(fmt::format("empty border, {}, px", kSides[i]),
                {columns[0]->border_px[i], columns[1]->border_px[i], columns[2]->border_px[i]}, 1.0);
  }
  text += row("unlikeness (0: alike)",
              {0.0, unlikeness(imitation.preset, real.figures), unlikeness(imitation.figures, real.figures)}, 1.0);
  text.pop_back();
  for (const OptionText& option : changed_options(imitation.sensor)) {
    const char* quote = option.kind == OptionKind::word ? "\"" : "";
    text += fmt::format("\n{} = {}{}{}", option.name, quote, option.value, quote);
  }
  return text;
}

}  // namespace vesalius::cli
