// What several cameras find together, and what each finds alone, on rendered clips: docs/several-cameras.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>

#include "../run_tool.h"
#include "dataset/labelled_folder.h"
#include "dataset/labelled_truth.h"
#include "evaluation/evaluation_joints.h"
#include "metrics/joint_metrics.h"
#include "metrics/match_people.h"
#include "metrics/track_metrics.h"
#include "vesalius/detect.h"
#include "vesalius/merge/find_poses.h"
#include "vesalius/merge/merge_people.h"
#include "vesalius/model_file.h"
#include "vesalius/track_people.h"

namespace vesalius {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr double kFar_m = 1.0;  // at which two middles are not alike at all; at half of it they are one person's

/// A true person at a moment, in the first camera's frame.
struct TruePerson {
  std::vector<Vector3f> joints;
  std::vector<bool> seen;                 ///< [camera]
  std::vector<std::vector<bool>> hidden;  ///< [camera][joint]
};

/// What all cameras know of a moment.
struct Moment {
  double time_s = 0.0;
  std::map<int, TruePerson> truth;
  std::vector<TrackedFrame> people;  ///< [camera], in its own frame
};

struct Figures {
  double same = 0.0, all = 0.0;  ///< IDF1
  double people = 0.0, missed = 0.0, falsely = 0.0, switches = 0.0;
  std::vector<double> hidden_m;  ///< errors of joints that the camera does not see
  std::string errors() const {
    return fmt::format("of {} {} missed, {} false, {} switches", people, missed, falsely, switches);
  }
  double idf1() const { return all > 0.0 ? 100.0 * same / all : 0.0; }
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

Vector3f middle(const std::vector<Vector3f>& points) { return mean_known(points); }

class Measuring {
 public:
  Measuring(const std::string& folder, const Model& model) : detector_(model) {
    for (int c = 0; std::filesystem::exists(fmt::format("{}/camera_{}", folder, c)); ++c) {
      cameras_.emplace_back(fmt::format("{}/camera_{}", folder, c));
    }
    if (cameras_.size() < 2) throw Error(folder + ": expected folders camera_0 and camera_1 of synth --cameras");
    if (cameras_[0].clips().frames_per_clip == 0) throw Error(folder + ": expected clips");
    alone_.resize(cameras_.size());
    together_.resize(cameras_.size());
    of_all_.resize(cameras_.size());
  }

  void run() {
    const std::uint64_t per_clip = cameras_[0].clips().frames_per_clip;
    for (std::uint64_t clip = 0; clip < cameras_[0].size() / per_clip; ++clip) {
      std::vector<Moment> moments;
      std::vector<PeopleTracker> trackers;
      for (std::size_t c = 0; c < cameras_.size(); ++c) trackers.push_back(make_tracker(detector_, {}));
      for (std::uint64_t k = 0; k < per_clip; ++k) moments.push_back(moment(clip, clip * per_clip + k, trackers));
      judge(clip, moments);
    }
    tell();
  }

 private:
  Moment moment(std::uint64_t clip, std::uint64_t index, std::vector<PeopleTracker>& trackers) {
    Moment moment;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      LabelledFrame labelled = cameras_[c].read(index);
      world_from_.resize(cameras_.size());
      world_from_[c] = labelled.world_from_camera.value();
      TrueFrame frame = as_true_frame(std::move(labelled), cameras_[c].joint_names(), int(clip));
      put_visible_people_first(frame);
      moment.time_s = frame.frame.time_s.value_or(0.0);
      add_truth(c, frame, moment);
      moment.people.push_back(follow(detector_, trackers[c], frame.frame));
    }
    return moment;
  }

  Isometry3f first_from(std::size_t camera) const { return world_from_[0].inverse() * world_from_[camera]; }

  void add_truth(std::size_t camera, const TrueFrame& frame, Moment& moment) {
    const auto known = known_joints(frame.truth, detector_.body(), "");
    if (!known) throw Error("no joints of the truth have places in the model's joint sets");
    set_ = known->set;
    names_ = known->names;
    for (std::size_t p = 0; p < known->of_person.size(); ++p) {
      TruePerson& person = moment.truth[frame.truth.ids[p]];
      person.seen.resize(cameras_.size());
      person.hidden.resize(cameras_.size());
      person.seen[camera] = int(p) < expected_people(frame.truth);
      const std::vector<Sight> sight = joint_sight(frame, p, known->of_person[p]);
      for (const Sight s : sight) person.hidden[camera].push_back(s == Sight::hidden);
      if (!person.joints.empty()) continue;
      for (const Vector3f& joint : known->of_person[p]) person.joints.push_back(first_from(camera) * joint);
    }
  }

