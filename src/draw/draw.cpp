#include "vesalius/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "draw/canvas.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

// Seven colours that people with colour-blindness can tell apart (Okabe and Ito, 2008).
constexpr std::array<Rgb, 7> kPersonColours{
    {{86, 180, 233}, {230, 159, 0}, {0, 158, 115}, {204, 121, 167}, {240, 228, 66}, {0, 114, 178}, {213, 94, 0}}};

struct DepthRange {
  int near_mm = 0;
  int far_mm = 0;

  /// Returns 0 at the near end of the range and 1 at the far end.
  float place(int depth_mm) const {
    if (far_mm == near_mm) return 0.F;
    const float t = float(depth_mm - near_mm) / float(far_mm - near_mm);
    return std::clamp(t, 0.F, 1.F);
  }
};

DepthRange depth_range(const DepthImage& depth) {
  std::vector<std::uint16_t> readings;
  readings.reserve(depth.size());
  std::copy_if(depth.begin(), depth.end(), std::back_inserter(readings), [](std::uint16_t d) { return d != 0; });
  if (readings.empty()) return {};
  const auto percentile = [&readings](std::size_t percent) {
    const auto at = readings.begin() + static_cast<std::ptrdiff_t>((readings.size() - 1) * percent / 100);
    std::nth_element(readings.begin(), at, readings.end());
    return int(*at);
  };
  return {percentile(1), percentile(99)};
}

// The colour map Turbo (Mikhailov 2019) at every 17th of its 256 steps; straight lines between these miss it by 7 of
// 255.
constexpr std::array<Rgb, 16> kTurbo{{{48, 18, 59},
                                      {65, 67, 167},
                                      {71, 113, 233},
                                      {62, 155, 254},
                                      {34, 197, 226},
                                      {26, 228, 182},
                                      {70, 248, 132},
                                      {136, 255, 78},
                                      {185, 246, 53},
                                      {225, 221, 55},
                                      {250, 186, 57},
                                      {253, 141, 39},
                                      {240, 91, 18},
                                      {214, 53, 6},
                                      {175, 24, 1},
                                      {122, 4, 3}}};

/// Returns Turbo's colour at 0 (blue) to 1 (red).
Rgb turbo(float at) {
  const float step = at * float(kTurbo.size() - 1);
  const auto below = std::min(std::size_t(step), kTurbo.size() - 2);
  return mix(kTurbo[below], kTurbo[below + 1], step - float(below));
}

/// Draws depth in grey from near (lighter) to far (darker), dark enough for part colours to stand out. Holes are black.
ColourImage dark_depth(const DepthImage& depth) {
  const DepthRange range = depth_range(depth);
  ColourImage picture(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const auto grey = static_cast<std::uint8_t>(std::lround(110.F - 80.F * range.place(depth[i])));
    picture[i] = {grey, grey, grey};
  }
  return picture;
}

/// Returns the picture with the parts' names beside it, in columns as tall as the picture.
ColourImage with_legend(const ColourImage& picture, const BodyModel& body) {
  constexpr int kSwatch = 12;
  constexpr int kMargin = 6;
  int name_width = 0;
  for (const BodyPart& part : body.parts) name_width = std::max(name_width, text_width(part.name));
  const int column_width = kSwatch + name_width + 3 * kMargin;
  const int rows = std::max(1, picture.height() / kTextRow);
  const int columns = (body.part_count() + rows - 1) / rows;
  ColourImage result(picture.width() + columns * column_width, std::max(picture.height(), kTextRow), {24, 24, 24});
  for (int v = 0; v < picture.height(); ++v) std::copy(picture.row(v), picture.row(v) + picture.width(), result.row(v));
  for (int i = 0; i < body.part_count(); ++i) {
    const BodyPart& part = body.parts[i];
    const int left = picture.width() + i / rows * column_width + kMargin;
    const int top = i % rows * kTextRow;
    fill_rectangle(result, {left, top + 2, kSwatch, kSwatch}, part.colour);
    draw_text(result, part.name, left + kSwatch + kMargin, top + kSwatch, {255, 255, 255});
  }
  return result;
}

/// Tints the pixels of the mask and draws its outline on pixels of the mask.
void draw_mask(ColourImage& picture, const Mask& mask, Rgb colour) {
  const auto inside = [&mask](int u, int v) { return mask.contains(u, v) && mask(u, v) != 0; };
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (mask(u, v) == 0) continue;
      const bool edge = !inside(u - 1, v) || !inside(u + 1, v) || !inside(u, v - 1) || !inside(u, v + 1);
      picture(u, v) = edge ? colour : mix(picture(u, v), colour, 0.35F);
    }
  }
}

/// Returns the position of a part's centre on the canvas in pixels, or nothing if it cannot be drawn.
std::optional<Eigen::Vector2f> place_on_canvas(const SkeletonPart& part, const Camera& camera, int scale) {
  if (part.state == State::none || !part.centre.allFinite() || part.centre.z() <= 0.F) return std::nullopt;
  const Eigen::Vector2f pixel = camera.pixel(part.centre);
  // Farther outside than the picture's size, no disc or plausible link would show, and integers would overflow.
  const auto near = [](float at, int size) { return at > -float(size) && at < 2.F * float(size); };
  if (!near(pixel.x(), camera.width) || !near(pixel.y(), camera.height)) return std::nullopt;
  const Eigen::Vector2f middle(0.5F, 0.5F);  // pixel centres are at integers
  return (pixel + middle) * float(scale) - middle;
}

