#define HWY_WANT_AVX3_DL  // as the kernels of networks do
// These tests run the released trees with the same default options on all real frames. Each test prints its counts.

#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <iostream>
#include <map>
#include <set>

#include "metrics/pixel_metrics.h"
#include "shared_frames.h"
#include "vesalius/base/test_targets.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/detect.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

Detector released_detector(const std::filesystem::path& shared) { return Detector(load_released_trees(shared)); }

/// Returns n, such that every nth frame is tested. Under sanitizers a frame takes seconds, so fewer frames have to do.
int stride() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 25;
#else
  return 1;
#endif
}

std::vector<RealFrame> some_of(std::vector<RealFrame> frames) {
  std::vector<RealFrame> kept;
  for (std::size_t i = 0; i < frames.size(); i += static_cast<std::size_t>(stride()))
    kept.push_back(std::move(frames[i]));
  return kept;
}

// Labels: real
TEST(RealFrames, AWalkingAndWavingPersonIsFound) {
  VESALIUS_NEEDS_SHARED();
  const Detector detector = released_detector(shared);
  int with = 0, empty = 0, found = 0, false_people = 0;
  double iou = 0.0;
  std::map<std::string, int> parts;
  for (const RealFrame& real : some_of(load_real_set(shared, "alina_wave"))) {
    const std::vector<Person> people = detector.detect(real.frame);
    if (real.people == 0) {
      ++empty;
      false_people += static_cast<int>(people.size());
      continue;
    }
    ++with;
    if (people.empty()) continue;
    ++found;
    false_people += static_cast<int>(people.size()) - 1;
    iou += mask_iou(people[0].mask, real.mask, real.frame.depth);
    for (int i = 0; i < detector.body().part_count(); ++i) {
      if (people[0].skeleton.parts[i].state == State::observed) {
        ++parts[detector.body().parts[i].name];
      }
    }
  }
  std::cout << "alina_wave: a person in " << found << " of " << with << " frames with one, " << false_people
            << " people too many in these and " << empty << " empty ones, mask IoU " << iou / found << '\n';
  for (const auto& [name, n] : parts) std::cout << "  " << name << ' ' << n << '\n';
  EXPECT_GE(found, with - 1);
  EXPECT_EQ(false_people, 0);
  EXPECT_GE(iou / found, 0.95);
  EXPECT_GE(parts["l_upper_arm"], 0.8 * with);
  EXPECT_GE(parts["r_upper_arm"], 0.8 * with);
}

// Labels: real
TEST(RealFrames, NobodyIsFoundWhereNobodyIs) {
  VESALIUS_NEEDS_SHARED();
  const Detector detector = released_detector(shared);
  int frames = 0, with_person = 0;
  for (const char* set : {"neg_7scenes_kitchen", "neg_aims", "neg_leezl_tabletop", "neg_pcl"}) {
    for (const RealFrame& real : some_of(load_real_set(shared, set))) {
      ++frames;
      if (detector.detect(real.frame).empty()) continue;
      ++with_person;
      std::cout << "  " << set << '/' << real.frame.name << '\n';
    }
  }
  std::cout << "neg_*: a person in " << with_person << " of " << frames << " frames\n";
  EXPECT_LE(with_person, 2);
}

// Labels: real
TEST(RealFrames, FourOfFivePeopleFromBehindAreFound) {
  VESALIUS_NEEDS_SHARED();
  const Detector detector = released_detector(shared);
  // These are pixels on the trunks, from left to right.
  const std::array<std::array<int, 2>, 5> trunks{{{90, 230}, {190, 260}, {345, 230}, {430, 230}, {560, 230}}};
  for (const RealFrame& real : load_real_set(shared, "pcl")) {
    if (real.people != 5) continue;
    const std::vector<Person> people = detector.detect(real.frame);
    std::set<std::size_t> matched;
    for (const auto& [u, v] : trunks) {
      for (std::size_t p = 0; p < people.size(); ++p) {
        if (people[p].mask(u, v) != 0) matched.insert(p);
      }
    }
    std::cout << "five_people: " << matched.size() << " of 5, " << people.size() - matched.size() << " other\n";
    EXPECT_GE(matched.size(), 4U);
    EXPECT_EQ(people.size(), matched.size());
  }
}

