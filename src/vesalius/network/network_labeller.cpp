#include "vesalius/network/network_labeller.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <span>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/pool.h"
#include "vesalius/error.h"
#include "vesalius/forest/background_gate.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/network/network_input.h"
#include "vesalius/network/run_network.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Posteriors::whole: what smoothing sums over its window fits 16 bits.
constexpr int kNetworkWhole = 2040;
constexpr double kHalf = 0.5;  ///< added to what is rounded down, which is the same everywhere

/// exp(-i / 256) of every i, until it is nothing; in 2^-16. By products of doubles, which are the same everywhere.
class Powers {
 public:
  static constexpr int kCount = 2560;  ///< exp(-10) is less than a tenth of 1 / kNetworkWhole

  Powers() {
    constexpr double step = 0.99610136947011749;  // exp(-1 / 256)
    double power = 65536.0;
    for (std::uint32_t& each : powers_) {
      each = static_cast<std::uint32_t>(power + kHalf);
      power *= step;
    }
  }
  std::uint32_t operator()(int below) const { return below < kCount ? powers_[below] : 0; }

 private:
  std::array<std::uint32_t, kCount> powers_{};
};

/// Makes posteriors of all pixels of those of every second one, which are settled where nothing but the background is
/// possible.
class Enlarger {
 public:
  Enlarger(const DepthImage& depth, const Posteriors& half, Posteriors& out)
      : depth_(depth), half_(half), out_(out), classes_(static_cast<std::size_t>(half.classes)) {}

  void row(int v) const {
    for (int u = 0; u < depth_.width(); ++u) {
      const int mm = depth_(u, v);
      if (mm == 0) {
        std::fill_n(out_.at(u, v), classes_, std::uint16_t{0});
      } else if ((u % 2 == 0 && v % 2 == 0) || is_settled(u, v)) {
        std::copy_n(half_.at(u / 2, v / 2), classes_, out_.at(u, v));
      } else {
        mix(u, v, mm);
      }
    }
  }

 private:
  bool is_settled(int u, int v) const {
    const int right = std::min((u + 1) / 2, half_.width - 1), below = std::min((v + 1) / 2, half_.height - 1);
    return (half_.settled(u / 2, v / 2) & half_.settled(right, v / 2) & half_.settled(u / 2, below) &
            half_.settled(right, below)) != 0;
  }

  /// Takes the mean of the pixels around whose depth is like this one's; if none is, the one that is nearest to it.
  void mix(int u, int v, int mm) const {
    const int like_mm = 20 + 3 * mm / 100;
    const int last_u = std::min((u + 1) / 2, half_.width - 1), last_v = std::min((v + 1) / 2, half_.height - 1);
    std::array<const std::uint16_t*, 4> like{};
    int count = 0, nearest_mm = 1 << 17;
    const std::uint16_t* nearest = nullptr;
    for (int hv = v / 2; hv <= last_v; ++hv) {
      for (int hu = u / 2; hu <= last_u; ++hu) {
        const int there_mm = depth_(2 * hu, 2 * hv);
        const int off_mm = there_mm == 0 ? 1 << 16 : std::abs(there_mm - mm);
        if (off_mm < like_mm) like[count++] = half_.at(hu, hv);
        if (off_mm < nearest_mm) nearest = half_.at(hu, hv);
        nearest_mm = std::min(nearest_mm, off_mm);
      }
    }
    std::uint16_t* to = out_.at(u, v);
    if (count < 2) {
      std::copy_n(nearest, classes_, to);
    } else {
      mean({like.data(), std::size_t(count)}, to);
    }
  }

  void mean(std::span<const std::uint16_t* const> of, std::uint16_t* to) const {
    static constexpr std::array<std::uint32_t, 5> kFactor{0, 65536, 32768, 21846, 16384};
    const std::uint16_t *a = of[0], *b = of[1], *c = of[of.size() > 2 ? 2 : 0], *d = of[of.size() > 3 ? 3 : 0];
    const std::uint32_t factor = kFactor[of.size()];
    const std::uint32_t third = of.size() > 2 ? 1 : 0, fourth = of.size() > 3 ? 1 : 0;
    for (std::size_t i = 0; i < classes_; ++i) {
      to[i] = static_cast<std::uint16_t>(((a[i] + b[i] + third * c[i] + fourth * d[i]) * factor) >> 16U);
    }
  }

  const DepthImage& depth_;
  const Posteriors& half_;
  Posteriors& out_;
  std::size_t classes_;
};

Image<PersonVote> votes_of(const WideImage& person, const DepthImage& depth) {
  const auto part = [](int size) { return (size + kVoteStep - 1) / kVoteStep; };
  Image<PersonVote> votes(part(depth.width()), part(depth.height()));
  for (int v = 0; v < votes.height(); ++v) {
    for (int u = 0; u < votes.width(); ++u) {
      const std::int16_t* of = person.at(u, v);
      votes(u, v) = {{of[0], of[1], of[2]}, {of[3], of[4]}};
    }
  }
  return votes;
}

}  // namespace

void softmax_in_steps(const std::int16_t* logits, int count, int whole, std::uint16_t* shares) {
  static const Powers powers;
  std::int16_t body = std::numeric_limits<std::int16_t>::min();
  for (int c = 0; c + 1 < count; ++c) body = std::max(body, logits[c]);
  const std::int16_t last = logits[count - 1], most = std::max(body, last);
  if (last - body >= Powers::kCount) {
    std::fill_n(shares, count - 1, std::uint16_t{0});
    shares[count - 1] = static_cast<std::uint16_t>(whole);
    return;
  }
  std::array<std::uint32_t, 256> power;
  std::uint32_t sum = 0;
  for (int c = 0; c < count; ++c) sum += power[c] = powers(most - logits[c]);
  const float scale = float(whole) / float(sum);
  for (int c = 0; c < count; ++c) shares[c] = static_cast<std::uint16_t>(float(power[c]) * scale + float(kHalf));
}

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
      for (int u = 0; u < half.width; ++u) {
        softmax_in_steps(memory.result.classes.at(u, v), half.classes, kNetworkWhole, half.at(u, v));
        half.settled(u, v) = half.at(u, v)[half.classes - 1] == kNetworkWhole ? 1 : 0;
      }
    }
  });
  out.resize_like(
      {.width = depth.width(), .height = depth.height(), .classes = half.classes, .whole = kNetworkWhole, .sums = {}});
  out.headings = 0;
  const Enlarger enlarger(depth, half, out);
  parallel_ranges(depth.height(), kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) enlarger.row(v);
  });
  out.votes = votes_of(memory.result.person, depth);
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
