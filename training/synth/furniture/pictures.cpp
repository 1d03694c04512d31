#include "synth/furniture/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kCell_m = 0.012F;

/// A picture on a board, painted cell by cell with the board's materials. Places are in metres from the middle of its
/// lower edge, x to the right as seen from in front.
class Canvas {
 public:
  Canvas(FurnitureBuilder& board, const Vector2f& size, float infrared, float glow)
      : board_(board),
        size_(size),
        infrared_(infrared),
        glow_(glow),
        cells_(std::max(1, int(size.x() / kCell_m)), std::max(1, int(size.y() / kCell_m))) {}

  const Vector2f& size() const { return size_; }

  std::uint8_t colour(const Rgb& rgb) {
    Material material;
    material.colour = material.second = scaled(rgb, glow_);
    material.infrared = infrared_;
    return add_material(board_.piece.mesh, material);
  }
  std::uint8_t colour(Stuff stuff, Random& random) { return colour(sample_material(stuff, random).colour); }

  void fill(std::uint8_t ink) { cells_.fill(ink); }
  void ellipse(const Vector2f& centre, const Vector2f& half, std::uint8_t ink) {
    paint(ink, [&](const Vector2f& p) { return (p - centre).cwiseQuotient(half).squaredNorm() < 1.F; });
  }
  void box(const Vector2f& centre, const Vector2f& half, std::uint8_t ink) {
    paint(ink, [&](const Vector2f& p) { return ((p - centre).cwiseAbs() - half).maxCoeff() < 0.F; });
  }
  void stroke(const Vector2f& from, const Vector2f& to, float radius, std::uint8_t ink) {
    const Vector2f way = to - from;
    paint(ink, [&](const Vector2f& p) {
      const float along = std::clamp((p - from).dot(way) / std::max(way.squaredNorm(), 1e-9F), 0.F, 1.F);
      return (p - from - along * way).norm() < radius;
    });
  }

  /// Adds the picture to the board as one face for each run of cells of one colour. `pose` places the middle of the
  /// lower edge, with the picture's front to +z.
  void hang(const Isometry3f& pose) {
    const Vector2f cell = size_.cwiseQuotient(Vector2f(float(cells_.width()), float(cells_.height())));
    for (int row = 0; row < cells_.height(); ++row) {
      for (int begin = 0, end = 0; begin < cells_.width(); begin = end) {
        while (end < cells_.width() && cells_(end, row) == cells_(begin, row)) ++end;
        const auto corner = [&](int u, int v) -> Vector3f {
          return pose * Vector3f(float(u) * cell.x() - 0.5F * size_.x(), size_.y() - float(v) * cell.y(), 0.F);
        };
        add_quad(board_.piece.mesh, corner(begin, row + 1), corner(end, row + 1), corner(end, row), corner(begin, row),
                 cells_(begin, row));
      }
    }
  }

 private:
  template <typename Inside>
  void paint(std::uint8_t ink, const Inside& inside) {
    for (int v = 0; v < cells_.height(); ++v) {
      for (int u = 0; u < cells_.width(); ++u) {
        const Vector2f share((float(u) + 0.5F) / float(cells_.width()), (float(v) + 0.5F) / float(cells_.height()));
        if (inside({(share.x() - 0.5F) * size_.x(), (1.F - share.y()) * size_.y()})) cells_(u, v) = ink;
      }
    }
  }

  FurnitureBuilder& board_;
  Vector2f size_;
  float infrared_, glow_;
  Image<std::uint8_t> cells_;
};

/// Paints somebody of a height, standing at a place, with arms anywhere.
void paint_person(Canvas& canvas, const Vector2f& feet, float tall, Random& random) {
  const std::uint8_t skin = canvas.colour(skin_colour(random));
  const std::uint8_t top = canvas.colour(Stuff::cloth, random), legs = canvas.colour(Stuff::cloth, random);
  const std::uint8_t hair = canvas.colour(Stuff::wood, random);
  const auto at = [&](float x, float y) -> Vector2f { return feet + tall * Vector2f(x, y); };
  for (const float side : {-1.F, 1.F}) {
    canvas.stroke(at(0.05F * side, 0.5F), at(side * between(0.04, 0.12, random), 0.04F), 0.042F * tall, legs);
  }
  canvas.stroke(at(0.F, 0.54F), at(0.F, 0.74F), 0.1F * tall, top);
  for (const float side : {-1.F, 1.F}) {
    const float turn = between(-1.4, 1.8, random), bend = turn + between(0.0, 1.6, random);
    const Vector2f shoulder = at(0.1F * side, 0.8F);
    const Vector2f elbow = shoulder + 0.17F * tall * Vector2f(side * std::cos(turn), std::sin(turn));
    const Vector2f hand = elbow + 0.15F * tall * Vector2f(side * std::cos(bend), std::sin(bend));
    canvas.stroke(shoulder, elbow, 0.032F * tall, top);
    canvas.stroke(elbow, hand, 0.026F * tall, chance(0.5, random) ? top : skin);
    canvas.stroke(hand, hand, 0.032F * tall, skin);
  }
  canvas.stroke(at(0.F, 0.82F), at(0.F, 0.86F), 0.03F * tall, skin);
  canvas.ellipse(at(0.F, 0.95F), tall * Vector2f(0.053F, 0.07F), hair);
  canvas.ellipse(at(0.F, 0.925F), tall * Vector2f(0.045F, 0.06F), skin);
}

