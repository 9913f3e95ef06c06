// This file holds what can happen to a packet of directions at the film and at the base, for the walks.
//
// The base forgets azimuth, so a walk carries polar cosines alone; where two directions meet at a facet their
// azimuths are drawn anew. Sides, weights and densities are those of film/geometry.h. Lost lanes go on with
// weight 0, cosine 1 and density 1.
#pragma once

#include "bake/live/walks/layers.h"

namespace sunbeam::walk {

template <class V>
SUNBEAM_INLINE V sine_of(const V& cosine) {
  return sqrt(max(V(0), V(1) - squared(cosine)));
}

// Evaluates GGX with Smith masking (sunbeam/detail/ggx.h has the equations) for the walks: isotropic, in
// double precision. Lanes are directions, known by their polar cosines.
template <class V>
class FacetPackets {
 public:
  SUNBEAM_INLINE explicit FacetPackets(double alpha) : alpha2_(alpha * alpha), alpha_(alpha) {}

  // Returns cosine (1 + 2 Lambda).
  SUNBEAM_INLINE V root(const V& cosine) const { return sqrt(squared(cosine) * V(1 - alpha2_) + V(alpha2_)); }
  // Returns the projected area of the facets that light travelling at this cosine meets. The cosine is
  // negative towards them (microsurface.h).
  SUNBEAM_INLINE V area(const V& travel) const {
    return max(V(0.5) * (root(travel) - travel), V(kLeastArea));
  }
  // Returns G2(a, b) / G1(a).
  SUNBEAM_INLINE V g2_over_g1(const V& a, const V& root_a, const V& b, const V& root_b) const {
    return b * (a + root_a) / (root_a * b + root_b * a);
  }
  // Returns G2(a, b) / (a b).
  SUNBEAM_INLINE V g2_over_cosines(const V& a, const V& b) const {
    return V(2) / (root(a) * b + root(b) * a);
  }
  // Returns D of a normal's cosine.
  SUNBEAM_INLINE V d(const V& cos_h) const {
    return V(alpha2_ * kInvPi) / squared(V(1) - squared(cos_h) * V(1 - alpha2_));
  }
  // Returns D_vis / (w.h D), where D_vis is the density of normals seen from w.
  SUNBEAM_INLINE V visible(const V& w, const V& root_w) const { return V(2) / (w + root_w); }

  struct Normal {
    V cos_h;   // with the macro normal
    V cosine;  // with w
    V along;   // component along the tangent towards w
  };
  // Draws a normal with density D_vis(h; w), for w on either side of the macro surface, by spherical caps
  // (Dupuy and Benyoub 2023).
  SUNBEAM_INLINE Normal sample(const V& w, const V& root_w, Rng& rng) const {
    // All lengths times root_w, which is that of the stretched w.
    const V alpha(alpha_), axis_x = alpha * sine_of(w);
    const V z = (V(1) - Uniform<V>::draw(rng)) * (root_w + w) - w;
    const V ring2 = max(squared(root_w) - squared(z), V(0));
    const V x = sqrt(ring2) * cos_half_turn(Uniform<V>::draw(rng));  // the other half is its mirror image
    const V cap_x = x + axis_x, cap_z = max(z + w, V(1e-12) * root_w);
    const V length2 = V(alpha2_) * (ring2 + axis_x * (V(2) * x + axis_x)) + squared(cap_z);
    const V per_length = V(1) / sqrt(length2);
    return {cap_z * per_length, min((axis_x * cap_x + w * cap_z) * per_length, V(1)),
            alpha * cap_x * per_length};
  }

 private:
  static constexpr double kLeastArea = 1e-18;  // straight away there are none

