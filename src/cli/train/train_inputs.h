#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/synth/synth_assets.h"
#include "io/sources/source_options.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"

namespace vesalius::cli {

/// Where `vesalius train` takes frames from.
struct TrainSources {
  std::vector<std::string> data;         ///< folders that `vesalius synth` wrote
  std::vector<std::string> recipes;      ///< TOML files of what to render
  std::vector<std::string> backgrounds;  ///< sources of frames without people
  SourceOptions camera;                  ///< of the backgrounds
  int count = 0;                         ///< most frames of each dataset and those of each recipe; 0: not given
  std::uint64_t render_seed = 1;
  std::string body;  ///< file; empty: the body of the first dataset, else the paper's
  AssetPlaces assets;
};

/// Frames with truth, read or rendered in any order.
struct TrainInput {
  std::string name;     ///< for messages
  std::string made_by;  ///< recipe, as text
  std::uint64_t seed = 0;
  std::uint64_t hash = 0;  ///< of the dataset that they are, or would be (io/labelled_dataset.h)
  int frames = 0;
  int width = 0, height = 0;                ///< pixels; of the first frame
  std::function<LabelledFrame(int)> frame;  ///< by number, from any thread
};

/// A source of frames without people.
struct TrainBackground {
  std::string source;
  int frames = 0;             ///< -1: not known before all are read
  int width = 0, height = 0;  ///< pixels; of the first frame
};

/// What reading it to the end showed.
struct BackgroundFacts {
  int frames = 0;
  std::string sha256;  ///< over cameras and depth
};

/// All that a forest is trained from: opened, not yet read.
class TrainInputs {
 public:
  /// Throws UsageError where neither data nor recipes are given or recipes lack a count, Error for what cannot be
  /// opened, has no frame, or has another body than the rest.
  explicit TrainInputs(const TrainSources& sources);

  const BodyModel& body() const { return body_; }
  const std::vector<TrainInput>& inputs() const { return inputs_; }
  const std::vector<TrainBackground>& backgrounds() const { return backgrounds_; }
  /// Of all inputs; backgrounds come on top.
  std::int64_t frames() const;
  /// What a user should know, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

  using TakeFrame = std::function<void(const LabelledFrame&)>;

  /// Hands over the frames of all backgrounds, in order, labelled as such. Throws Error naming what cannot be read, and
  /// when the user interrupts.
  std::vector<BackgroundFacts> read_backgrounds(const TakeFrame& take) const;

  struct Selection {
    double share = 1.0;               ///< of each input, its first frames
    std::function<bool(int)> wanted;  ///< asked for each frame's number over all inputs; empty: all
  };
  /// Reads or renders on all threads allowed and hands over in order. Throws likewise.
  void read(const Selection& selection, const TakeFrame& take) const;

 private:
  template <class Reader>
  void open_labelled(std::shared_ptr<const Reader> reader, int count, TrainInput input);
  void open_dataset(const std::string& folder, int count);
  void open_recipe(const std::string& file, const TrainSources& sources);
  void open_background(const std::string& source);

  SourceOptions background_camera_;
  BodyModel body_;
  std::string body_from_;  ///< names what `body_` is of
  std::vector<TrainInput> inputs_;
  std::vector<TrainBackground> backgrounds_;
  std::vector<std::string> notes_;
};

}  // namespace vesalius::cli
