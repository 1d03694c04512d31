#include "synth/body/population.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr int kTries = 200;

struct Row {
  float age_years, woman_m, man_m;
};

constexpr std::array<Row, 14> kMeans{{
    {4.F, 1.010F, 1.022F},
    {5.F, 1.080F, 1.090F},
    {6.F, 1.151F, 1.155F},
    {8.F, 1.278F, 1.280F},
    {10.F, 1.384F, 1.387F},
    {12.F, 1.515F, 1.491F},
    {14.F, 1.604F, 1.638F},
    {16.F, 1.624F, 1.735F},
    {18.F, 1.629F, 1.756F},
    {40.F, 1.629F, 1.756F},
    {60.F, 1.610F, 1.743F},
    {70.F, 1.590F, 1.730F},
    {80.F, 1.568F, 1.714F},
    {90.F, 1.545F, 1.695F},
}};

constexpr std::array<std::string_view, kFactorWords> kWords = {"female",
                                                               "male",
                                                               "child",
                                                               "young",
                                                               "old",
                                                               "african",
                                                               "asian",
                                                               "caucasian",
                                                               "minmuscle",
                                                               "maxmuscle",
                                                               "minweight",
                                                               "averageweight",
                                                               "maxweight",
                                                               "minheight",
                                                               "maxheight",
                                                               "averagemuscle",
                                                               "universal",
                                                               "idealproportions",
                                                               "uncommonproportions"};

float low(float v) { return std::max(0.F, 1.F - 2.F * v); }
float middle(float v) { return 1.F - std::abs(2.F * v - 1.F); }
float high(float v) { return std::max(0.F, 2.F * v - 1.F); }
float unit(float v) { return std::clamp(v, 0.F, 1.F); }

/// Draws sex: whether it is a woman or a girl.
bool draw_woman(const Population& population, Random& random) {
  return random.uniform() < 1.0 - double(population.men);
}

/// Draws an age in years within the population's range, from the shares of children (from 5 on) and of old
/// people (up to 85). If those shares have next to nobody of that range, every age in it is equally likely.
float draw_age(const Population& population, Random& random) {
  constexpr double kYoungest = 5.0;
  const auto uniform = [&](double from, double to) { return float(random.uniform(from, to)); };
  for (int i = 0; i < kTries; ++i) {
    const double group = random.uniform();
    const bool child = group < double(population.children);
    const bool old = group >= 1.0 - double(population.old);
    const float age = child ? uniform(kYoungest, 18.0) : old ? uniform(60.0, 85.0) : uniform(18.0, 60.0);
    if (age >= population.age_min_years && age <= population.age_max_years) return age;
  }
  return uniform(population.age_min_years, population.age_max_years);
}

/// Returns the first person of `draw` whose stature is within the population's range. After many tries without one,
/// since people like that are rare or do not exist, the last gets any stature of the range.
template <class Draw>
MakeHumanFactors draw_within(const Population& population, Random& random, Draw draw) {
  MakeHumanFactors person;
  for (int i = 0; i < kTries; ++i) {
    person = draw();
    if (person.stature_m >= population.stature_min_m && person.stature_m <= population.stature_max_m) return person;
  }
  person.stature_m = float(random.uniform(population.stature_min_m, population.stature_max_m));
  return person;
}

}  // namespace

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

Stature stature_at(float age_years, float maleness) {
  const float age = std::clamp(age_years, kMeans.front().age_years, kMeans.back().age_years);
  const auto* above =
      std::find_if(kMeans.begin() + 1, kMeans.end() - 1, [&](const Row& r) { return r.age_years >= age; });
  const Row& high = *above;
  const Row& low = *(above - 1);
  const float share = (age - low.age_years) / (high.age_years - low.age_years);
  const float woman = std::lerp(low.woman_m, high.woman_m, share);
  const float man = std::lerp(low.man_m, high.man_m, share);
  const float mean = std::lerp(woman, man, std::clamp(maleness, 0.F, 1.F));
  return {mean, 0.0393F * mean};  // 64 mm of 1.629 m and 69 mm of 1.756 m; children vary about as much
}

FactorValues factor_values(const MakeHumanFactors& f) {
  // In MakeHuman "child" is 10 years old, "young" 25 and "old" 90; ages between them mix two targets.
  const float child = unit((25.F - f.age_years) / 15.F);
  const float old = unit((f.age_years - 25.F) / 65.F);
  const float shares = std::max(f.african, 0.F) + std::max(f.asian, 0.F) + std::max(f.caucasian, 0.F);
  const auto share = [&](float value) { return shares > 0.F ? std::max(value, 0.F) / shares : 1.F / 3.F; };
  const float gender = unit(f.gender);
  const float muscle = unit(f.muscle);
  const float weight = unit(f.weight);
  const float height = unit(f.height);
  const float proportions = unit(f.proportions);
  return {1.F - gender,
          gender,
          child,
          1.F - child - old,
          old,
          share(f.african),
          share(f.asian),
          share(f.caucasian),
          low(muscle),
          high(muscle),
          low(weight),
          middle(weight),
          high(weight),
          low(height),
          high(height),
          middle(muscle),
          1.F,
          high(proportions),
          low(proportions)};
}

std::vector<std::uint8_t> factors_of_name(const std::string& path) {
  std::string_view name = std::string_view(path).substr(path.find_last_of('/') + 1);
  if (name.ends_with(".target")) name.remove_suffix(7);
  std::vector<std::uint8_t> factors;
  while (!name.empty()) {
    const std::string_view word = name.substr(0, name.find('-'));
    const auto found = std::ranges::find(kWords, word);
    if (found == kWords.end()) {
      throw Error(
          fmt::format("{}: \"{}\" in the file's name is no factor, expected words as in "
                      "female-child-minmuscle-averageweight-maxheight.target",
                      path, shown(word)));
    }
    factors.push_back(static_cast<std::uint8_t>(found - kWords.begin()));
    name.remove_prefix(std::min(word.size() + 1, name.size()));
  }
  return factors;
}

MakeHumanFactors sample_factors(const Population& population, Random& random) {
  const auto uniform = [&](double from, double to) { return float(random.uniform(from, to)); };
  const auto between = [&](double mean, double sigma) {
    return std::clamp(float(random.normal(mean, sigma)), 0.F, 1.F);
  };
  return draw_within(population, random, [&] {
    MakeHumanFactors f;
    f.gender = draw_woman(population, random) ? uniform(0.0, 0.2) : uniform(0.8, 1.0);
    f.age_years = draw_age(population, random);
    f.muscle = between(0.5, 0.2);
    f.weight = between(0.55 + 0.35 * double(population.build), 0.22);
    f.proportions = uniform(0.4, 1.0);
    f.african = uniform(0.0, 1.0);
    f.asian = uniform(0.0, 1.0);
    f.caucasian = uniform(0.05, 1.0);
    const Stature stature = stature_at(f.age_years, f.gender);
    const auto deviation = float(std::clamp(random.normal(), -2.5, 2.5));
    f.stature_m = stature.mean_m + deviation * stature.sigma_m;
    f.height = 0.5F + 0.11F * deviation;  // 0.22 to 0.78; limbs outside this range do not look human
    return f;
  });
}

}  // namespace vesalius::synth
