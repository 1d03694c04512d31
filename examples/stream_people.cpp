// People in frames of one's own making, as lines of JSON: MODEL FRAMES. A camera's source looks the same: next() waits
// for a frame.

#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "vesalius/detect.h"
#include "vesalius/detect_stream.h"
#include "vesalius/model_file.h"
#include "vesalius/open_source.h"
#include "vesalius/person_json.h"

namespace {

constexpr int kFarthest_mm = 4000;

/// The frames of another source without what is far away.
class NearSource : public vesalius::FrameSource {
 public:
  explicit NearSource(std::unique_ptr<vesalius::FrameSource> source) : source_(std::move(source)) {}

  std::optional<vesalius::Frame> next() override {
    std::optional<vesalius::Frame> frame = source_->next();
    if (!frame) return std::nullopt;
    for (std::uint16_t& depth_mm : frame->depth) {
      if (depth_mm > kFarthest_mm) depth_mm = 0;
    }
    return frame;
  }
  int size() const override { return source_->size(); }

 private:
  std::unique_ptr<vesalius::FrameSource> source_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const vesalius::Detector detector(vesalius::load_model(argv[1]));
  NearSource source(vesalius::open_source(argv[2]));
  vesalius::stream_frames(source, detector, {}, [&](const vesalius::FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    std::cout << vesalius::frame_json(*found.frame, found.people, detector.body()) << '\n';
    return true;
  });
}
