#include "vesalius/find_clusters.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "vesalius/base/rays.h"
#include "vesalius/frame.h"

namespace vesalius {
namespace {

/// The sums over the pixels of one cluster. They are double so that distant clusters keep their covariance, and each by
/// itself so that they stay in registers.
struct Moments {
  double x = 0.0, y = 0.0, z = 0.0;
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  void add(const Eigen::Vector3f& point) {
    const Eigen::Vector3d p = point.cast<double>();
    x += p.x();
    y += p.y();
    z += p.z();
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    xz += p.x() * p.z();
    yy += p.y() * p.y();
    yz += p.y() * p.z();
    zz += p.z() * p.z();
  }
  Eigen::Vector3d sum() const { return {x, y, z}; }
  Eigen::Matrix3d products() const { return Eigen::Matrix3d{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}; }
};

class ClusterFinder {
 public:
  ClusterFinder(const LabelImage& labels, const DepthImage& depth, const Camera& camera, const BodyModel& body,
                const ClusterOptions& options, const Box& within)
      : labels_(labels),
        depth_(depth),
        camera_(camera),
        body_(body),
        options_(options),
        within_(within),
        rays_(camera),
        open_(within.width + 2, within.height + 2, kBackground) {
    for (int v = 0; v < within.height; ++v) {
      const std::uint8_t* from = labels.row(within.v + v) + within.u;
      const std::uint16_t* reading = depth.row(within.v + v) + within.u;
      std::transform(from, from + within.width, reading, open_.row(v + 1) + 1,
                     [](std::uint8_t label, std::uint16_t mm) { return mm != 0 ? label : kBackground; });
    }
  }

  Clusters run() {
    Clusters out;
    out.index = Image<std::int32_t>(labels_.width(), labels_.height(), kNone);
    std::vector<PartCluster> kept;
    for (int v = 0; v < within_.height; ++v) {
      const std::uint8_t* labels = open_.row(v + 1) + 1;
      for (int u = 0; u < within_.width; ++u) {
        if (labels[u] >= parts_) continue;  // most pixels
        const PartCluster cluster = fill(u, v);
        if (!feasible(cluster)) continue;
        for (const auto& [pu, pv] : queue_) {
          out.index(within_.u + pu, within_.v + pv) = static_cast<std::int32_t>(kept.size());
        }
        kept.push_back(cluster);
      }
    }
    renumber(kept, out);
    return out;
  }

 private:
  static constexpr std::int32_t kNone = -1;

  /// A pixel of the box.
  struct Pixel {
    int u, v;
  };

  Eigen::Vector3f point(int u, int v) const { return rays_.point(depth_, within_.u + u, within_.v + v); }

  bool connected(const Eigen::Vector3f& a, const Eigen::Vector3f& b) const {
    const float gap = options_.max_gap_m + options_.max_gap_per_z2 * a.z() * b.z();
    return (a - b).squaredNorm() <= gap * gap;
  }

  /// Runs a breadth-first search from (u, v) of the box. Leaves the cluster's pixels in queue_, and closes them.
  PartCluster fill(int u, int v) {
    PartCluster cluster;
    cluster.label = open_(u + 1, v + 1);
    cluster.first_pixel = (within_.v + v) * labels_.width() + within_.u + u;
    Moments moments;
    double area = 0.0;
    queue_.assign(1, {u, v});
    open_(u + 1, v + 1) = kBackground;
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const auto [pu, pv] = queue_[head];
      const Eigen::Vector3f here = point(pu, pv);
      moments.add(here);
      area += double(here.z()) * double(here.z());
      for (int nv = pv - 1; nv <= pv + 1; ++nv) {
        std::uint8_t* open = open_.row(nv + 1) + 1;
        for (int nu = pu - 1; nu <= pu + 1; ++nu) {
          if (open[nu] != cluster.label || !connected(here, point(nu, nv))) continue;
          open[nu] = kBackground;
          queue_.push_back({nu, nv});
        }
      }
    }
    cluster.pixels = int(queue_.size());
    cluster.area_m2 = float(area / (double(camera_.fx) * double(camera_.fy)));
    summarise(moments, cluster);
    return cluster;
  }

  static void summarise(const Moments& moments, PartCluster& cluster) {
    const double n = cluster.pixels;
    const Eigen::Vector3d mean = moments.sum() / n;
    const Eigen::Matrix3d covariance = moments.products() / n - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
    cluster.centroid = mean.cast<float>();
    cluster.covariance = covariance.cast<float>();
    cluster.eigenvalues = solver.eigenvalues().reverse().cwiseMax(0.0).cast<float>();
    cluster.extent_m = std::sqrt(12.F * cluster.eigenvalues.x());
  }

  bool feasible(const PartCluster& cluster) const {
    const BodyPart& part = body_.parts[cluster.label];
    return cluster.pixels >= options_.min_pixels && cluster.area_m2 * 1e4F >= options_.min_area_cm2 &&
           cluster.extent_m <= part.max_extent_m * options_.max_extent_scale;
  }

  void renumber(const std::vector<PartCluster>& kept, Clusters& out) const {
    std::vector<std::size_t> order(kept.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
      const PartCluster &x = kept[a], &y = kept[b];
      if (x.label != y.label) return x.label < y.label;
      if (x.area_m2 != y.area_m2) return x.area_m2 > y.area_m2;
      return x.first_pixel < y.first_pixel;
    });
    std::vector<std::int32_t> rank(kept.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      rank[order[i]] = static_cast<std::int32_t>(i);
      out.items.push_back(kept[order[i]]);
    }
    for (int v = within_.v; v < within_.v + within_.height; ++v) {
      std::int32_t* row = out.index.row(v) + within_.u;
      std::transform(row, row + within_.width, row, [&](std::int32_t i) { return i >= 0 ? rank[i] : kNone; });
    }
  }

  const LabelImage& labels_;
  const DepthImage& depth_;
  const Camera& camera_;
  const BodyModel& body_;
  const int parts_ = body_.part_count();
  const ClusterOptions& options_;
  const Box& within_;
  Rays rays_;
  LabelImage open_;  ///< labels in the box of pixels with a reading that no cluster has; a pixel more on all sides
  std::vector<Pixel> queue_;  ///< of the cluster being filled
};

}  // namespace

Clusters find_clusters(const LabelImage& labels, const DepthImage& depth, const Camera& camera, const BodyModel& body,
                       const ClusterOptions& options, const Box& within) {
  return ClusterFinder(labels, depth, camera, body, options, within).run();
}

}  // namespace vesalius
