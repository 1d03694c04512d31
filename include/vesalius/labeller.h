#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

struct SmoothOptions;

/// What a pixel tells of the person whom it belongs to, if it belongs to one.
struct PersonVote {
  std::array<std::int16_t, 3> middle_mm{};  ///< way from the pixel's point to the person's middle; optical frame
  std::array<std::int16_t, 2> heading{};    ///< cosine and sine of the person's heading (YawEstimate), in 1/8192
  friend bool operator==(const PersonVote&, const PersonVote&) = default;
};
/// There is a vote for every so many pixels of every so many rows, the first included.
inline constexpr int kVoteStep = 4;

/// Where pixels say that the parts of their person are, also those that are hidden.
struct PartVotes {
  int width = 0;
  int height = 0;
  int parts = 0;
  /// Ways from a pixel's point to the centres of the parts' volumes, mm, optical frame: [row][column][part][axis].
  std::vector<std::int16_t> ways_mm = {};

  const std::int16_t* at(int column, int row) const {
    return ways_mm.data() + (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + std::size_t(column)) *
                                std::size_t(parts) * 3;
  }
  friend bool operator==(const PartVotes&, const PartVotes&) = default;
};
/// As kVoteStep, of PartVotes.
inline constexpr int kPartVoteStep = 8;

/// What a labeller knows of a picture: P(c | x) of every pixel, `classes` values for each pixel, pixel after pixel.
/// Body parts come first, then the background. All are zero if depth has no reading. What else a labeller may know is
/// empty where it does not, and who wants it asks for that: headings, votes.
struct Posteriors {
  int width = 0;
  int height = 0;
  int classes = 0;
  int whole = 0;  ///< sums / whole are probabilities; at most 65535. A forest's is 255 for each tree
  std::vector<std::uint16_t> sums;
  int headings = 0;  ///< headings that `turns` tells apart; 0: none
  /// P(side, heading | x, body) in 1/65535 of every pixel about which the labeller was asked: for each pixel the
  /// headings of the middle parts, of the left ones and of the right ones (leaf_logits.h). Others are undefined.
  std::vector<std::uint16_t> turns = {};
  /// 1 on settled pixels, around which the labeller was so certain of the background that it gave them a neighbour's
  /// posteriors. They are background, and smoothing leaves them as they are. Empty if the labeller looked at every
  /// pixel.
  Mask settled = {};
  /// Votes for the middles of people, a picture of kVoteStep-th the size, rounded up. Undefined where depth has no
  /// reading. Empty if the labeller knows of none.
  Image<PersonVote> votes = {};
  /// Votes for the centres of parts, a picture of kPartVoteStep-th the size, rounded up; as `votes`.
  PartVotes part_votes = {};

  const std::uint16_t* at(int u, int v) const {
    return sums.data() + (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)) *
                             static_cast<std::size_t>(classes);
  }
  std::uint16_t* at(int u, int v) { return const_cast<std::uint16_t*>(std::as_const(*this).at(u, v)); }

  std::size_t turn_count() const { return 3U * static_cast<std::size_t>(headings); }
  const std::uint16_t* turns_at(int u, int v) const {
    return turns.data() +
           (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)) * turn_count();
  }
  std::uint16_t* turns_at(int u, int v) { return const_cast<std::uint16_t*>(std::as_const(*this).turns_at(u, v)); }

  /// Takes the size and the settled pixels of `other`. The numbers are undefined.
  void resize_like(const Posteriors& other) {
    width = other.width;
    height = other.height;
    classes = other.classes;
    whole = other.whole;
    settled = other.settled;
    sums.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(classes));
  }
};

/// Returns the share of the first `parts` classes in all of a pixel's, 0-1: how probably it is a body. Returns nothing
/// where depth has no reading.
inline std::optional<double> body_share(const Posteriors& posteriors, int u, int v, int parts) {
  const std::uint16_t* sums = posteriors.at(u, v);
  const int body = std::accumulate(sums, sums + parts, 0);
  const int all = std::accumulate(sums + parts, sums + posteriors.classes, body);
  return all > 0 ? std::optional(double(body) / all) : std::nullopt;
}

/// Gives every pixel of a frame its posteriors: those of the parts of a body and, last, that of the background. A model
/// (vesalius/model.h) has one; tests and experiments provide others (the truth, a network).
///
/// All member functions are called from several threads at once, also for different frames: a labeller keeps nothing
/// between calls that could change a result. It may run work in parallel itself (vesalius/parallel.h).
class Labeller {
 public:
  virtual ~Labeller() = default;

  /// Writes the posteriors of all pixels to `out` and reuses its memory. It sees the whole frame: depth, colour if
  /// there is some, the camera, and the way up if it was measured. What Posteriors calls optional is left empty by
  /// those who do not know it. If the background has a probability of at least `gate` all around a pixel, the pixel may
  /// get the posteriors of a neighbour of similar depth and be marked as settled. A labeller that looks at such pixels
  /// gives other posteriors there, which are equally valid. With a gate above 1 every pixel is looked at, and all
  /// devices give the same bits.
  virtual void label_into(const Frame& frame, float gate, Posteriors& out) const = 0;

  /// Writes the posteriors as label_into does, and to `smooth` the smoothed ones. Returns false and does nothing where
  /// that is mean_filter of the former (smooth_labels.h) and no quicker than one after the other.
  virtual bool label_and_smooth_into(const Frame& /*frame*/, float /*gate*/, const SmoothOptions& /*options*/,
                                     Posteriors& /*out*/, Posteriors& /*smooth*/) const {
    return false;
  }

  /// Looks again at the pixels of one person, those where `person` is not 0, all inside `box`: writes their smoothed
  /// posteriors to `out`, a picture of the box's size. Returns false and does nothing where that would tell no more
  /// than the posteriors of the whole frame do.
  virtual bool label_person_into(const Frame& /*frame*/, const Mask& /*person*/, const Box& /*box*/,
                                 const SmoothOptions& /*options*/, Posteriors& /*out*/) const {
    return false;
  }

  /// Returns how many neighbours along a side of its window smoothing takes where SmoothOptions does not say; 0: as
  /// many as forests need, whose pixels are labelled one by one.
  virtual int smoothing_window() const { return 0; }

  /// Returns the posteriors of all pixels, each looked at.
  Posteriors label(const Frame& frame) const {
    Posteriors out;
    label_into(frame, 2.F, out);
    return out;
  }
};

}  // namespace vesalius