// Labels: real
TEST(RealFrames, MasksInOtherRoomsAreGood) {
  VESALIUS_NEEDS_SHARED();
  const Detector detector = released_detector(shared);
  for (const char* set : {"uc3m", "uva_person"}) {
    int frames = 0, found = 0;
    double iou = 0.0;
    for (const RealFrame& real : some_of(load_real_set(shared, set))) {
      if (real.mask.empty()) continue;
      ++frames;
      Mask all(real.mask.width(), real.mask.height(), 0);
      const std::vector<Person> people = detector.detect(real.frame);
      for (const Person& person : people) {
        for (std::size_t i = 0; i < all.size(); ++i) all[i] |= person.mask[i];
      }
      found += people.empty() ? 0 : 1;
      iou += people.empty() ? 0.0 : mask_iou(all, real.mask, real.frame.depth);
    }
    std::cout << set << ": a person in " << found << " of " << frames << " frames, mask IoU where found "
              << iou / std::max(1, found) << '\n';
    if (stride() > 1) continue;
    EXPECT_GE(found, frames / 2);
    EXPECT_GE(iou / std::max(1, found), 0.75);
  }
}

void expect_same(const std::vector<Person>& people, const std::vector<Person>& expected) {
  ASSERT_EQ(people.size(), expected.size());
  for (std::size_t p = 0; p < people.size(); ++p) {
    EXPECT_EQ(people[p].mask, expected[p].mask);
    EXPECT_EQ(people[p].labels, expected[p].labels);
    EXPECT_EQ(people[p].score, expected[p].score);
    for (std::size_t k = 0; k < people[p].skeleton.parts.size(); ++k) {
      EXPECT_EQ(people[p].skeleton.parts[k].centre, expected[p].skeleton.parts[k].centre);
      EXPECT_EQ(people[p].skeleton.parts[k].confidence, expected[p].skeleton.parts[k].confidence);
    }
  }
}

// Labels: real threads
TEST(RealFrames, SameResultForAnyThreadCount) {
  VESALIUS_NEEDS_SHARED();
  const Detector detector = released_detector(shared);
  for (const RealFrame& real : load_real_set(shared, "tue_people")) {
    std::vector<std::vector<Person>> results;
    for_threads({1, 2, 8, 8}, [&] { results.push_back(detector.detect(real.frame)); });
    for (const std::vector<Person>& people : results) expect_same(people, results[0]);
  }
}

/// The shipped models run on every `kEach`-th frame of all sets, or on all frames if VESALIUS_ALL_FRAMES=1. Under
/// sanitizers one of each of the first four sets has to do: each goes twice through every instruction set.
// Labels: real threads
TEST(RealFrames, SameResultForEveryInstructionSetAndThreadCount) {
  VESALIUS_NEEDS_SHARED();
  constexpr std::size_t kEach = 48, kFirstSets = 4;
  const bool every = std::getenv("VESALIUS_ALL_FRAMES") != nullptr;
  const std::size_t step = every ? 1 : kEach * static_cast<std::size_t>(stride());
  std::vector<RealFrame> frames;
  for (const char* set : {"alina_wave", "fallseq", "uva_person", "uc3m", "tue_people", "jointvosf", "pcl",
                          "neg_7scenes_kitchen", "neg_aims", "neg_leezl_tabletop", "neg_pcl"}) {
    std::vector<RealFrame> all = load_real_set(shared, set);
    for (std::size_t i = 0; i < all.size(); i += step) frames.push_back(std::move(all[i]));
    if (!every && stride() > 1 && frames.size() == kFirstSets) break;
  }
  for (const char* name : {"default.forest", "default.model"}) {
    const auto make = [&] { return Detector(load_model(std::string(VESALIUS_SOURCE_DIR) + "/data/models/" + name)); };
    std::vector<std::vector<Person>> expected;
    std::size_t found = 0;
    for (const Detector detector = make(); const RealFrame& real : frames) {
      expected.push_back(detector.detect(real.frame));
      found += expected.back().size();
    }
    for_each_target([&](const char* target) {
      const Detector detector = make();  // a network is arranged for one instruction set
      for (std::size_t i = 0; i < frames.size(); ++i) {
        SCOPED_TRACE(std::string(name) + ", " + target + ", " + frames[i].frame.name);
        for_threads({1, 3}, [&] { expect_same(detector.detect(frames[i].frame), expected[i]); });
      }
    });
    std::cout << name << ": " << frames.size() << " frames, " << found << " people\n";
    EXPECT_GT(found, 0U);
  }
}

}  // namespace
}  // namespace vesalius
