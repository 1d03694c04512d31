#include "view/viewer.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "io/files/options_file.h"
#include "io/recordings/frame_recorder.h"
#include "stream/frame_queue.h"
#include "stream/person_json.h"
#include "vesalius/base/error.h"
#include "vesalius/base/quiet_thread.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/fit/fit_body.h"
#include "view/bundle_files.h"
#include "view/frame_message.h"
#include "view/track_history.h"
#include "view/viewer_messages.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::chrono::milliseconds kPatience(50);     // time between questions whether to stop
constexpr std::chrono::milliseconds kStatePause(200);  // between states while no frame comes
constexpr std::chrono::milliseconds kSoon(200);        // a frame that plays is followed by another
constexpr std::size_t kMedianOf = 30;
constexpr const char* kOptionsPath = "/options.toml";

double milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

/// The last measurements of a time.
class RecentTimes {
 public:
  void add(double ms) {
    ms_.push_back(ms);
    if (ms_.size() > kMedianOf) ms_.pop_front();
  }
  std::optional<double> median() const {
    if (ms_.empty()) return std::nullopt;
    std::vector<double> sorted(ms_.begin(), ms_.end());
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
    return sorted[sorted.size() / 2];
  }

 private:
  std::deque<double> ms_;
};

/// Counts what happened in the last second.
class RecentRate {
 public:
  void add(Clock::time_point when) {
    times_.push_back(when);
    forget(when);
  }
  double per_s(Clock::time_point now) {
    forget(now);
    return static_cast<double>(times_.size());
  }

 private:
  void forget(Clock::time_point now) {
    while (!times_.empty() && times_.front() < now - std::chrono::seconds(1)) times_.pop_front();
  }

  std::deque<Clock::time_point> times_;
};

std::string new_recording(const std::string& folder) {
  const std::time_t now = std::time(nullptr);
  const std::string stem = fmt::format("vesalius-{:%Y%m%d-%H%M%S}", fmt::localtime(now));
  std::filesystem::path path;
  std::error_code ignored;
  for (int i = 1;; ++i) {
    path = std::filesystem::path(folder) / (i == 1 ? stem + ".mcap" : fmt::format("{}-{}.mcap", stem, i));
    if (!std::filesystem::exists(path, ignored)) return path.string();
  }
}

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

class Viewer::Session {
 public:
  Session(FrameSource& source, std::shared_ptr<const PixelLabeller> labeller, const PeopleOptions& options,
          const ViewerOptions& viewer)
      : source_(source),
        labeller_(std::move(labeller)),
        first_options_(options),
        facts_{viewer.source, viewer.model, viewer.folder, viewer.track},
        rate_(viewer.player.rate),
        say_(viewer.say),
        options_(options),
        detector_(labeller_, options.detect),
        track_rate_(static_cast<double>(options.track.rate)),
        played_(1),
        found_(1),
        player_(source, viewer.player, outputs()),
        server_(viewer.web, handlers()) {
    if (facts_.track) {
      tracks_.emplace(make_tracker(detector_, options));
    }
    worker_ = quiet_thread([this] { detect_all(); });
    server_.start();
    player_.start();
  }

  /// The player tells the server and the server the player; so its thread ends before either is gone.
  ~Session() {
    played_.close();
    found_.close();
    player_.stop();
  }

  std::uint16_t port() const { return server_.port(); }
  void say(const std::string& line) { server_.publish_text("", notice_message(line)); }

  void run(const std::function<bool()>& stop) {
    Clock::time_point last_state;
    while (!stop() && !has_ended()) {
      if (const std::optional<Found> found = found_.pop(kPatience)) {
        deliver(*found);
      } else if (Clock::now() < last_state + kStatePause) {
        continue;
      }
      keep_recorder();
      if (server_.clients() > 0) server_.publish_text("state", state());
      last_state = Clock::now();
    }
    stop_recording();
    if (ended_by_) std::rethrow_exception(ended_by_);
    if (!failed_recording_.empty()) throw Error("not all was recorded: " + failed_recording_);
  }

 private:
  using Wish = std::function<void(ClientWishes)>;

