#include "vesalius/network/network_labeller.h"

#include <algorithm>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/pool.h"
#include "vesalius/error.h"
#include "vesalius/forest/background_gate.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/network/network_input.h"
#include "vesalius/network/posterior_kernels.h"
#include "vesalius/network/run_network.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Posteriors::whole: what smoothing sums over its window fits 16 bits.
constexpr int kNetworkWhole = 2040;

/// Returns how many of `size` pixels vote, the first included.
int voters(int size, int step) { return (size + step - 1) / step; }

Image<PersonVote> votes_of(const WideImage& person, const DepthImage& depth) {
  Image<PersonVote> votes(voters(depth.width(), kVoteStep), voters(depth.height(), kVoteStep));
  for (int v = 0; v < votes.height(); ++v) {
    for (int u = 0; u < votes.width(); ++u) {
      const std::int16_t* of = person.at(u, v);
      votes(u, v) = {{of[0], of[1], of[2]}, {of[3], of[4]}};
    }
  }
  return votes;
}

void write_part_votes(const WideImage& centres, const DepthImage& depth, PartVotes& votes) {
  votes = {.parts = centres.channels / kCentreNumbers, .ways_mm = std::move(votes.ways_mm)};
  votes.ways_mm.clear();
  if (centres.values.empty()) return;
  votes.width = voters(depth.width(), kPartVoteStep);
  votes.height = voters(depth.height(), kPartVoteStep);
  for (int v = 0; v < votes.height; ++v) {
    votes.ways_mm.insert(votes.ways_mm.end(), centres.at(0, v), centres.at(votes.width, v));
  }
}

}  // namespace

struct NetworkLabeller::Working {
  Working(RunNetwork by, int parts) : run(std::move(by)), classes(parts + 1) {}

  RunNetwork run;
  int classes;
  struct Memory {
    NetworkInput input;
    NetworkResult result;
    Posteriors half;  ///< of every second pixel
  };
  mutable Pool<Memory> memory;
};

NetworkLabeller::NetworkLabeller(const Network& network, int parts)
    : NetworkLabeller([runner = std::make_shared<const NetworkRunner>(network, parts)](
                          const NetworkInput& input, NetworkResult& out) { runner->run(input, out); },
                      parts) {}

NetworkLabeller::NetworkLabeller(RunNetwork run, int parts)
    : working_(std::make_unique<const Working>(std::move(run), parts)) {}

NetworkLabeller::~NetworkLabeller() = default;

void NetworkLabeller::label_into(const Frame& frame, float gate, Posteriors& out) const {
  const DepthImage& depth = frame.depth;
  check_sides(depth);
  Working::Memory memory = working_->memory.take();
  fill_network_input(depth, frame.camera.fx, memory.input);
  working_->run(memory.input, memory.result);
  Posteriors& half = memory.half;
  const int half_width = (depth.width() + 1) / 2, half_height = (depth.height() + 1) / 2;
  half.resize_like({.width = half_width,
                    .height = half_height,
                    .classes = working_->classes,
                    .whole = kNetworkWhole,
                    .sums = {},
                    .settled = Mask(half_width, half_height, 0)});
  parallel_ranges(half.height, kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      softmax_in_steps(memory.result.classes.at(0, v), half.width, half.classes, kNetworkWhole, half.at(0, v));
      for (int u = 0; u < half.width; ++u) {
        half.settled(u, v) = half.at(u, v)[half.classes - 1] == kNetworkWhole ? 1 : 0;
      }
    }
  });
  out.resize_like(
      {.width = depth.width(), .height = depth.height(), .classes = half.classes, .whole = kNetworkWhole, .sums = {}});
  out.headings = 0;
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) enlarge_row(depth, half, v, out);
  });
  out.votes = votes_of(memory.result.person, depth);
  write_part_votes(memory.result.centres, depth, out.part_votes);
  working_->memory.give_back(std::move(memory));
  if (gate > 1.F) return;
  const BackgroundGate closed(depth, out, gate);
  out.settled = Mask(depth.width(), depth.height(), 0);
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      closed.row(v, out.settled.row(v));
      for (int u = 0; u < depth.width(); ++u) {
        if (depth(u, v) == 0) out.settled(u, v) = 0;
      }
    }
  });
}

}  // namespace vesalius
