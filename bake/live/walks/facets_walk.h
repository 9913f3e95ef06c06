// This file estimates the base part of the rest with multiple facets, for a packet of walks at once. It
// serves isotropic facets and clear pigment (templates; see general_walk.h for the parts, microsurface.h for
// the facets).
//
// The base forgets azimuth and every event at a facet looks at signed polar cosines alone, so a walk is a
// cosine and a height. Lanes need different numbers of facets between two visits of the base: every round is
// one facet for every lane, and a lane that comes out below visits the base and flies on to its next facet
// within the same round. No lane waits for others. What would leave upwards stays, with the chance that it
// does as its weight, so that lanes fade and never die; roulette ends all of them together, by what is left
// of their power.
//
// With "sum" a forecast stands in for what roulette ends: of what is still to come, from the power that is
// left. Light that goes on is paid the difference, so a wrong forecast costs noise and no bias.
//
// Both sides of a single clear film share one reflectance: that at the cosine outside.
#pragma once

#include "bake/live/walks/unidirectional.h"

namespace sunbeam::walk {

template <class V, bool kLayered = false>
class FacetsWalk {
 public:
  SUNBEAM_INLINE explicit FacetsWalk(const Layers& layers)
      : layers_(layers), events_(layers), facets_(layers.alpha) {}

  // Adds the packet's estimate of the base part of rest(wo[k], wi), 1/sr per wavelength, to
  // sums[k * count + j]; k < exits.
  SUNBEAM_INLINE void add(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    if (layers_.product) {
      for (int first = 0; first < exits; first += kMostExits)
        add_product(wi, wo + first, std::min(exits - first, kMostExits), rng, sums + first * layers_.count);
    } else {
      add_sum(wi, wo, exits, rng, sums);
    }
  }

  // Adds an estimate of the share of the light at the base that comes back to it, per wavelength, to sums.
  SUNBEAM_INLINE void add_returns(Rng& rng, double* sums) const {
    Arrival<V> light;
    come_back(rng, light);
    for (int j = 0; j < layers_.count; ++j) sums[j] += mean_of_lanes(light.throughput[j]);
  }

 private:
  // Roulette starts when less than this is still to come: for walks over the base as a share of all that
  // comes after the first visit, for single crossings as a share of what enters. The first pair holds where a
  // forecast stands in for what ends, the second where none does.
  static constexpr double kForecastWalkEnd = 0.5, kForecastCrossingEnd = 0.8;
  static constexpr double kWalkEnd = 0.2, kCrossingEnd = 0.05;
  static constexpr double kNothing = 0.02;  // of what enters

  // Describes light between two facets or about to meet one, in the frame of a side: cosines > 0 lead away
  // from the facets.
  struct Flight {
    V is_outside;  // 1 or 0
    V travel;      // cosine
    V height;      // ln of the share of the microsurface below, 0 above everything
    Spectrum<V> power;
    V total;  // of power
  };

  // Says what a facet has done.
  struct Outcome {
    V comes_out;  // below: 1 or 0
    V share;      // uniform in (0, 1]: of the chance to fly at least as far as now
  };

  // Adds the estimate with "sum", where f1 is a product: all lanes of the walk, at all their visits, connect
  // to all lanes of an exit.
  SUNBEAM_INLINE void add_sum(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    Spectrum<V> arrived;
    for (int j = 0; j < layers_.count; ++j) arrived[j] = V(0);
    walk(
        wi, kForecastWalkEnd, rng,
        [&](const V&, const Spectrum<V>& power, const auto& is_here) {
          for (int j = 0; j < layers_.count; ++j) arrived[j] += select(is_here, power[j], V(0));
        },
        [&](const Spectrum<V>& ahead, double ended) {
          for (int j = 0; j < layers_.count; ++j) arrived[j] += ahead[j] * V(ended);
        });
    std::array<double, kMostWavelengths> leaving;
    for (int k = 0; k < exits; ++k) {
      leave(wo[k], rng, leaving);
      for (int j = 0; j < layers_.count; ++j)
        sums[k * layers_.count + j] += mean_of_lanes(arrived[j]) * leaving[j];
    }
  }

