#include "synth/body/builtin_shape.h"

#include <algorithm>

#include "synth/body/stature.h"

namespace vesalius::synth {

BuiltinShape sample_builtin_shape(Random& random) {
  const auto uniform = [&](double from, double to) { return static_cast<float>(random.uniform(from, to)); };
  BuiltinShape shape;
  shape.maleness = random.below(2) == 0 ? uniform(0.0, 0.3) : uniform(0.7, 1.0);
  const double group = random.uniform();
  shape.age_years = group < 0.2 ? uniform(4.0, 18.0) : group < 0.8 ? uniform(18.0, 60.0) : uniform(60.0, 85.0);
  shape.build = std::clamp(static_cast<float>(random.normal(0.1, 0.45)), -1.F, 1.F);
  const Stature stature = stature_at(shape.age_years, shape.maleness);
  shape.stature_m = stature.mean_m + static_cast<float>(std::clamp(random.normal(), -2.5, 2.5)) * stature.sigma_m;
  return shape;
}

}  // namespace vesalius::synth
