// This file holds the bidirectional estimator of the rest (Guo, Hasan, Zhao 2018, Sec. 5), for a packet of
// walks at once. It is the cross-check of the unidirectional one, which is the faster of the two for these
// materials.
//
// A walk from wo, the camera's, is kept for its first kCameraVisits visits of the base; one from wi, the
// light's, goes on until roulette ends it, and each of its vertices connects to all of the camera's:
//   at the base     light arrived along m_s, camera arrived along n_t: f1(m_s, n_t);
//   at the film     light left the base along u_s, camera along v_t: the lower lobe (rough films);
//   on the way out  light left the base along u_s: its crossing to wo (glossy crossings);
//   on the way in   camera left the base along v_t: its crossing to wi (glossy crossings).
// A path with k visits of the base can be made in up to 2 k + 1 of these ways. The balance heuristic weighs
// them: shifting the connection by one vertex multiplies the density by (density of the direction between as
// the other walk draws it) / (as this one does), so the sum over all shifts is a recursion along each walk
// (the partial sums of Georgiev et al. 2012). In the code X is `down_sum`, for light on its way down, and U
// is `up_sum`; p(a | b) is the density of a given b:
//   X_s = [film + p(u_{s-1} | m_s) U_{s-1}] / p(m_s),    film = 1 if that connection exists, else 0,
//   U_s = [1 + p(m_s | u_s) X_s] / p(u_s),
//   weight = 1 / (1 + light's sum + camera's sum).
// Shifts towards the light end where the camera would need more visits than it keeps; so X and U are held for
// every number of visits that it has left. For a smooth film the densities of mirrored directions are Dirac
// on both sides and cancel: X_s = U_{s-1}. Densities at the base are those of cos-weighted directions,
// whatever the guide has, scaled to the least that it can give: weights may take any densities that all
// techniques agree on.
#pragma once

#include "bake/live/walks/unidirectional.h"

namespace sunbeam::walk {

inline constexpr int kCameraVisits = 4;

template <class V, bool kLayered = false>
class BidirectionalWalk {
 public:
  SUNBEAM_INLINE explicit BidirectionalWalk(const Layers& layers)
      : steps_(layers), layers_(layers), rough_(!layers.is_smooth()), glossy_(layers.has_glossy_crossing()) {}

  // Adds the packet's estimate of rest(wo, wi), 1/sr per wavelength, to sums[j].
  SUNBEAM_INLINE void add(double wi, double wo, Rng& rng, double* sums) const {
    Spectrum<V> estimate;
    for (int j = 0; j < layers_.count; ++j) estimate[j] = V(0);
    CameraVertex camera[kCameraVisits];
    const int visits = walk_camera(wi, wo, rng, camera, estimate);
    walk_light(wi, wo, rng, camera, visits, estimate);
    for (int j = 0; j < layers_.count; ++j) sums[j] += mean_of_lanes(estimate[j]);
  }

 private:
  struct CameraVertex {
    Arrival<V> down;    // n_t
    V down_sum;         // over shifts towards the camera; of X's kind
    V up;               // v_t
    Spectrum<V> power;  // after leaving the base
    V up_sum;           // of U's kind
  };
  // Holds the sums over shifts towards the light, by the visits that the camera has left.
  using Sums = std::array<V, kCameraVisits + 1>;

  SUNBEAM_INLINE static V base_density(const V& cosine) {
    return V(BaseGuide::kCosineShare * kInvPi) * cosine;
  }

  // These make one step of the recursions: U from X over the base, X from U over the film.
  SUNBEAM_INLINE static V sum_after_base(const V& arrived, const V& down_sum, const V& up) {
    return (V(1) + base_density(arrived) * down_sum) / base_density(up);
  }
  SUNBEAM_INLINE V sum_after_film(const Reflection<V>& event, const V& up_sum) const {
    return rough_ ? (V(1) + event.density_reverse * up_sum) / event.density : up_sum;
  }

