#include "commands/train/set_samples.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <utility>

#include "cluster/message.h"
#include "console/interrupts.h"
#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "metrics/fit_samples.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"
#include "vesalius/trace.h"

namespace vesalius::cli {
namespace {

constexpr int kFramesPerThread = 4;

/// The file of a set's samples.
struct StoredSamples {
  std::string made_from;
  std::uint64_t features = 0;  ///< number of features of each sample
  std::vector<float> values;
  std::vector<std::uint8_t> positive;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("made_from", of.made_from...)("features", of.features...)("values", of.values...)("positive", of.positive...);
  }
};

std::vector<TrueFrame> next_frames(TruthSource& source, std::size_t most) {
  std::vector<TrueFrame> frames;
  while (frames.size() < most) {
    std::optional<TrueFrame> frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  return frames;
}

}  // namespace

SampleFrame context_sampler(const Model& model) {
  return [model = on_device(model)](const TrueFrame& frame) { return context_samples(frame, model, {}); };
}

SampleFrame judge_sampler(const Model& model) {
  return [detector = Detector(model)](const TrueFrame& frame) {
    Trace trace;
    detector.detect(frame.frame, &trace);
    return judge_samples(trace, frame.truth, frame.frame.depth);
  };
}

std::vector<BoostSample> samples_of(TruthSource& frames, const SampleFrame& sample, const std::function<void()>& done) {
  std::vector<BoostSample> all;
  const auto most = static_cast<std::size_t>(kFramesPerThread * std::max(1, thread_count()));
  for (std::vector<TrueFrame> batch = next_frames(frames, most); !batch.empty(); batch = next_frames(frames, most)) {
    std::vector<std::vector<BoostSample>> of_each(batch.size());
    parallel_for(int(batch.size()), [&](int i) { of_each[i] = sample(batch[i]); });
    for (std::vector<BoostSample>& samples : of_each) {
      std::ranges::move(samples, std::back_inserter(all));
      done();
    }
    if (interrupted()) throw Error("interrupted: the same command goes on");
  }
  return all;
}

void write_samples(const std::string& path, const std::string& made_from, const std::vector<BoostSample>& samples) {
  StoredSamples stored{made_from, samples.empty() ? 0 : samples.front().features.size(), {}, {}};
  for (const BoostSample& sample : samples) {
    stored.values.insert(stored.values.end(), sample.features.begin(), sample.features.end());
    stored.positive.push_back(sample.positive ? 1 : 0);
  }
  write_file_atomically(path, sealed(to_message(stored)));
}

std::optional<std::vector<BoostSample>> read_samples(const std::string& path, const std::string& made_from) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    const auto stored = from_message<StoredSamples>(opened(read_file(path), path), path);
    if (stored.made_from != made_from || stored.values.size() != stored.features * stored.positive.size())
      return std::nullopt;
    std::vector<BoostSample> samples;
    for (auto value = stored.values.begin(); const std::uint8_t positive : stored.positive) {
      samples.push_back({{value, value + std::ptrdiff_t(stored.features)}, positive != 0});
      value += std::ptrdiff_t(stored.features);
    }
    return samples;
  } catch (const Error&) {
    return std::nullopt;  // damaged samples are taken again
  }
}

}  // namespace vesalius::cli
