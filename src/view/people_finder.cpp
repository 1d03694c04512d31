#include "view/people_finder.h"

#include <fmt/chrono.h>

#include <ctime>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "io/files/options_file.h"
#include "vesalius/fit/fit_body.h"
#include "vesalius/frame_source.h"
#include "vesalius/person_json.h"
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

constexpr std::size_t kMostKnown = 60;
constexpr double kBefore = -std::numeric_limits<double>::infinity();

std::string new_path(const std::string& folder) {
  const std::string stem = fmt::format("vesalius-{:%Y%m%d-%H%M%S}", fmt::localtime(std::time(nullptr)));
  std::error_code ignored;
  for (int i = 1;; ++i) {
    const auto path = std::filesystem::path(folder) / (i == 1 ? stem + ".mcap" : fmt::format("{}-{}.mcap", stem, i));
    if (!std::filesystem::exists(path, ignored)) return path.string();
  }
}

}  // namespace

PeopleFinder::PeopleFinder(Settings settings, bool track, MergePeople merge)
    : settings_(std::move(settings)), merge_(std::move(merge)) {
  if (track) tracks_.emplace(make_tracker(settings_->detector, settings_->options));
}

void PeopleFinder::take_over(const Settings& settings) {
  const Settings before = std::exchange(settings_, settings);
  if (before != settings_ && are_tracks_others(before->options, settings_->options)) begin_anew();
}

void PeopleFinder::begin_anew() {
  if (!tracks_) return;
  const PeopleOptions& options = settings_->options;
  const Detector& detector = settings_->detector;
  tracks_->restart(options.track, detector.appearance(),
                   std::make_shared<const BodyFitter>(detector.body(), options.fit));
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
  FollowReport report;
  report.trace = viewed.trace ? &*viewed.trace : nullptr;
  viewed.people = vesalius::follow(settings_->detector, tracker, frame, report);
  viewed.planes = std::move(report.planes);
  viewed.times = report.times;
  viewed.track_ms = report.track_ms;
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
    const Frame& frame = *viewed.frame;
    if (merge_) viewed.people = merge_(frame, moment_of(frame, viewed.at_s), std::move(viewed.people));
  } else {
    const auto nothing = [](const Frame&) { return Prior{}; };
    Trace* const trace = viewed.trace ? &*viewed.trace : nullptr;
    Detection found = settings_->detector.detect(*viewed.frame, nothing, trace, &viewed.times);
    viewed.planes = std::move(found.planes);
    viewed.people = seen_people(std::move(found.people));
  }
  viewed.number = ++frames_;
  return viewed;
}

TrackHistory::TrackHistory(PeopleTracker first) { known_.push_back({kBefore, std::move(first)}); }

PeopleTracker& TrackHistory::before(double at_s) {
  std::optional<PeopleTracker> newest;
  bool again = false;  // whether this very frame was there
  while (known_.size() > 1 && known_.back().at_s >= at_s) {
    again = known_.back().at_s == at_s;
    if (!newest) newest = std::move(known_.back().tracker);
    known_.pop_back();
  }
  // What came before this frame is not known any more.
  if (known_.size() == 1 && newest && !again) known_.front().tracker = newest->restarted();
  known_.push_back({at_s, known_.back().tracker});
  if (known_.size() > kMostKnown) known_.pop_front();
  return known_.back().tracker;
}

void TrackHistory::restart(const TrackOptions& options, const std::shared_ptr<const Appearance>& appearance,
                           const std::shared_ptr<const BodyFitter>& fitter) {
  PeopleTracker anew = known_.back().tracker.restarted(options, appearance, fitter);
  known_.clear();
  known_.push_back({kBefore, std::move(anew)});
}

PageRecording::PageRecording(const std::string& folder, double rate)
    : path_(new_path(folder)), file_(path_, rate), rate_(rate) {}

void PageRecording::add_frame(const ViewedFrame& viewed, const BodyModel& body) {
  if (viewed.at_s <= up_to_s_) return;
  Frame frame = *viewed.frame;
  if (!frame.time_s) frame.time_s = viewed.at_s * kUsualRate / rate_;
  file_.write(frame);
  file_.write_people(frame, viewed.people, body, frame_json(frame, viewed.people, body, viewed.latency_ms));
  up_to_s_ = viewed.at_s;
  ++frames_;
}

}  // namespace vesalius
