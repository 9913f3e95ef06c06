// This file holds the unidirectional estimator of the rest, for a packet of walks at once (templates; see
// pfmc.h).
//
// Throughputs are powers per wavelength. At the base a walk that arrived along m connects to m', a crossing
// drawn from wo: f1(m, m') T(wo -> m'). That alone serves every film: f1 is bounded by kd / pi and the
// crossing's weight by 1. (Adding the walk's own way out through a rough film by multiple importance sampling
// was measured: more time and, if anything, more noise; docs/theory/live.md.)
#pragma once

#include "bake/live/walks/film_events.h"

namespace sunbeam::walk {

// Roulette starts when the film and the albedo together have left less than this of a walk. It looks at
// neither absorption nor base sampling: with the product path later visits can outweigh the first.
// Measured: earlier costs more in noise, later in time.
inline constexpr double kRouletteStart = 0.05;

// One walk with "product" serves this many directions at most; they are kept on the stack.
inline constexpr int kMostExits = 8;

// Decides for all lanes together when a walk ends.
class Roulette {
 public:
  // `share` is what one more visit leaves of the brightest wavelength. Returns the factor to go on with, or
  // 0.
  SUNBEAM_INLINE double go_on(double share, Rng& rng) {
    left_ *= share;
    if (left_ >= kRouletteStart) return 1;
    const double survival = left_ / kRouletteStart;
    if (!(rng.uniform() < survival)) return 0;
    left_ = kRouletteStart;
    return 1 / survival;
  }

 private:
  double left_ = 1;
};

// Describes light on its way down that is about to reach the base.
template <class V>
struct Arrival {
  V cosine;
  Spectrum<V> throughput;
};

// Makes the steps of a walk between two visits of the base, on either side of a path.
template <class V, bool kLayered>
class Steps {
 public:
  SUNBEAM_INLINE explicit Steps(const Layers& layers) : layers_(layers), events_(layers) {}

  const Events<V, kLayered>& events() const { return events_; }

  // Takes light through the film from outside along w, and returns that crossing.
  SUNBEAM_INLINE Crossing<V> enter(const V& w, Rng& rng, Arrival<V>& arrival) const {
    const Crossing<V> crossing = events_.cross(w, rng);
    arrival.cosine = crossing.cosine;
    events_.transmittances(crossing.film,
                           [&](int j, const V& t) { arrival.throughput[j] = t * crossing.weight; });
    return crossing;
  }

  // Applies with "sum" the pigment's share of one direction; with "product" it is known only with the other
  // one.
  SUNBEAM_INLINE void arrive(Arrival<V>& light) const {
    if (!layers_.product) events_.attenuate(V(1) / light.cosine, light.throughput);
  }

  // Leaves the base upwards; throughputs become those of the light that leaves along the cosine returned.
  SUNBEAM_INLINE V leave_base(Arrival<V>& light, Rng& rng) const {
    const auto up = events_.leave_base(layers_.guide, rng);
    for (int j = 0; j < layers_.count; ++j) light.throughput[j] *= V(layers_.albedo[j]) * up.share;
    const V per_cosine = V(1) / up.cosine;
    events_.attenuate(layers_.product ? per_cosine / light.cosine : per_cosine, light.throughput);
    return up.cosine;
  }

  // reflect() mirrors light below the film back down. The factor is roulette's, 0 at the walk's end.
  struct Down {
    Reflection<V> event;
    double factor;
  };
  SUNBEAM_INLINE Down reflect(const V& up, Arrival<V>& light, Roulette& roulette, Rng& rng) const {
    const Reflection<V> event = events_.reflect_below(up, rng);
    light.cosine = event.cosine;
    V brightest(0);
    events_.reflectances_below(event.film, [&](int j, const V& r) {
      light.throughput[j] *= r * event.weight;
      brightest = max(brightest, r);
    });
    const double share = mean_of_lanes(brightest * event.weight) * layers_.brightest_albedo;
    const double factor = roulette.go_on(share, rng);
    if (factor != 1)
      for (int j = 0; j < layers_.count; ++j) light.throughput[j] *= V(factor);
    return {event, factor};
  }

