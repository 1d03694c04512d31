#include "metrics/score_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "metrics/frame_truth.h"
#include "metrics/joint_metrics.h"
#include "metrics/match_people.h"
#include "metrics/people_metrics.h"
#include "metrics/side_metrics.h"
#include "metrics/unseen_metrics.h"
#include "vesalius/error.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

/// Returns the value of a metric in this frame, or `fallback` where it has none.
double term_or(const MetricTerms& terms, Metric metric, double fallback) {
  const auto found = std::ranges::find(terms, metric, [](const MetricTerm& term) { return term.id.metric; });
  if (found == terms.end() || found->denominator <= 0.0) return fallback;
  return found->numerator / found->denominator;
}

void say_what_went_wrong(FrameScore& score, bool labels_only) {
  std::string& wrong = score.what_went_wrong;
  const auto add = [&](double badness, const std::string& text) {
    score.badness += badness;
    wrong += (wrong.empty() ? "" : ", ") + text;
  };
  const MetricTerms& terms = score.terms;
  const double missed = score.expected * (1.0 - term_or(terms, Metric::people_found, 1.0));
  const double excess = term_or(terms, Metric::people_false, 0.0);
  if (missed > 0.0) add(missed, fmt::format("{:.0f} of {} people missed", missed, score.expected));
  if (excess > 0.0) add(excess, fmt::format("{:.0f} found who are none", excess));
  const Metric overlap = labels_only ? Metric::pixel_person_iou : Metric::mask_iou_where_found;
  const double iou = term_or(terms, overlap, 1.0);
  if (iou < 0.9) add(1.0 - iou, fmt::format("{} IoU {:.2f}", labels_only ? "pixel" : "mask", iou));
  const double body = term_or(terms, Metric::body_on_empty, 0.0);
  if (body > 0.003) add(body, fmt::format("{:.1f} % of the empty frame taken for a body", 100.0 * body));
  const double joints = term_or(terms, Metric::joints_at_10cm, 1.0);
  if (joints < 0.9) add(1.0 - joints, fmt::format("{:.0f} % of the joints within 10 cm", 100.0 * joints));
}

void append(MetricTerms& terms, MetricTerms more) {
  terms.insert(terms.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Throws Error unless each true person, if ids are known, has one of its own.
void check_ids(const TrueFrame& frame) {
  const FrameTruth& truth = frame.truth;
  if (truth.ids.empty()) return;
  const std::size_t people = std::max(truth.parts.size(), truth.joints.size());
  if (people > 0 && truth.ids.size() != people) {
    throw Error(fmt::format("truth of frame {}: {} ids, expected one for each of {} people", frame.frame.name,
                            truth.ids.size(), people));
  }
  if (std::set(truth.ids.begin(), truth.ids.end()).size() == truth.ids.size()) return;
  throw Error(fmt::format("truth of frame {}: two people of one id", frame.frame.name));
}

/// Throws Error unless the truth fits the frame and itself.
void check_truth(const TrueFrame& frame, const BodyModel& body) {
  const FrameTruth& truth = frame.truth;
  const auto fits = [&](const Image<std::uint8_t>& image) {
    return image.empty() || image.same_size(frame.frame.depth);
  };
  if (!fits(truth.mask) || !fits(truth.person) || !fits(truth.labels)) {
    throw Error(fmt::format("truth of frame {}: a mask or labels of another size than the depth, {}x{}",
                            frame.frame.name, frame.frame.depth.width(), frame.frame.depth.height()));
  }
  if (!truth.labels.empty() && truth.person.empty()) {
    throw Error(fmt::format("truth of frame {}: labels without the persons they belong to", frame.frame.name));
  }
  for (const auto& joints : truth.joints) {
    if (joints.size() == truth.joint_names.size()) continue;
    throw Error(fmt::format("truth of frame {}: {} joints, expected {}", frame.frame.name, joints.size(),
                            truth.joint_names.size()));
  }
  for (const auto& parts : truth.parts) {
    if (parts.size() == body.parts.size()) continue;
    throw Error(fmt::format("truth of frame {}: centres of {} parts, expected {}", frame.frame.name, parts.size(),
                            body.parts.size()));
  }
  check_ids(frame);
  if (truth.parts.empty() || truth.joints.empty() || truth.parts.size() == truth.joints.size()) return;
  throw Error(fmt::format("truth of frame {}: parts of {} people and joints of {}", frame.frame.name,
                          truth.parts.size(), truth.joints.size()));
}

/// Returns the found person for each true one, or null if that one was missed.
std::vector<const Person*> found_of_each(const std::vector<Person>& people, const std::vector<Match>& matches,
                                         int expected) {
  std::vector<const Person*> found(expected, nullptr);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i].kind == Match::Kind::person) found[matches[i].person] = &people[i];
  }
  return found;
}

