#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "commands/synth/synth_recipe.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/frame_source.h"

namespace vesalius::cli {

/// The sources of frames for `vesalius train`.
struct TrainSources {
  std::vector<std::string> data;         ///< folders that `vesalius synth` wrote
  std::vector<std::string> recipes;      ///< TOML files of recipes to render
  std::vector<std::string> backgrounds;  ///< sources of frames without people
  SourceOptions camera;                  ///< camera of the backgrounds
  int count = 0;  ///< most frames of each dataset, and number of frames of each recipe; 0 if not given
  std::uint64_t render_seed = 1;
  std::string body;  ///< path; if empty, the body of the first dataset, or the paper's
  AssetPlaces assets;
};

/// A source of frames with truth, which are read or rendered in any order.
struct TrainInput {
  std::string name;     ///< for messages
  std::string made_by;  ///< text of the recipe
  std::uint64_t seed = 0;
  std::uint64_t hash = 0;  ///< hash of the dataset that the frames form or would form (dataset/labelled_dataset.h)
  int frames = 0;
  int width = 0, height = 0;                ///< size of the first frame in pixels
  std::function<LabelledFrame(int)> frame;  ///< returns a frame by its number; any thread may call it
};

/// Opens a dataset or a folder of labelled frames, at most `count` of them if that is not 0. Where `body` is said to be
/// from nowhere, it becomes that of the frames. Throws Error for a folder that cannot be read, has no frames, or has
/// another body.
TrainInput open_labelled(const std::string& folder, int count, BodyModel& body, std::string& body_from);

/// A source of frames without people.
struct TrainBackground {
  std::string source;
  int frames = 0;             ///< -1 if it is not known before all are read
  int width = 0, height = 0;  ///< size of the first frame in pixels
};

/// Facts that are known after a background was read to its end.
struct BackgroundFacts {
  int frames = 0;
  std::string sha256;  ///< over cameras and depth
};

/// All sources of a training. They are open but not yet read.
class TrainInputs {
 public:
  /// Takes labelled frames that are open; `backgrounds` are opened. Throws Error as below.
  TrainInputs(BodyModel body, std::vector<TrainInput> inputs, const std::vector<std::string>& backgrounds,
              SourceOptions camera);
  /// Throws UsageError if neither data nor recipes are given or recipes lack a count. Throws Error for a source that
  /// cannot be opened, has no frame, or has another body than the others.
  explicit TrainInputs(const TrainSources& sources);

  const BodyModel& body() const { return body_; }
  const std::vector<TrainInput>& inputs() const { return inputs_; }
  const std::vector<TrainBackground>& backgrounds() const { return backgrounds_; }
  /// Returns the number of frames of all inputs, without backgrounds.
  std::int64_t frames() const;
  /// Remarks for the user, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

  using TakeFrame = std::function<void(const LabelledFrame&)>;

  /// Passes the frames of all backgrounds to `take`, in order and labelled as background. Throws Error naming a frame
  /// that cannot be read, and when the user interrupts.
  std::vector<BackgroundFacts> read_backgrounds(const TakeFrame& take) const;

  struct Selection {
    double share = 1.0;  ///< share of each input's frames, counted from its first
    /// Says whether a frame is wanted, by its number over all inputs. If empty, all frames are.
    std::function<bool(int)> wanted;
  };
  /// Reads or renders frames on all allowed threads and passes them on in order. Throws as read_backgrounds does.
  void read(const Selection& selection, const TakeFrame& take) const;

 private:
  void open_recipe(const std::string& file, const TrainSources& sources);
  void open_background(const std::string& source);

  SourceOptions background_camera_;
  BodyModel body_;
  std::string body_from_;  ///< the source of `body_`
  std::vector<TrainInput> inputs_;
  std::vector<TrainBackground> backgrounds_;
  std::vector<std::string> notes_;
};

}  // namespace vesalius::cli
