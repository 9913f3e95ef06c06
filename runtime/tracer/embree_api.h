// This file hides the one argument in which single rays of Embree 3.13 and 4 differ. Only embree_scene and
// its benchmark include this.
#pragma once

#if SUNBEAM_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace sunbeam {

inline void intersect_one(RTCScene scene, RTCRayHit& query) {
#if SUNBEAM_EMBREE_MAJOR >= 4
  rtcIntersect1(scene, &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
#endif
}

// Sets tfar to -infinity if anything is met.
inline void occluded_one(RTCScene scene, RTCRay& query) {
#if SUNBEAM_EMBREE_MAJOR >= 4
  rtcOccluded1(scene, &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &query);
#endif
}

}  // namespace sunbeam