/// Whether a proposal is a person, by the tenth in which its score lies.
MetricTerm score_term(float score, bool person) {
  const int tenth = std::clamp(int(10.F * score), 0, 9);
  return {{Metric::score_right, tenth, fmt::format("{}_to_{}", 10 * tenth, 10 * tenth + 10)}, person ? 1.0 : 0.0, 1.0};
}

}  // namespace

FrameScorer::FrameScorer(Model model, Options options)
    : options_(std::move(options)), detector_(std::move(model), options_.detect) {
  const std::vector<JointSet>& sets = body().joint_sets;
  if (options_.joint_set.empty() || std::ranges::find(sets, options_.joint_set, &JointSet::name) != sets.end()) return;
  std::string names;
  for (const JointSet& set : sets) names += (names.empty() ? "" : ", ") + set.name;
  throw UsageError(fmt::format("joint set \"{}\", expected one of {}", options_.joint_set, names));
}

void FrameScorer::check(const TrueFrame& frame) const {
  vesalius::check(frame.frame);
  check_truth(frame, body());
}

FrameScore FrameScorer::score(TrueFrame frame, bool fit_joints) const {
  check(frame);
  put_visible_people_first(frame);
  FrameScore score;
  score.expected = expected_people(frame.truth);
  const Mask people = labelled_people(frame.truth);
  const Mask* asked = people.empty() ? nullptr : &people;
  FrameLabels labels =
      options_.labels_only ? detector_.label(frame.frame, asked) : find_people(frame, asked, fit_joints, score);
  judge_labels(frame, labels, score);
  score.labels = std::move(labels.labels);
  say_what_went_wrong(score, options_.labels_only);
  return score;
}

FrameLabels FrameScorer::find_people(const TrueFrame& frame, const Mask* asked, bool fit_joints,
                                     FrameScore& score) const {
  Trace trace;
  trace.person = asked;
  score.people = detector_.detect(frame.frame, &trace);
  const std::vector<const Person*> of_person = judge_people(frame, score);
  log_proposals(frame, trace, fit_joints, score);
  if (fit_joints) {
    keep_known_people(frame, of_person, score);
  } else {
    judge_points(frame, of_person, score);
  }
  return {std::move(trace.labels), std::move(trace.inside)};
}

std::vector<const Person*> FrameScorer::judge_people(const TrueFrame& frame, FrameScore& score) const {
  const std::vector<Match> matches = match_people(accepted_proposals(score.people), frame.truth, frame.frame.depth);
  append(score.terms, people_terms(frame, score.people, matches, body()));
  std::vector<const Person*> of_person = found_of_each(score.people, matches, score.expected);
  append(score.terms, visible_part_terms(frame, of_person, body()));
  append(score.terms, breakdown_terms(frame, of_person, body()));
  append(score.terms, given_part_terms(frame, of_person, body()));
  append(score.terms, side_order_terms(frame, of_person, body()));
  append(score.terms, yaw_terms(frame, of_person, body()));
  return of_person;
}

FrameScore FrameScorer::score_found(TrueFrame frame, std::vector<Person> people,
                                    const std::vector<const Person*>& unseen) const {
  check(frame);
  put_visible_people_first(frame);
  FrameScore score;
  score.expected = expected_people(frame.truth);
  std::ranges::stable_sort(people, std::ranges::greater{}, &Person::score);
  score.people = std::move(people);
  std::vector<const Person*> of_person = judge_people(frame, score);
  of_person.resize(std::max(of_person.size(), unseen.size()), nullptr);
  for (std::size_t who = 0; who < unseen.size(); ++who) {
    if (of_person[who] == nullptr) of_person[who] = unseen[who];
  }
  judge_points(frame, of_person, score);
  say_what_went_wrong(score, false);
  return score;
}

void FrameScorer::log_proposals(const TrueFrame& frame, const Trace& trace, bool fit_joints, FrameScore& score) const {
  const auto proposals = distinct_proposals(trace, options_.detect.refine.max_overlap);
  if (!fit_joints) {
    const auto joints = known_joints(frame.truth, body(), options_.joint_set), centres = known_centres(frame.truth);
    if (joints) judge_proposed_points(*joints, proposals, score.expected, score.joint_precision);
    if (centres) judge_proposed_points(*centres, proposals, score.expected, score.centre_precision);
  }
  const std::vector<Match> matches = match_people(proposals, frame.truth, frame.frame.depth);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    if (matches[i].kind == Match::Kind::ignored) continue;
    if (proposals[i].skeleton->found >= options_.detect.refine.min_parts) {
      score.terms.push_back(score_term(proposals[i].score, matches[i].kind == Match::Kind::person));
    }
    JudgedProposal judged{proposals[i].score, proposals[i].skeleton->found, matches[i].kind == Match::Kind::person, {}};
    if (judged.person) {
      std::vector<Eigen::Vector3f> visible;
      if (!frame.truth.labels.empty()) visible = visible_parts(frame, matches[i].person, body());
      judged.counts = count_parts(*proposals[i].skeleton, visible, body());
      if (judged.score >= options_.detect.refine.min_score) {
        append(score.terms, found_part_terms(*proposals[i].skeleton, visible, body()));
      }
    }
    score.proposals.push_back(judged);
  }
}

