#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/detect.h"
#include "vesalius/frame_source.h"
#include "vesalius/merge/find_poses.h"
#include "vesalius/merge/merge_people.h"
#include "vesalius/people_options.h"
#include "vesalius/track_people.h"

namespace vesalius {

/// One of the cameras beside the first, whose people are followed from frame to frame as far as it is asked.
class OtherCamera {
 public:
  OtherCamera(std::unique_ptr<FrameSource> source, const Detector& detector, const PeopleOptions& options);

  /// Goes on to the frame that is nearest to a time, in seconds as the first camera counts them, and returns the
  /// people in it; of a camera that is plugged in its newest. Nobody where none was taken within a quarter of a
  /// second. A time a second or more before the last one goes back where the source can, and follows people anew.
  /// Throws what reading and detecting throw.
  CameraPeople at(double time_s);

 private:
  struct Taken {
    Frame frame;
    double time_s;  ///< as the first camera counts
  };
  std::optional<Taken> read(double first_time_s);
  void take(const Taken& taken);
  void go_back(double time_s);

  std::unique_ptr<FrameSource> source_;
  const Detector* detector_;
  PeopleTracker tracker_;
  std::optional<double> offset_s_;  ///< what is added to the source's times; none before the first frame
  int read_ = 0;                    ///< frames
  std::optional<Taken> ahead_;      ///< read, but not looked at yet
  TrackedFrame people_;
  std::optional<double> people_s_;  ///< when they were seen
};

/// Returns when a frame was taken: as this machine got it from a camera that is plugged in, otherwise as its source
/// says, or `untimed_s` where it has no time. Seconds.
double moment_of(const Frame& frame, double untimed_s);

/// Several cameras about the same people, of which the first is read by somebody else.
class MergedCameras {
 public:
  MergedCameras(BodyModel body, std::vector<OtherCamera> others, std::vector<Eigen::Isometry3f> first_from);

  /// Returns the people of all cameras at the first one's frame, in whose picture they are, as PeopleMerger does, and
  /// why that one does not see what none of them observes. `time_s` is the frame's (moment_of). Throws as
  /// OtherCamera::at.
  TrackedFrame merge(const Frame& first, double time_s, TrackedFrame people);

 private:
  BodyModel body_;
  std::vector<OtherCamera> others_;
  PeopleMerger merger_;
};

/// What MergedCameras::merge does.
using MergePeople = std::function<TrackedFrame(const Frame& first, double time_s, TrackedFrame people)>;

/// Finds how cameras stand by the people whom they see: follows those of the first one's frames and of the others
/// until that is sure (PoseFinder::find) by half a minute of people whom several see, `stop` returns true, ten
/// minutes are over, or the frames end. `progress` gets how many moments there were. Returns nothing if it never was
/// sure.
std::optional<std::vector<FoundPose>> find_camera_poses(FrameSource& first, std::vector<OtherCamera> others,
                                                        const Detector& detector, const PeopleOptions& options,
                                                        const std::function<bool()>& stop,
                                                        const std::function<void(int)>& progress);

}  // namespace vesalius
