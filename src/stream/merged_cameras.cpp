#include "stream/merged_cameras.h"

#include <cmath>
#include <exception>
#include <utility>

#include "vesalius/detect_stream.h"
#include "vesalius/explain_unseen.h"
#include "vesalius/merge/carry_people.h"

namespace vesalius {
namespace {

constexpr double kTogether_s = 0.25;      // two frames of one moment are at most so far apart
constexpr double kDay_s = 24.0 * 3600.0;  // clocks that are further apart count from other moments
constexpr double kBack_s = 1.0;
constexpr int kEnough = 150;  // moments with people whom several see: half a minute
constexpr int kAsk = 25;      // moments between two tries

}  // namespace

double moment_of(const Frame& frame, double untimed_s) {
  return frame.arrived_s ? *frame.arrived_s : frame.time_s.value_or(untimed_s);
}

OtherCamera::OtherCamera(std::unique_ptr<FrameSource> source, const Detector& detector, const PeopleOptions& options)
    : source_(std::move(source)), detector_(&detector), tracker_(make_tracker(detector, options)) {}

std::optional<OtherCamera::Taken> OtherCamera::read(double first_time_s) {
  std::optional<Frame> frame = source_->next();
  if (!frame) return std::nullopt;
  const double time_s = moment_of(*frame, read_++ / kUsualRate);
  // Recordings that count from their own beginnings began together, as far as anybody knows.
  if (!offset_s_) offset_s_ = std::abs(time_s - first_time_s) > kDay_s ? first_time_s - time_s : 0.0;
  return Taken{std::move(*frame), time_s + *offset_s_};
}

void OtherCamera::take(const Taken& taken) {
  people_ = follow(*detector_, tracker_, taken.frame);
  people_s_ = taken.time_s;
}

void OtherCamera::go_back(double time_s) {
  const std::optional<TimeSpan> span = source_->span();
  if (!span) return;
  source_->seek(time_s - offset_s_.value_or(0.0));
  tracker_ = tracker_.restarted();
  ahead_.reset();
  people_s_.reset();
}

CameraPeople OtherCamera::at(double time_s) {
  if (source_->is_live()) {
    if (const std::optional<Taken> newest = read(time_s)) take(*newest);
  } else {
    if (people_s_ && time_s < *people_s_ - kBack_s) go_back(time_s);
    if (!ahead_) ahead_ = read(time_s);
    const auto is_nearer = [&] {
      return !people_s_ || std::abs(ahead_->time_s - time_s) <= std::abs(*people_s_ - time_s);
    };
    while (ahead_ && is_nearer()) {
      take(*ahead_);
      ahead_ = read(time_s);
    }
  }
  if (!people_s_ || std::abs(time_s - *people_s_) > kTogether_s) return {};
  return {people_, time_s - *people_s_};
}

MergedCameras::MergedCameras(BodyModel body, std::vector<OtherCamera> others, std::vector<Eigen::Isometry3f> first_from)
    : body_(std::move(body)), others_(std::move(others)), merger_(std::move(first_from)) {}

TrackedFrame MergedCameras::merge(const Frame& first, double time_s, TrackedFrame people) {
  std::vector<CameraPeople> seen(1);
  seen[0].people = std::move(people);
  for (OtherCamera& other : others_) seen.push_back(other.at(time_s));
  TrackedFrame merged = merger_.merge(std::move(seen));
  explain_unseen(first, body_, merged);
  return merged;
}

std::optional<std::vector<FoundPose>> find_camera_poses(FrameSource& first, std::vector<OtherCamera> others,
                                                        const Detector& detector, const PeopleOptions& options,
                                                        const std::function<bool()>& stop,
                                                        const std::function<void(int)>& progress) {
  PoseFinder finder(others.size() + 1);
  std::optional<std::vector<FoundPose>> poses;
  int asked = 0, number = 0;
  const auto take = [&](const FoundFrame& found) {
    if (found.error) std::rethrow_exception(found.error);
    const double time_s = moment_of(*found.frame, number++ / kUsualRate);
    std::vector<TrackedFrame> seen = {found.people};
    for (OtherCamera& other : others) {
      CameraPeople people = other.at(time_s);
      for (TrackedPerson& person : people.people.people) {
        carry(person, Eigen::Isometry3f::Identity(), float(people.behind_s));
      }
      seen.push_back(std::move(people.people));
    }
    finder.add(time_s, seen);
    progress(finder.shared_moments());
    if (finder.is_full()) return false;  // cameras that are plugged in do not end
    if (finder.shared_moments() < kEnough + asked * kAsk) return true;
    ++asked;
    poses = finder.find();
    return !poses;
  };
  PeopleTracker tracker = make_tracker(detector, options);
  StreamOptions stream;
  stream.stop = stop;
  stream_frames(first, detector, tracker, stream, take);
  return poses ? poses : finder.find();
}

}  // namespace vesalius
