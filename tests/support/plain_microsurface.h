// The rough film as a random walk over a Smith microsurface with explicit heights, after Heitz, Hanika,
// d'Eon, Dachsbacher 2016, "Multiple-Scattering Microfacet BSDFs with the Smith Model". Heights are uniform
// in [-1, 1], slopes GGX. Slow, and on its own: Lambda, heights and normals share nothing with the live
// model.
//
// "refract": every facet reflects with R or refracts to the other side at the same height, where the surface
// is the same upside down. "straight": facets only reflect, each weighted by the one R of both sides; what a
// walk has lost when it leaves has passed the film without bending.
//
// `from` points from the surface to where light comes from, z > 0 outside; `travel` is where a ray goes.
// Power is transported, three wavelengths at a time; their mean R chooses. Equal wavelengths therefore keep
// power 1.
#pragma once

#include <limits>
#include <optional>

#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"
#include "tests/support/plain_slab.h"

namespace sunbeam::test {

// GGX heights, Lambda and visible normals for rays of any direction over the surface seen from above.
class PlainHeightfield {
 public:
  explicit PlainHeightfield(const Roughness& roughness) : u_(roughness.u), v_(roughness.v) {}

  // Lambda of a direction on either side: Lambda(-w) = -1 - Lambda(w).
  double lambda(const Vec3& w) const {
    const double slope = std::hypot(u_ * w.x, v_ * w.y) / std::abs(w.z);  // 1 / a in the paper
    const double root = std::sqrt(1 + slope * slope);
    return (w.z > 0 ? root - 1 : -root - 1) / 2;
  }

  // Height of the next facet on the way; none if the ray leaves. C1(h) = (h + 1) / 2 is the share below h,
  // and C1(h)^Lambda the chance to leave from h.
  std::optional<double> next_height(const Vec3& travel, double height, Rng& rng) const {
    const double below = (height + 1) / 2, exponent = lambda(travel), u = rng.uniform();
    if (travel.z > 0 && (exponent == 0 || u >= 1 - std::pow(below, exponent))) return {};
    const double met = below * std::pow(1 - u, -1 / exponent);
    return 2 * std::clamp(met, 1e-300, 1.0) - 1;
  }

  // A normal seen from w (of either side), density max(0, w.h) D(h) / (cos (1 + Lambda)): points of the half
  // ellipsoid whose normals are GGX, as many as its surface shows to w. By rejection.
  Vec3 visible_normal(const Vec3& w, Rng& rng) const {
    const Vec3 stretched = normalize({u_ * w.x, v_ * w.y, w.z});
    for (;;) {
      const Vec3 s = direction_from_cosine(rng.uniform(), 2 * kPi * rng.uniform());
      if (rng.uniform() >= dot(s, stretched)) continue;
      const Vec3 normal = normalize({u_ * s.x, v_ * s.y, s.z});
      if (dot(w, normal) > 0) return normal;  // in doubt by rounding
    }
  }

 private:
  double u_, v_;
};

class PlainMicrosurface {
 public:
  PlainMicrosurface(const Material& material, const Rgb& wavelengths_nm)
      : surface_(material.roughness),
        film_(ThinFilm::of(material)),
        wavelengths_nm_(wavelengths_nm),
        straight_(material.transmission == Transmission::straight) {}

  // Every facet a perfect mirror.
  static PlainMicrosurface mirrors(const Roughness& roughness) {
    Material material;
    material.transmission = Transmission::straight;
    material.roughness = roughness;
    PlainMicrosurface result(material, Rgb(550));
    result.mirrors_ = true;
    return result;
  }

  struct Outcome {
    Vec3 travel;
    bool is_outside;
    int bounces;  // facets met
    Rgb power;
  };

  Outcome walk(const Vec3& from, Rng& rng) const {
    Outcome ray{-from, from.z > 0, 0, Rgb(1)};
    double height = ray.is_outside ? 1 : -1;
    for (;;) {
      const double side = ray.is_outside ? 1 : -1;  // the inside sees the surface upside down
      const auto next = surface_.next_height(side * ray.travel, side * height, rng);
      if (!next) return ray;
      height = side * *next;
      ++ray.bounces;
      meet(ray, side * surface_.visible_normal(-side * ray.travel, rng), rng);
    }
  }

  // The film of PlainLayers. What leaves after one reflection is the first surface, not the rest.
  std::optional<FilmEvent> enter(const Vec3& wi, Rng& rng) const {
    const Outcome outcome = walk(wi, rng);
    if (!straight_) {
      if (outcome.is_outside && outcome.bounces == 1) return {};
      return event(outcome);
    }
    const auto choice = reflect_or_pass(outcome, -wi, rng);
    if (choice.is_outside && outcome.bounces == 1) return {};
    return choice;
  }
  std::optional<FilmEvent> meet_from_below(const Vec3& travel, Rng& rng) const {
    const Outcome outcome = walk(-travel, rng);
    return straight_ ? reflect_or_pass(outcome, travel, rng) : event(outcome);
  }

 private:
  static FilmEvent event(const Outcome& o) { return {o.travel, o.power, o.is_outside}; }

  static FilmEvent reflect_or_pass(const Outcome& o, const Vec3& travel, Rng& rng) {
    const double chance = mean(o.power);
    if (rng.uniform() < chance) return {o.travel, o.power / chance, o.is_outside};
    return {travel, (Rgb(1) - o.power) / (1 - chance), travel.z > 0};
  }

  Rgb reflectance(bool is_outside, double cosine) const {
    if (mirrors_) return Rgb(1);
    const ThinFilm& film = film_;
    return airy(is_outside || straight_ ? film : film.reversed(), std::min(cosine, 1.0), wavelengths_nm_)
        .reflectance;
  }

  // At a facet whose normal is on the ray's side.
  void meet(Outcome& ray, const Vec3& normal, Rng& rng) const {
    const double cosine = -dot(ray.travel, normal);
    const Rgb r = reflectance(ray.is_outside, cosine);
    const double chance = straight_ ? 1 : mean(r);
    if (rng.uniform() < chance) {
      ray.power *= r / chance;
      ray.travel = normalize(ray.travel + 2 * cosine * normal);
      return;
    }
    ray.power *= (Rgb(1) - r) / (1 - chance);
    const double ratio =
        ray.is_outside ? film_.exterior_ior / film_.base_ior : film_.base_ior / film_.exterior_ior;
    const double far = std::sqrt(std::max(0.0, 1 - square(ratio) * (1 - square(cosine))));
    ray.travel = normalize(ratio * ray.travel + (ratio * cosine - far) * normal);
    ray.is_outside = !ray.is_outside;
  }

  PlainHeightfield surface_;
  ThinFilm film_;
  Rgb wavelengths_nm_;
  bool straight_;
  bool mirrors_ = false;
};

using PlainFacetLayers = PlainLayers<PlainMicrosurface>;

}  // namespace sunbeam::test