  double alpha2_, alpha_;
};

// Describes light that enters along w, or by reciprocity leaves along it.
template <class V>
struct Crossing {
  V cosine;   // inside
  V density;  // of the inside direction, 1/sr; only with a glossy crossing
  V weight;   // without the film's transmittance
  V film;     // cosine at which the film is met, from outside
};

template <class V>
struct Reflection {
  V cosine, weight, film;
  V density;          // 1/sr, rough only: of going there,
  V density_reverse;  // and of coming back
};

// Holds the powers at a facet and a fixed pair of directions.
template <class V>
struct Connection {
  V value;    // 1/sr, without the film's power
  V film;     // cosine at which the film is met: a crossing from outside, a reflection from below
  V forward;  // density of the second direction given the first, as a walk draws it
  V reverse;  // and of the first given the second
};

// `kLayered` says whether the film is a layered one: walks under a single clear film are compiled without it.
template <class V, bool kLayered = false>
class Events {
 public:
  SUNBEAM_INLINE explicit Events(const Layers& layers) : layers_(layers), facets_(layers.alpha) {}

  using Normal = typename FacetPackets<V>::Normal;

  // Draws a facet seen from w; for a smooth film it is the macro normal.
  SUNBEAM_INLINE Normal meet(const V& w, Rng& rng) const {
    if (layers_.is_smooth()) return {V(1), w, V(0)};
    return facets_.sample(w, facets_.root(w), rng);
  }

  // Takes light through a facet, from outside to inside with far_per_near = n0 / n2, or the other way round.
  SUNBEAM_INLINE Crossing<V> cross(const V& w, const Normal& h, double far_per_near) const {
    if (!layers_.bends) return {w, V(1), unbent_shadowing(w), h.cosine};
    const V eta(far_per_near);
    const V far2 = V(1) - squared(eta) * (V(1) - squared(h.cosine));
    const V far = sqrt(max(far2, V(0)));
    const V other = eta * w + (far - eta * h.cosine) * h.cos_h;
    const auto through = (far2 > V(0)) & (other > V(0));
    const V m = select(through, min(other, V(1)), V(1));
    if (layers_.is_smooth()) return {m, V(1), select(through, V(1), V(0)), h.cosine};
    const V root_w = facets_.root(w);
    const V density =
        facets_.visible(w, root_w) * h.cosine * facets_.d(h.cos_h) * far / squared(eta * h.cosine - far);
    return {m, select(through, density, V(1)),
            select(through, facets_.g2_over_g1(w, root_w, m, facets_.root(m)), V(0)), h.cosine};
  }

  SUNBEAM_INLINE Crossing<V> cross(const V& w, Rng& rng) const {
    return cross(w, meet(w, rng), layers_.index_ratio);
  }

  // Returns G1 of a over that of b; 1 for a smooth film.
  SUNBEAM_INLINE V g1_ratio(const V& a, const V& b) const {
    return a * (b + facets_.root(b)) / (b * (a + facets_.root(a)));
  }

  SUNBEAM_INLINE Reflection<V> mirror(const V& u, const Normal& h) const {
    if (layers_.is_smooth()) return {u, V(1), u, V(1), V(1)};
    const V root_u = facets_.root(u);
    const V mirrored = V(2) * h.cosine * h.cos_h - u;
    const auto kept = mirrored > V(0);
    const V m = select(kept, min(mirrored, V(1)), V(1)), root_m = facets_.root(m);
    const V quarter_d = V(0.25) * facets_.d(h.cos_h);
    return {m, select(kept, facets_.g2_over_g1(u, root_u, m, root_m), V(0)), h.cosine,
            quarter_d * facets_.visible(u, root_u), quarter_d * facets_.visible(m, root_m)};
  }

  SUNBEAM_INLINE Reflection<V> reflect_below(const V& u, Rng& rng) const { return mirror(u, meet(u, rng)); }

  // Returns f_t(m -> w), Walter's function. forward is unused; reverse is the density of m when cross() draws
  // it for w.
  SUNBEAM_INLINE Connection<V> cross_towards(const V& m, const V& w, Rng& rng) const {
    const V eta(layers_.index_ratio);
    const V wm = dot(m, w, rng);
    const V length2 = squared(eta) + V(1) - V(2) * eta * wm;
    // Half vector, turned to the outside; both directions must see the facet from their sides.
    const V z = eta * w - m;
    const V scale = select(z > V(0), V(1), V(-1)) / sqrt(length2);
    const V wh = (eta - wm) * scale, mh = (eta * wm - V(1)) * scale, cos_h = z * scale;
    const auto seen = (wh > V(0)) & (mh > V(0));
    const V dh_dm = select(seen, mh / squared(eta * wh - mh), V(0));
    const V d = facets_.d(cos_h);
    return {dh_dm * wh * squared(eta) * d * facets_.g2_over_cosines(w, m), min(wh, V(1)), V(0),
            facets_.visible(w, facets_.root(w)) * wh * d * dh_dm};
  }