  /// A frame to be looked at, once more if `again` is true.
  struct Job {
    std::shared_ptr<const PlayedFrame> played;
    Clock::time_point arrived;
    bool again = false;
  };
  struct Found {
    ViewedFrame viewed;
    Clock::time_point arrived;
    bool again = false;
  };

  Player::Outputs outputs() {
    return {[this](PlayedFrame played) { take(std::move(played)); }, [this](const std::string& why) { say(why); },
            [this](std::exception_ptr why) {
              const std::scoped_lock lock(mutex_);
              ended_by_ = std::move(why);
            },
            [this] { server_.publish_text("state", state()); }};
  }

  WebHandlers handlers() {
    return {[this](const std::string& path) { return get(path); },
            [](const std::string& path) { return path == "/view.css" || path == "/view.js"; },
            [this] { return greet(); }, [this](const std::string& text, const Wish& wish) { return obey(text, wish); },
            [this](std::chrono::duration<double> since) {
              const std::scoped_lock lock(mutex_);
              page_times_.add(1e3 * since.count());
            }};
  }

  bool has_ended() const {
    const std::scoped_lock lock(mutex_);
    return ended_by_ != nullptr;
  }

  std::optional<WebResponse> get(const std::string& path) const {
    if (path == kOptionsPath) return WebResponse{"application/toml", options_text(), false, "options.toml"};
    const auto& files = bundle_files();
    const auto file = std::ranges::find(files, path, &BundleFile::path);
    if (file == files.end()) return std::nullopt;
    return WebResponse{std::string(file->type), std::string(file->gzip), true, {}};
  }

  std::string options_text() const {
    PeopleOptions options = current_options();
    return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }

  PeopleOptions current_options() const {
    const std::scoped_lock lock(mutex_);
    return options_;
  }

  std::vector<std::string> greet() {
    look_again();
    return {hello_message(facts_, labeller_->body()), options_message(current_options(), first_options_, facts_.track),
            state()};
  }

  /// Does what a page asks for.
  std::optional<std::string> obey(const std::string& text, const Wish& wish) {
    using Action = std::function<void(const Json&)>;
    const std::map<std::string, Action> actions{
        {"play", [this](const Json&) { player_.play(); }},
        {"pause", [this](const Json&) { player_.pause(); }},
        {"step", [this](const Json& c) { player_.step(c.at("by").get<double>() < 0.0 ? -1 : 1); }},
        {"seek", [this](const Json& c) { player_.seek(c.at("to_s").get<double>()); }},
        {"speed", [this](const Json& c) { player_.set_speed(c.at("times").get<double>()); }},
        {"repeat", [this](const Json& c) { player_.set_repeat(c.at("on").get<bool>()); }},
        {"stages",
         [&](const Json& c) {
           const bool on = c.at("on").get<bool>();
           wish({on});
           if (on) look_again(true);
         }},
        {"record", [this](const Json& c) { want_recording(c.at("on").get<bool>()); }},
        {"set", [this](const Json& c) { change_option(c.at("option").get<std::string>(), c.at("value").dump()); }},
        {"reset", [this](const Json&) { change_options(first_options_); }}};
    try {
      const Json command = Json::parse(text);
      const auto action = actions.find(command.at("do").get<std::string>());
      if (action == actions.end()) return notice_message("unknown command: " + text.substr(0, 100));
      action->second(command);
    } catch (const Error& e) {
      return notice_message(e.what());
    } catch (const Json::exception& e) {
      return notice_message(fmt::format("not a command: {}", e.what()));
    }
    return std::nullopt;
  }

  void change_option(const std::string& name, const std::string& value) {
    PeopleOptions options = current_options();
    try {
      set_option(options, name, value);
      change_options(options);
    } catch (const Error&) {
      tell_options();  // the page shows the refused value
      throw;
    }
  }

  void change_options(const PeopleOptions& options) {
    Detector changed(labeller_, options.detect);  // it knows best which options it can use
    {
      const std::scoped_lock lock(mutex_);
      tracks_changed_ = tracks_changed_ || are_tracks_others(options, options_);
      options_ = options;
      changed_detector_ = std::move(changed);
    }
    tell_options();
    look_again();
  }

  void tell_options() {
    server_.publish_text("options", options_message(current_options(), first_options_, facts_.track));
  }