  // Adds the estimate with "product", where each lane connects to its own.
  SUNBEAM_INLINE void add_product(double wi, const double* wo, int exits, Rng& rng, double* sums) const {
    Arrival<V> exit[kMostExits];
    Spectrum<V> sum[kMostExits];
    for (int k = 0; k < exits; ++k) {
      prepare_exit(wo[k], kCrossingEnd, rng, exit[k], [](const Flight&, double) {});
      for (int j = 0; j < layers_.count; ++j) sum[k][j] = V(0);
    }
    const auto connect = [&](const V& cosine, const Spectrum<V>& power, const auto& is_here) {
      for (int k = 0; k < exits; ++k) {
        Spectrum<V> value;
        for (int j = 0; j < layers_.count; ++j)
          value[j] = select(is_here, power[j] * exit[k].throughput[j], V(0));
        events_.attenuate(V(1) / (select(is_here, cosine, V(1)) * exit[k].cosine), value);
        for (int j = 0; j < layers_.count; ++j) sum[k][j] += value[j];
      }
    };
    walk(wi, kWalkEnd, rng, connect, [](const Spectrum<V>&, double) {});
    for (int k = 0; k < exits; ++k)
      for (int j = 0; j < layers_.count; ++j) sums[k * layers_.count + j] += mean_of_lanes(sum[k][j]);
  }

  // Calls visit(cosine, power, mask of the lanes that are at the base) once a round, and
  // forecast(ahead, ended) where roulette ends the share `ended` of what is ahead, negative where it
  // multiplies the walk instead.
  template <class Visit, class Forecast>
  SUNBEAM_INLINE void walk(double wi, double end, Rng& rng, Visit visit, Forecast forecast) const {
    Flight light;
    start(wi, light, rng);
    V path(0);  // through the pigment, not yet paid
    double later = 0;
    for (int j = 0; j < layers_.count; ++j) later += layers_.visits[j] - 1;
    const double least = max(end * later, kNothing * layers_.count);
    const std::array<double, kMostWavelengths> first = passing(wi);
    for (;;) {
      Outcome facet = meet(wi, light, rng);
      const auto is_here = facet.comes_out > V(0.5);
      const V cosine = light.travel;
      const V down = layers_.product ? V(0) : V(1) / max(cosine, V(1e-12));
      events_.attenuate(select(is_here, path + down, V(0)), light.power);
      visit(cosine, light.power, is_here);

      Spectrum<V> ahead;
      V left(0);
      for (int j = 0; j < layers_.count; ++j) {
        const double visits = layers_.visits[j];
        const V in_flight = select(path > V(0), V(layers_.later_visits[j]), V(visits * first[j]));
        ahead[j] = light.power[j] * select(is_here, V(visits - 1), in_flight);
        left += ahead[j];
      }
      const double factor = go_on(mean_of_lanes(left), least, rng);
      if (factor != 1) forecast(ahead, 1 - factor);
      if (factor == 0) return;

      const auto up = events_.leave_base(layers_.guide, rng);
      light.total = V(0);
      for (int j = 0; j < layers_.count; ++j) {
        light.power[j] *= select(is_here, V(factor * layers_.albedo[j]) * up.share, V(factor));
        light.total += light.power[j];
      }
      const V way = layers_.product ? up.cosine * cosine : up.cosine;
      path = select(is_here, V(1) / way, path);
      light.travel = select(is_here, -up.cosine, cosine);
      light.height = select(is_here, V(0), light.height);
      fly(select(is_here, V(1) - Uniform<V>::draw(rng), facet.share), light);
    }
  }

  // Writes what the base's kd / pi and the crossing from outside along wo make of light, as the mean over all
  // lanes.
  SUNBEAM_INLINE void leave(double wo, Rng& rng, std::array<double, kMostWavelengths>& mean) const {
    Arrival<V> exit;
    std::array<double, kMostWavelengths> ended{};
    prepare_exit(wo, kForecastCrossingEnd, rng, exit, [&](const Flight& light, double share) {
      for (int j = 0; j < layers_.count; ++j) ended[j] += mean_of_lanes(light.power[j]) * share;
    });
    const std::array<double, kMostWavelengths> attenuation = passing(wo);
    for (int j = 0; j < layers_.count; ++j)
      mean[j] = mean_of_lanes(exit.throughput[j]) +
                ended[j] * attenuation[j] * layers_.albedo[j] * kInvPi * layers_.radiance_scale;
  }

  // Forecasts what the pigment lets through on the way between film and base; w is outside.
  SUNBEAM_INLINE std::array<double, kMostWavelengths> passing(double w) const {
    const double below = 1 - squared(layers_.index_ratio) * (1 - squared(w));
    const double path = 1 / sqrt(max(below, 0.01));
    std::array<double, kMostWavelengths> share;
    for (int j = 0; j < layers_.count; ++j)
      share[j] = j > 0 && layers_.same_tau ? share[0] : std::exp(-layers_.tau[j] * path);
    return share;
  }

