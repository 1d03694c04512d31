#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "synth/body/makehuman.h"
#include "synth/recipe.h"
#include "synth/scene/person_plan.h"
#include "vesalius/base/random.h"
#include "vesalius/body_model.h"

namespace vesalius::synth {

/// The people of a recipe: bodies with their clothes, each made when it is first wanted and then kept. It may be used
/// from several threads.
class Cast {
 public:
  /// Without `makehuman`, which may be null, bodies are built in. Keeps references to recipe, poses and body. Throws
  /// Error if the recipe requires bodies that are not there.
  Cast(const Recipe& recipe, std::shared_ptr<const MakeHumanModel> makehuman, const std::vector<SampledPose>& captured,
       const BodyModel& body, std::uint64_t seed);

  /// Draws a number of people by the recipe's weights.
  std::size_t draw_count(Random& random) const;
  /// Draws a body, a pose and a look.
  PersonPlan draw_person(Random& random) const;
  /// Draws a pose as that of a person.
  SampledPose draw_pose(Random& random) const;
  /// Returns body k, below the recipe's body.count, with its clothes.
  const Poser& body(std::size_t k) const { return person(k).poser; }

 private:
  /// A body with its clothes.
  struct Dressed {
    Poser poser;
    std::optional<BodyDetail> detail;  ///< empty if the recipe uses none

    Dressed(Poser the_poser, float detail_px);
  };

  std::unique_ptr<Dressed> make_person(std::size_t k) const;
  const Dressed& person(std::size_t k) const;

  const Recipe& recipe_;
  std::shared_ptr<const MakeHumanModel> makehuman_;  ///< null if bodies are built in
  const std::vector<SampledPose>& captured_;
  const BodyModel& body_;
  std::uint64_t seed_;
  mutable std::vector<std::once_flag> made_;
  mutable std::vector<std::unique_ptr<Dressed>> people_;
};

}  // namespace vesalius::synth