  std::vector<Vector3f> joints_of(const TrackedPerson& person, const Isometry3f& to_first) const {
    std::vector<Vector3f> joints =
        joints_by_name(names_, *set_, person.person.joints[set_ - detector_.body().joint_sets.data()]);
    for (Vector3f& joint : joints) joint = to_first * joint;
    return joints;
  }

  /// Adds a moment to a sample of tracks: true people for whom `counts` says so, and those found, without those who are
  /// somebody else of the truth. Measures hidden joints for which `is_hidden` says so.
  template <class Counts, class IsHidden>
  TrackSample sample(const Moment& moment, const TrackedFrame& found, const Isometry3f& to_first, const Counts& counts,
                     const IsHidden& is_hidden, Figures& figures) const {
    TrackSample sample;
    std::vector<Vector3f> places;
    std::vector<std::vector<Vector3f>> joints;
    for (const auto& [id, person] : moment.truth) {
      if (!counts(person)) continue;
      sample.truth.push_back(id);
      places.push_back(middle(person.joints));
    }
    std::vector<std::vector<double>> alike;
    for (const TrackedPerson& person : found.people) {
      if (!is_found(person)) continue;
      const std::vector<Vector3f> of_person = joints_of(person, to_first);
      const Vector3f at = middle(of_person);
      bool is_other = false;
      for (const auto& [id, other] : moment.truth) {
        const double far = double((middle(other.joints) - at).norm());
        is_other |= !counts(other) && far < 0.5 * kFar_m;
        if (far < 0.5 * kFar_m) add_errors(other, of_person, is_hidden, figures);
      }
      std::vector<double> row;
      for (const Vector3f& place : places) row.push_back(std::max(0.0, 1.0 - double((place - at).norm()) / kFar_m));
      if (is_other && std::ranges::none_of(row, [](double s) { return s >= 0.5; })) continue;
      sample.found.push_back(person.id);
      alike.push_back(std::move(row));
    }
    sample.similarity.resize(Eigen::Index(sample.truth.size()), Eigen::Index(sample.found.size()));
    for (std::size_t f = 0; f < alike.size(); ++f) {
      for (std::size_t t = 0; t < alike[f].size(); ++t)
        sample.similarity(Eigen::Index(t), Eigen::Index(f)) = alike[f][t];
    }
    return sample;
  }

  template <class IsHidden>
  static void add_errors(const TruePerson& person, const std::vector<Vector3f>& found, const IsHidden& is_hidden,
                         Figures& figures) {
    for (std::size_t j = 0; j < found.size(); ++j) {
      if (is_hidden(person, j) && !found[j].hasNaN())
        figures.hidden_m.push_back(double((found[j] - person.joints[j]).norm()));
    }
  }

  static void add_tracks(const std::vector<TrackSample>& samples, Figures& figures) {
    for (const MetricTerms& terms : track_terms(samples)) {
      for (const MetricTerm& term : terms) {
        if (term.id.metric == Metric::track_missed)
          figures.missed += term.numerator, figures.people += term.denominator;
        if (term.id.metric == Metric::track_false) figures.falsely += term.numerator;
        if (term.id.metric == Metric::track_switches) figures.switches += term.numerator;
        if (term.id.metric != Metric::track_idf1) continue;
        figures.same += term.numerator;
        figures.all += term.denominator;
      }
    }
  }

