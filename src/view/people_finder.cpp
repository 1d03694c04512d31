#include "view/people_finder.h"

#include <string>
#include <utility>

#include "io/files/options_file.h"
#include "vesalius/fit/fit_body.h"
#include "vesalius/stage_times.h"
#include "vesalius/trace.h"

namespace vesalius {
namespace {

/// Returns whether what is known of people with some options is of no use with others.
bool are_tracks_others(const PeopleOptions& a, const PeopleOptions& b) {
  const auto text = [](TrackOptions track, FitOptions fit) {
    return options_toml([&](OptionVisitor& visitor) {
      visit_options("track.", track, visitor);
      visit_options("fit.", fit, visitor);
    });
  };
  return a.detect.grow.appearance != b.detect.grow.appearance || text(a.track, a.fit) != text(b.track, b.fit);
}

}  // namespace

PeopleFinder::PeopleFinder(Settings settings, bool track) : settings_(std::move(settings)) {
  if (track) tracks_.emplace(make_tracker(settings_->detector, settings_->options));
}

void PeopleFinder::take_over(const Settings& settings) {
  const Settings before = std::exchange(settings_, settings);
  const PeopleOptions& options = settings_->options;
  if (before == settings_ || !tracks_ || !are_tracks_others(before->options, options)) return;
  const Detector& detector = settings_->detector;
  tracks_->restart(options.track, detector.appearance(),
                   std::make_shared<const BodyFitter>(detector.body(), options.fit));
}

std::vector<Person> PeopleFinder::detect(const Frame& frame, const AskPrior& ask, ViewedFrame& viewed) const {
  Trace* const trace = viewed.trace ? &*viewed.trace : nullptr;
  Detection found = settings_->detector.detect(frame, ask, trace, &viewed.times);
  viewed.planes = std::move(found.planes);
  return std::move(found.people);
}

void PeopleFinder::follow(ViewedFrame& viewed) {
  // Some frames are dropped, and people move in a source: where frames have no times, their places count.
  std::optional<Frame> timed;
  if (!viewed.frame->time_s) {
    timed = *viewed.frame;
    timed->time_s = viewed.at_s * kUsualRate / double(settings_->options.track.rate);
  }
  const Frame& frame = timed ? *timed : *viewed.frame;
  PeopleTracker& tracker = tracks_->before(viewed.at_s);
  const auto ask = [&](const Frame& asked) {
    Prior prior;
    viewed.track_ms += elapsed_ms([&] { prior = tracker.expect(asked); });
    return prior;
  };
  std::vector<Person> found = detect(frame, ask, viewed);
  viewed.track_ms += elapsed_ms([&] { viewed.people = tracker.update(frame, std::move(found), viewed.planes); });
}

ViewedFrame PeopleFinder::find(const std::shared_ptr<const PlayedFrame>& played, const Settings& settings,
                               bool with_stages) {
  take_over(settings);
  ViewedFrame viewed;
  viewed.frame = {played, &played->frame};
  viewed.at_s = played->at_s;
  if (with_stages) viewed.trace.emplace();
  if (tracks_) {
    follow(viewed);
  } else {
    const auto nothing = [](const Frame&) { return Prior{}; };
    viewed.people = seen_people(detect(*viewed.frame, nothing, viewed));
  }
  viewed.number = ++frames_;
  return viewed;
}

}  // namespace vesalius
