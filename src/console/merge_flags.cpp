#include "console/merge_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "console/interrupts.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "io/files/extrinsics_file.h"

namespace vesalius::cli {
namespace {

constexpr std::size_t kMostOthers = 7;

/// Where a camera was found, as "camera 1 (b/) is 3.21 m from the first, turned by 88.2 degrees; ...".
std::string describe(const FoundPose& pose, std::size_t camera, const std::string& source) {
  const double turn = Eigen::AngleAxisf(pose.first_from_this.linear()).angle() * 57.29577951;
  return fmt::format(
      "camera {} ({}) is {:.2f} m from the first, turned by {:.1f} degrees; joints of the same people, at {} moments, "
      "are {:.1f} cm apart in the median from camera {}'s",
      camera, source, pose.first_from_this.translation().norm(), turn, pose.moments, 100.F * pose.residual_m, pose.to);
}

std::vector<Eigen::Isometry3f> places_in(const std::string& text, const std::string& source, std::size_t count) {
  std::vector<Eigen::Isometry3f> places;
  for (const CameraExtrinsics& camera : parse_extrinsics(text, source, count)) {
    places.push_back(camera.first_from_this);
  }
  return places;
}

}  // namespace

void MergeFlags::add_to(CLI::App& command) {
  const std::string group = "Several cameras about the same people";
  command.add_option("MORE", others_, "With --merge: further sources, of the other cameras")
      ->type_name("SOURCE")
      ->group(group);
  command
      .add_flag("--merge", merge_,
                "One list of the people whom all sources see, in the frame of the first: whoever is hidden from one "
                "camera is known from another")
      ->group(group);
  command
      .add_option("--extrinsics", extrinsics_file_,
                  "With --merge: where the cameras stand. If there is no such file, it is found by the people whom "
                  "they see, as without this option, and written there")
      ->type_name("FILE")
      ->group(group);
}

std::vector<OtherCamera> MergeFlags::open(const SourceFlags& first, const Detector& detector,
                                          const PeopleOptions& options, bool quiet) const {
  std::vector<OtherCamera> cameras;
  for (const std::string& name : others_) cameras.emplace_back(first.open_other(name, quiet), detector, options);
  return cameras;
}

std::vector<Eigen::Isometry3f> MergeFlags::find(const SourceFlags& first, const Detector& detector,
                                                const PeopleOptions& options, bool quiet) const {
  const auto source = first.open(true, {});
  watch_interrupts();
  Progress progress(-1, !quiet);
  const auto poses = find_camera_poses(*source, open(first, detector, options, true), detector, options, interrupted,
                                       [&](int moments) { progress.set(moments, -1); });
  progress.clear();
  if (interrupted()) throw Error("interrupted while looking for where the cameras stand");
  if (!poses) {
    throw Error(
        "the cameras do not see the same people for long enough to tell where they stand: expected three seconds, "
        "better half a minute of people who walk about, or --extrinsics FILE with what is known");
  }
  std::vector<CameraExtrinsics> found;
  for (std::size_t c = 0; c < poses->size(); ++c) {
    const std::string& name = c == 0 ? first.name() : others_[c - 1];
    if (c > 0 && !quiet) say("note: " + describe((*poses)[c], c, name));
    found.push_back({name, (*poses)[c].first_from_this});
  }
  const std::string text = extrinsics_json(found);
  if (!extrinsics_file_.empty()) write_file_atomically(extrinsics_file_, text);
  return places_in(text, "extrinsics", found.size());  // as whoever reads the file has them, to the last bit
}

void MergeFlags::check(bool follows) const {
  if (merge_ && others_.empty()) throw UsageError("--merge expects further sources after the first");
  if (others_.size() > kMostOthers) {
    throw UsageError(fmt::format("{} sources, expected at most {}", others_.size() + 1, kMostOthers + 1));
  }
  if (merge_ && !follows) throw UsageError("--merge follows people, which --no-track forbids");
  if (merge_) return;
  if (!others_.empty()) {
    throw UsageError(others_.front() + ": a second source; --merge makes one list of the people whom both see");
  }
  if (!extrinsics_file_.empty()) throw UsageError("--extrinsics expects --merge and further sources");
}

MergedCameras MergeFlags::make(const SourceFlags& first, const Detector& detector, const PeopleOptions& options,
                               bool quiet) const {
  std::error_code ignored;
  const bool is_there = !extrinsics_file_.empty() && std::filesystem::exists(extrinsics_file_, ignored);
  std::vector<Eigen::Isometry3f> first_from =
      is_there ? places_in(read_file(extrinsics_file_), extrinsics_file_, others_.size() + 1)
               : find(first, detector, options, quiet);
  return {detector.body(), open(first, detector, options, quiet), std::move(first_from)};
}

}  // namespace vesalius::cli