  void judge(std::uint64_t clip, const std::vector<Moment>& moments) {
    PoseFinder finder(cameras_.size());
    for (const Moment& moment : moments) finder.add(moment.time_s, moment.people);
    const auto poses = finder.find();
    std::vector<Isometry3f> given;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const Isometry3f truth = first_from(c);
      given.push_back(poses ? (*poses)[c].first_from_this : truth);
      if (c == 0 || !poses) continue;
      const Isometry3f off = truth.inverse() * given[c];
      place_errors_.push_back(100.0 * double((given[c].translation() - truth.translation()).norm()));
      turn_errors_.push_back(57.29577951 * double(Eigen::AngleAxisf(off.linear()).angle()));
      std::cout << fmt::format(
          "clip {}: camera {} off by {:.1f} cm and {:.2f} degrees; joints {:.1f} cm apart at {} moments\n", clip, c,
          place_errors_.back(), turn_errors_.back(), 100.F * (*poses)[c].residual_m, (*poses)[c].moments);
    }
    if (!poses) std::cout << fmt::format("clip {}: cameras not tied\n", clip);
    not_tied_ += poses ? 0 : 1;
    ++clips_;
    const auto anybody = [](const TruePerson& p) { return std::ranges::any_of(p.seen, std::identity()); };
    PeopleMerger merger(given);
    std::vector<TrackSample> merged;
    std::vector<TrackedFrame> people;
    for (const Moment& moment : moments) {
      std::vector<CameraPeople> seen;
      for (const TrackedFrame& frame : moment.people) seen.push_back({frame, 0.0});
      people.push_back(merger.merge(std::move(seen)));
      Figures ignored;
      merged.push_back(sample(
          moment, people.back(), Isometry3f::Identity(), anybody, [](const TruePerson&, std::size_t) { return false; },
          ignored));
    }
    add_tracks(merged, merged_);
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const auto is_seen = [&](const TruePerson& p) { return bool(p.seen[c]); };
      const auto is_hidden = [&](const TruePerson& p, std::size_t j) {
        bool another_sees = false;
        for (std::size_t other = 0; other < cameras_.size(); ++other) {
          another_sees |= other != c && p.seen[other] && !p.hidden[other][j];
        }
        return p.seen[c] && p.hidden[c][j] && another_sees;
      };
      const auto none = [](const TruePerson&, std::size_t) { return false; };
      std::vector<TrackSample> alone, of_all;
      for (std::size_t m = 0; m < moments.size(); ++m) {
        alone.push_back(sample(moments[m], moments[m].people[c], first_from(c), is_seen, is_hidden, alone_[c]));
        of_all.push_back(sample(moments[m], moments[m].people[c], first_from(c), anybody, none, of_all_[c]));
        (void)sample(moments[m], people[m], Isometry3f::Identity(), anybody, is_hidden, together_[c]);
      }
      add_tracks(alone, alone_[c]);
      add_tracks(of_all, of_all_[c]);
    }
  }

  void tell() const {
    std::cout << fmt::format(
        "{} clips, {} not tied; places of cameras off by {:.1f} cm (median; most {:.1f}), turns by {:.2f} degrees "
        "({:.2f})\n",
        clips_, not_tied_, median(place_errors_),
        place_errors_.empty() ? 0.0 : *std::ranges::max_element(place_errors_), median(turn_errors_),
        turn_errors_.empty() ? 0.0 : *std::ranges::max_element(turn_errors_));
    std::cout << fmt::format("IDF1 of all whom some camera sees: {:.1f} merged ({})\n", merged_.idf1(),
                             merged_.errors());
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      std::cout << fmt::format(
          "camera {}: IDF1 of those whom it sees {:.1f} ({}), of all {:.1f}; joints that it does not see and another "
          "does {:.1f} cm off alone, {:.1f} cm "
          "merged "
          "(median; mean {:.1f}, {:.1f}; {}, {})\n",
          c, alone_[c].idf1(), alone_[c].errors(), of_all_[c].idf1(), 100.0 * median(alone_[c].hidden_m),
          100.0 * median(together_[c].hidden_m), 100.0 * mean(alone_[c].hidden_m), 100.0 * mean(together_[c].hidden_m),
          alone_[c].hidden_m.size(), together_[c].hidden_m.size());
    }
  }

  static double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / double(values.size());
  }

  Detector detector_;
  std::vector<LabelledFolder> cameras_;
  std::vector<Isometry3f> world_from_;
  const JointSet* set_ = nullptr;
  std::vector<std::string> names_;
  std::vector<Figures> alone_, together_, of_all_;  ///< [camera]
  Figures merged_;
  std::vector<double> place_errors_, turn_errors_;
  int clips_ = 0, not_tied_ = 0;
};

int run(int argc, char** argv) {
  CLI::App app("Measures what several cameras find together, on clips of `vesalius synth --cameras`");
  std::string folder, file;
  app.add_option("FOLDER", folder, "Folder with camera_0, camera_1, ...")->required();
  app.add_option("-m,--model", file, "Model that finds the people")->required();
  CLI11_PARSE(app, argc, argv);
  Model model = load_model(file);
  model.body = with_evaluation_joints(model.body);
  Measuring(folder, on_device(std::move(model))).run();
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_merge_figures", [&] { return vesalius::run(argc, argv); });
}
