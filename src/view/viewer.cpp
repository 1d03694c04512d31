#include "view/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "io/files/options_file.h"
#include "stream/frame_queue.h"
#include "stream/turn_hint.h"
#include "vesalius/base/quiet_thread.h"
#include "vesalius/error.h"
#include "view/frame_message.h"
#include "view/happenings.h"
#include "view/people_files.h"
#include "view/people_finder.h"
#include "view/people_log.h"
#include "view/source_opener.h"
#include "view/viewer_messages.h"

namespace vesalius {
namespace {

// CMake writes the bytes of bundle/*.gz.
#include "bundle_bytes.inc"

template <std::size_t size>
std::string_view text(const unsigned char (&bytes)[size]) {
  return {reinterpret_cast<const char*>(bytes), size};
}

/// A file of the page, compressed by gzip.
struct BundleFile {
  std::string_view path;  ///< what a browser asks for, e.g. "/view.js"
  std::string_view type;  ///< MIME type
  std::string_view gzip;
};

/// Returns the files of the page.
const std::vector<BundleFile>& bundle_files() {
  static const std::vector<BundleFile> files{{"/", "text/html; charset=utf-8", text(k_index_html)},
                                             {"/view.css", "text/css; charset=utf-8", text(k_view_css)},
                                             {"/view.js", "text/javascript; charset=utf-8", text(k_view_js)}};
  return files;
}

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using Settings = PeopleFinder::Settings;

constexpr std::chrono::milliseconds kPatience(50);      // time between questions whether to stop
constexpr std::chrono::milliseconds kStatePause(200);   // between states while no frame comes
constexpr std::chrono::milliseconds kSoon(200);         // a frame that plays is followed by another
constexpr std::chrono::milliseconds kHappenPause(500);  // between messages of what happened
constexpr std::size_t kMedianOf = 30;
constexpr std::size_t kMostRecent = 1000;
constexpr const char* kOptionsPath = "/options.toml";

/// The times that the last frames took.
class RecentTimes {
 public:
  void add_time(Clock::time_point when, double ms) {
    last_.emplace_back(when, ms);
    if (last_.size() > kMostRecent) last_.pop_front();
  }
  /// Returns the median of the last ones in milliseconds.
  std::optional<double> median() const {
    std::vector<double> ms;
    for (auto i = last_.rbegin(); i != last_.rend() && ms.size() < kMedianOf; ++i) ms.push_back(i->second);
    if (ms.empty()) return std::nullopt;
    const auto middle = ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2);
    std::ranges::nth_element(ms, middle);
    return *middle;
  }
  /// Returns how many there were in the last second.
  double per_s(Clock::time_point now) const {
    const auto is_recent = [&](const auto& one) { return one.first >= now - std::chrono::seconds(1); };
    return double(std::ranges::count_if(last_, is_recent));
  }

 private:
  std::deque<std::pair<Clock::time_point, double>> last_;
};

/// A value that threads share: nobody reaches it without its lock.
template <class T>
class Guarded {
 public:
  explicit Guarded(T value = {}) : value_(std::move(value)) {}

  template <class Use>
  auto with(Use use) {
    const std::scoped_lock lock(mutex_);
    return use(value_);
  }
  T get() {
    return with([](const T& value) { return value; });
  }

 private:
  std::mutex mutex_;
  T value_;
};

/// A source and what plays it.
struct Playing {
  Playing(std::shared_ptr<FrameSource> frames, const PlayerOptions& options, Player::Outputs outputs)
      : source(std::move(frames)), player(*source, options, std::move(outputs)) {}

  const std::shared_ptr<FrameSource> source;
  Player player;
};

/// A frame to be looked at, once more if `again` is true.
struct Job {
  int source = 0;  ///< number of the source that it is of
  std::shared_ptr<const PlayedFrame> played;
  Settings settings;
  Clock::time_point arrived;
  bool again = false;
};
struct Found {
  int source = 0;
  ViewedFrame viewed;
  Settings settings;
  Clock::time_point arrived;
  bool again = false;
};

/// What the next job is made of.
struct Now {
  int source = 0;
  Settings settings;
  std::shared_ptr<const PlayedFrame> last;  ///< the frame that was shown last
};

/// What every thread counts.
struct Figures {
  ViewerState state;
  RecentTimes result, page;
  int missed = 0;  ///< frames of a camera that nobody took
};

}  // namespace