std::optional<KnownPoints> FrameScorer::known_centres(const FrameTruth& truth) const {
  if (truth.parts.empty()) return std::nullopt;
  KnownPoints known{nullptr, sided(body()).names, truth.parts};
  known.set = joint_set_with_names(body(), known.names);
  return known.set != nullptr ? std::optional(std::move(known)) : std::nullopt;
}

std::vector<Eigen::Vector3f> FrameScorer::points_of(const Skeleton& skeleton, const KnownPoints& known) const {
  return joints_by_name(known.names, *known.set, derive_joints(body(), skeleton)[known.set - body().joint_sets.data()]);
}

void FrameScorer::judge_proposed_points(const KnownPoints& known, const std::vector<Proposal>& proposals, int expected,
                                        JointPrecision& precision) const {
  std::vector<JointProposals> judged;
  for (const Proposal& proposal : proposals) {
    Skeleton skeleton = *proposal.skeleton;
    predict_missing_parts(body(), skeleton);
    judged.push_back({proposal.score, points_of(skeleton, known)});
  }
  precision.add(known.names, std::move(judged), known.of_person, expected);
}

void FrameScorer::judge_points(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                               FrameScore& score) const {
  const auto each = [&](const std::optional<KnownPoints>& known, const auto& judge) {
    for (std::size_t who = 0; known && who < of_person.size() && who < known->of_person.size(); ++who) {
      std::vector<Joint> joints;
      if (of_person[who] != nullptr) joints = of_person[who]->joints[known->set - body().joint_sets.data()];
      const JointPair pair{known->of_person[who], joints_by_name(known->names, *known->set, joints)};
      judge(who, *known, pair, joints);
    }
  };
  std::vector<int> found;
  for (const Person* person : of_person) {
    const auto same = [&](const Person& one) { return &one == person; };
    const auto at = std::ranges::find_if(score.people, same);
    found.push_back(at != score.people.end() ? int(at - score.people.begin()) : -1);
  }
  const auto judge_joints = [&](std::size_t who, const KnownPoints& known, const JointPair& pair,
                                const std::vector<Joint>& joints) {
    append(score.terms, joint_terms(pair, known.names));
    append(score.terms, joint_bias_terms(pair, known.names));
    append(score.terms, sight_terms(pair, confidences_by_name(known.names, *known.set, joints),
                                    joint_sight(frame, who, pair.truth)));
    append(score.terms, unseen_terms(frame, who, known.names, pair.truth, *known.set, joints, found));
    const GivenPoints given = count_given(sided(known.names), pair.found, pair.truth, kJointTolerance_m);
    append(score.terms,
           given_terms(given, GivenKind::joints, heading_of(frame.truth, who, body()), frame.truth.parts.empty()));
  };
  const auto judge_centres = [&](std::size_t who, const KnownPoints& known, const JointPair& pair,
                                 const std::vector<Joint>&) {
    append(score.terms, centre_terms(pair, known.names));
    if (of_person[who] != nullptr) append(score.terms, predicted_part_terms(of_person[who]->skeleton, pair));
  };
  each(known_joints(frame.truth, body(), options_.joint_set), judge_joints);
  each(known_centres(frame.truth), judge_centres);
}

void FrameScorer::keep_known_people(const TrueFrame& frame, const std::vector<const Person*>& of_person,
                                    FrameScore& score) const {
  const auto joints = known_joints(frame.truth, body(), options_.joint_set);
  // The joints of rendered skeletons are those of every tracker, others only those of one.
  const bool any_set = options_.joint_set.empty() && !frame.truth.parts.empty();
  for (std::size_t who = 0; who < of_person.size(); ++who) {
    if (of_person[who] == nullptr) continue;
    KnownPerson person;
    person.skeleton = of_person[who]->skeleton;
    if (joints && who < frame.truth.joints.size()) {
      if (!any_set) person.joint_set = joints->set->name;
      person.joint_names = frame.truth.joint_names;
      person.joints = frame.truth.joints[who];
    }
    if (options_.joint_set.empty() && who < frame.truth.parts.size()) person.part_centres = frame.truth.parts[who];
    score.known_people.push_back(std::move(person));
  }
}

void FrameScorer::judge_labels(const TrueFrame& frame, const FrameLabels& labels, FrameScore& score) const {
  const FrameTruth& truth = frame.truth;
  const DepthImage& depth = frame.frame.depth;
  if (truth.labels.empty()) {
    append(score.terms, mask_terms(truth, labels.labels, depth));
    return;
  }
  PixelConfusion inside(body().part_count());
  inside.add(truth.labels, labels.inside, depth);
  score.confusion.emplace(body().part_count());
  score.confusion->add(truth.labels, labels.labels, depth);
  append(score.terms, pixel_terms(*score.confusion, inside, body()));
  if (truth.people == 0) append(score.terms, mask_terms(truth, labels.labels, depth));
}

}  // namespace vesalius
