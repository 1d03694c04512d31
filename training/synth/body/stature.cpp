#include "synth/body/stature.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius::synth {
namespace {

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

}  // namespace

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

}  // namespace vesalius::synth
