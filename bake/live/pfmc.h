// This file estimates the BSDF of the layered skin by position-free Monte Carlo (Guo, Hasan, Zhao 2018).
//
// A path is a sequence of directions only. Its value f(wo, wi) is the sum over all paths that enter along wi
// and leave along wo; here split into
//   first = the reflection off the film's upper surface (closed form; a Dirac weight if the film is smooth),
//   rest  = everything that has been below the film, estimated by walks.
// Unidirectional: walks from wi connect to wo through the film at every visit of the base (unidirectional.h).
// Bidirectional: walks from both sides, every connection, weighted by the balance heuristic
// (bidirectional.h). Both are unbiased and exact in expectation for every film, smooth or rough, straight or
// refracting (but for what facets_part.h leaves out). Reciprocity of the crossing turns leaving into
// entering, which leaves one factor (n0/n2)^2 on the whole rest.
//
// For plain materials (Material::is_plain) one estimate is the mean of kLanes stratified walks, worked on
// side by side at all wavelengths (kernels.h); so it is for what has reached the base through multiple
// isotropic facets and a clear pigment (facets_walk.h), whatever the technique. All else, and a rough film
// over a base less dense than the exterior, is the mean of a few walks in three dimensions (general_walk.h).
// Directions are chosen alike for all wavelengths. No value
// depends on earlier calls, and no call allocates.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>

#include "bake/live/general/general_walk.h"
#include "bake/live/walks/film_events.h"
#include "bake/live/walks/kernels.h"
#include "sunbeam/bsdf.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {

enum class Technique { unidirectional, bidirectional };

class Pfmc {
 public:
  Pfmc(const Material& material, const Wavelengths& wavelengths,
       const walk::Kernels& kernels = walk::best_kernels());
  // Carries the paper's three wavelengths.
  explicit Pfmc(const Material& material) : Pfmc(material, Wavelengths::rgb3(material)) {}

  int wavelengths() const { return layers_.count; }

  // Returns how many directions wo share a walk in add_rest().
  std::size_t exits_per_walk() const {
    return family_ == Family::plain ? std::numeric_limits<std::size_t>::max() : walk::GeneralWalk::kMostExits;
  }

  int walks_per_estimate() const { return family_ == Family::general ? walk::kGeneralWalks : walk::kLanes; }

  // Returns the film's reflectance from outside. It is exact.
  Rgb film_reflectance(double cos_exterior) const;

  // Returns the first-surface value in 1/sr; 0 for a smooth film. It is exact.
  Rgb first(const Vec3& wo, const Vec3& wi) const;

  // Returns the weight of the mirror direction; 0 for a rough film. It is exact.
  Rgb dirac(const Vec3& wo) const;

  // Adds one unbiased estimate of rest(wo[k], wi), 1/sr, to sums[k]; the wo share the walks.
  void add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums,
                Technique technique = Technique::unidirectional) const;
  Rgb estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng,
                    Technique technique = Technique::unidirectional) const;

  // Draws a direction by a single walk. The throughput is the walk's own: its mean at a given wi is f cos /
  // pdf. At the upper surface it chooses by the film's reflectance and by what entering is worth over this
  // base, below like the film does. The result is empty if light is lost in the microsurface. What enters the
  // film is carried on by `below`, the same model at other wavelengths. Its mis_pdf is left at 0.
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng, const Pfmc& below) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const { return sample(wo, rng, *this); }

  // Returns an unbiased estimate of the density of sample()'s non-Dirac outcomes at wi, 1/sr, from one walk.
  double estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng, const Pfmc& below) const;
  double estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const {
    return estimate_pdf(wo, wi, rng, *this);
  }

  // Returns the density of choosing the first surface and going to wi, 1/sr. It is exact; 0 for a smooth
  // film.
  double first_pdf(const Vec3& wo, const Vec3& wi) const;

  // Returns the chance that sample() chooses reflection at a facet met from outside at this cosine.
  double reflect_chance(double cos_exterior) const;
  // Returns the density over wi of what leaves after a visit of the base, up to a factor and as if the film
  // were smooth; it is the cosine if the material is not plain.
  double leaving_shape(double cos_exterior) const;

  // Returns the share of wavelength k in choices and in colour: its absolute weights, normalised.
  double importance(int k) const { return importance_[k]; }

  // at() returns the same model at some of its wavelengths, their weights multiplied by `factor`.
  struct Pick {
    int wavelength;
    double factor;
  };
  Pfmc at(std::span<const Pick> picks) const;

 private:
  // Says what estimates the rest.
  enum class Family { plain, facets, general };
  static Family family_of(const Material& material);
  void forecast_visits();

  using Powers = walk::Spectrum<double>;
  Rgb fold(const double* values) const;
  FilmPowers film_at(sunbeam::Side side, double cosine) const;
  std::optional<BsdfSample> sample_plain(const Vec3& wo, Rng& rng, const Pfmc& below) const;
  double estimate_plain_pdf(const Vec3& wo, const Vec3& wi, Rng& rng, const Pfmc& below) const;
  std::optional<BsdfSample> sample_below(double cosine, Powers& throughput, Rng& rng) const;
  double leave_pdf(const Vec3& wi, Rng& rng, double& cosine) const;
  double pdf_below(const Vec3& wi, Rng& rng) const;

  void add_general_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums,
                        Technique technique) const;
  void add_facets_rest(const Vec3& wi, const Vec3* wo, int exits, Rng& rng, double* values) const;
  std::optional<BsdfSample> sample_general(const Vec3& wo, Rng& rng, const Pfmc& below) const;
  double estimate_general_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const;
  walk::GeneralWalk general_walk(walk::Carrying carrying) const;

  walk::Layers layers_;
  walk::GeneralLayers general_;
  Family family_;
  std::array<Rgb, kMostWavelengths> weight_;
  std::array<double, kMostWavelengths> importance_;
  Ggx ggx_;
  const walk::Kernels* kernels_;
};

}  // namespace sunbeam