struct Strokes {
  float thin, thick, radius;

  explicit Strokes(int canvas_width)
      : thin(std::max(1.5F, float(canvas_width) / 450.F)),
        thick(std::max(3.F, float(canvas_width) / 210.F)),
        radius(std::max(3.F, float(canvas_width) / 110.F)) {}
};

void draw_skeleton(ColourImage& picture, const Skeleton& skeleton, const Camera& camera, const BodyModel& body,
                   int scale) {
  const Strokes strokes(picture.width());
  std::vector<std::optional<Eigen::Vector2f>> at;
  for (const SkeletonPart& part : skeleton.parts) at.push_back(place_on_canvas(part, camera, scale));
  const auto seen = [&skeleton](int part) { return skeleton.parts[part].state == State::observed; };
  for (const BodyLink& link : body.links) {
    const auto& from = at[link.parent];
    const auto& to = at[link.child];
    if (!from || !to) continue;
    const float width = seen(link.parent) && seen(link.child) ? strokes.thick : strokes.thin;
    draw_line(picture, *from, *to, width, {255, 255, 255});
  }
  for (int i = 0; i < body.part_count(); ++i) {
    const auto& centre = at[i];
    if (!centre) continue;
    const Rgb colour = body.parts[i].colour;
    if (seen(i)) {
      draw_disc(picture, *centre, strokes.radius, colour);
      draw_ring(picture, *centre, strokes.radius, 1.F, {0, 0, 0});
    } else {
      draw_ring(picture, *centre, strokes.radius, strokes.thin, colour);
    }
  }
}

void draw_score(ColourImage& picture, const Person& person, int number, Rgb colour, int scale) {
  std::array<char, 48> text;
  std::snprintf(text.data(), text.size(), "%d: %.2f", number, double(person.score));
  draw_tag(picture, text.data(), person.box.u * scale, person.box.v * scale - 2, colour);
}

void check_fits(const Frame& frame, const Person& person, std::size_t index, const BodyModel& body) {
  const std::string who = "draw_people: person " + std::to_string(index);
  if (!person.mask.same_size(frame.depth))
    throw Error(who + " has a mask of " + std::to_string(person.mask.width()) + "x" +
                std::to_string(person.mask.height()) + " pixels, expected the frame's size");
  if (person.skeleton.parts.size() != body.parts.size())
    throw Error(who + " has " + std::to_string(person.skeleton.parts.size()) + " parts, expected the body's " +
                std::to_string(body.parts.size()));
}

}  // namespace

ColourImage draw_depth(const DepthImage& depth) {
  const DepthRange range = depth_range(depth);
  ColourImage picture(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    // The two ends of Turbo are nearly black; the middle nine tenths are not.
    picture[i] = turbo(0.95F - 0.9F * range.place(depth[i]));
  }
  return picture;
}

ColourImage draw_labels(const LabelImage& labels, const DepthImage& depth, const BodyModel& body, bool legend) {
  if (!labels.same_size(depth)) throw Error("draw_labels: labels and depth differ in size");
  ColourImage picture = dark_depth(depth);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == kBackground) continue;
    if (labels[i] >= body.parts.size())
      throw Error("draw_labels: label " + std::to_string(labels[i]) + ", expected less than the body's " +
                  std::to_string(body.parts.size()) + " parts");
    picture[i] = body.parts[labels[i]].colour;
  }
  picture = enlarge(picture, legible_scale(picture.width()));
  return legend ? with_legend(picture, body) : picture;
}

ColourImage draw_people(const Frame& frame, const std::vector<Person>& people, const BodyModel& body,
                        const std::vector<int>& numbers) {
  check(frame);
  if (!numbers.empty() && numbers.size() != people.size()) {
    throw Error("draw_people: " + std::to_string(numbers.size()) + " numbers for " + std::to_string(people.size()) +
                " people");
  }
  const auto number_of = [&](std::size_t i) { return numbers.empty() ? int(i) : numbers[i]; };
  const int scale = legible_scale(frame.depth.width());
  ColourImage picture = enlarge(frame.colour.empty() ? draw_depth(frame.depth) : frame.colour, scale);
  const auto colour_of = [&](std::size_t i) {
    return kPersonColours[std::size_t(number_of(i)) % kPersonColours.size()];
  };
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (people[i].mask.empty()) continue;
    check_fits(frame, people[i], i, body);
    draw_mask(picture, enlarge(people[i].mask, scale), colour_of(i));
  }
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (people[i].mask.empty()) continue;
    draw_skeleton(picture, people[i].skeleton, frame.camera, body, scale);
    draw_score(picture, people[i], number_of(i), colour_of(i), scale);
  }
  return picture;
}

}  // namespace vesalius
