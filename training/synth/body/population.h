#pragma once

#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Whose bodies are made.
struct Population {
  float men = 0.5F;           ///< share of men and boys
  float children = 0.2F;      ///< share of people below 18
  float old = 0.2F;           ///< share of people above 60, as far as children leave room
  float age_min_years = 4.F;  ///< people of other ages are left out
  float age_max_years = 90.F;
  float stature_min_m = 0.9F;  ///< people of other statures are left out
  float stature_max_m = 2.2F;
  float build = 0.F;  ///< -1: most are thin, 0: as people are, 1: most are heavy
};

void visit_options(const std::string& prefix, Population& options, OptionVisitor& visitor);

/// Throws UsageError if a minimum is above its maximum.
void check(const Population& population);

/// Draws sex: whether it is a woman or a girl.
bool draw_woman(const Population& population, Random& random);

/// Draws an age in years within the population's range, from the shares of children (from `youngest` on) and of old
/// people (up to 85). If those shares have next to nobody of that range, every age in it is equally likely.
float draw_age(const Population& population, float youngest, Random& random);

/// Returns the first shape of `draw` whose stature is within the population's range. After many tries without one,
/// since people like that are rare or do not exist, the last gets any stature of the range.
template <class Shape, class Draw>
Shape draw_within(const Population& population, Random& random, Draw draw) {
  constexpr int kTries = 200;
  Shape shape;
  for (int i = 0; i < kTries; ++i) {
    shape = draw();
    if (shape.stature_m >= population.stature_min_m && shape.stature_m <= population.stature_max_m) return shape;
  }
  shape.stature_m = float(random.uniform(population.stature_min_m, population.stature_max_m));
  return shape;
}

}  // namespace vesalius::synth