  // Returns f_r(u -> m) of the film's lower side.
  SUNBEAM_INLINE Connection<V> mirror_towards(const V& u, const V& m, Rng& rng) const {
    const V um = dot(u, m, rng);
    const V length = sqrt(max(V(2) + V(2) * um, V(1e-30)));
    const V quarter_d = V(0.25) * facets_.d(min((u + m) / length, V(1)));
    return {quarter_d * facets_.g2_over_cosines(u, m), V(0.5) * length,
            quarter_d * facets_.visible(u, facets_.root(u)), quarter_d * facets_.visible(m, facets_.root(m))};
  }

  // Calls visit(j, T) or visit(j, R) for every wavelength.
  template <class F>
  SUNBEAM_INLINE void transmittances(const V& film_cosine, F visit) const {
    if constexpr (kLayered)
      visit_transmittances(film_cosine, visit);
    else
      FilmPackets<V>(layers_.film, layers_.phases, film_cosine).transmittances(visit);
  }
  template <class F>
  SUNBEAM_INLINE void reflectances_below(const V& film_cosine, F visit) const {
    if constexpr (kLayered)
      visit_reflectances_below(film_cosine, visit);
    else
      FilmPackets<V>(layers_.film_below, layers_.phases, film_cosine).reflectances(visit);
  }

  // Describes light that leaves the base upwards, as the guide has it.
  struct Leaving {
    V cosine;
    V share;  // cos / (pi density)
  };
  SUNBEAM_INLINE Leaving leave_base(const BaseGuide& guide, Rng& rng) const {
    const auto at = guide.sample(Uniform<V>::draw(rng));
    return {sqrt(at.square), at.per_density};
  }

  // Multiplies by exp(-tau x): Beer and Lambert. With "sum" a walk pays for each leg, x = 1 / cosine; with
  // "product" for each visit of the base, x = 1 / (cosine down * cosine up), once both are known.
  SUNBEAM_INLINE void attenuate(const V& x, Spectrum<V>& value) const {
    if (layers_.same_tau) {
      if (layers_.least_tau == 0) return;
      const V factor = exp_negative(V(-layers_.least_tau) * x);
      for (int j = 0; j < layers_.count; ++j) value[j] *= factor;
      return;
    }
    for (int j = 0; j < layers_.count; ++j) value[j] *= exp_negative(V(-layers_.tau[j]) * x);
  }

 private:
  template <class F>
  SUNBEAM_INLINE void visit_transmittances(const V& cosine, F& visit) const {
    Spectrum<V> r, t;
    look_up_film(layers_.phases, V(0), cosine, r, t);
    for (int j = 0; j < layers_.count; ++j) visit(j, t[j]);
  }
  template <class F>
  SUNBEAM_INLINE void visit_reflectances_below(const V& cosine, F& visit) const {
    Spectrum<V> r, t;
    look_up_film(layers_.phases, V(1), cosine, r, t);
    for (int j = 0; j < layers_.count; ++j) visit(j, r[j]);
  }

  // Returns the shadowing of light that passes unbent. In "straight" mode the paper's Tbar has none; in
  // index-matched "refract" the limit of Walter's function has it.
  SUNBEAM_INLINE V unbent_shadowing(const V& w) const {
    if (layers_.straight || layers_.is_smooth()) return V(1);
    const V root_w = facets_.root(w);
    return facets_.g2_over_g1(w, root_w, w, root_w);
  }
  // Returns the dot product of two directions whose azimuths differ by a random angle.
  SUNBEAM_INLINE static V dot(const V& a, const V& b, Rng& rng) {
    return a * b + sine_of(a) * sine_of(b) * cos_half_turn(Uniform<V>::draw(rng));
  }

  const Layers& layers_;
  FacetPackets<V> facets_;
};

}  // namespace sunbeam::walk
