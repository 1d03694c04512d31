#include "view/source_opener.h"

#include <chrono>
#include <exception>
#include <utility>
#include <vector>

#include "vesalius/base/quiet_thread.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"
#include "view/viewer_messages.h"

namespace vesalius {
namespace {

constexpr std::size_t kMostWishes = 4;  // that wait
constexpr std::chrono::milliseconds kWishPatience(200);

/// An error may list below its line what a folder holds.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

SourceOpener::SourceOpener(SourceChoice choice, bool reconnect, Outputs outputs)
    : choice_(std::move(choice)), reconnect_(reconnect), outputs_(std::move(outputs)), wishes_(kMostWishes) {
  thread_ = quiet_thread([this] { work(); });
}

SourceOpener::~SourceOpener() { wishes_.close(); }

void SourceOpener::work() {
  while (!wishes_.finished()) {
    const auto wish = wishes_.pop(kWishPatience);
    if (!wish) continue;
    try {
      (*wish)();
    } catch (const std::exception& e) {  // the source that is shown goes on
      outputs_.say(first_line(e.what()));
    }
  }
}

bool SourceOpener::list(const std::string& folder) {
  return wishes_.try_push([this, folder] {
    try {
      // Drivers take long to look for cameras: once, where a page begins to choose.
      const std::vector<SensorInfo> cameras = folder.empty() ? choice_.cameras() : std::vector<SensorInfo>();
      outputs_.listed(sources_message(choice_.list(folder), cameras));
    } catch (const Error& e) {
      outputs_.listed(no_sources_message(folder, first_line(e.what())));
    }
  });
}

bool SourceOpener::open(const std::string& wish) {
  return wishes_.try_push([this, wish] { open_now(wish); });
}

void SourceOpener::open_now(const std::string& wish) {
  const std::string name = choice_.source(wish);
  SourceOptions options;
  options.reconnect = reconnect_ && is_camera(name);
  options.say = outputs_.say;
  OpenedSource opened{name, open_source(name, options)};
  for (const std::string& note : opened.frames->notes()) outputs_.say("note: " + note);
  const std::scoped_lock lock(mutex_);
  opened_ = std::move(opened);
}

std::optional<OpenedSource> SourceOpener::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(opened_, std::nullopt);
}

}  // namespace vesalius
