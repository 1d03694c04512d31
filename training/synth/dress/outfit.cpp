#include "synth/dress/outfit.h"

#include <algorithm>
#include <cmath>

#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

float uniform(Random& random, float low, float high) { return low + (high - low) * float(random.uniform()); }

bool chance(Random& random, float probability) { return float(random.uniform()) < probability; }

/// Draws a colour of cloth: any hue, often muted.
Rgb cloth_colour(Random& random) {
  const float hue = uniform(random, 0.F, 6.F);
  const float saturation = std::pow(uniform(random, 0.F, 1.F), 1.5F) * 0.9F;
  const float value = uniform(random, 0.08F, 0.95F);
  const auto channel = [&](float centre) {
    const float away = std::abs(std::remainder(hue - centre, 6.F));
    const float pure = std::clamp(2.F - away, 0.F, 1.F);
    return static_cast<std::uint8_t>(std::lround(255.F * value * (1.F - saturation * (1.F - pure))));
  };
  return {channel(0.F), channel(2.F), channel(4.F)};
}

Material cloth(const OutfitOptions& options, Random& random) {
  Material m;
  m.colour = cloth_colour(random);
  m.second = chance(random, 0.5F) ? cloth_colour(random) : mix(m.colour, {255, 255, 255}, 0.25F);
  const float pattern = uniform(random, 0.F, 1.F);
  m.texture = pattern < 0.6F    ? Texture::plain
              : pattern < 0.75F ? Texture::stripes
              : pattern < 0.85F ? Texture::checks
                                : Texture::speckle;
  m.period_m = uniform(random, 0.015F, 0.12F);
  m.infrared = uniform(random, 0.35F, 0.9F);  // most dyes hardly absorb infrared light
  // Leather and many blacks absorb it: trousers without any depth are common in public frames.
  if (chance(random, options.dark_cloth)) {
    m.infrared = std::exp(uniform(random, std::log(0.01F), std::log(0.2F)));
    Random eye = random;  // all else stays the same with and without
    if (chance(eye, options.dark_to_the_eye)) {
      const float share = uniform(eye, 0.75F, 0.95F);
      for (Rgb* colour : {&m.colour, &m.second}) *colour = mix(*colour, {10, 10, 12}, share);
    }
  }
  return m;
}

Material plain(const Rgb& colour, float infrared) {
  Material m;
  m.colour = m.second = colour;
  m.infrared = infrared;
  return m;
}

Material hair(const OutfitOptions& options, Random& random) {
  if (chance(random, options.dark_hair)) {
    const float shade = uniform(random, 0.F, 1.F);
    return plain(mix({12, 10, 10}, {60, 40, 30}, shade), std::exp(uniform(random, std::log(0.01F), std::log(0.08F))));
  }
  const float kind = uniform(random, 0.F, 1.F);
  const float shade = uniform(random, 0.F, 1.F);
  if (kind < 0.6F) return plain(mix({20, 16, 14}, {70, 48, 34}, shade), uniform(random, 0.05F, 0.3F));
  if (kind < 0.8F) return plain(mix({110, 75, 45}, {205, 170, 110}, shade), uniform(random, 0.25F, 0.55F));
  return plain(mix({110, 110, 112}, {225, 224, 220}, shade), uniform(random, 0.3F, 0.65F));
}

/// Draws the thickness of cloth, which is most often thin.
float cloth_m(Random& random, float most) {
  const float u = uniform(random, 0.F, 1.F);
  return most * (0.1F + 0.9F * u * u);
}

}  // namespace

