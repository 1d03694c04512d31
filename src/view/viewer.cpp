#include "view/viewer.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <deque>
#include <filesystem>
#include <functional>
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
#include "view/bundle_files.h"
#include "view/frame_message.h"
#include "view/player.h"
#include "view/viewer_messages.h"

namespace vesalius {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::chrono::milliseconds kPatience(50);     // time between questions whether to stop
constexpr std::chrono::milliseconds kStatePause(200);  // between states while no frame comes
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
  void add(Clock::time_point when) { times_.push_back(when); }
  double per_s(Clock::time_point now) {
    while (!times_.empty() && times_.front() < now - std::chrono::seconds(1)) times_.pop_front();
    return static_cast<double>(times_.size());
  }

 private:
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

}  // namespace

class Viewer::Session {
 public:
  Session(FrameSource& source, std::shared_ptr<const PixelLabeller> labeller, const DetectOptions& options,
          const ViewerOptions& viewer)
      : source_(source),
        labeller_(std::move(labeller)),
        facts_{viewer.source, viewer.model, viewer.folder},
        rate_(viewer.rate),
        options_(options),
        detector_(labeller_, options),
        played_(1),
        found_(1),
        player_(source, viewer.rate, !viewer.paused, outputs(), frame_number(viewer.start_s)),
        server_(viewer.web, handlers()),
        worker_([this] { detect_all(); }) {
    player_.start();
  }

  /// The player tells the server and the server the player; so its thread ends before either is gone.
  ~Session() {
    played_.close();
    found_.close();
    player_.stop();
  }

  std::uint16_t port() const { return server_.port(); }
  void say(const std::string& line) { server_.publish_text("notice", notice_message(line)); }

  void run(const std::function<bool()>& stop) {
    Clock::time_point last_state;
    while (!stop()) {
      if (std::optional<Found> found = found_.pop(kPatience)) {
        deliver(*found);
      } else if (Clock::now() < last_state + kStatePause) {
        continue;
      }
      keep_recorder();
      if (server_.clients() > 0) server_.publish_text("state", state());
      last_state = Clock::now();
    }
    stop_recording();
  }

 private:
  struct Found {
    ViewedFrame viewed;
    Clock::time_point arrived;
  };

  Player::Outputs outputs() {
    return {[this](PlayedFrame played) { take(std::move(played)); }, [this](const std::string& why) { say(why); },
            [this] { server_.publish_text("state", state()); }};
  }

  WebHandlers handlers() {
    return {[this](const std::string& path) { return get(path); },
            [](const std::string& path) { return path == "/view.css" || path == "/view.js"; },
            [this] { return greet(); }, [this](const std::string& text) { return obey(text); },
            [this](std::chrono::duration<double> since) {
              const std::scoped_lock lock(mutex_);
              page_times_.add(1e3 * since.count());
            }};
  }

  std::optional<WebResponse> get(const std::string& path) const {
    if (path == kOptionsPath) return WebResponse{"application/toml", options_text(), false, "options.toml"};
    const auto& files = bundle_files();
    const auto file = std::ranges::find(files, path, &BundleFile::path);
    if (file == files.end()) return std::nullopt;
    return WebResponse{std::string(file->type), std::string(file->gzip), true, {}};
  }

  std::string options_text() const {
    DetectOptions options = current_options();
    return options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }

  DetectOptions current_options() const {
    const std::scoped_lock lock(mutex_);
    return options_;
  }

  std::vector<std::string> greet() {
    look_again();
    return {hello_message(facts_, labeller_->body()), options_message(current_options()), state()};
  }

  /// Does what a page asks for.
  std::optional<std::string> obey(const std::string& text) {
    using Action = std::function<void(const Json&)>;
    const std::map<std::string, Action> actions{
        {"play", [this](const Json&) { player_.play(); }},
        {"pause", [this](const Json&) { player_.pause(); }},
        {"step", [this](const Json& c) { player_.step(c.at("by").get<int>()); }},
        {"seek", [this](const Json& c) { player_.seek(c.at("to_s").get<double>()); }},
        {"speed", [this](const Json& c) { player_.set_speed(c.at("times").get<double>()); }},
        {"repeat", [this](const Json& c) { player_.set_repeat(c.at("on").get<bool>()); }},
        {"stages", [this](const Json& c) { show_stages(c.at("on").get<bool>()); }},
        {"record", [this](const Json& c) { want_recording(c.at("on").get<bool>()); }},
        {"set", [this](const Json& c) { change_option(c.at("option").get<std::string>(), c.at("value").dump()); }},
        {"reset", [this](const Json&) { change_options({}); }}};
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
    DetectOptions options = current_options();
    set_option(options, name, value);
    change_options(options);
  }