  void want_recording(bool on) {
    const std::scoped_lock lock(mutex_);
    recording_wanted_ = on;
  }

  /// Opens or closes the recorder as it is wanted. Files are the business of the caller's thread alone: a slow disk
  /// must not hold up the page.
  void keep_recorder() {
    bool wanted = false;
    {
      const std::scoped_lock lock(mutex_);
      wanted = recording_wanted_;
    }
    if (wanted == recorder_.has_value()) return;
    if (!wanted) return stop_recording();
    guard_recorder([this] {
      const std::string path = new_recording(facts_.folder);
      recorder_.emplace(path, rate_);
      recorded_up_to_s_ = -std::numeric_limits<double>::infinity();
      const std::scoped_lock lock(mutex_);
      state_.recording = path;
      state_.recorded = 0;
    });
  }

  void stop_recording() {
    guard_recorder([this] {
      if (recorder_) recorder_->close();
    });
    forget_recorder();
  }

  void forget_recorder() {
    recorder_.reset();
    const std::scoped_lock lock(mutex_);
    recording_wanted_ = false;
    state_.recording.clear();
  }

  template <class Work>
  void guard_recorder(Work work) {
    try {
      work();
    } catch (const Error& e) {
      failed_recording_ = e.what();
      say(failed_recording_);
      if (say_) say_(failed_recording_);
      forget_recorder();
    }
  }

  /// Frames whose time is recorded already are left out: a recording shows a source once, however it was moved in.
  void record(const Found& found) {
    const ViewedFrame& viewed = found.viewed;
    if (!recorder_ || found.again || viewed.at_s <= recorded_up_to_s_) return;
    guard_recorder([&] {
      Frame frame = *viewed.frame;
      if (!frame.time_s) frame.time_s = viewed.at_s * kUsualRate / rate_;
      recorder_->write(frame);
      const BodyModel& body = labeller_->body();
      recorder_->write_people(frame, viewed.people, body, frame_json(frame, viewed.people, body, viewed.latency_ms));
      recorded_up_to_s_ = viewed.at_s;
      const std::scoped_lock lock(mutex_);
      ++state_.recorded;
    });
  }

  /// Detects the last frame once more, where no other will come soon or somebody wants more of it.
  void look_again(bool surely = false) {
    const bool playing = player_.state().playing;
    const std::scoped_lock lock(mutex_);
    if (!last_) return;
    if (playing && !surely && Clock::now() < last_->arrived + kSoon) return;
    played_.push_newest({last_, Clock::now(), true});
  }

  void take(PlayedFrame played) {
    auto shared = std::make_shared<const PlayedFrame>(std::move(played));
    const std::scoped_lock lock(mutex_);
    last_ = shared;
    missed_ = source_.missed();
    // Nobody would see the people.
    if (server_.clients() == 0 && !recording_wanted_) return;
    const Clock::time_point arrived = shared->arrived;
    state_.dropped += played_.push_newest({std::move(shared), arrived, false});
  }

  void detect_all() {
    while (!played_.finished()) {
      const std::optional<Job> job = played_.pop(kPatience);
      if (!job) continue;
      try {
        if (!found_.push(detect(*job))) return;
      } catch (const std::exception& e) {  // no frame may end the program
        say(e.what());
      }
    }
  }

  void take_changed_options() {
    const std::scoped_lock lock(mutex_);
    if (!changed_detector_) return;
    detector_ = *std::exchange(changed_detector_, std::nullopt);
    track_rate_ = static_cast<double>(options_.track.rate);
    if (tracks_ && std::exchange(tracks_changed_, false)) {
      tracks_->restart(options_.track, detector_.appearance(),
                       std::make_shared<const BodyFitter>(labeller_->body(), options_.fit));
    }
  }

  void find(const Frame& frame, ViewedFrame& viewed) {
    const AskPrior nothing = [](const Frame&) { return Prior{}; };
    Detection found = detector_.detect(frame, nothing, viewed.trace ? &*viewed.trace : nullptr, &viewed.times);
    viewed.people = seen_people(std::move(found.people));
    viewed.planes = std::move(found.planes);
  }