/// Four threads are at work: the player's in `look_at`, the server's in the handlers, the finder's in `find_all`, the
/// caller's in `run`, which also puts another source in place of the one that is played. What only one of them needs is
/// a variable there (the finder, the recording); frames, settings and people pass from one to the next in queues.
class Viewer::Session {
 public:
  Session(FrameSource& source, Model model, const PeopleOptions& options, const ViewerOptions& viewer)
      : model_(std::move(model)),
        first_options_(options),
        player_options_(viewer.player),
        track_(viewer.track),
        merges_(viewer.merge != nullptr),
        say_(viewer.say),
        facts_({viewer.source, viewer.model, viewer.folder, viewer.track}),
        now_({0, settings(options), nullptr}),
        log_(std::make_shared<PeopleLog>(model_.body, viewer.player.rate)),
        playing_(std::make_shared<Playing>(std::shared_ptr<FrameSource>(&source, [](FrameSource*) {}), viewer.player,
                                           outputs())),
        server_(viewer.web, handlers()) {
    if (!viewer.choice.empty()) {
      SourceChoice choice(viewer.choice);
      facts_.with([&](ViewerFacts& facts) { facts.choice = choice.folder(); });
      opener_.emplace(std::move(choice), viewer.reconnect,
                      SourceOpener::Outputs{[this](const std::string& list) { server_.publish_text("sources", list); },
                                            [this](const std::string& line) { tell(line); }});
    }
    const auto finder = std::make_shared<PeopleFinder>(now_.get().settings, track_, viewer.merge);
    worker_ = quiet_thread([this, finder] { find_all(*finder); });
    server_.start();
    playing()->player.start();
  }

  /// The player tells the server and the server the player; so its thread ends before either is gone.
  ~Session() {
    jobs_.close();
    found_.close();
    playing()->player.stop();
  }

  std::uint16_t port() const { return server_.port(); }
  void say(const std::string& line) { server_.publish_text("", notice_message(line)); }

  void run(const std::function<bool()>& stop) {
    std::optional<PageRecording> recording;
    std::string failure;
    const auto record = [&](const std::optional<Found>& found, bool wanted) {
      try {
        if (recording && found && !found->again) recording->add_frame(found->viewed, model_.body);
        if (recording && !wanted) {
          complete(*recording);
          recording.reset();
        }
        if (!recording && wanted) recording.emplace(facts_.get().folder, player_options_.rate);
      } catch (const Error& e) {
        recording.reset();
        recording_wanted_ = false;
        failure = e.what();
        tell(failure);
      }
      figures_.with([&](Figures& figures) {
        figures.state.recording = recording ? recording->path() : "";
        if (recording) figures.state.recorded = recording->frames();
      });
    };
    int source = 0;
    Clock::time_point last_state;
    while (!stop() && !ended_by_.get()) {
      std::optional<Found> found = found_.pop(kPatience);
      if (std::optional<OpenedSource> opened = opener_ ? opener_->take() : std::nullopt) {
        recording_wanted_ = false;
        record(found, false);
        change_source(std::move(*opened), ++source);
      }
      if (found && found->source != source) found.reset();  // nobody is to take it for one of this source
      if (!found && Clock::now() < last_state + kStatePause) continue;
      if (found) publish(*found);
      if (found) remember(*found);
      record(found, recording_wanted_);
      tell_happenings();
      if (server_.clients() > 0) server_.publish_text("state", state());
      last_state = Clock::now();
    }
    record(std::nullopt, false);
    if (const std::exception_ptr why = ended_by_.get()) std::rethrow_exception(why);
    if (!failure.empty()) throw Error("not all was recorded: " + failure);
  }

 private:
  using Wish = std::function<void(ClientWishes)>;

  std::shared_ptr<Playing> playing() { return playing_.get(); }

