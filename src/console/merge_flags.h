#pragma once

#include <string>
#include <vector>

#include "console/source_flags.h"
#include "stream/merged_cameras.h"

namespace CLI {
class App;
}  // namespace CLI

namespace vesalius::cli {

/// Further sources, --merge and --extrinsics of a command that can make one list of the people whom several cameras
/// see.
class MergeFlags {
 public:
  /// Adds them to a command, as long as which this object must live, after its SOURCE.
  void add_to(CLI::App& command);

  /// Throws UsageError for flags that do not go together; `follows` says whether people are followed.
  void check(bool follows) const;
  bool asked() const { return merge_; }

  /// Returns the cameras beside `first`, where that is asked for. Where they stand is read from the file or found by
  /// the people, which is said and written to the file, if one is named. Throws Error if the extrinsics cannot be used
  /// or found. `detector` must outlive the result.
  MergedCameras make(const SourceFlags& first, const Detector& detector, const PeopleOptions& options,
                     bool quiet) const;

 private:
  std::vector<OtherCamera> open(const SourceFlags& first, const Detector& detector, const PeopleOptions& options,
                                bool quiet) const;
  std::vector<Eigen::Isometry3f> find(const SourceFlags& first, const Detector& detector, const PeopleOptions& options,
                                      bool quiet) const;

  std::vector<std::string> others_;
  bool merge_ = false;
  std::string extrinsics_file_;
};

}  // namespace vesalius::cli
