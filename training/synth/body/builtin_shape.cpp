#include "synth/body/builtin_shape.h"

#include <algorithm>

#include "synth/body/stature.h"

namespace vesalius::synth {

BuiltinShape sample_builtin_shape(const Population& population, Random& random) {
  const auto uniform = [&](double from, double to) { return static_cast<float>(random.uniform(from, to)); };
  return draw_within<BuiltinShape>(population, random, [&] {
    BuiltinShape shape;
    shape.maleness = draw_woman(population, random) ? uniform(0.0, 0.3) : uniform(0.7, 1.0);
    shape.age_years = draw_age(population, 4.F, random);
    const double usual_build = 0.1 + 0.6 * static_cast<double>(population.build);
    shape.build = std::clamp(static_cast<float>(random.normal(usual_build, 0.45)), -1.F, 1.F);
    const Stature stature = stature_at(shape.age_years, shape.maleness);
    shape.stature_m = stature.mean_m + static_cast<float>(std::clamp(random.normal(), -2.5, 2.5)) * stature.sigma_m;
    return shape;
  });
}

}  // namespace vesalius::synth
