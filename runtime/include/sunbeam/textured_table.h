// A table whose parameters change at every hit: film thickness, base IOR and absorption come from textures.
// Made once from a loaded table, in a fraction of a second; at() then only finds its place in the grid.
//
// For factored tables (factors.h) of isotropic films with absorption path "sum". Both parts of f = first +
// rest are those of table.h and TableBsdf.
//
// First surface: closed form, with the film's reflectance folded at the half angle by FilmSpectrum.
// Rest: at each wavelength it is g A(wi) A(wo) (factors.h). The folded sum is taken as a product of the same
// form, which is exact where A(wi) does not vary within a channel, and right in the mean over wo everywhere:
//
//   rest = B(wi) B(wo),   B(w) = fold(g A* A(w)) / sqrt(fold(g A* A*)),   A* = Int A(w) cos dw.
//
// What decays stays in closed form, and so do a smooth film's fringes; an array of L holds what is left,
//
//   B(w) = P exp(L - a tau / m~),   P = fold(1 - R) at c for a smooth film, 1 - (1 - c~)^5 for a rough one,
//
// over (path, base IOR, absorption, cosine), all linear between nodes that are even in the path and in the
// roots of the others. The path is the thickness, for a rough film times the cosine in the film over that at
// normal incidence: at a fixed path its fringes stand still. c~ and m~, the cosines outside and below the
// film, are kept away from 0 by the roughness; a is the mean absorption of the channel relative to that of
// the parameter. A fourth lane of L is the chance of sampling the first surface, taken at the nearest
// parameters.
//
// sample mixes bounded visible normals (ggx.h; for a smooth film its mirror direction, a Dirac), and for the
// rest two densities proportional to powers of cos(theta_i), which grow with the absorption. The choice
// follows estimates of both albedos. pdf is the exact density of that mixture. What normals send below the
// horizon is empty.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sunbeam/bsdf.h"
#include "sunbeam/power_density.h"
#include "sunbeam/table.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_point.h"

namespace sunbeam {

struct FloatRgb;
struct TexturedData;
struct TexturedDenseViewer;
struct TexturedViewer;

// Copies share the data. Const calls, those of At included, allocate nothing and lock nothing, and may run on
// any number of threads.
class TexturedTable {
 public:
  // Throws Error naming what is not supported.
  explicit TexturedTable(const Table& table);

  // The BSDF at one parameter point; lives no longer than its table.
  class At final : public Bsdf {
   public:
    Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override { return eval_pdf(wo, wi).f; }
    std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const override;
    double pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return mis_pdf(wo, wi); }
    double mis_pdf(const Vec3& wo, const Vec3& wi) const override { return eval_pdf(wo, wi).pdf; }

    // Both at once, at the price of one.
    EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi) const;
    EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi, Rng&) const override { return eval_pdf(wo, wi); }

    const Parameters& parameters() const { return parameters_; }
    // Weight of the mirror direction; 0 for a rough film.
    Rgb dirac(const Vec3& wo) const;
    // Estimate of the directional-hemispherical reflectance, mean over channels, Dirac included.
    double albedo(const Vec3& wo) const;

   private:
    friend class TexturedTable;
    At(const TexturedData& data, const Parameters& parameters);
    void fold(std::span<const float> cosines, FloatRgb* reflectance) const;
    EvalPdf eval_pdf(const TexturedViewer& viewer, const Vec3& wo, const Vec3& wi) const;
    EvalPdf eval_pdf(const TexturedDenseViewer& viewer, const Vec3& wo, const Vec3& wi) const;
    template <class Viewer>
    std::optional<BsdfSample> sample_for(const Viewer& viewer, const Vec3& wo, Rng& rng) const;

    const TexturedData* data_;
    Parameters parameters_;
    TexturedPlace place_;
    TexturedFrame frame_;
    PowerDensity rest_density_;
  };

  // Outside the grid parameters are clamped to it.
  At at(const Parameters& parameters) const noexcept;
  // Or Error is thrown.
  At at(const Parameters& parameters, OutsideGrid outside) const;

  std::size_t bytes() const;

 private:
  std::shared_ptr<const TexturedData> data_;
};

}  // namespace sunbeam
