#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/person.h"

namespace vesalius {

/// The true and the found people of one frame of a sequence.
struct TrackSample {
  std::vector<int> truth;      ///< id of each true person, no id twice
  std::vector<int> found;      ///< id of each found person, no id twice
  Eigen::MatrixXd similarity;  ///< [true person][found person], 0-1
};

/// Matches the people of one frame after the other, as CLEAR MOT does (K. Bernardin and R. Stiefelhagen 2008): a true
/// person stays with the id that it had last wherever that has a similarity of at least 0.5, and the others are paired
/// such that as many as possible are, and then such that the sum of similarities is the largest.
class TrackMatcher {
 public:
  /// Returns for each true person of the next frame the index of the found one, or -1. Throws Error for a similarity
  /// that is no number from 0 to 1 or a matrix of another size than the lists.
  std::vector<int> match(const TrackSample& sample);

 private:
  std::map<int, int> last_;  ///< the found id that each true id had last
};

/// What the frames of a sequence add to the metrics of tracks, [frame]. Throws Error as TrackMatcher does.
///
/// - CLEAR MOT by TrackMatcher: track.mota, missed, false, switches; ids of a true person.
/// - IDF1 (E. Ristani et al. 2016): one found id for each true one over the sequence, such that as many frames as
///   possible are right.
/// - HOTA, of DetA and AssA at the thresholds .05 to .95 (J. Luiten et al. 2021).
std::vector<MetricTerms> track_terms(const std::vector<TrackSample>& sequence);

/// The people of a frame who take part in the metrics of tracks.
struct TrackPeople {
  TrackSample sample;
  std::vector<std::size_t> truth;           ///< index in the frame of each true person of the sample
  std::vector<const TrackedPerson*> found;  ///< each found person of the sample
};

/// Returns the people of a frame who take part: the true ones who are expected to be found and the found ones with
/// pixels, without those who are neither right nor false (Match::Kind::ignored). With `hidden`, also all other true
/// people and those found ones who are hidden (TrackState); people without pixels are compared by the distance of their
/// trunks. Lost ones never take part. The frame's people are sorted (put_visible_people_first). Returns nothing if
/// there are true people whose ids are not known. The result is valid while `tracked` is.
std::optional<TrackPeople> track_people_of(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden);

/// Whether a found person has pixels in the frame.
bool has_pixels(const TrackedPerson& person);

}  // namespace vesalius
