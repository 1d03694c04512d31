#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/derive_joints.h"
#include "vesalius/find_clusters.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/grow_person.h"
#include "vesalius/score_person.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

/// Second iteration and acceptance (section 7).
struct RefineOptions {
  bool second_pass = true;        ///< off: the rough skeleton and its grown mask are the result
  float area_scale = 0.5F;        ///< multiplies the smallest area of a part in the second pass
  int max_candidates = 12;        ///< most rough skeletons refined in one frame
  float rival_likelihood = 0.2F;  ///< rough skeletons of at least this likelihood a part grow against each other
  int min_parts = 6;              ///< fewest parts of a person after the second pass
  float min_score = 0.5F;         ///< lowest score of a person
  float max_overlap = 0.3F;       ///< share of its mask that a person may have in common with a surer one
};

struct DetectOptions {
  GridOptions grid;
  LabelOptions label;
  SmoothOptions smooth;
  ClusterOptions cluster;
  SearchOptions search;
  GrowOptions grow;
  RefineOptions refine;
  ScoreOptions score;  ///< with forests that have a background class
  ScoreOptions score_without_background = vesalius::score_without_background();  ///< with others
};
void visit_options(const std::string& prefix, DetectOptions& options, OptionVisitor& visitor);

/// Everything found about one person.
struct Person {
  Skeleton skeleton;                       ///< parts with 3-D centre, extent, confidence and state
  std::vector<std::vector<Joint>> joints;  ///< [joint set of the body model][joint]
  Mask mask;                               ///< 1 on the person's pixels
  LabelImage labels;                       ///< part of each of the person's pixels, kBackground elsewhere
  Box box;                                 ///< smallest around the mask
  float score = 0.F;                       ///< 0-1, higher is surer
};

/// Every intermediate of one detection, for pictures and evaluation. All pictures are of the frame's size; what
/// clusters count are pixels of the grid (GridOptions).
struct Trace {
  LabelImage raw_labels;        ///< pass 1, before smoothing
  LabelImage labels;            ///< pass 1, smoothed
  Clusters clusters;            ///< pass 1, of labels with the proposals' weight of the background
  std::vector<Skeleton> rough;  ///< pass 1, best first
  Mask flat;                    ///< pixels of floor, walls and other large flat surfaces

  /// A rough skeleton grown and refined; a rough skeleton has two where growing against its rivals differs from
  /// growing alone.
  struct Candidate {
    int rough = -1;  ///< index in `rough`
    Mask grown;
    LabelImage labels;  ///< pass 2, smoothed
    Skeleton refined;   ///< pass 2; found = 0 if there was none
    Evidence evidence;
    float score = 0.F;
    bool accepted = false;
  };
  std::vector<Candidate> candidates;  ///< surest first
};

class Workspaces;

/// The whole method: people of one frame. Keeps only memory between frames, and copies of it share that; safe to call
/// from several threads.
class Detector {
 public:
  /// Throws Error for an inconsistent forest, UsageError for an option outside its range.
  explicit Detector(Forest forest, DetectOptions options = {});
  explicit Detector(std::shared_ptr<const PixelLabeller> labeller, DetectOptions options = {});

  /// People in the frame, surest first; empty when nobody is in view. To `times` is added what each stage took. Throws
  /// Error for a frame whose images do not fit its camera.
  std::vector<Person> detect(const Frame& frame, Trace* trace = nullptr, StageTimes* times = nullptr) const;

  const BodyModel& body() const { return labeller_->body(); }

 private:
  std::vector<Person> detect_everywhere(const Frame& frame, Trace* trace, StageTimes* times) const;

  std::shared_ptr<const PixelLabeller> labeller_;
  DetectOptions options_;
  std::shared_ptr<Workspaces> workspaces_;
};

/// uint8 map of the people: index in `people`, kBackground elsewhere (of the frame's size).
Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height);

/// Part labels of all people in one picture, kBackground elsewhere.
LabelImage part_label_map(const std::vector<Person>& people, int width, int height);

}  // namespace vesalius
