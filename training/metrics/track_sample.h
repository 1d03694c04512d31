#pragma once

#include <optional>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/track_metrics.h"
#include "vesalius/person.h"

namespace vesalius {

/// How similar two people are by their trunks: 1 at one place, falling to 0 at this distance in metres.
inline constexpr double kTrunkReach_m = 1.0;

/// What the similarity of a true and a found person is made of, in a frame.
enum class SimilarityKind {
  masks,   ///< IoU of masks: the pixels of each true person are known
  trunks,  ///< distance of trunks (kTrunkReach_m): joints or parts are known, but no pixels
  counts,  ///< 1 for everybody who is where people are, as far as is known (match_people); otherwise 0
};
SimilarityKind similarity_kind(const FrameTruth& truth);

/// Returns the middle of a true person's trunk: the mean of the joints of shoulders, hips, spine and trunk that are
/// known, or of all joints, or of the parts; nothing if none is known.
std::optional<Eigen::Vector3f> true_trunk(const FrameTruth& truth, std::size_t person);

/// The people of a frame who take part in the metrics of tracks.
struct TrackPeople {
  TrackSample sample;
  std::vector<std::size_t> truth;           ///< index in the frame of each true person of the sample
  std::vector<const TrackedPerson*> found;  ///< each found person of the sample
};

/// Returns the people of a frame who take part: the true ones who are expected to be found and the found ones with
/// pixels, without those who are neither right nor false (Match::Kind::ignored). With `hidden`, also all other true
/// people and those found ones who are hidden (TrackState); people without pixels are compared by their trunks. Lost
/// ones never take part. The frame's people are sorted (put_visible_people_first). Returns nothing if there are true
/// people whose ids are not known. The result is valid while `tracked` is.
std::optional<TrackPeople> track_people_of(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden);

/// Whether a found person has pixels in the frame.
bool has_pixels(const TrackedPerson& person);

}  // namespace vesalius