  SUNBEAM_INLINE int walk_camera(double wi, double wo, Rng& rng, CameraVertex* camera,
                                 Spectrum<V>& estimate) const {
    Arrival<V> light;
    const V density = steps_.enter(V(wo), rng, light).density;
    V down_sum = glossy_ ? V(1) / density : V(0);
    Roulette roulette;
    for (int t = 0;; ++t) {
      CameraVertex& vertex = camera[t];
      steps_.arrive(light);
      vertex.down = light;
      vertex.down_sum = down_sum;
      vertex.up = steps_.leave_base(light, rng);
      vertex.power = light.throughput;
      vertex.up_sum = sum_after_base(vertex.down.cosine, down_sum, vertex.up);
      if (glossy_) leave(vertex.up, vertex.power, wi, vertex.up_sum, rng, estimate);
      if (t + 1 == kCameraVisits) return kCameraVisits;
      const auto next = steps_.reflect(vertex.up, light, roulette, rng);
      if (next.factor == 0) return t + 1;
      down_sum = sum_after_film(next.event, vertex.up_sum);
    }
  }

  SUNBEAM_INLINE void walk_light(double wi, double wo, Rng& rng, const CameraVertex* camera, int visits,
                                 Spectrum<V>& estimate) const {
    Arrival<V> light;
    const V density = steps_.enter(V(wi), rng, light).density;
    Sums down, up;
    for (V& sum : down) sum = glossy_ ? V(1) / density : V(0);
    Roulette roulette;
    for (;;) {
      steps_.arrive(light);
      for (int t = 0; t < visits; ++t)
        connect_at_base(light, down[kCameraVisits - 1 - t], camera[t], estimate);
      const V arrived = light.cosine, cosine = steps_.leave_base(light, rng);
      up[0] = V(0);
      for (int left = 1; left <= kCameraVisits; ++left)
        up[left] = sum_after_base(arrived, down[left - 1], cosine);
      if (rough_)
        for (int t = 0; t < visits; ++t)
          connect_at_film(cosine, light.throughput, up[kCameraVisits - 1 - t], camera[t], rng, estimate);
      if (glossy_) leave(cosine, light.throughput, wo, up[kCameraVisits], rng, estimate);
      const auto next = steps_.reflect(cosine, light, roulette, rng);
      if (next.factor == 0) return;
      for (int left = 0; left < kCameraVisits; ++left) down[left] = sum_after_film(next.event, up[left]);
    }
  }

  SUNBEAM_INLINE void connect_at_base(const Arrival<V>& light, const V& light_sum, const CameraVertex& camera,
                                      Spectrum<V>& estimate) const {
    const V weight =
        V(kInvPi * layers_.radiance_scale) /
        (V(1) + base_density(light.cosine) * light_sum + base_density(camera.down.cosine) * camera.down_sum);
    Spectrum<V> value;
    for (int j = 0; j < layers_.count; ++j)
      value[j] = light.throughput[j] * camera.down.throughput[j] * V(layers_.albedo[j]) * weight;
    if (layers_.product) steps_.events().attenuate(V(1) / (light.cosine * camera.down.cosine), value);
    for (int j = 0; j < layers_.count; ++j) estimate[j] += value[j];
  }

  SUNBEAM_INLINE void connect_at_film(const V& up, const Spectrum<V>& power, const V& light_sum,
                                      const CameraVertex& camera, Rng& rng, Spectrum<V>& estimate) const {
    const auto lobe = steps_.events().mirror_towards(up, camera.up, rng);
    const V factor = lobe.value * V(layers_.radiance_scale) /
                     (V(1) + lobe.reverse * light_sum + lobe.forward * camera.up_sum);
    steps_.events().reflectances_below(
        lobe.film, [&](int j, const V& r) { estimate[j] += power[j] * camera.power[j] * r * factor; });
  }

  // Lets light out along w; `sum` is over shifts away from w. The lobe holds the radiance scale.
  SUNBEAM_INLINE void leave(const V& up, const Spectrum<V>& power, double w, const V& sum, Rng& rng,
                            Spectrum<V>& estimate) const {
    const auto lobe = steps_.events().cross_towards(up, V(w), rng);
    const V factor = lobe.value / (V(1) + lobe.reverse * sum);
    steps_.events().transmittances(lobe.film,
                                   [&](int j, const V& t) { estimate[j] += power[j] * t * factor; });
  }

  Steps<V, kLayered> steps_;
  const Layers& layers_;
  bool rough_, glossy_;
};

}  // namespace sunbeam::walk