void paint_people(Canvas& canvas, Random& random) {
  const Vector2f& size = canvas.size();
  canvas.fill(canvas.colour(Stuff::wall, random));
  const bool whole = chance(0.5, random);  // or head and shoulders
  const int count = whole ? 1 + int(random.below(3)) : 1;
  for (int i = 0; i < count; ++i) {
    const float tall = size.y() * (whole ? between(0.7, 0.97, random) : between(1.6, 3.5, random));
    const float x = size.x() * ((float(i) + between(0.3, 0.7, random)) / float(count) - 0.5F);
    paint_person(canvas, {x, whole ? between(0.0, 0.05, random) : 0.95F * size.y() - tall}, tall, random);
  }
}

void paint_landscape(Canvas& canvas, Random& random) {
  const Vector2f& size = canvas.size();
  canvas.fill(canvas.colour(Stuff::paint, random));
  const int hills = 2 + int(random.below(5));
  for (int i = 0; i < hills; ++i) {
    const Vector2f centre{between(-0.5, 0.5, random) * size.x(), between(-0.4, 0.1, random) * size.y()};
    const Vector2f half{between(0.3, 0.9, random) * size.x(), between(0.3, 0.7, random) * size.y()};
    canvas.ellipse(centre, half, canvas.colour(chance(0.6, random) ? Stuff::leaf : Stuff::floor, random));
  }
}

void paint_page(Canvas& canvas, Random& random) {
  const Vector2f& size = canvas.size();
  canvas.fill(canvas.colour(Stuff::wall, random));
  const std::uint8_t ink = canvas.colour(Stuff::glass, random);
  canvas.box({0.F, between(0.7, 0.85, random) * size.y()}, {0.4F * size.x(), between(0.03, 0.1, random) * size.y()},
             canvas.colour(Stuff::paint, random));
  for (float y = 0.6F * size.y(); y > 0.08F * size.y(); y -= 3.F * kCell_m) {
    const float end = between(-0.1, 0.42, random) * size.x();
    canvas.stroke({-0.42F * size.x(), y}, {end, y}, 0.7F * kCell_m, ink);
  }
}

void paint_shapes(Canvas& canvas, Random& random) {
  const Vector2f& size = canvas.size();
  canvas.fill(canvas.colour(Stuff::paint, random));
  const int shapes = 3 + int(random.below(10));
  for (int i = 0; i < shapes; ++i) {
    const std::uint8_t ink = canvas.colour(Stuff::cloth, random);
    const Vector2f centre{between(-0.5, 0.5, random) * size.x(), between(0.0, 1.0, random) * size.y()};
    const Vector2f half{between(0.05, 0.35, random) * size.x(), between(0.05, 0.35, random) * size.y()};
    if (chance(0.5, random)) {
      canvas.ellipse(centre, half, ink);
    } else {
      canvas.box(centre, half, ink);
    }
  }
}

enum class Carrier : std::uint8_t { poster, painting, screen, banner };

/// Returns width and height of the picture, metres.
Vector2f draw_size(Carrier carrier, Random& random) {
  switch (carrier) {
    case Carrier::poster:
    case Carrier::painting: {
      const float longer = between(0.4, 1.2, random), shorter = longer * between(0.6, 0.85, random);
      return chance(0.6, random) ? Vector2f(shorter, longer) : Vector2f(longer, shorter);
    }
    case Carrier::screen: {
      const float wide = between(0.6, 1.5, random);
      return {wide, 0.5625F * wide};
    }
    case Carrier::banner: {
      const float wide = between(0.7, 1.0, random);
      return {wide, between(1.7, 2.1, random)};
    }
  }
  return {};
}

}  // namespace

Furniture make_picture(Random& random) {
  constexpr float kBeforeBoard_m = 0.002F;
  const auto carrier = static_cast<Carrier>(random.below(4));
  const Vector2f size = draw_size(carrier, random);
  FurnitureBuilder board(random);
  const bool screen = carrier == Carrier::screen, stands = carrier == Carrier::banner;
  const std::uint8_t edge = board.stuff(screen                         ? Stuff::plastic
                                        : carrier == Carrier::painting ? Stuff::wood
                                                                       : Stuff::metal);
  const float frame = carrier == Carrier::poster ? 0.F : between(0.01, 0.05, random);
  const float thick = carrier == Carrier::poster ? 0.004F : between(0.02, 0.05, random);
  const float low = stands ? 0.06F : std::max(0.4F, between(1.3, 1.7, random) - 0.5F * size.y());
  const Vector2f half = 0.5F * size + Vector2f::Constant(frame);
  board.box({-half.x(), low - (stands ? 0.06F : frame), 0.F}, {half.x(), low + size.y() + frame, thick}, edge);
  const float infrared = screen ? between(0.02, 0.12, random) : between(0.5, 0.85, random);
  Canvas canvas(board, size, infrared, screen ? 1.6F : 1.F);
  switch (random.below(5)) {
    case 0:
      paint_landscape(canvas, random);
      break;
    case 1:
      paint_page(canvas, random);
      break;
    case 2:
      paint_shapes(canvas, random);
      break;
    default:
      paint_people(canvas, random);
  }
  canvas.hang(placed_at({0.F, low, thick + kBeforeBoard_m}));
  return std::move(board.piece);
}

}  // namespace vesalius::synth