  /// Says a line on all pages and in the program's own place.
  void tell(const std::string& line) {
    say(line);
    if (say_) say_(line);
  }

  void complete(PageRecording& recording) {
    recording.close();
    std::error_code unknown;
    const std::filesystem::path path = std::filesystem::absolute(recording.path(), unknown).lexically_normal();
    const std::uintmax_t bytes = std::filesystem::file_size(path, unknown);
    figures_.with([&](Figures& figures) {
      figures.state.saved = SavedRecording{path.string(), recording.frames(), unknown ? 0 : bytes};
    });
  }

  /// Plays another source from now on; `number` is its own.
  void change_source(OpenedSource opened, int number) {
    playing()->player.stop();  // nothing comes from the one before any more
    PlayerOptions options = player_options_;
    options.start_s = 0.0;
    now_.with([number](Now& now) {
      now.source = number;
      now.last.reset();
    });
    const int after = figures_.with([](Figures& figures) {
      figures.state.dropped = figures.missed = 0;
      return figures.state.frames;
    });
    const auto next = std::make_shared<Playing>(std::move(opened.frames), options, outputs());
    const auto before = playing_.with([&](auto& playing) { return std::exchange(playing, next); });
    facts_.with([&](ViewerFacts& facts) {
      facts.source = opened.name;
      facts.after = after;
    });
    log_.with([&](auto& log) { log = std::make_shared<PeopleLog>(model_.body, player_options_.rate); });
    happenings_ = {};
    happenings_told_ = {};
    server_.publish_text("", hello_message(facts_.get(), model_.body));
    server_.publish_text("state", state());
    tell_happenings();
    next->player.start();
  }

  Player::Outputs outputs() {
    return {[this](PlayedFrame played) { look_at(std::move(played)); }, [this](const std::string& why) { say(why); },
            [this](std::exception_ptr why) { ended_by_.with([&](auto& ended_by) { ended_by = std::move(why); }); },
            [this] { server_.publish_text("state", state()); }};
  }

  WebHandlers handlers() {
    return {[this](const std::string& path) { return get(path); },
            [](const std::string& path) { return path == "/view.css" || path == "/view.js"; },
            [this] { return greet(); }, [this](const std::string& text, const Wish& wish) { return obey(text, wish); },
            [this](std::chrono::duration<double> since) {
              figures_.with([&](Figures& figures) { figures.page.add_time(Clock::now(), 1e3 * since.count()); });
            }};
  }

