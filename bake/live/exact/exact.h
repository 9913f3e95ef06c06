// This file evaluates the live model without noise: the rest of the BSDF and the albedo by quadrature, for 1
// to kMostWavelengths.
//
// The base has no azimuth, so g, the light that leaves the base along mu_o for one unit of power arriving at
// mu_i, depends on two cosines below the film and obeys
//     g(mu_i, mu_o) = f1(mu_i, mu_o) + 2 pi Int f1(mu_i, m) m [film reflects m -> m'] g(m', mu_o) dm
//     rest(wo, wi)  = s Int Int p_t(wi -> m) g(m, m') p_t(wo -> m') dm dm',   s = (n0/n2)^2 or 1 (straight),
// where an anisotropic film reflects by the mean over azimuths, and only p_t knows that of wi or wo.
// Path "sum": f1 is a product, and the series over visits of the base sums up (rank one),
//     rest = s kd/pi A(wi) A(wo) / (1 - kd rho).
// Path "product": with v(m) = f1(mu, m) at the nodes of a CosineBasis, F = f1 between nodes and B the film's
// reflection from below, g = f1 + v_i^T M v_o, M = B + B F B + ... = (1 - B F)^-1 B.
//
// Exact here means deterministic: no noise, the same bits each time, symmetric to rounding. What is left is
// quadrature error; docs/theory/live.md lists it, and tests hold it. The nodes
// follow the directions refracted to grazing the base, and a film of lower index that light tunnels. Values
// below 1e-20, deep in the pigment at grazing angles, may lose all relative precision.
//
// Wavelengths are independent and worked through three at a time. Const members are safe to share.
#pragma once

#include <span>
#include <vector>

#include "bake/live/exact/film_integrals.h"
#include "sunbeam/detail/wavelengths.h"

namespace sunbeam {

// Solves the equations above for three wavelengths side by side, one value each. ExactRest is made of it.
class ExactTriple {
 public:
  // Takes three wavelengths. Their albedo stands in for that of the material, and their absorption scales its
  // own.
  ExactTriple(const Material& material, const Wavelengths& three, const ExactResolution& resolution);

  // Returns the ways to the base. Unless the film is layered they also serve triples of no shorter
  // wavelengths.
  std::vector<CrossingNode> crossings(const Vec3& w) const { return film_.crossings(w); }

  // Holds what rest() needs of a direction with w.z > 0. Making it is what takes the time.
  struct Side {
    Rgb power;                       // A; product without bending at facets: what passes,
    std::array<Vector, 3> on_nodes;  // v / kd there,
    double cosine = 0;               // below the film; product through facets: p_t at nodes alone
  };
  Side side(const std::vector<CrossingNode>& crossings) const;
  Rgb rest(const Side& wo, const Side& wi) const;
  Rgb first_albedo(const Vec3& w) const { return film_.first_albedo(w); }
  Rgb facet_reflectance(double cosine) const { return film_.facet_reflectance(cosine); }
  Rgb rest_albedo(const std::vector<CrossingNode>& crossings) const;

  // Path "sum" alone has these: rest = gain() A(wo) A(wi) with A = arriving().
  Rgb arriving(const std::vector<CrossingNode>& crossings) const;
  Rgb gain() const { return gain_ * material_.radiance_scale(); }

 private:
  using Matrices = std::array<Matrix, 3>;
  using Vectors = std::array<Vector, 3>;

  void solve_sum(const Matrices& reflection, const Vectors& exit);
  void solve_product(const Matrices& reflection, const Vectors& exit);
  Rgb attenuation(double exponent) const;
  Rgb attenuated(double cos_i, double cos_o) const;
  Vectors towards_nodes(double cosine) const;
  Vectors on_nodes(const std::vector<CrossingNode>& crossings) const;
  Rgb passing(const std::vector<CrossingNode>& crossings) const;

  Material material_;
  Rgb base_albedo_, absorption_;
  FilmIntegrals film_;
  Rgb gain_, leaving_;  // sum: kd/pi / (1 - kd rho), and the power that leaves for A = gain = 1
  Matrices visits_;     // product: M; if facets bend light g between nodes
  Vectors exit_;        // product: the rest's albedo of v(m) / kd; if facets bend light of p_t(m)
};

class ExactRest {
 public:
  // Says whether the material is without scattering and its facets are met once.
  static bool is_valid_for(const Material& material) {
    return !material.scatters() && !material.has_multiple_facets();
  }

  // Prepares the rest of a material. Its albedo gives way to that of the wavelengths, and its absorption is
  // scaled by theirs.
  ExactRest(const Material& material, const Wavelengths& wavelengths, const ExactResolution& resolution = {});

  const Wavelengths& wavelengths() const { return wavelengths_; }

  // Returns everything but the first surface, 1/sr, folded to linear RGB; 0 below the horizon. It is
  // symmetric.
  Rgb rest(const Vec3& wo, const Vec3& wi) const { return rest(std::span(&wo, 1), wi).front(); }
  // Does the same for many wo at half the price.
  std::vector<Rgb> rest(std::span<const Vec3> wo, const Vec3& wi) const;

  // Returns the directional-hemispherical reflectance, folded: of first surface (a smooth film's Dirac
  // included) and rest.
  Rgb albedo(const Vec3& w) const;
  Rgb rest_albedo(const Vec3& w) const;

  // Returns the reflectance of a facet that light meets at this cosine from outside, a value for each
  // wavelength.
  std::vector<double> facet_reflectance(double cosine) const;

  // Path "sum" alone has these, a value for each wavelength: rest = fold(gain_k A_k(wo) A_k(wi)). A =
  // arriving(w) is the share of the power along w that reaches the base; w.z > 0.
  std::vector<double> arriving(const Vec3& w) const;
  std::vector<double> gain() const;

 private:
  template <class F>
  std::vector<double> each(F of_triple) const;
  template <class F>
  std::vector<double> each_crossed(const Vec3& w, F of_triple) const;

  Wavelengths wavelengths_;
  bool is_layered_;
  std::vector<ExactTriple> triples_;  // the last one filled up with its last wavelength
  std::size_t finest_;                // of them has the shortest wavelength
};

}  // namespace sunbeam