  // Prepares the way out along wo, from the base's kd / pi on.
  template <class Forecast>
  SUNBEAM_INLINE void prepare_exit(double wo, double end, Rng& rng, Arrival<V>& exit,
                                   Forecast forecast) const {
    Flight light;
    start(wo, light, rng);
    come_out(wo, end, light, exit, rng, forecast);
    for (int j = 0; j < layers_.count; ++j)
      exit.throughput[j] *= V(layers_.albedo[j] * kInvPi * layers_.radiance_scale);
  }

  // Takes light from the base to the film and back.
  SUNBEAM_INLINE void come_back(Rng& rng, Arrival<V>& arrival) const {
    const auto up = events_.leave_base(layers_.guide, rng);
    Flight light;
    light.is_outside = light.height = light.total = V(0);
    light.travel = -up.cosine;
    for (int j = 0; j < layers_.count; ++j) light.power[j] = V(layers_.albedo[j]) * up.share;
    events_.attenuate(V(1) / up.cosine, light.power);
    for (int j = 0; j < layers_.count; ++j) light.total += light.power[j];
    fly(V(1) - Uniform<V>::draw(rng), light);
    come_out(1, kCrossingEnd, light, arrival, rng, [](const Flight&, double) {});
  }

  // Goes from facet to facet until every lane has come out below or roulette has ended the others;
  // forecast(light, ended) is called as above.
  template <class Forecast>
  SUNBEAM_INLINE void come_out(double unbent, double end, Flight& light, Arrival<V>& arrival, Rng& rng,
                               Forecast forecast) const {
    arrival.cosine = V(1);
    for (int j = 0; j < layers_.count; ++j) arrival.throughput[j] = V(0);
    end *= mean_of_lanes(light.total);
    for (;;) {
      const Outcome facet = meet(unbent, light, rng);
      const auto is_here = (facet.comes_out > V(0.5)) & (light.total > V(0));
      arrival.cosine = select(is_here, light.travel, arrival.cosine);
      for (int j = 0; j < layers_.count; ++j) {
        arrival.throughput[j] = select(is_here, light.power[j], arrival.throughput[j]);
        light.power[j] = select(is_here, V(0), light.power[j]);
      }
      light.total = select(is_here, V(0), light.total);
      const double factor = go_on(mean_of_lanes(light.total), end, rng);
      if (factor != 1) forecast(light, 1 - factor);
      if (factor == 0) break;
      for (int j = 0; j < layers_.count; ++j) light.power[j] *= V(factor);
      light.total *= V(factor);
      fly(facet.share, light);
    }
    if (!layers_.product) events_.attenuate(V(1) / arrival.cosine, arrival.throughput);
  }

  // Keeps what is left at `end` by ending packets below it. Returns the factor to go on with, or 0.
  SUNBEAM_INLINE static double go_on(double left, double end, Rng& rng) {
    if (left >= end && left > 0) return 1;
    return rng.uniform() * end < left ? end / left : 0;
  }

  // Takes light from outside to the first facet.
  SUNBEAM_INLINE void start(double w, Flight& light, Rng& rng) const {
    light.is_outside = V(1);
    light.travel = V(-w);
    light.height = V(0);
    for (int j = 0; j < layers_.count; ++j) light.power[j] = V(1);
    light.total = V(layers_.count);
    fly(V(1) - Uniform<V>::draw(rng), light);
  }

  // Flies on to the next facet, so far that only `share` of all light gets there.
  SUNBEAM_INLINE void fly(const V& share, Flight& light) const {
    light.height = min(light.height - log_of_share(share) * light.travel / facets_.area(light.travel), V(0));
  }

  // Returns the mean number of facets on the way out, for lanes that lead away from the facets.
  SUNBEAM_INLINE V facets_ahead(const V& travel, const V& height) const {
    return -height * facets_.area(travel) / max(travel, V(1e-12));
  }

  // Says where light can go on from a facet, mirrored or passing, and the power of either.
  struct Ways {
    V mirrored, passed, passed_height;  // travel, and height where it changes
    V mirrors, passes;
  };
  // Describes the way that was taken: 1 or 0, and the power before and after the choice, both times the same
  // factor.
  struct Turn {
    V is_mirrored, goes_out;
    V whole, chosen;
  };

