#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/statistics.h"

namespace vesalius {

/// Everything that an evaluation measures (docs/metrics.md), in the order in which all reports show it. Metrics marked
/// as families have a parameter: a posture, a range, a body part or a joint.
enum class Metric {
  people_found,
  people_false,
  empty_with_person,
  posture,      ///< family
  distance,     ///< family
  heading,      ///< family
  visible,      ///< family
  stature,      ///< family
  roll,         ///< family
  score_right,  ///< family
  mask_iou,
  mask_iou_where_found,
  part_seen,  ///< family
  part_mean_seen,
  part_right_of_4,  ///< family
  part_right_of_8,  ///< family
  parts_right,
  parts_right_upper,
  missing_right,
  given_right,
  given_mirrored,
  given_right_heading,     ///< family
  given_mirrored_heading,  ///< family
  sides_swapped,
  sides_swapped_heading,  ///< family
  sides_order,
  sides_order_heading,  ///< family
  sides_order_arms,
  sides_order_arms_heading,  ///< family
  yaw_right,
  yaw_right_heading,     ///< family
  yaw_right_confidence,  ///< family
  pixel_person_iou,
  pixel_background_iou,
  pixel_recall,  ///< family
  pixel_mean_recall,
  pixel_recall_inside,  ///< family
  pixel_mean_recall_inside,
  body_on_empty,
  joint_at_10cm,  ///< family
  joints_at_10cm,
  joint_error,  ///< family
  joints_error,
  joints_given_right,
  joints_given_right_heading,  ///< family
  joints_swapped,
  joints_seen_at_10cm,
  joints_seen_error,
  joints_hidden_at_10cm,
  joints_hidden_error,
  joints_right_confidence,         ///< family
  joints_seen_right_confidence,    ///< family
  joints_hidden_right_confidence,  ///< family
  unseen_right,
  unseen_right_confidence,  ///< family
  unseen_given,             ///< family
  joint_up,                 ///< family
  joint_up_placed,          ///< family
  centre_at_10cm,           ///< family
  centres_at_10cm,
  track_mota,
  track_missed,
  track_false,
  track_switches,
  track_ids,
  track_idf1,
  track_hota,
  track_det_a_at,  ///< family
  track_ass_a_at,  ///< family
  joints_jitter,
  joints_true_jitter,
  bones_error,
  bones_spread,
  stance_right,
  stance_given,  ///< family
};

enum class MetricUnit { share, per_frame, per_person, metres, millimetres, mm_per_s2 };
enum class MetricDirection { higher_is_better, lower_is_better, nearer_zero_is_better };
/// How a metric is computed from the terms of its frames, which determines its interval.
enum class MetricKind {
  trials,  ///< share of independent trials, with Wilson's interval
  ratio,   ///< ratio of two sums over the frames, with the bootstrap's interval
  mean,    ///< mean over the members of the family `mean_of`, with the bootstrap's interval
};

struct MetricInfo {
  Metric metric;
  std::string_view name;  ///< name in files; '*' stands for the parameter of a family
  std::string_view title;
  MetricUnit unit = MetricUnit::share;
  MetricDirection direction = MetricDirection::higher_is_better;
  MetricKind kind = MetricKind::ratio;
  std::optional<Metric> mean_of = std::nullopt;
  /// If given, the mean is that of the roots of the products of each of its members and that of `mean_of`, 0 if there
  /// is none.
  std::optional<Metric> times = std::nullopt;

