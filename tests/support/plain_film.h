// The film as a scalar walk meets it, facet by facet: what FilmGeometry leaves out. A second code path for
// the tests, and part of the yardstick of the benchmarks.
//
// A walk first meets a facet, then asks what reflection and what crossing that facet offers. Weights
// transport power, one value a wavelength. Directions are those of FilmGeometry.
#pragma once

#include <optional>

#include "bake/live/film/geometry.h"
#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"

namespace sunbeam::test {

// A microfacet met by a walk: a visible normal and what the film does there. Smooth: the macro normal.
struct Facet {
  Vec3 normal;
  FilmPower power;
  double reflect_chance;  // mean reflectance over the wavelengths: what a walk chooses by
};

// A direction taken at a facet and power / density of the normal.
struct Scatter {
  Vec3 direction;
  Rgb weight;
};

// Crossing from outside to inside along a given w, which by reciprocity also serves leaving along w.
struct Crossing {
  Vec3 inside;     // m
  Rgb weight;      // power let through / density of m
  double density;  // of m given w, 1/sr; 0 if m is the only one (Dirac)
  // [density over w of a walk that meets the same facet from m and crosses] / [density of m given w]
  double reverse_ratio;
};

// Leaving along w from a given m through facets that bend light.
struct Exit {
  Rgb value;       // f_t(m -> w), 1/sr
  double density;  // of m when cross() draws it for w, 1/sr
};

class FacetedFilm {
 public:
  FacetedFilm(const Material& material, const Rgb& wavelengths_nm)
      : geometry_(material),
        film_(ThinFilm::of(material)),
        film_below_(ThinFilm::below(material)),
        wavelengths_nm_(wavelengths_nm) {}

  bool is_smooth() const { return geometry_.is_smooth(); }
  bool has_glossy_crossing() const { return geometry_.has_glossy_crossing(); }

  // Film power from outside at a (micro)facet cosine in the exterior medium.
  FilmPower power(double cos_exterior) const { return airy(film_, cos_exterior, wavelengths_nm_); }

  // First-surface lobe f_r(wo, wi), 1/sr, and its density as a walk draws it; 0 for a smooth film.
  Rgb first_surface(const Vec3& wo, const Vec3& wi) const {
    if (is_smooth() || wo.z <= 0 || wi.z <= 0) return {};
    const Vec3 h = normalize(wo + wi);
    return ggx().reflection(wo, wi, h) * power(dot(wo, h)).reflectance;
  }
  double first_surface_pdf(const Vec3& wo, const Vec3& wi) const {
    if (is_smooth() || wo.z <= 0 || wi.z <= 0) return 0;
    const Vec3 h = normalize(wo + wi);
    return ggx().reflection_pdf(wo, h) * mean(power(dot(wo, h)).reflectance);
  }

  Facet meet_from_outside(const Vec3& w, Rng& rng) const { return meet(film_, w, rng); }
  Facet meet_from_below(const Vec3& m, Rng& rng) const { return meet(film_below_, m, rng); }

  std::optional<Scatter> reflect_up(const Vec3& w, const Facet& facet) const { return mirror(w, facet); }
  std::optional<Scatter> reflect_down(const Vec3& m, const Facet& facet) const { return mirror(m, facet); }

  std::optional<Crossing> cross(const Vec3& w, const Facet& facet) const {
    const auto on = geometry_.cross(w, facet.normal);
    if (!on) return {};
    const Vec3 &m = on->direction, &h = facet.normal;
    const Rgb weight = facet.power.transmittance * on->share;
    if (!geometry_.bends()) return Crossing{m, weight, 0, 1};
    const double ratio = geometry_.index_ratio(), solid_angle_ratio = square(ratio) * w.z / m.z;
    if (is_smooth()) return Crossing{m, weight, 0, solid_angle_ratio};
    const double jacobian = dot(m, h) / square(ratio * dot(w, h) - dot(m, h));
    return Crossing{m, weight, ggx().visible_pdf(w, h) * jacobian,
                    solid_angle_ratio * ggx().g1(m) / ggx().g1(w)};
  }

  std::optional<Scatter> leave(const Vec3& m, const Facet& facet) const {
    const auto on = geometry_.leave(m, facet.normal);
    if (!on) return {};
    return Scatter{on->direction, facet.power.transmittance * on->share};
  }

  // Only with has_glossy_crossing().
  Exit exit(const Vec3& m, const Vec3& w) const {
    // Half vector of the crossing, turned to the outside; both directions must see the facet from its sides.
    const double ratio = geometry_.index_ratio();
    Vec3 h = ratio * w - m;
    if (h.z < 0) h = -h;
    h = normalize(h);
    const double wh = dot(w, h), mh = dot(m, h);
    if (wh <= 0 || mh <= 0 || h.z <= 0) return {};
    const double dh_dm = mh / square(ratio * wh - mh);  // n2^2 mh / (n0 wh - n2 mh)^2
    const double lobe = dh_dm * wh * square(ratio) * ggx().g2(w, m) * ggx().d(h) / (w.z * m.z);
    return {power(std::min(wh, 1.0)).transmittance * lobe, ggx().visible_pdf(w, h) * dh_dm};
  }

 private:
  const Ggx& ggx() const { return geometry_.ggx(); }

  Facet meet(const ThinFilm& film, const Vec3& w, Rng& rng) const {
    const Vec3 h = is_smooth() ? Vec3{0, 0, 1} : ggx().sample_visible(w, {rng.uniform(), rng.uniform()});
    const FilmPower power = airy(film, std::clamp(dot(w, h), 0.0, 1.0), wavelengths_nm_);
    return {h, power, mean(power.reflectance)};
  }
  std::optional<Scatter> mirror(const Vec3& w, const Facet& facet) const {
    const auto on = geometry_.mirror(w, facet.normal);
    if (!on) return {};
    return Scatter{on->direction, facet.power.reflectance * on->share};
  }

  FilmGeometry geometry_;
  ThinFilm film_;        // as seen from outside
  ThinFilm film_below_;  // as seen from below: reversed, or the same in "straight" mode
  Rgb wavelengths_nm_;
};

}  // namespace sunbeam::test
