#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "stream/frame_queue.h"
#include "vesalius/frame_source.h"
#include "view/source_choice.h"

namespace vesalius {

/// A source that was opened for a page.
struct OpenedSource {
  std::string name;
  std::shared_ptr<FrameSource> frames;
};

/// Lists and opens sources for pages on a thread of its own: a large recording or a camera takes long to open.
class SourceOpener {
 public:
  struct Outputs {
    std::function<void(const std::string& message)> listed;  ///< receives what sources_message tells
    std::function<void(const std::string& line)> say;        ///< receives notes and why something cannot be opened
  };

  /// Both outputs are called in the opener's thread, and `say` in that of a camera that is lost and comes back.
  /// `reconnect` says whether that is waited for.
  SourceOpener(SourceChoice choice, bool reconnect, Outputs outputs);
  ~SourceOpener();
  SourceOpener(const SourceOpener&) = delete;
  SourceOpener& operator=(const SourceOpener&) = delete;

  // Both return at once, false where too much waits already.
  bool list(const std::string& folder);
  bool open(const std::string& wish);

  /// Returns the source that was opened last, once; nothing if there is none that is not taken.
  std::optional<OpenedSource> take();

 private:
  void work();
  void open_now(const std::string& wish);

  const SourceChoice choice_;
  const bool reconnect_;
  const Outputs outputs_;
  FrameQueue<std::function<void()>> wishes_;
  std::mutex mutex_;
  std::optional<OpenedSource> opened_;
  std::jthread thread_;
};

}  // namespace vesalius
