#include "view/recording.h"

#include <fmt/chrono.h>

#include <ctime>
#include <filesystem>

#include "vesalius/frame_source.h"
#include "vesalius/person_json.h"

namespace vesalius {
namespace {

std::string new_path(const std::string& folder) {
  const std::string stem = fmt::format("vesalius-{:%Y%m%d-%H%M%S}", fmt::localtime(std::time(nullptr)));
  std::error_code ignored;
  for (int i = 1;; ++i) {
    const auto path = std::filesystem::path(folder) / (i == 1 ? stem + ".mcap" : fmt::format("{}-{}.mcap", stem, i));
    if (!std::filesystem::exists(path, ignored)) return path.string();
  }
}

}  // namespace

Recording::Recording(const std::string& folder, double rate)
    : path_(new_path(folder)), file_(path_, rate), rate_(rate) {}

void Recording::add_frame(const ViewedFrame& viewed, const BodyModel& body) {
  if (viewed.at_s <= up_to_s_) return;
  Frame frame = *viewed.frame;
  if (!frame.time_s) frame.time_s = viewed.at_s * kUsualRate / rate_;
  file_.write(frame);
  file_.write_people(frame, viewed.people, body, frame_json(frame, viewed.people, body, viewed.latency_ms));
  up_to_s_ = viewed.at_s;
  ++frames_;
}

}  // namespace vesalius