  void change_options(const DetectOptions& options) {
    Detector changed(labeller_, options);  // it knows best which options it can use
    {
      const std::scoped_lock lock(mutex_);
      options_ = options;
      changed_detector_ = std::move(changed);
    }
    server_.publish_text("options", options_message(options));
    look_again();
  }

  void show_stages(bool on) {
    {
      const std::scoped_lock lock(mutex_);
      state_.stages = on;
    }
    look_again();
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
      say(e.what());
      forget_recorder();
    }
  }

  /// Detects the last frame once more, where no other will come soon.
  void look_again() {
    if (player_.state().playing) return;
    std::optional<PlayedFrame> again;
    {
      const std::scoped_lock lock(mutex_);
      again = last_;
    }
    if (again) {
      again->arrived = Clock::now();
      played_.push_newest(std::move(*again));
    }
  }

  void take(PlayedFrame played) {
    {
      const std::scoped_lock lock(mutex_);
      last_ = played;
      missed_ = source_.missed();
      // Nobody would see the people.
      if (server_.clients() == 0 && !recording_wanted_) return;
    }
    const int dropped = played_.push_newest(std::move(played));
    const std::scoped_lock lock(mutex_);
    state_.dropped += dropped;
  }

  void detect_all() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    while (!played_.finished()) {
      std::optional<PlayedFrame> played = played_.pop(kPatience);
      if (!played) continue;
      try {
        if (!found_.push(detect(std::move(*played)))) return;
      } catch (const Error& e) {
        say(e.what());
      }
    }
  }

  Found detect(PlayedFrame played) {
    bool stages = false;
    {
      const std::scoped_lock lock(mutex_);
      stages = state_.stages;
      if (changed_detector_) detector_ = *std::exchange(changed_detector_, std::nullopt);
    }
    Found found{{}, played.arrived};
    ViewedFrame& viewed = found.viewed;
    if (stages) viewed.trace.emplace();
    viewed.people = detector_.detect(played.frame, viewed.trace ? &*viewed.trace : nullptr, &viewed.times);
    viewed.frame = std::move(played.frame);
    viewed.at_s = played.at_s;
    const Clock::time_point now = Clock::now();
    const double result_ms = milliseconds(now - found.arrived);
    if (viewed.frame.arrived_s) viewed.latency_ms = result_ms;
    const std::scoped_lock lock(mutex_);
    viewed.number = ++state_.frames;
    result_times_.add(result_ms);
    rate_now_.add(now);
    return found;
  }

  void deliver(const Found& found) {
    const ViewedFrame& viewed = found.viewed;
    if (server_.clients() > 0) {
      server_.publish_frame(frame_message(viewed, labeller_->body()), found.arrived);
    }
    if (!recorder_) return;
    guard_recorder([&] {
      recorder_->write(viewed.frame);
      recorder_->write_people(viewed.frame, viewed.people, labeller_->body(),
                              frame_json(viewed.frame, viewed.people, labeller_->body(), viewed.latency_ms));
      const std::scoped_lock lock(mutex_);
      ++state_.recorded;
    });
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
  const ViewerFacts facts_;
  const double rate_;

  mutable std::mutex mutex_;  ///< of what follows
  DetectOptions options_;
  std::optional<Detector> changed_detector_;
  ViewerState state_;
  RecentTimes result_times_, page_times_;
  RecentRate rate_now_;
  bool recording_wanted_ = false;
  int missed_ = 0;  ///< frames of a camera that nobody took
  std::optional<PlayedFrame> last_;

  std::optional<FrameRecorder> recorder_;  ///< of the caller's thread alone
  Detector detector_;                      ///< of the worker's thread alone
  FrameQueue<PlayedFrame> played_;
  FrameQueue<Found> found_;
  Player player_;
  WebServer server_;
  std::jthread worker_;
};

Viewer::Viewer(FrameSource& source, std::shared_ptr<const PixelLabeller> labeller, const DetectOptions& options,
               const ViewerOptions& viewer)
    : session_(std::make_unique<Session>(source, std::move(labeller), options, viewer)) {}

Viewer::~Viewer() = default;

std::uint16_t Viewer::port() const { return session_->port(); }

void Viewer::say(const std::string& line) { session_->say(line); }

void Viewer::run(const std::function<bool()>& stop) { session_->run(stop); }

}  // namespace vesalius
