// The live model without noise: the rest of the BSDF and the albedo by quadrature.
//
// The base has no azimuth and the film is isotropic, so g, the light that leaves the base along mu_o for one
// unit of power arriving at mu_i, depends on two cosines below the film and obeys
//     g(mu_i, mu_o) = f1(mu_i, mu_o) + 2 pi Int f1(mu_i, m) m [film reflects m -> m'] g(m', mu_o) dm
//     rest(wo, wi)  = s Int Int p_t(wi -> m) g(m, m') p_t(wo -> m') dm dm',   s = (n0/n2)^2 or 1 (straight).
// Path "sum": f1 is a product, and the series over visits of the base sums up (rank one),
//     rest = s kd/pi A(wi) A(wo) / (1 - kd rho).
// Path "product": with v(m) = f1(mu, m) at the nodes of a CosineBasis, F = f1 between nodes and B the film's
// reflection from below, g = f1 + v_i^T M v_o, M = B + B F B + ... = (1 - B F)^-1 B.
//
// Exact here means deterministic: no noise, the same bits each time, symmetric to rounding. What is left is
// quadrature error; relative, found by refining every rule (some 900 random materials, n0 = 1, film up to
// 1500 nm, tau up to 2, values above 1e-12):
//   smooth film  4e-8 at most;
//   rough film   1e-5 typically, 2e-4 at most, 3e-4 for n2 within 0.1 % of n0; 1e-3 for films of 20 um;
//   rough film that bends light into a lower index (n2 < n0)  1e-3 typically, 1e-2 at most: light that grazes
//   the base is cut off by the pigment more steeply than the nodes follow.
// Values below 1e-20, deep in the pigment at grazing angles, may lose all relative precision.
//
// Times on one core: construction 2 ms smooth, 20 ms rough; rest() 0.3 us (sum) or 10 us (product) smooth,
// 0.6 ms rough. Thick films take more nodes: at 100 um 70 ms and 90 ms. Const members are safe to share.
#pragma once

#include "bake/live/film_integrals.h"
#include "bake/live/pfmc.h"

namespace sunbeam {

class ExactRest {
 public:
  explicit ExactRest(const Material& material, const Rgb& wavelengths_nm = kRgb3WavelengthsNm,
                     const ExactResolution& resolution = {});

  // Everything but the first surface, 1/sr; 0 below the horizon. Symmetric.
  Rgb rest(const Vec3& wo, const Vec3& wi) const;

  // Directional-hemispherical reflectance: first surface (a smooth film's Dirac included) and rest.
  Rgb albedo(const Vec3& w) const;

 private:
  void solve_sum(const std::array<Matrix, 3>& reflection, const std::array<Vector, 3>& exit);
  void solve_product(const std::array<Matrix, 3>& reflection, const std::array<Vector, 3>& exit);
  double attenuated(double cos_i, double cos_o) const;
  Vector towards_nodes(double cosine) const;
  Rgb arriving(const Vec3& w) const;
  std::array<Vector, 3> on_nodes(const Vec3& w) const;
  Rgb rest_of_sum(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_of_product(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_through_facets(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_albedo(const Vec3& w) const;

  Material material_;
  FilmIntegrals film_;
  Rgb gain_, leaving_;            // sum: kd/pi / (1 - kd rho), and the power that leaves for A = gain = 1
  std::array<Matrix, 3> visits_;  // product: M; if facets bend light g between nodes
  std::array<Vector, 3> albedo_;  // product: the rest's albedo of v(m) / kd; if facets bend light of p_t(m)
};

}  // namespace sunbeam
