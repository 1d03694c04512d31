#include "cli/detect/detect_outputs.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "vesalius/derive_joints.h"
#include "vesalius/image_file.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64, kHeight = 48;

/// Returns somebody who fills some columns of the picture.
Person person_from(int first, int end, float score) {
  Person person;
  person.mask = Mask(kWidth, kHeight, 0);
  person.labels = LabelImage(kWidth, kHeight, kBackground);
  for (int v = 10; v < 40; ++v) {
    for (int u = first; u < end; ++u) {
      person.mask(u, v) = 1;
      person.labels(u, v) = 0;
    }
  }
  person.box = bounding_box(person.mask);
  person.score = score;
  person.skeleton.parts.resize(paper_body().parts.size());
  person.joints = derive_joints(paper_body(), person.skeleton);
  return person;
}

TrackedPerson followed(int id, TrackState state, Person person) {
  TrackedPerson tracked;
  tracked.id = id;
  tracked.state = state;
  tracked.person = std::move(person);
  return tracked;
}

TEST(DetectOutputs, PicturesOfFollowedPeopleHaveTheIndicesOfTheJson) {
  const fs::path folder = fs::temp_directory_path() / ("vesalius_outputs_" + std::to_string(getpid()));
  const std::string json = (folder / "people.jsonl").string();
  fs::create_directories(folder);
  const Person left = person_from(5, 15, 0.9F), middle = person_from(20, 30, 0.99F), right = person_from(40, 50, 0.95F);
  Person out_of_sight = person_from(55, 60, 0.9F);
  out_of_sight.mask = {};
  out_of_sight.labels = {};
  out_of_sight.box = {};
  FoundFrame found;
  found.frame.emplace();
  found.frame->name = "0001";
  found.frame->camera = {kWidth, kHeight, 60.F, 60.F, 31.5F, 23.5F};
  found.frame->depth = DepthImage(kWidth, kHeight, 2000);
  found.people.people = {followed(2, TrackState::tracked, left), followed(5, TrackState::hidden, out_of_sight),
                         followed(7, TrackState::tracked, right), followed(9, TrackState::tracked, middle)};
  OutputRequest request;
  request.json = json;
  request.folder = folder.string();
  request.save = {"mask", "overlay", "parts", "labels", "cloud"};
  DetectOutputs outputs(request, paper_body());
  outputs.write(found);
  outputs.finish("");

  const Image<std::uint8_t> mask = read_png8((folder / "mask" / "0001.png").string());
  std::ifstream lines(json);
  std::string line;
  std::getline(lines, line);
  const auto people = nlohmann::json::parse(line).at("people");
  ASSERT_EQ(people.size(), 4U);
  int compared = 0;
  for (const auto& person : people) {
    if (person.at("state") != "tracked") continue;
    const auto& box = person.at("box_px");
    const int u = box.at(0).get<int>() + box.at(2).get<int>() / 2, v = box.at(1).get<int>() + box.at(3).get<int>() / 2;
    EXPECT_EQ(mask(u, v), person.at("index").get<int>()) << person.at("id");
    ++compared;
  }
  EXPECT_EQ(compared, 3);
  EXPECT_EQ(mask(57, 20), kBackground) << "nobody is seen there";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace vesalius::cli
