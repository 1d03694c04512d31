#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/image.h"

namespace vesalius {

/// One class of the labelling, e.g. "l_knee". Left and right are the person's own.
struct BodyPart {
  std::string name;
  Rgb colour;
  int mirror = -1;              ///< index of the partner on the other side; itself for parts on the middle line
  float max_extent_m = 0.F;     ///< largest feasible length (section 5), metres
  float typical_area_m2 = 0.F;  ///< visible area of an unoccluded adult part, square metres
  bool upper_body = false;      ///< one of the parts above the pelvis (section 8.3)
};

/// Two parts that touch, and the distance of their centres (section 6, d_m).
struct BodyLink {
  int parent = -1;
  int child = -1;
  float length_m = 0.F;
  float tolerance_m = 0.F;  ///< deviation that counts as one unit of normalised distance
};

/// A point derived from part centres: the weighted mean of the present ones, e.g. a wrist between forearm and hand.
struct JointDefinition {
  std::string name;
  std::vector<int> parts;      ///< empty if this body cannot supply a joint of the set
  std::vector<float> weights;  ///< same length as parts; need not be positive (extrapolation), sums to 1
  float depth_offset_m = 0.F;  ///< added along the viewing ray: from the visible surface into the body
  float up_offset_m = 0.F;     ///< added along the body's axis, towards the head (body_up)
};

/// Joints under the names and in the order that another tracker uses, e.g. "nite15".
struct JointSet {
  std::string name;
  std::vector<JointDefinition> joints;
};

/// The triangles of a synthetic body's surface that belong to a part: those that move with `bone` of the synthetic
/// skeleton and lie from `from` to `to` along it. Places before the bone's head or beyond its tail count as 0 or 1.
struct SurfaceRule {
  /// Half of the body, which its middle plane divides. Left is the person's own.
  enum class Side { both, left, right };

  int part = -1;
  std::string bone;  ///< name in synth's skeleton, e.g. "l_thigh"; synth checks it
  float from = 0.F;  ///< 0 is the bone's head (nearer to the trunk), 1 its tail
  float to = 1.F;    ///< greater than `from`
  Side side = Side::both;
  int line = 0;  ///< line of the body's TOML, for messages
};

/// How the centres of the visible surfaces of parts lie to each other in a population of bodies and poses: a point
/// distribution model (Cootes et al. 1995), a Gaussian with few factors. Its axes are those of a mean body.
struct PartDistribution {
  struct Part {
    std::array<float, 3> mean_m{};
    std::array<std::vector<float>, 3> factors_m;  ///< [axis][factor]: what a standard deviation of the factor adds
    float residual_m = 0.F;                       ///< standard deviation along an axis that the factors leave
    float depth_m = 0.F;  ///< by which the centre of its volume lies behind that of its surface, along the viewing ray
    float observed_m = 0.F;  ///< standard deviation along an axis of its observed centre beside its votes; 0: exact
  };
  /// Logit of the probability that a predicted part lies within 10 cm of the truth: bias + slope * log(sigma in m).
  struct Confidence {
    float bias = 0.F;
    float slope = 0.F;
  };

  int factors = 0;
  float noise_m = 0.F;  ///< standard deviation along an axis of an observed centre
  Confidence confidence;
  std::optional<Confidence> voted_confidence;  ///< the same where pixels vote for parts; none: votes do not count
  std::vector<Part> parts;  ///< one for each part of the body, or none: the distribution is not known
};

/// The body as data: parts, kinematic tree, joints. Read from TOML (docs/formats.md); nothing else in the program
/// knows how many parts there are or what they are called.
struct BodyModel {
  std::string name;
  std::vector<BodyPart> parts;
  std::vector<BodyLink> links;  ///< a tree over all parts
  std::vector<int> roots;       ///< parts from which a search may start, the most reliable first
  std::vector<JointSet> joint_sets;
  PartDistribution distribution;
  std::vector<SurfaceRule> surface;  ///< for training on synthetic people; may be empty: detection needs none
  std::string toml;                  ///< the text this was read from, embedded in model files

  int part_count() const { return int(parts.size()); }
  /// Returns the index of the part of that name, or -1 if there is none.
  int find_part(std::string_view part_name) const;
};

/// Parses and checks a body model; `source` is named in errors. Throws Error with line and expectation.
BodyModel parse_body_model(std::string_view toml, const std::string& source);

/// Returns the paper's 25 parts (section 4.1.3), in the order of its released trees.
const BodyModel& paper_body();

/// Returns for each part the index of its kind, which it shares with its mirror partner.
std::vector<int> part_slots(const BodyModel& body);
/// Returns how many kinds these are of.
int kind_count(const std::vector<int>& slots);

/// Returns the index of the joint set of that name. Throws UsageError, which names those that there are, if there is
/// none.
std::size_t find_joint_set(const BodyModel& body, std::string_view name);

}  // namespace vesalius
