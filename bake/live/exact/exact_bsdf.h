// This file makes the live model a deterministic BSDF at the price of a table look-up, for absorption_path
// "sum".
//
// There the rest is exactly of rank one at each wavelength (exact.h),
//     rest(wo, wi) = fold(gain_k A_k(wo) A_k(wi)),
// so that functions of one cosine are all there is: A_k, and the film's reflectance folded to RGB. Both are
// kept as PanelCurve, with errors about as small as those of ExactRest (docs/theory/live.md).
//
// sample mixes visible normals (a smooth film: its mirror direction, a Dirac) and, uniform in azimuth, a
// density over cos^2 in proportion to A_k, averaged over the wavelengths by the power they send out; pdf is
// the exact density of that mixture. Directions that visible normals send below the horizon are empty.
//
// Const members are safe to share.
#pragma once

#include <array>
#include <vector>

#include "bake/live/exact/exact.h"
#include "sunbeam/bsdf.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/panel_curve.h"
#include "sunbeam/detail/piecewise.h"

namespace sunbeam {

class ExactBsdf final : public Bsdf {
 public:
  // A rough film's A_k is dear, and oscillates with the thickness.
  static constexpr double kThickestRoughNm = 5000;
  // Says whether the material is plain with path "sum" and its film smooth or no thicker than that.
  static bool is_valid_for(const Material& material) {
    return material.is_plain() && material.absorption_path == AbsorptionPath::sum &&
           (material.is_smooth() || material.film_thickness_nm <= kThickestRoughNm);
  }

  // Requires is_valid_for(material). The albedo is that of the wavelengths.
  ExactBsdf(const Material& material, const Wavelengths& wavelengths);

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override { return first(wo, wi) + rest(wo, wi); }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override;
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override;
  bool is_isotropic() const override { return true; }

  // Returns the first surface's part, 1/sr; 0 for a smooth film.
  Rgb first(const Vec3& wo, const Vec3& wi) const;
  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  // Returns the weight of the mirror direction; 0 for a rough film.
  Rgb dirac(const Vec3& wo) const { return smooth_ && wo.z > 0 ? reflectance(wo.z) : Rgb(); }

 private:
  bool is_divided() const { return smooth_ && !layered_; }
  double film_coordinate(double cosine) const;
  double cosine_at(double coordinate) const;
  Rgb reflectance(double cosine) const;
  void arriving(double cosine, double* values) const;
  Rgb first_at(const Vec3& wo, const Vec3& wi, const Vec3& h) const;  // h: between wo and wi; rough only
  double density_at(const Vec3& wo, const Vec3& wi, const Vec3& h) const;
  Rgb fold(const double* a, const double* b) const;
  void tabulate_reflectance(const ExactRest& exact);
  void tabulate_arriving(const ExactRest& exact);
  void prepare_sampling();
  double first_albedo(const Vec3& wo) const;
  double first_chance(double cosine) const;
  double rest_pdf(double cosine) const { return rest_marginal_.pdf(square(cosine)) * cosine * kInvPi; }

  ThinFilm film_;  // its outline
  bool layered_, smooth_, rarer_base_;
  double critical_;  // cosine of total reflection outside
  Ggx ggx_;
  PanelCurve reflectance_;  // R over film_coordinate()
  PanelCurve total_;        // R of total reflection over cosine / critical_; no panels if R = 1
  PanelCurve
      arriving_;  // A_k over the cosine; smooth: A_k over x = film_coordinate(), divided by x if one layer
  std::vector<Rgb> weight_;  // gain_k times the weight of folding
  std::array<std::array<double, kMostWavelengths>, 3> fold_{};
  std::vector<double> chance_;       // of sampling the first surface, over even cosines
  PiecewiseConstant rest_marginal_;  // over cos^2
};

}  // namespace sunbeam
