#include <string>
#include <utility>
#include <vector>

#include "c/guard.h"
#include "c/handles.h"
#include "cuda/cuda_labeller.h"
#include "io/model/default_model.h"
#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/model.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {
namespace {

constexpr int kMaxThreads = 1024;

std::string default_model() {
  const std::string own_folder = folder_of_library(reinterpret_cast<const void*>(&vesalius_detector_create));
  return find_default_model(model_folders(own_folder, VESALIUS_MODELS_FROM_LIB), "model is NULL");
}

std::shared_ptr<const SharedDetector> make_detector(const char* model, const vesalius_options* options, int threads,
                                                    const char* device) {
  if (threads < 0 || threads > kMaxThreads) {
    throw UsageError("threads is " + std::to_string(threads) + ", expected 0 (all) to " + std::to_string(kMaxThreads));
  }
  const ThreadLimit limit(threads);
  const PeopleOptions values = options != nullptr ? options->values : PeopleOptions{};
  Model loaded = on_device(load_model(model != nullptr ? model : default_model()), device != nullptr ? device : "cpu",
                           {{gpu::cuda_labeller()}, {}});
  return std::shared_ptr<const SharedDetector>(
      new SharedDetector{values, threads, Detector(std::move(loaded), values.detect)});
}

const BodyModel& body_of(const vesalius_detector* detector) {
  return need(detector, "detector").shared->detector.body();
}

const JointSet& joint_set_of(const vesalius_detector* detector, const char* name) {
  const BodyModel& body = body_of(detector);
  return body.joint_sets[find_joint_set(body, set_or_usual(name))];
}

/// Bodies of every detector are fitted with the same bones.
const FleshBone& bone_of(const vesalius_detector* detector, std::int32_t bone) {
  need(detector, "detector");
  return at(builtin_flesh().bones, bone, "bone");
}

/// Gives the people that `find` finds in a frame of the interface.
template <class Find>
void give_people(const std::shared_ptr<const SharedDetector>& shared, const vesalius_frame* frame,
                 const vesalius_camera* camera, vesalius_people*& people, const Find& find) {
  const ThreadLimit limit(shared->threads);
  const Frame read = read_frame(frame, camera, shared->rectifications);
  people = new vesalius_people{shared, read.camera.width, read.camera.height, find(read).people};
}

}  // namespace
}  // namespace vesalius::c

using namespace vesalius;
using namespace vesalius::c;

vesalius_status vesalius_detector_create(const char* model, const vesalius_options* options, int32_t threads,
                                         const char* device, vesalius_detector** detector) {
  return guarded([&] {
    need(detector, "detector") = nullptr;
    *detector = new vesalius_detector{make_detector(model, options, threads, device)};
  });
}

vesalius_status vesalius_detector_detect(const vesalius_detector* detector, const vesalius_frame* frame,
                                         const vesalius_camera* camera, vesalius_people** people) {
  return guarded([&] {
    need(people, "people") = nullptr;
    const auto& shared = need(detector, "detector").shared;
    give_people(shared, frame, camera, *people,
                [&](const Frame& read) { return seen_people(shared->detector.detect(read)); });
  });
}

void vesalius_detector_destroy(vesalius_detector* detector) { delete detector; }

int32_t vesalius_detector_part_count(const vesalius_detector* detector) {
  return guarded_value(-1, [&] { return body_of(detector).part_count(); });
}

const char* vesalius_detector_part_name(const vesalius_detector* detector, int32_t part) {
  return guarded_value<const char*>(nullptr, [&] { return at(body_of(detector).parts, part, "part").name.c_str(); });
}

int32_t vesalius_detector_joint_set_count(const vesalius_detector* detector) {
  return guarded_value(-1, [&] { return static_cast<int32_t>(body_of(detector).joint_sets.size()); });
}

const char* vesalius_detector_joint_set_name(const vesalius_detector* detector, int32_t set) {
  return guarded_value<const char*>(nullptr,
                                    [&] { return at(body_of(detector).joint_sets, set, "joint set").name.c_str(); });
}

int32_t vesalius_detector_joint_count(const vesalius_detector* detector, const char* joint_set) {
  return guarded_value(-1, [&] { return static_cast<int32_t>(joint_set_of(detector, joint_set).joints.size()); });
}

const char* vesalius_detector_joint_name(const vesalius_detector* detector, const char* joint_set, int32_t joint) {
  return guarded_value<const char*>(
      nullptr, [&] { return at(joint_set_of(detector, joint_set).joints, joint, "joint").name.c_str(); });
}

int32_t vesalius_detector_bone_count(const vesalius_detector* detector) {
  return guarded_value(-1, [&] {
    need(detector, "detector");
    return builtin_flesh().bone_count();
  });
}

const char* vesalius_detector_bone_name(const vesalius_detector* detector, int32_t bone) {
  return guarded_value<const char*>(nullptr, [&] { return bone_of(detector, bone).name.c_str(); });
}

int32_t vesalius_detector_bone_parent(const vesalius_detector* detector, int32_t bone) {
  return guarded_value(-1, [&] { return bone_of(detector, bone).parent; });
}

vesalius_status vesalius_tracker_create(const vesalius_detector* detector, vesalius_tracker** tracker) {
  return guarded([&] {
    need(tracker, "tracker") = nullptr;
    const auto& shared = need(detector, "detector").shared;
    *tracker = new vesalius_tracker{shared, make_tracker(shared->detector, shared->options)};
  });
}

vesalius_status vesalius_tracker_update(vesalius_tracker* tracker, const vesalius_frame* frame,
                                        const vesalius_camera* camera, vesalius_people** people) {
  return guarded([&] {
    need(people, "people") = nullptr;
    const auto& shared = need(tracker, "tracker").shared;
    give_people(shared, frame, camera, *people, [&](const Frame& read) {
      const std::scoped_lock lock(tracker->mutex);
      return follow(shared->detector, tracker->tracker, read);
    });
  });
}

void vesalius_tracker_destroy(vesalius_tracker* tracker) { delete tracker; }