  constexpr bool is_family() const { return name.find('*') != std::string_view::npos; }
};

/// The names, titles and kinds of all metrics, in the order of `Metric`. No other place has them.
inline constexpr auto kMetrics = [] {
  using enum MetricUnit;
  using enum MetricDirection;
  using enum MetricKind;
  using M = Metric;
  return std::to_array<MetricInfo>({
      {M::people_found, "people.found", "people found", share, higher_is_better, trials},
      {M::people_false, "people.false", "false people", per_frame, lower_is_better},
      {M::empty_with_person, "frames.empty_with_person", "empty frames with somebody", share, lower_is_better, trials},
      {M::posture, "posture.*", "found by posture", share, higher_is_better, trials},
      {M::distance, "distance.*", "found by distance", share, higher_is_better, trials},
      {M::heading, "heading.*", "found by heading", share, higher_is_better, trials},
      {M::visible, "visible.*", "found by parts visible", share, higher_is_better, trials},
      {M::stature, "stature.*", "found by stature", share, higher_is_better, trials},
      {M::roll, "roll.*", "found by camera roll", share, higher_is_better, trials},
      {M::score_right, "score.right_at.*", "people among proposals by score", share, higher_is_better, trials},
      {M::mask_iou, "mask.iou", "mask IoU with misses"},
      {M::mask_iou_where_found, "mask.iou_where_found", "mask IoU where found"},
      {M::part_seen, "part.seen.*", "parts seen", share, higher_is_better, trials},
      {M::part_mean_seen, "part.mean_seen", "parts seen on average", share, higher_is_better, mean, M::part_seen},
      {M::part_right_of_4, "part.right_of_4.*", "right, found with 4 parts", share, higher_is_better, trials},
      {M::part_right_of_8, "part.right_of_8.*", "right, found with 8 parts", share, higher_is_better, trials},
      {M::parts_right, "parts.right", "visible parts right"},
      {M::parts_right_upper, "parts.right_upper", "visible upper parts right"},
      {M::missing_right, "missing.right", "parts not observed that are predicted right"},
      {M::given_right, "given.right", "given-out parts right"},
      {M::given_mirrored, "given.mirrored", "given-out parts mirrored", share, lower_is_better},
      {M::given_right_heading, "given.right.*", "given-out parts right by heading"},
      {M::given_mirrored_heading, "given.mirrored.*", "given-out parts mirrored by heading", share, lower_is_better},
      {M::sides_swapped, "sides.swapped", "people with swapped sides", share, lower_is_better, trials},
      {M::sides_swapped_heading, "sides.swapped.*", "swapped sides by heading", share, lower_is_better, trials},
      {M::sides_order, "sides.order", "pairs in order"},
      {M::sides_order_heading, "sides.order.*", "pairs in order by heading"},
      {M::sides_order_arms, "sides.order_arms", "arms in order"},
      {M::sides_order_arms_heading, "sides.order_arms.*", "arms in order by heading"},
      {M::yaw_right, "yaw.right", "yaw within 45 degrees", share, higher_is_better, trials},
      {M::yaw_right_heading, "yaw.right.*", "yaw within 45 degrees by heading", share, higher_is_better, trials},
      {M::yaw_right_confidence, "yaw.right_at.*", "yaw within 45 degrees by its confidence", share, higher_is_better,
       trials},
      {M::pixel_person_iou, "pixels.person_iou", "person IoU of labels"},
      {M::pixel_background_iou, "pixels.background_iou", "background IoU of labels"},
      {M::pixel_recall, "pixels.recall.*", "recall with background"},
      {M::pixel_mean_recall, "pixels.mean_recall", "mAcc", share, higher_is_better, mean, M::pixel_recall},
      {M::pixel_recall_inside, "pixels.recall_inside.*", "recall among parts"},
      {M::pixel_mean_recall_inside, "pixels.mean_recall_inside", "mAcc among parts", share, higher_is_better, mean,
       M::pixel_recall_inside},
      {M::body_on_empty, "pixels.body_on_empty", "body on empty frames", share, lower_is_better},
      {M::joint_at_10cm, "joint.*.at_10cm", "within 10 cm", share, higher_is_better, trials},
      {M::joints_at_10cm, "joints.at_10cm", "joints at 10 cm"},
      {M::joint_error, "joint.*.error_m", "mean error", metres, lower_is_better},
      {M::joints_error, "joints.error_m", "mean error of joints", metres, lower_is_better},
      {M::joints_given_right, "joints.given_right", "given-out joints right"},
      {M::joints_given_right_heading, "joints.given_right.*", "given-out joints right by heading"},
      {M::joints_swapped, "joints.swapped", "people with swapped joints", share, lower_is_better, trials},
      {M::joints_seen_at_10cm, "joints.seen.at_10cm", "seen joints at 10 cm"},
      {M::joints_seen_error, "joints.seen.error_m", "mean error of seen joints", metres, lower_is_better},
      {M::joints_hidden_at_10cm, "joints.hidden.at_10cm", "hidden joints at 10 cm"},
      {M::joints_hidden_error, "joints.hidden.error_m", "mean error of hidden joints", metres, lower_is_better},
      {M::joints_right_confidence, "joints.right_at.*", "joints right by confidence"},
      {M::joints_seen_right_confidence, "joints.seen.right_at.*", "seen joints right by confidence"},
      {M::joints_hidden_right_confidence, "joints.hidden.right_at.*", "hidden joints right by confidence"},
      {M::unseen_right, "unseen.right", "reasons of unseen joints right"},
      {M::unseen_right_confidence, "unseen.right_at.*", "reasons of unseen joints right by confidence"},
      {M::unseen_given, "unseen.given.*", "reason given by the true one", share, higher_is_better, trials},
      {M::joint_up, "joint.*.up_mm", "too high", millimetres, nearer_zero_is_better},
      {M::joint_up_placed, "joint.*.placed_up_mm", "too high where placed", millimetres, nearer_zero_is_better},
      {M::centre_at_10cm, "centre.*.at_10cm", "centre within 10 cm", share, higher_is_better, trials},
      {M::centres_at_10cm, "centres.at_10cm", "parts' centres at 10 cm"},
      {M::track_mota, "track.mota", "MOTA"},
      {M::track_missed, "track.missed", "missed by tracks", share, lower_is_better},
      {M::track_false, "track.false", "false by tracks", per_frame, lower_is_better},
      {M::track_switches, "track.switches", "id switches", per_person, lower_is_better},
      {M::track_ids, "track.ids", "ids", per_person, lower_is_better},
      {M::track_idf1, "track.idf1", "IDF1"},
      {M::track_hota, "track.hota", "HOTA", share, higher_is_better, mean, M::track_ass_a_at, M::track_det_a_at},
      {M::track_det_a_at, "track.det_a.at_*", "DetA by threshold"},
      {M::track_ass_a_at, "track.ass_a.at_*", "AssA by threshold"},
      {M::joints_jitter, "joints.jitter_mm_s2", "jitter", mm_per_s2, lower_is_better},
      {M::joints_true_jitter, "joints.true_jitter_mm_s2", "jitter of the truth", mm_per_s2, lower_is_better},
      {M::bones_error, "bones.error", "error of bones' lengths", share, lower_is_better},
      {M::bones_spread, "bones.spread", "spread of bones' lengths", share, lower_is_better},
      {M::stance_right, "stance.right", "stances right", share, higher_is_better, trials},
      {M::stance_given, "stance.given.*", "stance given by the true one", share, higher_is_better, trials},
  });
}();

static_assert(
    [] {
      for (std::size_t i = 0; i < kMetrics.size(); ++i) {
        if (kMetrics[i].metric != static_cast<Metric>(i)) return false;
      }
      return kMetrics.size() == static_cast<std::size_t>(Metric::stance_given) + 1;
    }(),
    "kMetrics is in the order of Metric");

constexpr const MetricInfo& info(Metric metric) { return kMetrics[static_cast<std::size_t>(metric)]; }

/// One metric, or one member of a family.
struct MetricId {
  Metric metric{};
  int place = 0;          ///< index of the parameter in its family, e.g. the part's; 0 for other metrics
  std::string parameter;  ///< e.g. "l_hand"; empty for other metrics

