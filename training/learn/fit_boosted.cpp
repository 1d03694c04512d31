#include "learn/fit_boosted.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

/// Neighbouring cells are alike, so leaves are large.
constexpr BoostOptions kContextOptions{
    .trees = 120, .rate = 0.1, .sample_share = 0.6, .feature_share = 0.4, .ridge = 10.0, .least_samples = 200};

/// Bodies' odds are so many times those that the samples have. A label is the background where that is likelier than
/// any single part, and a body's pixel has several likely parts; so the weights of the background stay what they are
/// for forests without context (docs/decisions/0037).
constexpr double kContextOdds = 7.0;

void expect_both(const std::vector<BoostSample>& samples, const std::string& none, const std::string& positive,
                 const std::string& negative) {
  const auto positives = std::ranges::count(samples, true, &BoostSample::positive);
  if (positives == 0) throw Error(none + positive);
  if (positives == std::ssize(samples)) throw Error(none + negative);
}

}  // namespace

BoostedTrees fit_context(const std::vector<BoostSample>& samples, const BodyModel& body) {
  expect_both(samples, "fitting the context: the frames have no pixel that may be a body and is known to be ", "one",
              "none");
  const std::vector<int> signs(samples.front().features.size(), 0);
  BoostedTrees context = boost_trees(samples, signs, kContextOptions);
  context.asks = BodySurroundings::feature_names(body);
  context.bias += float(std::log(kContextOdds));
  return context;
}

BoostedTrees fit_judge(const std::vector<BoostSample>& samples, const BodyModel& body) {
  expect_both(samples, "fitting the judge: the frames have no candidate that is known to be ", "a person", "nobody");
  BoostedTrees judge = boost_trees(samples, judge_signs(body));
  judge.asks = judge_names(body);
  return judge;
}

}  // namespace vesalius
