#include "synth/body/makehuman_factors.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "synth/body/stature.h"
#include "synth/text/text_scanner.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

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

}  // namespace

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
  return draw_within<MakeHumanFactors>(population, random, [&] {
    MakeHumanFactors f;
    f.gender = draw_woman(population, random) ? uniform(0.0, 0.2) : uniform(0.8, 1.0);
    f.age_years = draw_age(population, 5.F, random);
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