  void follow(const Frame& frame, ViewedFrame& viewed) {
    // Some frames are dropped, and people move in a source: where frames have no times, their places count.
    std::optional<Frame> timed;
    if (!frame.time_s) (timed = frame)->time_s = viewed.at_s * kUsualRate / track_rate_;
    const Frame& followed = timed ? *timed : frame;
    PeopleTracker& tracker = tracks_->before(viewed.at_s);
    const AskPrior ask = [&](const Frame& asked) {
      Prior prior;
      viewed.track_ms += elapsed_ms([&] { prior = tracker.expect(asked); });
      return prior;
    };
    Detection found = detector_.detect(followed, ask, viewed.trace ? &*viewed.trace : nullptr, &viewed.times);
    viewed.planes = std::move(found.planes);
    viewed.track_ms +=
        elapsed_ms([&] { viewed.people = tracker.update(followed, std::move(found.people), viewed.planes); });
  }

  Found detect(const Job& job) {
    take_changed_options();
    Found found{{}, job.arrived, job.again};
    ViewedFrame& viewed = found.viewed;
    viewed.frame = {job.played, &job.played->frame};
    viewed.at_s = job.played->at_s;
    if (server_.clients_for_details() > 0) viewed.trace.emplace();
    if (tracks_) {
      follow(*viewed.frame, viewed);
    } else {
      find(*viewed.frame, viewed);
    }
    const Clock::time_point now = Clock::now();
    const double result_ms = milliseconds(now - found.arrived);
    if (viewed.frame->arrived_s) viewed.latency_ms = result_ms;
    const std::scoped_lock lock(mutex_);
    viewed.number = ++state_.frames;
    result_times_.add(result_ms);
    rate_now_.add(now);
    return found;
  }

  void deliver(const Found& found) {
    if (server_.clients() > 0) {
      FrameMessages messages = frame_messages(found.viewed, labeller_->body());
      server_.publish_frame(std::move(messages.plain), std::move(messages.with_stages), found.arrived);
    }
    record(found);
  }

  std::string state() {
    const PlayerState player = player_.state();
    const std::scoped_lock lock(mutex_);
    ViewerState now = state_;
    now.frames_per_s = rate_now_.per_s(Clock::now());
    now.dropped += missed_;
    now.result_ms = result_times_.median();
    now.page_ms = page_times_.median();
    now.clients = server_.clients();
    return state_message(now, player);
  }

  FrameSource& source_;
  const std::shared_ptr<const PixelLabeller> labeller_;
  const PeopleOptions first_options_;
  const ViewerFacts facts_;
  const double rate_;
  const std::function<void(const std::string&)> say_;

  mutable std::mutex mutex_;  ///< of what follows
  PeopleOptions options_;
  std::optional<Detector> changed_detector_;
  bool tracks_changed_ = false;  ///< whether people must be followed anew
  ViewerState state_;
  RecentTimes result_times_, page_times_;
  RecentRate rate_now_;
  bool recording_wanted_ = false;
  int missed_ = 0;  ///< frames of a camera that nobody took
  std::shared_ptr<const PlayedFrame> last_;
  std::exception_ptr ended_by_;  ///< why a camera gives nothing more

  // Of the caller's thread alone:
  std::optional<FrameRecorder> recorder_;
  double recorded_up_to_s_ = 0.0;
  std::string failed_recording_;

  // Of the worker's thread alone:
  Detector detector_;
  double track_rate_;                   ///< frames a second of a source without times
  std::optional<TrackHistory> tracks_;  ///< none if people are not followed

  FrameQueue<Job> played_;
  FrameQueue<Found> found_;
  Player player_;
  WebServer server_;
  std::jthread worker_;
};

Viewer::Viewer(FrameSource& source, std::shared_ptr<const PixelLabeller> labeller, const PeopleOptions& options,
               const ViewerOptions& viewer)
    : session_(std::make_unique<Session>(source, std::move(labeller), options, viewer)) {}

Viewer::~Viewer() = default;

std::uint16_t Viewer::port() const { return session_->port(); }

void Viewer::say(const std::string& line) { session_->say(line); }

void Viewer::run(const std::function<bool()>& stop) { session_->run(stop); }

}  // namespace vesalius
