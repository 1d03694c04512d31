#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "metrics/metric_table.h"

namespace vesalius {

/// Least similarity at which a found person can be a true one (CLEAR MOT, IDF1).
inline constexpr double kTrackSimilarity = 0.5;

/// The true and the found people of one frame of a sequence.
struct TrackSample {
  std::vector<int> truth;      ///< id of each true person, no id twice
  std::vector<int> found;      ///< id of each found person, no id twice
  Eigen::MatrixXd similarity;  ///< [true person][found person], 0-1
};

/// Matches the people of one frame after the other, as CLEAR MOT does (K. Bernardin and R. Stiefelhagen 2008): a true
/// person stays with the id that it had last wherever that has at least kTrackSimilarity, and the others are paired
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
std::vector<MetricTerms> track_terms(const std::vector<TrackSample>& sequence);

}  // namespace vesalius
