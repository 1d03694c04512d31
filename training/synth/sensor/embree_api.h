#pragma once

// The calls that differ between Embree 3 and Embree 4.

#if VESALIUS_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace vesalius::synth {

/// Finds the first hit of 16 rays of similar direction. `valid` is -1 for rays to cast and 0 for the others.
inline void intersect_packet(const int* valid, RTCScene scene, RTCRayHit16& rays) {
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
inline void occlude_packet(const int* valid, RTCScene scene, RTCRay16& rays) {
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

}  // namespace vesalius::synth
