#include "synth/body/population.h"

#include <fmt/format.h>

#include "vesalius/error.h"

namespace vesalius::synth {

void visit_options(const std::string& prefix, Population& o, OptionVisitor& visitor) {
  visitor.option(prefix + "men", o.men, {"", 0, 1, "Share of men and boys."});
  visitor.option(prefix + "children", o.children, {"", 0, 1, "Share of people below 18 years."});
  visitor.option(prefix + "old", o.old, {"", 0, 1, "Share of people above 60 years, as far as children leave room."});
  visitor.option(prefix + "age-min", o.age_min_years, {"years", 4, 90, "Younger people are left out."});
  visitor.option(prefix + "age-max", o.age_max_years, {"years", 4, 90, "Older people are left out."});
  visitor.option(prefix + "stature-min", o.stature_min_m, {"m", 0.9, 2.2, "Smaller people are left out."});
  visitor.option(prefix + "stature-max", o.stature_max_m, {"m", 0.9, 2.2, "Taller people are left out."});
  visitor.option(prefix + "build", o.build, {"", -1, 1, "-1: most are thin; 0: as people are; 1: most are heavy."});
}

void check(const Population& p) {
  if (p.age_min_years > p.age_max_years) {
    throw UsageError(fmt::format("option body.age-min is {}, above body.age-max {}", p.age_min_years, p.age_max_years));
  }
  if (p.stature_min_m > p.stature_max_m) {
    throw UsageError(
        fmt::format("option body.stature-min is {}, above body.stature-max {}", p.stature_min_m, p.stature_max_m));
  }
}

bool draw_woman(const Population& population, Random& random) {
  return random.uniform() < 1.0 - double(population.men);
}

float draw_age(const Population& population, float youngest, Random& random) {
  constexpr int kTries = 200;
  const auto uniform = [&](double from, double to) { return float(random.uniform(from, to)); };
  for (int i = 0; i < kTries; ++i) {
    const double group = random.uniform();
    const bool child = group < double(population.children);
    const bool old = group >= 1.0 - double(population.old);
    const float age = child ? uniform(youngest, 18.0) : old ? uniform(60.0, 85.0) : uniform(18.0, 60.0);
    if (age >= population.age_min_years && age <= population.age_max_years) return age;
  }
  return uniform(population.age_min_years, population.age_max_years);
}

}  // namespace vesalius::synth
