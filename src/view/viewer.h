#pragma once

#include <functional>
#include <memory>
#include <string>

#include "stream/merged_cameras.h"
#include "vesalius/frame_source.h"
#include "vesalius/model.h"
#include "vesalius/track_people.h"
#include "view/player.h"
#include "view/web_server.h"

namespace vesalius {

struct ViewerOptions {
  WebServerOptions web;
  PlayerOptions player;
  bool track = true;         ///< whether people are followed over frames
  MergePeople merge = {};    ///< adds the people of other cameras to those who are followed; empty for one camera
  std::string folder = ".";  ///< where recordings are written
  std::string choice;        ///< folder below which the page may open other sources; empty: it may not
  bool reconnect = false;    ///< whether a camera that the page opened is waited for when it is lost
  std::string source;        ///< its name, for the page
  std::string model;         ///< its name, for the page
  /// Gets a line where a recording fails, or a camera that the page opened is lost or back; may be empty. Called in
  /// several threads.
  std::function<void(const std::string&)> say = {};
};

/// Finds the people in a source, follows them, and shows them on a page. Four threads: one plays the source, one
/// detects, the caller's packs the results, one serves them. Each takes the newest that the one before it has, so that
/// the page shows what is now, and a busy machine drops frames, which are counted. A page may open another source in
/// place of this one, which a fifth thread does; people are others then.
class Viewer {
 public:
  /// Listens and begins to play. Throws Error if it cannot listen or there is no folder to choose from, UsageError for
  /// an option outside its range.
  Viewer(FrameSource& source, Model model, const PeopleOptions& options, const ViewerOptions& viewer);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  std::uint16_t port() const;

  /// Shows a line on all pages. May be called from any thread.
  void say(const std::string& line);

  /// Serves until `stop`, which is asked every 50 ms, returns true. Throws what ended a camera, and Error at the end if
  /// a recording failed.
  void run(const std::function<bool()>& stop);

 private:
  class Session;
  std::unique_ptr<Session> session_;
};

}  // namespace vesalius
