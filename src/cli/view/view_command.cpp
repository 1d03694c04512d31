#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "console/detector_flags.h"
#include "console/interrupts.h"
#include "console/merge_flags.h"
#include "console/source_flags.h"
#include "console/text_sink.h"
#include "vesalius/base/keep_memory.h"
#include "vesalius/parallel.h"
#include "view/viewer.h"

namespace vesalius::cli {

namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  explicit ViewArguments(CLI::App& command) : detector(command) {}

  SourceFlags source;
  MergeFlags merge;
  DetectorFlags detector;
  std::string host = "127.0.0.1";
  int port = 8080;
  std::string folder;
  double rate = kUsualRate;
  int threads = 0;
  bool paused = false;
  bool no_track = false;
  bool no_browser = false;
  bool quiet = false;
};

/// Returns the numeric IPv4 addresses of this machine on its networks.
std::vector<std::string> network_addresses() {
  std::vector<std::string> found;
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return found;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr) found.emplace_back(text.data());
  }
  ::freeifaddrs(all);
  return found;
}

/// Returns the names by which browsers can ask for the page: where it listens at all addresses, those of the networks.
std::vector<std::string> names_of(const std::string& host) {
  if (host != "0.0.0.0" && host != "::") return {host.find(':') == host.npos ? host : "[" + host + "]"};
  std::vector<std::string> names = network_addresses();
  if (names.empty()) names.emplace_back("127.0.0.1");
  return names;
}

/// Opens the address in the user's browser if this is a desktop with one, and does not wait for it.
void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  // In a session of its own: Ctrl-C here must not end the user's browser.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string program = "xdg-open", argument = address;
  std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  // It may take as long as the browser runs.
  if (error == 0) std::thread([pid] { ::waitpid(pid, nullptr, 0); }).detach();
}

void check_folder(const std::string& folder) {
  std::error_code error;
  if (!folder.empty() && !fs::is_directory(folder, error)) {
    throw Error(folder + ": no such folder, expected one for recordings");
  }
}

/// Returns the folder below which the page may open other sources: that which was asked for, else that in which the
/// source lies.
std::string choice_of(const ViewArguments& arguments) {
  const std::string& name = arguments.source.name();
  if (!arguments.folder.empty()) return arguments.folder;
  if (is_camera(name)) return ".";
  std::error_code error;
  const fs::path path = fs::canonical(path_of_source(name), error);
  if (error) return ".";
  // Not the whole machine, because frames lie in a folder at its root.
  const fs::path around = path.parent_path();
  return around == path.root_path() && fs::is_directory(path, error) ? path.string() : around.string();
}

ViewerOptions viewer_options(const ViewArguments& arguments) {
  ViewerOptions options;
  options.web.host = arguments.host;
  options.web.port = static_cast<std::uint16_t>(arguments.port);
  options.web.access = web_access(arguments.host, is_loopback(arguments.host) ? "" : random_token());
  options.player.rate = arguments.rate;
  options.player.start_s = arguments.source.options().start_s.value_or(0.0);
  options.player.playing = !arguments.paused;
  options.say = [](const std::string& line) { say("vesalius: " + line); };
  options.track = !arguments.no_track;
  options.folder = arguments.folder.empty() ? "." : arguments.folder;
  if (!arguments.merge.asked()) options.choice = choice_of(arguments);
  options.reconnect = arguments.source.options().reconnect;
  options.source = arguments.source.name();
  options.model = fs::path(arguments.detector.model()).filename().string();
  return options;
}

void run_view(const ViewArguments& arguments) {
  check_folder(arguments.folder);
  arguments.merge.check(!arguments.no_track);
  keep_freed_memory();
  const ThreadLimit limit(arguments.threads);
  const PeopleOptions people = arguments.detector.options();
  const Model model = arguments.detector.loaded();
  // The page changes the first camera's options; those of the others stay as they are now.
  std::optional<Detector> others;
  std::optional<MergedCameras> cameras;
  if (arguments.merge.asked()) {
    others.emplace(model, people.detect);
    cameras.emplace(arguments.merge.make(arguments.source, *others, people, arguments.quiet));
  }
  std::atomic<Viewer*> page = nullptr;  // cameras speak in the player's thread
  const auto source = arguments.source.open(arguments.quiet, [&page](const std::string& line) {
    say(line);
    if (Viewer* const shown = page) shown->say(line);
  });
  ViewerOptions options = viewer_options(arguments);
  if (cameras) {
    options.merge = [&cameras](const Frame& frame, double time_s, TrackedFrame seen) {
      return cameras->merge(frame, time_s, std::move(seen));
    };
  }
  Viewer viewer(*source, model, people, options);
  page = &viewer;
  watch_interrupts();
  const std::string& token = options.web.access.token;
  std::string address;
  for (const std::string& name : names_of(arguments.host)) {
    address = fmt::format("http://{}:{}/{}", name, viewer.port(), token.empty() ? "" : "?token=" + token);
    print(address + "\n");
  }
  finish_stdout();
  if (!arguments.quiet) say("Open this address in a browser; Ctrl-C ends.");
  // A token would stand in the list of processes, which every user of this machine sees.
  if (!arguments.no_browser && token.empty()) open_browser(address);
  viewer.run(interrupted);
}

void add_page_flags(CLI::App& command, ViewArguments& arguments) {
  const std::string group = "Page";
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type)->capture_default_str()->group(group);
  };
  add("--host", arguments.host, "ADDRESS",
      "Address to listen at. Any but this machine's own lets others in who have the printed address with its token; "
      "0.0.0.0 is all");
  add("--port", arguments.port, "N", "Port to listen at; 0 = any that is free")->check(CLI::Range(0, 65535));
  command
      .add_option("--folder", arguments.folder,
                  "Folder for what the page records, and below which it may open other recordings and folders of "
                  "frames (default: this folder, and that in which SOURCE lies)")
      ->type_name("DIR")
      ->group(group);
  command.add_flag("--paused", arguments.paused, "Begin with the first frame and wait")->group(group);
  command.add_flag("--no-browser", arguments.no_browser, "Do not open a browser")->group(group);
}

}  // namespace

void add_view(CLI::App& program) {
  CLI::App* command = program.add_subcommand("view", "Show the people in a source, live, on a page in a browser");
  const auto arguments = std::make_shared<ViewArguments>(*command);
  add_page_flags(*command, *arguments);
  arguments->source.add_to(*command);
  arguments->merge.add_to(*command);
  add_threads_flag(*command, arguments->threads);
  command->add_flag("--no-track", arguments->no_track, "Find people in each frame alone, without ids");
  add_rate_flag(*command, arguments->rate, "Frames per second of a source without times");
  command->add_flag("-q,--quiet", arguments->quiet, "Print the address and errors only");
  command->footer(R"(
People are followed over the frames. The page shows the point cloud with skeletons, bodies and trails, the people and
their numbers, the stages of the method and every option of detector and tracking. It can open other sources, below
--folder alone. Nothing leaves this machine.

Examples:
  vesalius view frames/
  vesalius view realsense: --port 8081
  vesalius view session.mcap --host 0.0.0.0
  vesalius view frames/ --no-track)");
  command->callback([arguments] { run_view(*arguments); });
}

}  // namespace vesalius::cli
