#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "train/sample_accuracy.h"
#include "train/training_set.h"
#include "vesalius/base/parallel.h"

namespace vesalius {

/// Runs `work(begin, end)` on ranges of samples that cover [0, count), on all threads allowed.
template <class Work>
void for_sample_ranges(std::size_t count, const Work& work) {
  constexpr std::size_t kSamplesPerRange = 2048;
  const std::size_t ranges = (count + kSamplesPerRange - 1) / kSamplesPerRange;
  parallel_for(static_cast<int>(ranges), [&](int r) {
    const std::size_t begin = static_cast<std::size_t>(r) * kSamplesPerRange;
    work(begin, std::min(begin + kSamplesPerRange, count));
  });
}

/// Compares the class of largest vote, the lower one on a tie, with the truth. `votes_of(i)` points to one number for
/// each class for sample i.
template <class VotesOf>
SampleAccuracy accuracy_of_votes(const TrainingSet& set, std::span<const TrainingSample> samples,
                                 const VotesOf& votes_of) {
  const int parts = set.body().part_count();
  const int classes = set.class_count();
  SampleAccuracy total{Confusion(classes), Confusion(parts)};
  std::mutex mutex;
  for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
    SampleAccuracy here{Confusion(classes), Confusion(parts)};
    for (std::size_t i = begin; i < end; ++i) {
      const auto* votes = votes_of(i);
      const int truth = samples[i].label;
      const auto best_part = std::max_element(votes, votes + parts);
      const auto best = std::max_element(votes, votes + classes);
      ++here.all.at(truth, static_cast<int>(best - votes));
      if (truth < parts) ++here.parts.at(truth, static_cast<int>(best_part - votes));
    }
    const std::scoped_lock lock(mutex);
    for (std::size_t c = 0; c < here.all.counts.size(); ++c) total.all.counts[c] += here.all.counts[c];
    for (std::size_t c = 0; c < here.parts.counts.size(); ++c) total.parts.counts[c] += here.parts.counts[c];
  });
  return total;
}

}  // namespace vesalius