 private:
  const Layers& layers_;
  Events<V, kLayered> events_;
};

template <class V, bool kLayered = false>
class UnidirectionalWalk {
 public:
  SUNBEAM_INLINE explicit UnidirectionalWalk(const Layers& layers) : steps_(layers), layers_(layers) {}

  // Adds the packet's estimate of rest(wo[k], wi), 1/sr per wavelength, to sums[k * count + j]; k < exits.
  SUNBEAM_INLINE void add(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    if (layers_.product) {
      for (int first = 0; first < exits; first += kMostExits)
        add_product(wi, wo + first, std::min(exits - first, kMostExits), rng, sums + first * layers_.count);
    } else {
      add_sum(wi, wo, exits, rng, sums);
    }
  }

 private:
  // Adds the estimate with "sum", where f1 is a product: all lanes of the walk, at all their visits, connect
  // to all lanes of an exit.
  SUNBEAM_INLINE void add_sum(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    Spectrum<V> arrived;
    for (int j = 0; j < layers_.count; ++j) arrived[j] = V(0);
    walk(wi, rng, [&](const Arrival<V>& light) {
      for (int j = 0; j < layers_.count; ++j) arrived[j] += light.throughput[j];
    });
    Arrival<V> exit;
    for (int k = 0; k < exits; ++k) {
      prepare_exit(wo[k], rng, exit);
      for (int j = 0; j < layers_.count; ++j)
        sums[k * layers_.count + j] += mean_of_lanes(arrived[j]) * mean_of_lanes(exit.throughput[j]);
    }
  }

  // Adds the estimate with "product", where each lane connects to its own.
  SUNBEAM_INLINE void add_product(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    Arrival<V> exit[kMostExits];
    Spectrum<V> sum[kMostExits];
    for (int k = 0; k < exits; ++k) {
      prepare_exit(wo[k], rng, exit[k]);
      for (int j = 0; j < layers_.count; ++j) sum[k][j] = V(0);
    }
    walk(wi, rng, [&](const Arrival<V>& light) {
      for (int k = 0; k < exits; ++k) {
        Spectrum<V> value;
        for (int j = 0; j < layers_.count; ++j) value[j] = light.throughput[j] * exit[k].throughput[j];
        steps_.events().attenuate(V(1) / (light.cosine * exit[k].cosine), value);
        for (int j = 0; j < layers_.count; ++j) sum[k][j] += value[j];
      }
    });
    for (int k = 0; k < exits; ++k)
      for (int j = 0; j < layers_.count; ++j) sums[k * layers_.count + j] += mean_of_lanes(sum[k][j]);
  }

  // Calls visit(light) at every visit of the base.
  template <class F>
  SUNBEAM_INLINE void walk(double wi, Rng& rng, F visit) const {
    Arrival<V> light;
    steps_.enter(V(wi), rng, light);
    Roulette roulette;
    double factor = 1;
    while (factor > 0) {
      steps_.arrive(light);
      visit(light);
      const V up = steps_.leave_base(light, rng);
      factor = steps_.reflect(up, light, roulette, rng).factor;
    }
  }

  // Prepares the way out along wo, from the base's kd / pi on.
  SUNBEAM_INLINE void prepare_exit(double wo, Rng& rng, Arrival<V>& exit) const {
    steps_.enter(V(wo), rng, exit);
    steps_.arrive(exit);
    for (int j = 0; j < layers_.count; ++j)
      exit.throughput[j] *= V(layers_.albedo[j] * kInvPi * layers_.radiance_scale);
  }

  Steps<V, kLayered> steps_;
  const Layers& layers_;
};

}  // namespace sunbeam::walk
