#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "export/moving_skeleton.h"
#include "export/people_record.h"

namespace vesalius {

/// All people as a table, a row for each frame and person: frame, time, id, score, and of each joint of a set its place
/// in metres (optical frame; of a record that stands on the floor with y up and z towards the camera), confidence and
/// state. Places of joints without one are empty.
std::string to_csv(const PeopleRecord& record, std::size_t set);

/// One person's joints as OpenSim's markers: millimetres, y up, the origin that of the record. A row for each frame
/// from the person's first to the last; places that are not known are empty. `name` is what the file calls itself.
/// Throws Error if the person is not there.
std::string to_trc(const PeopleRecord& record, std::size_t set, int person, const std::string& name);

/// Returns the ids of all people, rising.
std::vector<int> people_in(const PeopleRecord& record);

/// All people as COCO's keypoints: images, annotations with boxes, one category with the set's joints. Pixels are those
/// of the depth picture; a frame without a picture is to be found as its name with .png. Visibility is 2 for what is
/// observed, 1 for what is predicted and 0 for the rest.
std::string to_coco(const PeopleRecord& record, std::size_t set);

/// All people as the offline processor of the Azure Kinect samples writes them: positions in millimetres in the depth
/// camera's frame, orientations as w, x, y, z. The record must have the joint set k4abt32; a joint without a place or
/// rotation is at the origin or unturned. Throws UsageError otherwise. `source` is what the file says it comes from.
std::string to_k4abt(const PeopleRecord& record, const std::string& source);

/// A skeleton as BVH: centimetres, angles about z, x and y. Its bones keep their length, as the format has them once.
std::string to_bvh(const MovingSkeleton& skeleton);

/// What is asked of a format.
struct ExportRequest {
  std::size_t set = 0;        ///< set of joints, for formats that have one
  std::optional<int> person;  ///< only this one, for formats of one person
  std::string name;           ///< name of the file
  std::string source;         ///< what the record was read from
};

/// A format of other programs. `vesalius export` has those of export_formats.
struct ExportFormat {
  std::string name;    ///< as --format takes it
  std::string ending;  ///< ending of files that tell the format by their names; empty where it must be asked for
  std::string joints;  ///< usual joint set; empty for formats without one
  bool of_one;         ///< whether it can have one person alone
  bool stands;         ///< whether its places are rather the floor's than the camera's, where the floor is known
  /// Returns whom to write a file each; null where one file has everybody.
  std::vector<int> (*files)(const PeopleRecord& record);
  std::string (*write)(const PeopleRecord& record, const ExportRequest& request);
};
const std::vector<ExportFormat>& export_formats();

}  // namespace vesalius