void visit_options(const std::string& prefix, OutfitOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "bald", o.bald, {"", 0, 1, "Share of people without hair."});
  visitor.option(prefix + "long-hair", o.long_hair, {"", 0, 1, "Share of long hair among people with hair."});
  visitor.option(prefix + "short-sleeves", o.short_sleeves, {"", 0, 1, "Share of people with bare forearms."});
  visitor.option(prefix + "shorts", o.shorts, {"", 0, 1, "Share of people in shorts."});
  visitor.option(prefix + "barefoot", o.barefoot, {"", 0, 1, "Share of people without shoes."});
  visitor.option(prefix + "skirt", o.skirt, {"", 0, 1, "Share of people in skirts."});
  visitor.option(prefix + "coat", o.coat, {"", 0, 1, "Share of people in coats."});
  visitor.option(prefix + "hat", o.hat, {"", 0, 1, "Share of people with a hat or cap."});
  visitor.option(prefix + "backpack", o.backpack, {"", 0, 1, "Share of people with a backpack."});
  visitor.option(prefix + "bag", o.bag, {"", 0, 1, "Share of people with a bag at the hip or in a hand."});
  visitor.option(prefix + "held", o.held, {"", 0, 1, "Share of people who hold a cup, phone, stick or box."});
  visitor.option(prefix + "carried", o.carried,
                 {"", 0, 1,
                  "Share of people with a bag on a strap over the other shoulder, or with an umbrella, broom or cane "
                  "upright in a hand, instead of those."});
  visitor.option(prefix + "max-cloth", o.max_cloth_m, {"m", 0, 0.05, "Thickest cloth over the skin."});
  visitor.option(prefix + "max-hair", o.max_hair_m, {"m", 0, 0.1, "Thickest hair over the skull."});
  visitor.option(prefix + "dark-cloth", o.dark_cloth,
                 {"", 0, 1, "Share of cloth that sends back next to no infrared light: leather, many blacks."});
  visitor.option(prefix + "dark-to-the-eye", o.dark_to_the_eye,
                 {"", 0, 1, "Share of such cloth that is dark in colour as well; the rest has any colour."});
  visitor.option(prefix + "dark-hair", o.dark_hair,
                 {"", 0, 1, "Share of hair that sends back next to no infrared light."});
}

Outfit sample_outfit(const OutfitOptions& options, Random& random) {
  OutfitOptions copy = options;
  RangeCheck ranges;
  visit_options("outfit.", copy, ranges);
  Outfit o;
  o.hair = chance(random, options.bald)        ? Hair::bald
           : chance(random, options.long_hair) ? Hair::long_hair
                                               : Hair::shorn;
  o.hair_m = o.hair == Hair::bald ? 0.F : options.max_hair_m * uniform(random, 0.1F, 1.F);
  if (o.hair == Hair::shorn) o.hair_m *= 0.6F;
  o.top_m = cloth_m(random, options.max_cloth_m);
  o.bottom_m = cloth_m(random, options.max_cloth_m);
  o.folds = uniform(random, 0.F, 1.F);
  o.sleeves = chance(random, options.short_sleeves) ? uniform(random, 0.15F, 0.6F) : 1.F;
  o.legs = chance(random, options.shorts) ? uniform(random, 0.25F, 0.6F) : 1.F;
  o.shoes = !chance(random, options.barefoot);
  if (chance(random, options.skirt)) {
    o.skirt = uniform(random, 0.3F, 0.95F);
    if (chance(random, 0.6F)) o.legs = 0.1F;
  }
  if (chance(random, options.coat)) {
    o.coat = uniform(random, 0.2F, 0.75F);
    o.top_m = std::max(o.top_m, 0.7F * options.max_cloth_m);
    o.sleeves = 1.F;
  }
  if (chance(random, options.hat)) o.hat = static_cast<Hat>(1 + random.below(3));
  o.backpack = chance(random, options.backpack);
  if (chance(random, options.bag)) o.bag = chance(random, 0.6F) ? Bag::at_hip : Bag::in_hand;
  if (chance(random, options.held)) o.held = static_cast<Held>(1 + random.below(4));
  o.left_hand = chance(random, 0.5F);
  if (options.carried > 0.F && chance(random, options.carried)) {  // off: draws no random numbers
    constexpr std::array<Held, 3> kUpright = {Held::umbrella, Held::broom, Held::cane};
    const bool strap = chance(random, 0.4F);
    o.bag = strap ? Bag::on_strap : o.bag;
    o.held = strap ? o.held : kUpright[random.below(kUpright.size())];
  }
  return o;
}

std::array<Material, kFabricCount> sample_look(const OutfitOptions& options, Random& random) {
  std::array<Material, kFabricCount> look;
  const auto of = [&](Fabric fabric) -> Material& { return look[static_cast<std::size_t>(fabric)]; };
  const float skin_infrared = uniform(random, 0.45F, 0.7F);
  of(Fabric::skin) = plain(skin_colour(random), skin_infrared);
  of(Fabric::hair) = hair(options, random);
  of(Fabric::top) = cloth(options, random);
  of(Fabric::bottom) = cloth(options, random);
  if (chance(random, 0.5F)) of(Fabric::bottom).texture = Texture::plain;
  of(Fabric::shoes) =
      plain(mix({15, 15, 18}, cloth_colour(random), uniform(random, 0.F, 0.6F)), uniform(random, 0.08F, 0.6F));
  of(Fabric::accessory) = cloth(options, random);
  return look;
}

}  // namespace vesalius::synth
