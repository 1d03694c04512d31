#include "bench/bench_fit.h"

#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/error.h"
#include "vesalius/fit/body_history.h"
#include "vesalius/fit/fit_body.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/track_people.h"

namespace vesalius {
namespace {

/// A fit that is due: a person in a frame, and what is known of the person's body.
struct DueFit {
  std::shared_ptr<const Frame> frame;
  Person person;
  BodyHistory history;
  double time_s = 0.0;
};

/// Follows the people of some frames and returns their fits: the first ones of each person, and all others.
std::pair<std::vector<DueFit>, std::vector<DueFit>> find_fits(const std::string& folder, const std::string& model,
                                                              const BodyFitter& fitter) {
  const std::string data = VESALIUS_SOURCE_DIR "/data/";
  const Detector detector(load_model(data + "models/" + model));
  PeopleTracker tracker = make_tracker(detector, {});
  std::map<int, BodyHistory> histories;
  std::vector<DueFit> first, followed;
  const auto source = open_source(data + folder);
  while (std::optional<Frame> next = source->next()) {
    const auto frame = std::make_shared<const Frame>(*std::move(next));
    Detection found = detector.detect(*frame, [&](const Frame& asked) { return tracker.expect(asked); });
    for (const TrackedPerson& tracked : tracker.update(*frame, std::move(found)).people) {
      if (tracked.person.mask.empty()) continue;
      const double time_s = tracked.seen_s;
      BodyHistory& history = histories[tracked.id];
      DueFit due{frame, tracked.person, history, time_s};
      const bool follows = history.expected_state(time_s).has_value();
      if (history.fit(fitter, *frame, tracked.person, time_s)) (follows ? followed : first).push_back(std::move(due));
    }
  }
  return {first, followed};
}

void add(const std::string& name, const std::shared_ptr<const BodyFitter>& fitter, std::vector<DueFit> fits) {
  if (fits.empty()) throw Error("fit_body:" + name + ": nobody was found whose body could be fitted");
  benchmark::RegisterBenchmark(("fit_body:" + name).c_str(), [fitter, fits = std::move(fits)](benchmark::State& state) {
    std::size_t next = 0;
    for (auto _ : state) {
      const DueFit& due = fits[next++ % fits.size()];
      BodyHistory history = due.history;
      benchmark::DoNotOptimize(history.fit(*fitter, *due.frame, due.person, due.time_s));
    }
    state.counters["fits"] = static_cast<double>(fits.size());
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

void add_fit_benchmarks() {
  const auto fitter = std::make_shared<const BodyFitter>(paper_body());
  add("first/rooms", fitter, find_fits("rooms", "default.forest", *fitter).first);
  add("followed/sample", fitter, find_fits("sample", "capsule.forest", *fitter).second);
}

}  // namespace vesalius
