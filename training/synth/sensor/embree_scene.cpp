#include "synth/sensor/embree_scene.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>

#include "synth/sensor/camera_rays.h"
#include "vesalius/error.h"

#if VESALIUS_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace vesalius::synth {
namespace {

// The two calls that differ between Embree 3 and Embree 4.

/// Finds the first hit of 16 rays of similar direction. `valid` is -1 for rays to cast and 0 for the others.
void intersect_packet(const int* valid, RTCScene scene, RTCRayHit16& rays) {
#if VESALIUS_EMBREE_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &rays, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, &rays);
#endif
}

/// Sets tfar of each ray that meets a surface to -infinity.
void occlude_packet(const int* valid, RTCScene scene, RTCRay16& rays) {
#if VESALIUS_EMBREE_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &rays, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &context, &rays);
#endif
}

constexpr int kPacket = 16;
constexpr int kTile = 4;  ///< side in pixels of the square that a packet of rays covers
static_assert(kTile - 1 == CameraRays::kBeyond && kTile * kTile == kPacket);

void check(RTCDevice device) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_NONE) return;
  throw Error(fmt::format("Embree: error {}{}", int(code), code == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
}

/// Rays from one point. Only what differs between packets is written for each.
struct Packet {
  alignas(64) std::array<int, kPacket> valid{};
  alignas(64) RTCRayHit16 rays{};

  explicit Packet(const Eigen::Vector3f& from) {
    std::fill_n(rays.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    for (int i = 0; i < kPacket; ++i) {
      rays.ray.org_x[i] = from.x();
      rays.ray.org_y[i] = from.y();
      rays.ray.org_z[i] = from.z();
      rays.ray.mask[i] = 0xFFFFFFFFU;
    }
  }
  void aim(int i, float x, float y, float z, float far) {
    rays.ray.dir_x[i] = x;
    rays.ray.dir_y[i] = y;
    rays.ray.dir_z[i] = z;
    rays.ray.tfar[i] = far;
  }
};

}  // namespace

struct EmbreeScene::State {
  // Embree's "threads=1" would limit all TBB work of the process to one thread. An arena with one slot limits Embree
  // alone, and keeps a waiting thread from starting other work, such as the next frame, in between.
  tbb::task_arena alone{1};
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  State() {
    alone.execute([this] { device = rtcNewDevice(nullptr); });
    if (device != nullptr && rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_TASKING_SYSTEM) != 1) {
      rtcReleaseDevice(device);  // this Embree has threads of its own, which the switch limits
      device = rtcNewDevice("threads=1");
    }
    if (device == nullptr) check(nullptr);
    if (device == nullptr) throw Error("Embree: cannot start");
  }
  ~State() {
    if (scene != nullptr) rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

EmbreeScene::EmbreeScene() : state_(std::make_unique<State>()) {}
EmbreeScene::~EmbreeScene() = default;

void EmbreeScene::build(const SceneGeometry& geometry) {
  State& state = *state_;
  if (state.scene != nullptr) rtcReleaseScene(state.scene);
  state.scene = rtcNewScene(state.device);
  rtcSetSceneFlags(state.scene, RTC_SCENE_FLAG_ROBUST);  // no ray slips between two triangles
  rtcSetSceneBuildQuality(state.scene, RTC_BUILD_QUALITY_LOW);
  if (!geometry.quads.empty()) {
    RTCGeometry quads = rtcNewGeometry(state.device, RTC_GEOMETRY_TYPE_QUAD);
    rtcSetGeometryBuildQuality(quads, RTC_BUILD_QUALITY_LOW);
    rtcSetSharedGeometryBuffer(quads, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, geometry.vertices.data(), 0,
                               sizeof(Eigen::Vector3f), geometry.vertices.size() - 1);
    rtcSetSharedGeometryBuffer(quads, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, geometry.quads.data(), 0,
                               sizeof(SceneGeometry::Quad), geometry.quads.size());
    rtcCommitGeometry(quads);
    rtcAttachGeometry(state.scene, quads);
    rtcReleaseGeometry(quads);
  }
  state.alone.execute([&] { rtcCommitScene(state.scene); });
  check(state.device);
}

void EmbreeScene::cast(const Camera& camera, Image<std::uint32_t>& hits) {
  Packet packet(Eigen::Vector3f::Zero());
  packet.valid.fill(-1);
  const CameraRays rays(camera);
  std::array<std::uint32_t, kPacket> met;
  for (int top = 0; top < camera.height; top += kTile) {
    for (int left = 0; left < camera.width; left += kTile) {
      for (int i = 0; i < kPacket; ++i) {
        packet.aim(i, rays.x(left + i % kTile), rays.y(top + i / kTile), 1.F, std::numeric_limits<float>::infinity());
        packet.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      intersect_packet(packet.valid.data(), state_->scene, packet.rays);
      const RTCHit16& hit = packet.rays.hit;
      for (int i = 0; i < kPacket; ++i) {
        const std::uint32_t triangle = 2 * hit.primID[i] + static_cast<std::uint32_t>(hit.u[i] + hit.v[i] > 1.F);
        met[i] = hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? kNothing : triangle;
      }
      const int columns = std::min(kTile, camera.width - left), rows = std::min(kTile, camera.height - top);
      for (int v = 0; v < rows; ++v) std::copy_n(met.data() + v * kTile, columns, hits.row(top + v) + left);
    }
  }
}

void EmbreeScene::light(const std::vector<ShadowRay>& rays, const Eigen::Vector3f& projector, Mask& lit) {
  Packet packet(projector);
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    const int count = int(std::min<std::size_t>(kPacket, rays.size() - first));
    for (int i = 0; i < kPacket; ++i) {
      packet.valid[i] = i < count ? -1 : 0;
      const Eigen::Vector3f& from = rays[first + static_cast<std::size_t>(i < count ? i : 0)].from;
      packet.aim(i, from.x() - projector.x(), from.y() - projector.y(), from.z() - projector.z(), 1.F);
    }
    occlude_packet(packet.valid.data(), state_->scene, packet.rays.ray);
    for (int i = 0; i < count; ++i) {
      if (packet.rays.ray.tfar[i] > 0.F) lit[rays[first + static_cast<std::size_t>(i)].pixel] = 1;
    }
  }
}

const char* embree_version() { return "Embree " RTC_VERSION_STRING; }

}  // namespace vesalius::synth
