// The thin film as an interface between the outside and the space above the base, smooth or rough.
//
// Directions: outside directions `w` and inside directions `m` are unit vectors with z > 0; w points away
// from the surface, m away from the base. Light that enters along w reaches the base along m; light that
// leaves the base along m leaves the film along w, or is thrown back and reaches the base again along another
// m. A walk first meets a facet, then asks what reflection and what passage that facet offers. Both can be
// empty: the direction is then lost in the microsurface (single scattering), which is part of the model.
// Weights transport power, one value a wavelength; the radiance's squared index ratio is the caller's affair.
#pragma once

#include <optional>

#include "bake/optics/thin_film.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/material.h"

namespace sunbeam {

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

// Passage from outside to inside along a given w, which by reciprocity also serves leaving along w.
struct Crossing {
  Vec3 inside;     // m
  Rgb weight;      // power let through / density of m
  double density;  // of m given w, 1/sr; 0 if m is the only one (Dirac)
  // [density over w of a walk that meets the same facet from m and passes] / [density of m given w]
  double reverse_ratio;
};

// Leaving along w from a given m through facets that bend light.
struct Exit {
  Rgb value;       // f_t(m -> w), 1/sr
  double density;  // of m when cross() draws it for w, 1/sr
};

class FilmInterface {
 public:
  FilmInterface(const Material& material, const Rgb& wavelengths_nm);

  bool is_smooth() const { return !rough_; }
  // True if facets bend what passes, so that leaving along a given w has a density over m.
  bool has_glossy_crossing() const { return rough_ && bends_; }

  // Film power from outside at a (micro)facet cosine in the exterior medium.
  FilmPower power(double cos_exterior) const { return airy(film_, cos_exterior, wavelengths_nm_); }

  // First-surface lobe f_r(wo, wi), 1/sr, and its density as a walk draws it; 0 for a smooth film.
  Rgb first_surface(const Vec3& wo, const Vec3& wi) const;
  double first_surface_pdf(const Vec3& wo, const Vec3& wi) const;

  Facet meet_from_outside(const Vec3& w, Rng& rng) const;
  std::optional<Scatter> reflect_up(const Vec3& w, const Facet& facet) const;
  std::optional<Crossing> cross(const Vec3& w, const Facet& facet) const;

  Facet meet_from_below(const Vec3& m, Rng& rng) const;
  std::optional<Scatter> reflect_down(const Vec3& m, const Facet& facet) const;
  std::optional<Scatter> leave(const Vec3& m, const Facet& facet) const;

  // Only with has_glossy_crossing().
  Exit exit(const Vec3& m, const Vec3& w) const;

 private:
  Vec3 sample_normal(const Vec3& w, Rng& rng) const;
  std::optional<Scatter> mirror(const Vec3& w, const Facet& facet) const;
  double shadowing(const Vec3& from, const Vec3& to) const;

  ThinFilm film_;        // as seen from outside
  ThinFilm film_below_;  // as seen from below: reversed, or the same in "straight" mode
  Rgb wavelengths_nm_;
  double index_ratio_;  // n0 / n2 in "refract" mode, else 1
  bool rough_;
  bool bends_;
  bool straight_;
  Ggx ggx_;
};

}  // namespace sunbeam