  std::optional<WebResponse> get(const std::string& path) {
    if (path == kOptionsPath) {
      PeopleOptions options = current_options();
      const std::string text = options_toml([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
      return WebResponse{"application/toml", text, false, "options.toml"};
    }
    if (auto people = people_response(log_.get(), path)) return people;
    const auto& files = bundle_files();
    const auto file = std::ranges::find(files, path, &BundleFile::path);
    if (file == files.end()) return std::nullopt;
    return WebResponse{std::string(file->type), std::string(file->gzip), true, {}};
  }

  PeopleOptions current_options() { return now_.get().settings->options; }

  std::string options_now() { return options_message(current_options(), first_options_, track_); }

  std::vector<std::string> greet() {
    look_again();
    return {hello_message(facts_.get(), model_.body), options_now(), state(), happened_.get()};
  }

  /// Does what a page asks for.
  std::optional<std::string> obey(const std::string& text, const Wish& wish) {
    using Action = std::function<void(const Json&)>;
    const std::shared_ptr<Playing> shown = playing();
    Player& player = shown->player;
    const std::map<std::string, Action> actions{
        {"play", [&](const Json&) { player.play(); }},
        {"pause", [&](const Json&) { player.pause(); }},
        {"step", [&](const Json& c) { player.step(c.at("by").get<double>() < 0.0 ? -1 : 1); }},
        {"seek", [&](const Json& c) { player.seek(c.at("to_s").get<double>()); }},
        {"speed", [&](const Json& c) { player.set_speed(c.at("times").get<double>()); }},
        {"repeat", [&](const Json& c) { player.set_repeat(c.at("on").get<bool>()); }},
        {"loop",
         [&](const Json& c) {
           const Json& between = c.at("between_s");
           std::optional<TimeSpan> loop;
           if (!between.is_null()) loop = {between.at(0).get<double>(), between.at(1).get<double>()};
           player.set_loop(loop);
         }},
        {"list", [this](const Json& c) { expect_taken(opener().list(c.at("folder").get<std::string>())); }},
        {"open", [this](const Json& c) { expect_taken(opener().open(c.at("source").get<std::string>())); }},
        {"stages",
         [&](const Json& c) {
           const bool on = c.at("on").get<bool>();
           wish({on});
           if (on) look_again(true);
         }},
        {"record", [this](const Json& c) { recording_wanted_ = c.at("on").get<bool>(); }},
        {"set",
         [this](const Json& c) {
           PeopleOptions options = current_options();
           set_option(options, c.at("option").get<std::string>(), c.at("value").dump());
           change_options(options);
         }},
        {"reset", [this](const Json&) { change_options(first_options_); }}};
    try {
      const Json command = Json::parse(text);
      const auto action = actions.find(command.at("do").get<std::string>());
      if (action == actions.end()) return notice_message("unknown command: " + text.substr(0, 100));
      action->second(command);
    } catch (const Error& e) {
      tell_options();  // the page shows the refused value
      return notice_message(e.what());
    } catch (const Json::exception& e) {
      return notice_message(fmt::format("not a command: {}", e.what()));
    }
    return std::nullopt;
  }

  /// Throws Error where pages may not open sources.
  SourceOpener& opener() {
    if (!opener_) throw Error("several cameras are shown as one, so that no other source can be opened");
    return *opener_;
  }

  static void expect_taken(bool taken) {
    if (!taken) throw Error("sources are still being opened, expected one after the other");
  }

  void change_options(const PeopleOptions& options) {
    const Settings changed = settings(options);
    now_.with([&](Now& now) { now.settings = changed; });
    tell_options();
    look_again();
  }

  void tell_options() { server_.publish_text("options", options_now()); }

  /// Throws UsageError for options that the detector cannot use.
  Settings settings(const PeopleOptions& options) const {
    return std::make_shared<const FinderSettings>(FinderSettings{options, Detector(model_, options.detect)});
  }

  void look_at(PlayedFrame played) {
    const auto frame = std::make_shared<const PlayedFrame>(std::move(played));
    const int missed = playing()->source->missed();
    const int dropped = now_.with([&](Now& now) {
      now.last = frame;
      // Nobody would see the people.
      if (server_.clients() == 0 && !recording_wanted_) return 0;
      return jobs_.push_newest({now.source, frame, now.settings, frame->arrived, false});
    });
    figures_.with([&](Figures& figures) {
      figures.missed = missed;
      figures.state.dropped += dropped;
    });
  }

  /// Looks at the last frame once more, where no other will come soon or somebody wants more of it.
  void look_again(bool surely = false) {
    const bool plays = playing()->player.state().playing;
    now_.with([&](const Now& now) {
      if (!now.last || (plays && !surely && Clock::now() < now.last->arrived + kSoon)) return;
      jobs_.push_newest({now.source, now.last, now.settings, Clock::now(), true});
    });
  }

  void find_all(PeopleFinder& finder) {
    TurnHint hint(now_.get().settings->detector);
    const auto tell_hint = [this](const std::optional<std::string>& note) {
      if (note) tell(*note);
    };
    int source = 0;
    while (!jobs_.finished()) {
      const std::optional<Job> job = jobs_.pop(kPatience);
      if (!job) {
        if (!playing()->player.state().playing) tell_hint(hint.finish());
        continue;
      }
      try {
        if (std::exchange(source, job->source) != job->source) {
          finder.begin_anew();
          hint = TurnHint(job->settings->detector);
        }
        ViewedFrame viewed = finder.find(job->played, job->settings, server_.clients_for_details() > 0);
        tell_hint(hint.add(*viewed.frame, merges_ || !viewed.people.people.empty()));
        const Clock::time_point now = Clock::now();
        const double result_ms = std::chrono::duration<double, std::milli>(now - job->arrived).count();
        if (viewed.frame->arrived_s) viewed.latency_ms = result_ms;
        figures_.with([&](Figures& figures) {
          figures.state.frames = viewed.number;
          figures.result.add_time(now, result_ms);
        });
        if (!found_.push({source, std::move(viewed), job->settings, job->arrived, job->again})) return;
      } catch (const std::exception& e) {  // no frame may end the program
        say(e.what());
      }
    }
  }

  void publish(const Found& found) {
    if (server_.clients() == 0) return;
    FrameMessages messages = frame_messages(found.viewed, model_.body);
    server_.publish_frame(std::move(messages.plain), std::move(messages.with_stages), found.arrived);
  }

  /// Keeps what is found, for files and for those who look later. In the caller's thread alone.
  void remember(const Found& found) {
    const ViewedFrame& viewed = found.viewed;
    if (found.settings != remembered_) ++settings_number_;
    remembered_ = found.settings;
    const std::shared_ptr<PeopleLog> log = log_.get();
    const bool had_all = log->forgotten() == 0;
    log->add(viewed, settings_number_);
    if (had_all && log->forgotten() > 0) {
      say(fmt::format("{} MB of people are kept to be saved; from now on the first ones are forgotten",
                      log->most_bytes() >> 20U));
    }
    const TrackOptions& track = found.settings->options.track;
    const double track_rate = viewed.frame->time_s ? 1.0 : kUsualRate / double(track.rate);
    happenings_.add(viewed.at_s, viewed.people, track_rate, double(track.gap_s));
  }

  void tell_happenings() {
    const Clock::time_point now = Clock::now();
    if (now < happenings_told_ + kHappenPause) return;
    happenings_told_ = now;
    std::string text = happenings_message(happenings_);
    const bool is_new = happened_.with([&](std::string& told) { return std::exchange(told, text) != text; });
    if (is_new) server_.publish_text("happened", std::move(text));
  }

  std::string state() {
    const PlayerState player = playing()->player.state();
    const int clients = server_.clients();
    const ViewerState now = figures_.with([clients](Figures& figures) {
      ViewerState state = figures.state;
      state.frames_per_s = figures.result.per_s(Clock::now());
      state.dropped += figures.missed;
      state.result_ms = figures.result.median();
      state.page_ms = figures.page.median();
      state.clients = clients;
      return state;
    });
    return state_message(now, player);
  }

  const Model model_;
  const PeopleOptions first_options_;
  const PlayerOptions player_options_;
  const bool track_;
  const bool merges_;  ///< whether other cameras' people are there, without anybody's guesses
  const std::function<void(const std::string&)> say_;

  Guarded<ViewerFacts> facts_;
  Guarded<Now> now_;
  Guarded<Figures> figures_;
  Guarded<std::exception_ptr> ended_by_;  ///< why a camera gives nothing more
  std::atomic<bool> recording_wanted_ = false;
  Guarded<std::shared_ptr<PeopleLog>> log_;  ///< of the source that is open
  // Of the caller's thread alone:
  Settings remembered_;  ///< those of the frame that was remembered last
  int settings_number_ = 0;
  Happenings happenings_;
  Clock::time_point happenings_told_;
  Guarded<std::string> happened_{happenings_message({})};  ///< the newest message of what happened
  FrameQueue<Job> jobs_{1};
  FrameQueue<Found> found_{1};
  Guarded<std::shared_ptr<Playing>> playing_;
  WebServer server_;
  std::optional<SourceOpener> opener_;
  std::jthread worker_;
};

Viewer::Viewer(FrameSource& source, Model model, const PeopleOptions& options, const ViewerOptions& viewer)
    : session_(std::make_unique<Session>(source, std::move(model), options, viewer)) {}

Viewer::~Viewer() = default;

std::uint16_t Viewer::port() const { return session_->port(); }

void Viewer::say(const std::string& line) { session_->say(line); }

void Viewer::run(const std::function<bool()>& stop) { session_->run(stop); }

}  // namespace vesalius
