#include "io/sources/list_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/sources/frame_times.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

template <class T>
void check_size(const Image<T>& image, const Camera& camera, const std::string& path, const char* expected) {
  if (image.width() == camera.width && image.height() == camera.height) return;
  throw Error(fmt::format("{}: {}x{} pixels, expected {}, {}x{}", path, image.width(), image.height(), expected,
                          camera.width, camera.height));
}

class ListSource final : public FrameSource {
 public:
  explicit ListSource(FrameList list) : reader_(std::move(list)) {}

  std::optional<Frame> next() override {
    if (next_ == reader_.size()) return std::nullopt;
    return reader_.read(next_++);
  }
  int size() const override { return int(reader_.size()); }
  std::optional<TimeSpan> span() const override { return TimeSpan{time_of(0), time_of(reader_.size() - 1)}; }
  void seek(double time_s) override {
    next_ = first_not_before(time_s, reader_.size(), [this](std::size_t i) { return time_of(i); });
  }
  std::vector<std::string> notes() const override { return reader_.list().notes; }

 private:
  double time_of(std::size_t index) const { return reader_.list().frames[index].time_s.value_or(usual_time_s(index)); }

  FrameListReader reader_;
  std::size_t next_ = 0;
};

}  // namespace

FrameListReader::FrameListReader(FrameList list) : list_(std::move(list)) {
  const Image<std::uint16_t> first = read_png16(list_.frames.front().depth);
  CameraFacts& facts = list_.facts;
  const CameraFacts& fallback = list_.fallback;
  if (!facts.fx && facts.sensor.empty() && fallback.fx && fallback.width == first.width() &&
      fallback.height == first.height()) {
    facts.fill_from(fallback);
    list_.notes.push_back(fmt::format("{}: no intrinsics given; those of {} assumed", list_.place, fallback.origin));
  }
  const bool registered = std::any_of(list_.frames.begin(), list_.frames.end(),
                                      [](const FrameFiles& files) { return !files.colour.empty(); });
  camera_ = resolve_camera(facts, first.width(), first.height(), registered, list_.place, list_.notes);
  rectification_ = make_rectification(facts.distorted, camera_);
  units_per_m_ = facts.depth_scale.value_or(list_.default_scale);
}

Frame FrameListReader::read(std::size_t index, bool with_colour) const {
  const FrameFiles& files = list_.frames[index];
  const Image<std::uint16_t> stored = read_png16(files.depth);
  check_size(stored, camera_, files.depth, "the size of the first");
  Frame frame{files.name, files.time_s, camera_, to_millimetres(stored, units_per_m_), {}};
  if (with_colour && !files.colour.empty()) {
    frame.colour = read_colour(files.colour);
    check_size(frame.colour, camera_, files.colour, "the size of the depth");
    if (rectification_) frame.colour = rectification_->colour(frame.colour);
  }
  if (rectification_) frame.depth = rectification_->depth(frame.depth);
  return frame;
}

std::unique_ptr<FrameSource> open_list(FrameList list) { return std::make_unique<ListSource>(std::move(list)); }

DepthImage to_millimetres(const Image<std::uint16_t>& stored, float units_per_m) {
  if (units_per_m == 1000.F) return stored;
  const double mm_per_unit = 1000.0 / units_per_m;
  DepthImage depth(stored.width(), stored.height());
  std::transform(stored.begin(), stored.end(), depth.begin(), [mm_per_unit](std::uint16_t units) {
    const double mm = std::round(units * mm_per_unit);
    return mm > std::numeric_limits<std::uint16_t>::max() ? std::uint16_t{0} : static_cast<std::uint16_t>(mm);
  });
  return depth;
}

}  // namespace vesalius