  // Lets light meet one facet, from where a straight crossing leads to the cosine `unbent` below.
  SUNBEAM_INLINE Outcome meet(double unbent, Flight& light, Rng& rng) const {
    const V one(1), half(0.5), zero(0);
    Spectrum<V> r, t;
    const Ways ways = ways_on(unbent, light, r, t, rng);
    const Turn turn = take_turn(ways, light, rng);
    const auto is_mirrored = turn.is_mirrored > half, goes_out = turn.goes_out > half;

    const V ahead = facets_ahead(light.travel, light.height);
    V escapes = select(light.travel > zero, exp_negative(-ahead), zero);
    if (layers_.straight) escapes = select(is_mirrored, escapes, one);
    const V stays = select(goes_out, one - escapes, one);
    const V factor = turn.whole * stays / max(turn.chosen, V(1e-300));
    if constexpr (kLayered) {
      for (int j = 0; j < layers_.count; ++j) r[j] = factor * select(is_mirrored, r[j], t[j]);
      weigh(zero, one, r, light);
    } else {
      weigh(select(is_mirrored, zero, factor), select(is_mirrored, factor, -factor), r, light);
    }

    const V u = Uniform<V>::draw(rng);
    const V share = one - u * stays;
    return {select(escapes >= share, one - light.is_outside, zero), share};
  }

  // Draws the facet; r becomes its reflectances, t the transmittances of a layered film.
  SUNBEAM_INLINE Ways ways_on(double unbent, const Flight& light, Spectrum<V>& r, Spectrum<V>& t,
                              Rng& rng) const {
    const V w = -light.travel, one(1), zero(0);
    const auto was_outside = light.is_outside > V(0.5);
    const auto h = facets_.sample(w, facets_.root(w), rng);
    const V cosine = max(h.cosine, zero);
    const V ratio = select(was_outside, V(layers_.index_ratio), V(1 / layers_.index_ratio));
    const V far = sqrt(max(one - squared(ratio) * (one - squared(cosine)), zero));

    V mirrors(0), passes(0);
    if constexpr (kLayered) {
      look_up_film(layers_.phases, one - light.is_outside, min(cosine, one), r, t);
      for (int j = 0; j < layers_.count; ++j) {
        mirrors += light.power[j] * r[j];
        passes += light.power[j] * t[j];
      }
    } else {
      const FilmPackets<V> film(layers_.film, layers_.phases, select(was_outside, cosine, far));
      film.reflectances([&](int j, const V& value) {
        r[j] = value;
        mirrors += light.power[j] * value;
      });
      passes = (light.total - mirrors) * film.through();
    }
    Ways ways{min(V(2) * cosine * h.cos_h - w, one), min(ratio * w + (far - ratio * cosine) * h.cos_h, one),
              light.height, mirrors, passes};
    if (layers_.straight) {
      ways.passes = select(was_outside, ways.passes, zero);
      ways.passed = V(unbent);
    } else {
      ways.passed_height = log_of_share(one - exp_negative(light.height));
    }
    return ways;
  }

  // Chooses between outside and inside: by power, and for the outside about by the chance x / (1 + x) to stay
  // there.
  SUNBEAM_INLINE Turn take_turn(const Ways& ways, Flight& light, Rng& rng) const {
    const V one(1), half(0.5), zero(0);
    const auto was_outside = light.is_outside > half;
    const V out = select(was_outside, ways.mirrored, ways.passed);
    const V x =
        select(out > zero, facets_ahead(out, select(was_outside, light.height, ways.passed_height)), V(1e12));
    const V outside = select(was_outside, ways.mirrors, ways.passes) * x;
    const V whole = outside + select(was_outside, ways.passes, ways.mirrors) * (one + x);
    const auto goes_out = outside > Uniform<V>::draw(rng) * whole;
    light.is_outside = select(goes_out, one, zero);
    const V mirrored = select(was_outside, light.is_outside, one - light.is_outside);
    const auto is_mirrored = mirrored > half;
    light.travel = select(is_mirrored, ways.mirrored, ways.passed);
    light.height = select(is_mirrored, light.height, ways.passed_height);
    return {mirrored, light.is_outside, whole,
            select(is_mirrored, ways.mirrors, ways.passes) * select(goes_out, x, one + x)};
  }

  // Multiplies the power at reflectance r by fixed + slope r.
  SUNBEAM_INLINE void weigh(const V& fixed, const V& slope, const Spectrum<V>& r, Flight& light) const {
    light.total = V(0);
    for (int j = 0; j < layers_.count; ++j) {
      light.power[j] *= fixed + slope * r[j];
      light.total += light.power[j];
    }
  }

  const Layers& layers_;
  Events<V, kLayered> events_;
  FacetPackets<V> facets_;
};

}  // namespace sunbeam::walk
