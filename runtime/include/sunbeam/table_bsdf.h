// A TableBsdf is a table bound to one parameter point: the fast BSDF that renderers embed. It is
// deterministic. Const calls allocate nothing, throw nothing, lock nothing, and may run on any number of
// threads. Copies share the data.
//
// eval = first + rest of table.h, 1/sr, without the cosine and without the Dirac part.
// sample mixes two techniques, chosen by their directional albedos: visible normals for the first surface
// (bounded, Eto and Tokuyoshi 2023; for a smooth film its mirror direction, a Dirac), and tabulated densities
// over the root of cos(theta_i) for the rest. Neither the choice nor those densities depend on the azimuth of
// wo. pdf is the exact density of that mixture. What normals send below the horizon is empty.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sunbeam/bsdf.h"
#include "sunbeam/core/export.h"
#include "sunbeam/core/result.h"
#include "sunbeam/table.h"

namespace sunbeam {
inline namespace v1 {

class BoundTable;

class SUNBEAM_EXPORT TableBsdf final : public Bsdf {
 public:
  // Slices the table at `parameters`. Outside the grid they are clamped to it, or Error is thrown.
  TableBsdf(const Table& table, const Parameters& parameters, const BindOptions& options = {});

  const Material& material() const;

  // Returns the memory that copies of this share: about 0.1 MB for an isotropic film, half a megabyte for an
  // anisotropic one.
  std::size_t bytes() const;

  // The contract of bsdf.h without a generator.
  Rgb eval(const Vec3& wo, const Vec3& wi) const { return eval_pdf(wo, wi).f; }
  double pdf(const Vec3& wo, const Vec3& wi) const { return eval_pdf(wo, wi).pdf; }
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u) const;
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u) const;

  // The contract itself; what is random draws `u` from the generator.
  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override { return eval(wo, wi); }
  double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return pdf(wo, wi); }
  double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return pdf(wo, wi); }
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override {
    return sample(wo, random3(rng));
  }
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u, Rng&) const override {
    return sample(wo, u);
  }
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const override {
    return eval_and_sample(wo, wi, random3(rng));
  }
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u, Rng&) const override {
    return eval_and_sample(wo, wi, u);
  }
  bool is_isotropic() const override { return material().roughness.is_isotropic(); }

  // Returns value and density at once, at the price of one.
  EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi) const;
  EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return eval_pdf(wo, wi); }

  // Writes f of one viewer and many lights at a lower price each; f[k] belongs to wi[k], and there are as
  // many.
  void eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const;

  // Return the two parts of f, never clipped.
  Rgb first(const Vec3& wo, const Vec3& wi) const;
  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  // Returns the standard error of the rest, 1/sr, in the table's own colours.
  Rgb rest_stderr(const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(double cosine) const;
  // Returns the weight of the mirror direction; 0 for a rough film.
  Rgb dirac(const Vec3& wo) const;

  // Returns the chance that sample() takes the mirror direction; 0 for a rough film.
  double dirac_chance(const Vec3& wo) const;

  // Returns the directional-hemispherical reflectance by quadrature, Dirac included.
  Rgb albedo(const Vec3& wo) const;

 private:
  std::shared_ptr<const BoundTable> bound_;
};

// Returns table.bind(parameters, options), or the message of the Error that it throws.
SUNBEAM_EXPORT Result<TableBsdf> try_bind(const Table& table, const Parameters& parameters,
                                          const BindOptions& options = {});

}  // namespace v1
}  // namespace sunbeam