  MetricId(Metric m) : metric(m) {}  // NOLINT(google-explicit-constructor): a metric without a parameter is one
  MetricId(Metric m, int place_in_family, std::string of)
      : metric(m), place(place_in_family), parameter(std::move(of)) {}

  /// Returns the name in files: "joint.l_hand.at_10cm".
  std::string name() const;
};

/// Returns the metric of that name, or nothing for a name that is not in kMetrics. For a member of a family `place`
/// stays 0.
std::optional<MetricId> parse_metric(std::string_view name);

/// Returns "higher", "lower" or "zero", the word in files for the better values.
const char* better_word(Metric metric);

/// Returns a value in its unit: "97.20 %", "0.041 m", "0.013 a frame", "+12 mm",
/// "1.20 a person", "5100 mm/s^2".
std::string metric_text(Metric metric, double value);
/// Returns a difference of two values: "+1.20 %", "-0.003 m", "+0.013".
std::string metric_difference_text(Metric metric, double difference);
/// Returns how many decimals these texts have.
int metric_digits(Metric metric);

/// The term that one frame adds to a metric. Every metric is a ratio of two sums over the frames, or a mean of such
/// ratios.
struct MetricTerm {
  MetricId id;
  double numerator = 0.0;
  double denominator = 1.0;
};
using MetricTerms = std::vector<MetricTerm>;

/// A metric of a set of frames.
struct Estimate {
  MetricId id;
  double value = 0.0;
  Interval interval{};
  double numerator = 0.0;
  double denominator = 0.0;
  std::vector<double> replicates{};  ///< kReplicates values of the resampled set; NaN if it had no term
};

/// Returns the estimate of a metric, for a family the one with that parameter; null if there is none.
const Estimate* find_estimate(const std::vector<Estimate>& estimates, Metric metric, std::string_view parameter = "");

/// Returns an estimate's value with its interval: "97.20 % (95.10 to 98.40)".
std::string text_with_interval(const Estimate& estimate);

/// Sums the terms of a set's frames. Its size does not depend on their number.
class MetricTable {
 public:
  /// Adds a frame; `key` names it (frame_key). Throws Error for a term that is not finite.
  void add(std::uint64_t key, const MetricTerms& terms);
  /// Returns the metrics whose denominators are not 0, and the means of families, in the order of kMetrics.
  std::vector<Estimate> estimates() const;
  /// Returns a hash of the frames that were added, whatever their order.
  std::uint64_t frames_key() const { return frames_key_; }

