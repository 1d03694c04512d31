#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "synth/mesh/scene_mesh.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// How often people wear and carry things. Probabilities are 0-1.
struct OutfitOptions {
  float bald = 0.08F;
  float long_hair = 0.4F;  ///< among those who are not bald
  float short_sleeves = 0.35F;
  float shorts = 0.15F;
  float barefoot = 0.1F;
  float skirt = 0.15F;
  float coat = 0.15F;
  float hat = 0.15F;
  float backpack = 0.08F;
  float bag = 0.1F;             ///< a bag at the hip or in a hand
  float held = 0.15F;           ///< a cup, phone, stick or box in a hand
  float carried = 0.F;          ///< a bag on a strap, or an umbrella, a broom or a cane that hangs from a hand, instead
  float max_cloth_m = 0.02F;    ///< largest thickness of cloth over the skin
  float max_hair_m = 0.05F;     ///< largest thickness of hair over the skull
  float dark_cloth = 0.2F;      ///< cloth that reflects almost no infrared light: leather, many blacks
  float dark_to_the_eye = 0.F;  ///< share of that cloth that has a dark colour too
  float dark_hair = 0.3F;       ///< hair that reflects almost no infrared light
};
void visit_options(const std::string& prefix, OutfitOptions& options, OptionVisitor& visitor);

enum class Hair : std::uint8_t { bald, shorn, long_hair };
enum class Hat : std::uint8_t { none, beanie, cap, brimmed };
enum class Bag : std::uint8_t { none, at_hip, in_hand, on_strap };
enum class Held : std::uint8_t { none, cup, phone, stick, box, umbrella, broom, cane };

/// The clothes and carried things of one person. Lengths are in metres.
struct Outfit {
  Hair hair = Hair::shorn;
  float hair_m = 0.01F;     ///< thickness of hair over the skull
  float top_m = 0.005F;     ///< thickness of cloth over trunk and arms
  float bottom_m = 0.005F;  ///< thickness of cloth over hips and legs
  float folds = 0.3F;       ///< 0-1; how much the thickness of cloth varies
  float sleeves = 1.F;      ///< covered share of the arms, shoulder to wrist
  float legs = 1.F;         ///< covered share of the legs, hip to ankle; 0 below a skirt
  bool shoes = true;
  float skirt = 0.F;  ///< share of the legs that a skirt covers; 0 means no skirt
  float coat = 0.F;   ///< share of the legs that a coat covers; 0 means no coat
  Hat hat = Hat::none;
  bool backpack = false;
  Bag bag = Bag::none;
  Held held = Held::none;
  bool left_hand = true;  ///< whether the bag is at the left hand or hip; a held thing is at the other side
};

/// Draws an outfit. Throws UsageError for options out of range.
Outfit sample_outfit(const OutfitOptions& options, Random& random);

/// Draws colours, patterns and infrared reflectance of a person's fabrics, indexed by Fabric. Dark hair and dark cloth
/// reflect as little as 0.01 of a depth sensor's light; other cloth reflects more than a third whatever its colour.
std::array<Material, kFabricCount> sample_look(const OutfitOptions& options, Random& random);

}  // namespace vesalius::synth
