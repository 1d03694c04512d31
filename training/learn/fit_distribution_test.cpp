#include "learn/fit_distribution.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "metrics/joint_metrics.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

Vector3f scattered(Random& random, double sigma_m) {
  const auto draw = [&] { return static_cast<float>(random.normal(0.0, sigma_m)); };
  const float x = draw(), y = draw();
  return {x, y, draw()};
}

/// Returns people of any yaw whose left arms and right arms swing together; half of the parts are observed, 5 cm before
/// their centres.
std::vector<KnownPerson> people(int count, std::uint64_t seed) {
  Random layout_of(9);
  std::vector<Vector3f> layout(paper_body().parts.size());
  for (std::size_t p = 0; p < layout.size(); ++p) {
    const auto mirror = static_cast<std::size_t>(paper_body().parts[p].mirror);
    if (mirror < p) continue;
    layout[p] = scattered(layout_of, 0.4);
    if (mirror == p) layout[p].x() = 0.F;
    layout[mirror] = Vector3f(mirror == p ? layout[p].x() : -layout[p].x(), layout[p].y(), layout[p].z());
  }
  Random random(seed);
  std::vector<KnownPerson> all;
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisf turn(static_cast<float>(random.uniform(-3.0, 3.0)), Vector3f::UnitY());
    const auto swing = static_cast<float>(random.normal(0.0, 0.2));
    KnownPerson person;
    for (std::size_t p = 0; p < layout.size(); ++p) {
      const bool arm = paper_body().parts[p].name.find("arm") != std::string::npos;
      const Vector3f moved = layout[p] + Vector3f(0.F, 0.F, arm ? swing : 0.F) + scattered(random, 0.03);
      const Vector3f centre = turn * moved + Vector3f(0.F, 0.F, 3.F);
      SkeletonPart part;
      part.state = random.uniform() < 0.5 ? State::observed : State::none;
      part.centre = centre - 0.05F * centre.normalized() + scattered(random, 0.02);
      person.part_centres.push_back(centre);
      person.skeleton.parts.push_back(part);
    }
    all.push_back(std::move(person));
  }
  return all;
}

TEST(FitDistribution, PredictsPartsOfOtherPeopleWithAFairProbability) {
  const PartDistribution distribution = fit_distribution(people(400, 1), paper_body());
  double right = 0.0, expected = 0.0, count = 0.0;
  for (const KnownPerson& person : people(200, 2)) {
    const auto predicted = predict_parts(distribution, given_centres(person.skeleton), {});
    for (std::size_t p = 0; p < predicted.size(); ++p) {
      if (person.skeleton.parts[p].state == State::observed) continue;
      const Vector3f surface = person.part_centres[p] - 0.05F * person.part_centres[p].normalized();
      right += (predicted[p].centre - surface).norm() < 0.1F ? 1.0 : 0.0;
      expected += static_cast<double>(predicted_confidence(distribution.confidence, predicted[p].sigma_m));
      count += 1.0;
    }
  }
  EXPECT_GT(right / count, 0.7);
  EXPECT_NEAR(expected / count, right / count, 0.05);
}

TEST(FitDistribution, PredictsPartsWithVotesWithAFairProbability) {
  Random random(6);
  const auto with_votes = [&](int count, std::uint64_t seed) {
    std::vector<KnownPerson> all = people(count, seed);
    for (KnownPerson& person : all) {
      for (SkeletonPart& part : person.skeleton.parts) {
        if (random.uniform() < 0.7) part.state = State::none;  // too few to tell how the body is turned
      }
      for (const Vector3f& centre : person.part_centres) {
        person.skeleton.voted.push_back({centre + scattered(random, 0.06), 0.02F});
      }
    }
    return all;
  };
  const PartDistribution distribution = fit_distribution(with_votes(400, 1), paper_body());
  ASSERT_TRUE(distribution.voted_confidence);
  for (const PartDistribution::Part& part : distribution.parts) EXPECT_NEAR(part.depth_m, 0.05F, 0.02F);
  double right = 0.0, expected = 0.0, count = 0.0, right_without = 0.0;
  for (const KnownPerson& person : with_votes(200, 2)) {
    const std::vector<Vector3f> seen = given_centres(person.skeleton);
    const auto predicted = predict_parts(distribution, seen, person.skeleton.voted);
    const auto without = predict_parts(distribution, seen, {});
    for (std::size_t p = 0; p < predicted.size(); ++p) {
      if (person.skeleton.parts[p].state == State::observed) continue;
      const Vector3f surface = person.part_centres[p] - 0.05F * person.part_centres[p].normalized();
      right += (predicted[p].centre - surface).norm() < 0.1F ? 1.0 : 0.0;
      right_without += !without.empty() && (without[p].centre - surface).norm() < 0.1F ? 1.0 : 0.0;
      expected += static_cast<double>(predicted_confidence(*distribution.voted_confidence, predicted[p].sigma_m));
      count += 1.0;
    }
  }
  EXPECT_GT(right / count, 0.7);
  EXPECT_LT(right_without / count, 0.5);
  EXPECT_NEAR(expected / count, right / count, 0.05);
}

TEST(FitDistribution, KnowsWhichPartsAreBetterVotedForThanSeen) {
  const int hips = paper_body().find_part("l_hips"), hand = paper_body().find_part("l_hand");
  Random random(8);
  std::vector<KnownPerson> all = people(200, 4);
  for (KnownPerson& person : all) {
    for (std::size_t p = 0; p < person.part_centres.size(); ++p) {
      const bool badly_seen = p == std::size_t(hips) || p == std::size_t(paper_body().parts[hips].mirror);
      if (badly_seen) person.skeleton.parts[p].centre += scattered(random, 0.1);
      person.skeleton.voted.push_back({person.part_centres[p] + scattered(random, badly_seen ? 0.02 : 0.1), 0.02F});
    }
  }
  const PartDistribution distribution = fit_distribution(all, paper_body());
  EXPECT_GE(distribution.parts[hips].observed_m, 0.2F);
  EXPECT_EQ(distribution.parts[hips].observed_m, distribution.parts[paper_body().parts[hips].mirror].observed_m);
  EXPECT_LE(distribution.parts[hand].observed_m, 0.04F);
}

TEST(FitDistribution, LeavesVotesOutWhereNobodyHasAny) {
  EXPECT_FALSE(fit_distribution(people(150, 3), paper_body()).voted_confidence);
}

TEST(FitDistribution, IsTheSameForBothSides) {
  const PartDistribution distribution = fit_distribution(people(150, 3), paper_body());
  ASSERT_EQ(distribution.parts.size(), paper_body().parts.size());
  for (std::size_t p = 0; p < distribution.parts.size(); ++p) {
    const auto& partner = distribution.parts[paper_body().parts[p].mirror];
    EXPECT_NEAR(distribution.parts[p].residual_m, partner.residual_m, 0.005F);
  }
}

TEST(FitDistribution, NeedsPeopleWhoseCentresAreKnown) {
  std::vector<KnownPerson> known = people(120, 4);
  for (std::size_t i = 0; i < 50; ++i) known[i].part_centres.clear();
  EXPECT_THAT([&] { fit_distribution(known, paper_body()); }, ThrowsMessage<Error>(HasSubstr("70 people found")));
}

}  // namespace
}  // namespace vesalius
