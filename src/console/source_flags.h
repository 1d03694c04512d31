#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "vesalius/open_source.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vesalius::cli {

/// Adds the flags for what the files of SOURCE may not state: --fx --fy --cx --cy --depth-scale --camera --colour
/// --depth-topic --colour-topic --depth-bits.
void add_camera_flags(CLI::App& command, SourceOptions& options);

/// Adds --turn, by which pictures become upright.
void add_turn_flag(CLI::App& command, SourceOptions& options);

/// Adds --start, the first frame of SOURCE to take.
void add_start_flag(CLI::App& command, SourceOptions& options);

/// SOURCE, with these flags and --reconnect, of a command that may look at a camera for long.
class SourceFlags {
 public:
  /// Adds them to a command, as long as which this object must live. If `required` is false, SOURCE may be left out.
  void add_to(CLI::App& command, bool required = true);

  /// Opens the source. Its notes are printed unless `quiet`; `say` gets what a camera says later. Throws as
  /// open_source.
  std::unique_ptr<FrameSource> open(bool quiet, std::function<void(const std::string&)> say) const;
  /// Opens another source with the same facts, of a camera of the same kind, from its beginning.
  std::unique_ptr<FrameSource> open_other(const std::string& name, bool quiet) const;
  const std::string& name() const { return name_; }
  const SourceOptions& options() const { return options_; }

 private:
  std::string name_;
  SourceOptions options_;
};

/// Adds --frames: after how many to end; 0 = all.
void add_frames_flag(CLI::App& command, int& frames);

/// Adds --rate, in frames per second. `what` is its help.
CLI::Option* add_rate_flag(CLI::App& command, double& rate, const std::string& what);

/// Adds --track and --no-track: whether people are followed over the frames. Nothing said: FrameSource::is_sequence.
void add_track_flag(CLI::App& command, std::optional<bool>& track);

/// Adds --threads; 0 = all.
void add_threads_flag(CLI::App& command, int& threads);

/// Adds the flag `name` that says whose places somebody gets: "floor", as long as it is not given, or "camera". `whose`
/// begins its text.
CLI::Option* add_places_flag(CLI::App& command, const std::string& name, bool& on_floor, const std::string& whose);

/// The text of --help on what SOURCE may be.
inline constexpr const char* kSourceHelp =
    "Frames: a folder (depth/*.png with meta.json or camera_info.yaml, TUM RGB-D, PNG or PCD files), a 16-bit depth "
    "PNG, an organised PCD file, a recording (MCAP, ROS 1 .bag, ROS 2 .db3, .mkv), or a camera that "
    "`vesalius cameras` lists; tum:FOLDER and similar prefixes state the kind";

}  // namespace vesalius::cli
