// This file is what TableBsdf is made of: a table bound to one parameter point. It says what is prepared and
// how directions are looked up.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "runtime/src/lookup/bound_sampling.h"
#include "runtime/src/lookup/bound_values.h"
#include "runtime/src/sampling/cosine_rows.h"
#include "runtime/src/sampling/facet_cells.h"
#include "runtime/src/sampling/facets.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam {
inline namespace v1 {

class BoundTable {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid.
  BoundTable(const Table& table, const Material& material, const BindOptions& options);

  struct Parts {
    Color4 first, rest;  // 1/sr
    float pdf;

    Color4 least;  // of each component of f

    EvalPdf eval_pdf() const { return {to_rgb(max4(first + rest, least)), double{pdf}}; }
    std::optional<BsdfSample> sample(const Vec3& wi) const {
      if (pdf <= 0) return {};
      return BsdfSample{wi, eval_pdf().f * (wi.z / double{pdf}), false, double{pdf}};
    }
  };
  // All directions lie above the horizon, but for those of a span.
  Parts parts(const Vec3& wo, const Vec3& wi) const;
  EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi) const;
  void eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const;
  std::optional<BsdfSample> sample(const Vec3& wo, const Random3& u) const;
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u) const;

  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_stderr(const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(double cosine) const { return values_.film_reflectance(cosine); }
  // Returns the chance that sample() tries the first surface.
  double first_chance(const Vec3& wo) const;
  Rgb dirac(double cosine) const { return to_rgb(max4(to_color4(film_reflectance(cosine)), least_)); }
  Rgb albedo(const Vec3& wo) const;

  std::size_t bytes() const {
    return sizeof(BoundTable) + values_.bytes() + cosine_rows_.bytes() + facet_cells_.bytes();
  }
  const Material& material() const { return values_.material; }
  bool is_smooth() const { return smooth_; }

 private:
  // Holds what the viewer decides, for any number of lights.
  struct Viewer {
    Viewer(const BoundTable& table, const Vec3& wo);

    float first_chance() const { return scale[3]; }

    Color4 scale;  // S, and in the last lane the chance that sample() tries the first surface
    FacetViewer facets;
    EvenPosition ratios, rows;  // in Q and in the rows of both samplers
    FacetCells::Mixture mixture;
  };

  Parts parts(const Viewer& viewer, const Vec3& wo, const Vec3& wi) const;
  float cell_density(const Viewer& viewer, const FacetPair& pair) const;
  std::optional<BsdfSample> sample(const Viewer& viewer, const Vec3& wo, const Random3& u) const;
  Vec3 draw(const Viewer& viewer, const Vec3& wo, const Random3& u) const;
  BsdfSample mirrored(const Viewer& viewer, const Vec3& wo) const;
  void eval_four(const Viewer& viewer, const Color4* ratios, const Vec3& wo, const Vec3* wi, Rgb* f) const;

  void fill_last_lanes(const BoundSampling& sampling);
  // Returns where Q's last lane is the density of a row of cosine_rows_ at a node.
  const Color4* rest_density(int row, int node) const {
    const int step = (ratio_roots() - 1) / CosineRows::kIntervals;
    return values_.separable.ratios.data() + (2 * row * ratio_roots() + node) * step;
  }
  bool has_cells() const { return facets_.u2 == facets_.v2; }

  int ratio_roots() const { return values_.separable.ratio_roots; }
  // Returns the last nodes of S, Q and the film's reflectance.
  Color4 last_nodes() const {
    return Color4{float{kScales - 1}, static_cast<float>(ratio_roots() - 1),
                  float{BoundValues::kFilmCosines - 1}, 0};
  }

  static constexpr int kScales = Separable::kScaleCosines, kRows = FacetCells::kRows;
  static constexpr int kIntervals = Separable::kRatioRoots - 1;
  static_assert(kIntervals % (kRows - 1) == 0 && kIntervals % (CosineRows::kNodes - 1) == 0,
                "what is linear between rows and nodes of sampling must be so between ratios");

  static_assert(CosineRows::kIntervals == 2 * (kRows - 1));

  // The last lanes of S and Q, of every table, hold for a viewer there the chance of trying the first
  // surface, and for a pair the density of cosine_rows_.
  BoundValues values_;
  Facets facets_;
  bool smooth_, separable_;
  Color4 least_;  // of each component of f: 0 if negative ones are clipped, else a number below all
  CosineRows cosine_rows_;
  FacetCells facet_cells_;  // of an isotropic rough film
};

}  // namespace v1
}  // namespace sunbeam
