// A TexturedTable is a table whose parameters change at every hit: film thickness, base IOR and absorption
// come from textures. It is made once from a loaded table, in a fraction of a second; at() then only finds
// its place in the grid.
//
// In every table both parts of f = first + rest are those of table.h and TableBsdf.
//
// A dense table's own arrays are interpolated at the parameters and directions as bind() would; what differs
// is rounding.
//
// Of a factored table (factors.h) the first surface is in closed form, with the film's reflectance folded at
// the half angle by FilmSpectrum. The rest is at each wavelength g A(wi) A(wo), times a bracket V(wi, wo)
// with path "product". The folded sum is taken as a product of the same form,
//
//   rest = B(wi) B(wo) [1 with path "sum", V1 + X with "product"],
//   B(w) = fold(g A* A(w)) / sqrt(fold(g A* A*)),   A* = Int A(w) cos dw,
//
// which with path "sum" is exact where A(wi) does not vary within a channel, and right in the mean over wo
// everywhere. With "product", V1 is one visit of the base at the channel's mean absorption, and X, an array
// over the parameters and both directions, what is left: the sum is right at its nodes.
//
// What decays stays in closed form, and so do a smooth film's fringes; an array of L holds what is left,
//
//   B(w) = P exp(L - a tau / m~),   P = fold(1 - R) at c for a smooth film, 1 - (1 - c~)^5 for a rough one,
//
// over (path, base IOR, absorption, azimuth, cosine), all linear between nodes that are even in the path, in
// the azimuth of an anisotropic film and in the roots of the others. The path is the thickness, for a rough
// film times the cosine in the film over that at normal incidence: at a fixed path its fringes stand still.
// c~ and m~, the cosines outside and below the film, are kept away from 0 by the roughness; a is the mean
// absorption of the channel relative to that of the parameter. A fourth lane of L is the chance of sampling
// the first surface, taken at the nearest parameters.
//
// Where base IORs of a rough film's table lie below the exterior's, nodes of the cosine are even in the
// warped cosine of factor_frame.h, m~ = hypot(m, 0.3) with "refract", and L = ln(B / (P e) + 1e-4 B1 / P)
// with e = exp(-a tau / m~) and B1 what B would be if all light arrived. V1 is then taken at hypot(m, a/2)
// in place of m, with the a of that file.
//
// Under a layered film (layered_film.h) no closed form is fast enough, and what passes may depend on the
// wavelength as sharply as a mirror's band, which moves with the angle. So arrays hold what the film
// reflects, R, and B at the least absorption tau0 of the grid, P, and X holds all of the bracket,
//
//   rest = B(wi) B(wo) [X with path "sum", V1 + X with "product"],   B = P exp(L - a (tau - tau0) / m~),
//
// with the positive part of each weight in the fold of B, so that no channel of it passes through 0. Nodes of
// thickness and base IOR are as many as the film's error between them asks for. R and P are cubic in the
// thickness; all else is linear, over even cosines too; but where some
// base IOR lies below the exterior's, R and P have an eighth of their nodes up to the critical
// cosine of their base IOR. An opaque base leaves R alone.
//
// sample mixes bounded visible normals (ggx.h; for a smooth film its mirror direction, a Dirac), and for the
// rest two densities proportional to powers of cos(theta_i), which grow with the absorption. The choice
// follows estimates of both albedos. pdf is the exact density of that mixture. What normals send below the
// horizon is empty.
//
// Factored isotropic tables of path "sum" are the fast kind; the others take several times as long, dense
// ones more than a microsecond (bench_runtime, textured_*).
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sunbeam/bsdf.h"
#include "sunbeam/core/export.h"
#include "sunbeam/detail/power_density.h"
#include "sunbeam/detail/textured_point.h"
#include "sunbeam/table.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {
inline namespace v1 {

struct TexturedData;
enum class TexturedKind;
template <TexturedKind kKind>
class TexturedLookup;

// Copies share the data. Const calls, those of At included, allocate nothing and lock nothing, and may run on
// any number of threads.
class SUNBEAM_EXPORT TexturedTable {
 public:
  // Takes what it needs of `table`, which need not outlive it. Throws Error if the film's thickness or its
  // layers would take too much memory or time. `outside` of the options is of no matter.
  explicit TexturedTable(const Table& table, const BindOptions& options = {});

  // At is the BSDF at one parameter point; it lives no longer than its table.
  class SUNBEAM_EXPORT At final : public Bsdf {
   public:
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

    // Returns value and density at once, at the price of one.
    EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi) const;
    EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return eval_pdf(wo, wi); }

    const Parameters& parameters() const { return parameters_; }
    // Returns the weight of the mirror direction; 0 for a rough film.
    Rgb dirac(const Vec3& wo) const;
    // Estimates the directional-hemispherical reflectance, mean over channels, Dirac included.
    double albedo(const Vec3& wo) const;

   private:
    friend class TexturedTable;
    template <TexturedKind kKind>
    friend class TexturedLookup;
    At(const TexturedData& data, const Parameters& parameters);
    template <class Call>
    auto with_lookup(const Vec3& wo, Call call) const;
    template <class Lookup, class Viewer>
    EvalPdf eval_pdf_for(const Lookup& lookup, const Viewer& viewer, const Vec3& wo, const Vec3& wi) const;
    template <class Lookup, class Viewer>
    std::optional<BsdfSample> sample_for(const Lookup& lookup, const Viewer& viewer, const Vec3& wo,
                                         const Random3& u) const;

    const TexturedData* data_;
    Parameters parameters_;
    ParameterTaps taps_;
    PigmentCosines pigment_;
    PowerDensity rest_density_;
  };

  // Returns the BSDF at these parameters. Outside the grid they are clamped to it.
  At at(const Parameters& parameters) const noexcept;
  // Does the same, but throws Error outside the grid if `outside` says so.
  At at(const Parameters& parameters, OutsideGrid outside) const;

  std::size_t bytes() const;

 private:
  std::shared_ptr<const TexturedData> data_;
};

}  // namespace v1
}  // namespace sunbeam
