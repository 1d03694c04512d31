// People in frames of one's own making, as lines of JSON: MODEL. A camera's source looks the same: next() waits for a
// frame.

#include <exception>
#include <iostream>
#include <optional>

#include "io/model/model_file.h"
#include "stream/detect_stream.h"
#include "stream/person_json.h"
#include "synth/generate.h"
#include "vesalius/vesalius.h"

namespace {

/// Six rendered frames.
class RenderedSource : public vesalius::FrameSource {
 public:
  std::optional<vesalius::Frame> next() override {
    if (index_ == size()) return std::nullopt;
    vesalius::Frame frame = generator_.frame(static_cast<std::uint64_t>(index_)).frame;
    frame.name = "rendered_" + std::to_string(index_++);
    return frame;
  }
  int size() const override { return 6; }

 private:
  static vesalius::synth::Recipe recipe() {
    vesalius::synth::Recipe recipe;
    recipe.body.count = 3;
    recipe.sensor.width = 160;
    recipe.sensor.height = 120;
    return recipe;
  }

  vesalius::synth::Generator generator_{recipe(), {}, vesalius::paper_body(), 1};
  int index_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const vesalius::Detector detector(vesalius::load_model(argv[1]));
  RenderedSource source;
  vesalius::stream_frames(source, detector, {}, [&](const vesalius::FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    std::cout << vesalius::frame_json(*found.frame, found.people, detector.body()) << '\n';
    return true;
  });
}
