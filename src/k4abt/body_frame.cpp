#include "k4abt/body_frame.h"

#include <algorithm>
#include <utility>

#include "vesalius/error.h"

namespace vesalius::k4abt {

BodyFrame::BodyFrame(CaptureReference capture, ImageReference depth, std::vector<k4abt_body_t> bodies,
                     Image<std::uint8_t> index_map)
    : capture_(std::move(capture)),
      device_usec_(k4a().image_get_device_timestamp_usec(depth.get())),
      system_nsec_(k4a().image_get_system_timestamp_nsec(depth.get())),
      bodies_(std::move(bodies)),
      pixels_(std::move(index_map)) {}

k4a_image_t BodyFrame::index_map() const {
  const std::scoped_lock lock(mutex_);
  if (picture_) return picture_.get();
  const int width = pixels_.width(), height = pixels_.height();
  k4a_image_t made = nullptr;
  if (k4a().image_create(K4A_IMAGE_FORMAT_CUSTOM8, width, height, width, &made) != K4A_RESULT_SUCCEEDED) {
    throw Error("libk4a makes no picture for the body index map");
  }
  picture_.reset(made);
  std::copy(pixels_.begin(), pixels_.end(), k4a().image_get_buffer(made));
  k4a().image_set_device_timestamp_usec(made, device_usec_);
  k4a().image_set_system_timestamp_nsec(made, system_nsec_);
  pixels_ = {};
  return made;
}

}  // namespace vesalius::k4abt
