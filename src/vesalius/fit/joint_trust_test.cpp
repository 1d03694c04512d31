#include "vesalius/fit/joint_trust.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/fit/test_bad_toml.h"

namespace vesalius {
namespace {

// The tests depend on its line numbers.
constexpr const char* kSmall = R"([observed]
bias = 1.5
log_sigma = -2
[predicted]
bias = 0
[hidden]
bias = -1
unseen = -0.5
)";

float logit_of(float probability) { return std::log(probability / (1.F - probability)); }

TEST(JointTrust, IsReadAsWritten) {
  const BodyTrust trust = parse_body_trust(kSmall, "small");
  EXPECT_EQ(trust.observed.bias, 1.5F);
  EXPECT_EQ(trust.observed.weights.log_sigma, -2.F);
  EXPECT_EQ(trust.observed.weights.unseen_s, 0.F) << "what is not named does not count";
  EXPECT_EQ(trust.hidden.weights.unseen_s, -0.5F);
}

TEST(JointTrust, IsTheProbabilityOfTheSumOfWeightedSignals) {
  const BodyTrust trust = parse_body_trust(kSmall, "small");
  TrustSignals signals;
  signals.log_sigma = -0.25F;
  signals.unseen_s = 2.F;
  EXPECT_NEAR(logit_of(trusted(trust, JointSource::observed, signals)), 2.F, 1e-5F);
  EXPECT_NEAR(trusted(trust, JointSource::predicted, signals), 0.5F, 1e-6F);
  EXPECT_NEAR(logit_of(trusted(trust, JointSource::hidden, signals)), -2.F, 1e-5F);
}

TEST(JointTrust, OfAPointBetweenTwoLiesBetweenTheirs) {
  TrustSignals from, to;
  from.log_sigma = -4.F;
  to.log_sigma = -2.F;
  from.misfit = to.misfit = 0.7F;
  const TrustSignals quarter = between(from, to, 0.25F);
  EXPECT_NEAR(quarter.log_sigma, -3.5F, 1e-6F);
  EXPECT_NEAR(quarter.misfit, 0.7F, 1e-6F);
}

TEST(JointTrust, OfTheProgramFallsWithTheStandardDeviation) {
  for (const NamedSource& source : kJointSources) EXPECT_LT((builtin_trust().*source.trust).weights.log_sigma, 0.F);
}

TEST(JointTrust, ErrorsNameFileLineAndExpectation) {
  test::expect_refused(kSmall,
                       {
                           test::BadToml{"bias = 1.5", "bias = \"a\"", 2, "bias: expected a number"},
                           test::BadToml{"bias = 1.5", "bias = 1e9", 2, "bias: expected a number"},
                           test::BadToml{"bias = 0\n", "", 4, "missing key \"bias\""},
                           test::BadToml{"unseen", "unseem", 8, "unknown key \"unseem\", expected bias, log_sigma"},
                           test::BadToml{"unseen = -0.5", "unseen = nan", 8, "unseen: expected a number"},
                           test::BadToml{"[hidden]", "[lost]", 6, "unknown key \"lost\""},
                       },
                       [](const std::string& text, const char* name) { parse_body_trust(text, name); });
  EXPECT_THROW(parse_body_trust("", "some.toml"), Error);
}

}  // namespace
}  // namespace vesalius
