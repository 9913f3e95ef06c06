// A table bound to one parameter point: the fast BSDF that renderers embed. Deterministic; const calls may
// run on any number of threads.
//
// eval = first + rest of table.h, 1/sr, without the cosine and without the Dirac part.
// sample mixes two techniques, chosen by their directional albedos: visible normals for the first surface
// (for a smooth film: its mirror direction, a Dirac), and tabulated densities over cos(theta_i) for the rest.
// Neither the choice nor those densities depend on the azimuth of wo. pdf is the exact density of that
// mixture. Directions that visible normals send below the horizon are empty.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "sunbeam/bsdf.h"
#include "sunbeam/core/bracket.h"
#include "sunbeam/core/piecewise.h"
#include "sunbeam/ggx.h"
#include "sunbeam/table.h"

namespace sunbeam {

enum class OutsideGrid { clamp, refuse };

// A colour over cos(theta) in [0, 1], equally spaced nodes, linear between.
class CosineCurve {
 public:
  CosineCurve() = default;
  explicit CosineCurve(std::vector<Rgb> values) : values_(std::move(values)) {}
  Rgb operator()(double cosine) const {
    const Bracket at = even_bracket(cosine, values_.size());
    return (1 - at.upper_weight) * values_[at.lower] + at.upper_weight * values_[at.upper];
  }

 private:
  std::vector<Rgb> values_;
};

class TableBsdf final : public Bsdf {
 public:
  // Slices the table at `parameters`. Outside the grid they are clamped to it, or Error is thrown.
  TableBsdf(const Table& table, const Parameters& parameters, OutsideGrid outside);

  const Material& material() const { return material_; }

  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override { return first(wo, wi) + rest(wo, wi); }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override;
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override;

  Rgb first(const Vec3& wo, const Vec3& wi) const;
  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_stderr(const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(double cosine) const { return reflectance_(cosine); }
  // Weight of the mirror direction; 0 for a rough film.
  Rgb dirac(const Vec3& wo) const { return material_.is_smooth() ? reflectance_(wo.z) : Rgb(); }

  // Directional-hemispherical reflectance by quadrature, Dirac included.
  Rgb albedo(const Vec3& wo) const;

 private:
  struct AzimuthNode {
    double phi_i, phi_o;  // table coordinates
    double weight;        // all add up to 1
  };
  std::array<double, 4> coordinates(const Vec3& wo, const Vec3& wi) const;
  std::vector<AzimuthNode> azimuths_around(const Vec3& wo) const;
  double make_sampling_node(double cos_o);
  Rgb first_albedo(const Vec3& wo, int nodes) const;
  Rgb rest_albedo(const Vec3& wo, std::vector<double>* marginal) const;
  double first_chance(double cos_o) const;
  double rest_pdf(double cos_o, double cos_i) const;
  Vec3 sample_rest(const Vec3& wo, Rng& rng) const;

  Material material_;
  Symmetry symmetry_;
  RestFrame frame_;
  Ggx ggx_;
  NdArray remainder_, stderr_;  // over the four angles
  bool has_azimuth_;            // else they have one node each, and finding the azimuths would be in vain
  CosineCurve reflectance_, transmittance_;

  // Sampling data over cos(theta_o), equally spaced nodes; means over the azimuth of wo.
  CosineCurve first_chance_;
  std::vector<PiecewiseConstant> rest_marginals_;
};

}  // namespace sunbeam