 private:
  struct Sums {
    int place = 0;  ///< the smallest place given for this member of a family
    double numerator = 0.0;
    double denominator = 0.0;
    std::array<double, kReplicates> numerators{};
    std::array<double, kReplicates> denominators{};
  };

  static Estimate estimate(MetricId id, const Sums& sums);
  std::vector<Estimate> estimates_of(Metric metric) const;

  std::map<std::pair<Metric, std::string>, Sums> sums_;  ///< by metric and parameter
  std::uint64_t frames_key_ = 0;
};

/// One metric of two evaluations.
struct Comparison {
  /// What is said of the second one; same if the interval of the difference contains 0.
  enum class Verdict { better, worse, same };
  MetricId id;
  double first = 0.0;
  double second = 0.0;
  double difference = 0.0;  ///< second - first
  Interval interval{};      ///< 95 % interval of the difference
  Verdict verdict = Verdict::same;
};

/// Compares two estimates of one metric. If `paired` is true, both saw the same frames: their resamples are then the
/// same, and the interval is that of the resampled difference. Otherwise it is Newcombe's interval of a difference of
/// independent estimates (method 10 of R. G. Newcombe 1998).
Comparison compare(const Estimate& first, const Estimate& second, bool paired);

/// Compares every metric that both have, in the order of kMetrics.
std::vector<Comparison> compare_common(const std::vector<Estimate>& first, const std::vector<Estimate>& second,
                                       bool paired);

/// Returns "better", "worse" or "same".
const char* verdict_word(Comparison::Verdict verdict);

}  // namespace vesalius
