// Position-free Monte Carlo (Guo, Hasan, Zhao 2018) for the layered skin, unidirectional.
//
// A path is a sequence of directions only. Its value f(wo, wi) is the sum over all paths that enter along wi
// and leave along wo; here split into
//   first = the reflection off the film's upper surface (closed form; a Dirac weight if the film is smooth),
//   rest  = everything that has been below the film, estimated by walks.
// A walk enters along wi. At each visit of the base it connects to wo through the film: a passage drawn from
// wo (always), and the walk's own next direction passing to wo (where facets bend light); the two are
// combined by the balance heuristic over *inside* directions, the measure they share. Reciprocity of the
// passage turns leaving into entering, which leaves one factor (n0/n2)^2 on the whole rest.
//
// Everything is per wavelength, three at once; directions are chosen by means over the three. No hidden
// state.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bake/live/base.h"
#include "bake/live/film_interface.h"
#include "bake/live/wavelengths.h"
#include "sunbeam/bsdf.h"

namespace sunbeam {

// The paper's three wavelengths, taken as linear R, G, B.
inline constexpr Rgb kRgb3WavelengthsNm{650, 510, 475};

// Three wavelengths.
class PfmcOfThree {
 public:
  PfmcOfThree(const Material& material, const Rgb& wavelengths_nm, const Rgb& absorption);

  const FilmInterface& film() const { return film_; }
  const PigmentedBase& base() const { return base_; }

  // First-surface value in 1/sr; 0 for a smooth film. Exact.
  Rgb first(const Vec3& wo, const Vec3& wi) const { return film_.first_surface(wo, wi); }

  // Weight of the mirror direction; 0 for a rough film. Exact.
  Rgb dirac(const Vec3& wo) const { return film_.is_smooth() ? film_.power(wo.z).reflectance : Rgb(); }

  // Adds one walk's unbiased estimate of rest(wo[k], wi), 1/sr, to sums[k]; the wo share the walk.
  void add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums) const;
  Rgb estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng) const;

  // One walk that chooses like the film does; the throughput is the walk's own, its mean at a given wi is
  // f cos / pdf. Empty if lost in the microsurface.
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const;

  // Unbiased estimate of the density of sample()'s non-Dirac outcomes at wi, 1/sr.
  double estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const;

 private:
  void connect(const Vec3& m, const Rgb& throughput, std::span<const Vec3> wo, Rng& rng,
               std::span<Rgb> sums) const;
  void connect_own(const Vec3& m, const Rgb& throughput, double density, std::span<const Vec3> wo,
                   std::span<Rgb> sums) const;
  bool next_visit(Vec3& m, Rgb& throughput, double& roulette, Rng& rng, std::span<const Vec3> wo,
                  std::span<Rgb> sums) const;
  double connect_density(double cos_in, const Vec3& wi, Rng& rng) const;

  FilmInterface film_;
  PigmentedBase base_;
  double radiance_scale_;
  double brightest_albedo_;
};

// Any number of wavelengths, in groups of three that are walked one after the other; everything it returns is
// folded linear RGB. Stands in for a walk that carries all of them.
class Pfmc {
 public:
  explicit Pfmc(const Material& material) : Pfmc(material, Wavelengths::rgb3(material)) {}
  Pfmc(const Material& material, Wavelengths wavelengths);

  // First-surface value in 1/sr; 0 for a smooth film. Exact.
  Rgb first(const Vec3& wo, const Vec3& wi) const;
  double first_pdf(const Vec3& wo, const Vec3& wi) const;
  // Weight of the mirror direction; 0 for a rough film. Exact.
  Rgb dirac(const Vec3& wo) const { return smooth_ ? film_reflectance(wo.z) : Rgb(); }
  Rgb film_reflectance(double cos_exterior) const;

  void add_rest(const Vec3& wi, std::span<const Vec3> wo, Rng& rng, std::span<Rgb> sums) const;
  Rgb estimate_rest(const Vec3& wo, const Vec3& wi, Rng& rng) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const;
  double estimate_pdf(const Vec3& wo, const Vec3& wi, Rng& rng) const;

 private:
  struct Group {
    PfmcOfThree walk;
    Rgb weight[3];  // of each wavelength
    Rgb fold(const Rgb& value) const {
      return value.r * weight[0] + value.g * weight[1] + value.b * weight[2];
    }
  };

  std::vector<Group> groups_;
  bool smooth_;
};

}  // namespace sunbeam
