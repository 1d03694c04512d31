#pragma once

#include <cstdint>
#include <optional>

#include "synth/scene/group.h"
#include "synth/scene/person_plan.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// How two people touch each other.
enum class Contact : std::uint8_t {
  embrace,     ///< face to face, arms around each other's back
  handing,     ///< face to face, a hand of each at one place: hands shaken, something handed over
  arm_around,  ///< side by side, an arm around the other's back, which also supports who walks badly
  hand_in_hand,
  helping_up  ///< one stands before one who sits or kneels low, and holds both hands
};

/// Returns two people who touch, with their legs and trunks as planned and arms that reach each other. The first
/// stands; so does the second, except who is helped up. `number` and `other_number` are those of the plans. Returns
/// nothing if they cannot: bent too far, too different in size, or in each other's way by more than flesh gives.
std::optional<PeopleGroup> touching_pair(Contact contact, const PersonPlan& one, int number, const PersonPlan& other,
                                         int other_number, Random& random);

}  // namespace vesalius::synth
