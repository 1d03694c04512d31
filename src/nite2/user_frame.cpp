#include "nite2/user_frame.h"

#include <utility>

namespace vesalius::nite2 {

UserFrame::UserFrame(OniFrameReference depth, std::vector<NiteUserData> users, std::vector<NiteUserId> map)
    : depth_(std::move(depth)), users_(std::move(users)), map_(std::move(map)) {
  frame_.userCount = int(users_.size());
  frame_.pUser = users_.data();
  frame_.userMap = {map_.data(), depth_->width, depth_->height, depth_->width * int(sizeof(NiteUserId))};
  frame_.pDepthFrame = depth_.get();
  frame_.timestamp = depth_->timestamp;
  frame_.frameIndex = depth_->frameIndex;
}

void UserFrame::set_floor(const NitePlane& floor) {
  frame_.floor = floor;
  frame_.floorConfidence = 1.F;
}

}  // namespace vesalius::nite2
