// A table bound to one parameter point, behind TableBsdf: what is prepared, and how directions are looked up.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "runtime/src/lookup/bound_rest.h"
#include "runtime/src/lookup/cosine_rows.h"
#include "runtime/src/lookup/dense_rest.h"
#include "runtime/src/lookup/facet_cells.h"
#include "runtime/src/lookup/facets.h"
#include "sunbeam/detail/ggx.h"
#include "sunbeam/table_bsdf.h"

namespace sunbeam::inline v1 {

class BoundTable {
 public:
  // `material` is that of the table with the parameters of the point, which lie in the grid.
  BoundTable(const Table& table, const Material& material, Arithmetic arithmetic);

  struct Parts {
    Color4 first, rest;  // 1/sr
    float pdf;

    EvalPdf eval_pdf() const { return {to_rgb(first + rest), double{pdf}}; }
    std::optional<BsdfSample> sample(const Vec3& wi) const {
      if (pdf <= 0) return {};
      return BsdfSample{wi, to_rgb(first + rest) * (wi.z / double{pdf}), false, double{pdf}};
    }
  };
  // All directions lie above the horizon, but for those of a span.
  Parts parts(const Vec3& wo, const Vec3& wi) const;
  EvalPdf eval_pdf(const Vec3& wo, const Vec3& wi) const;
  void eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const;
  std::optional<BsdfSample> sample(const Vec3& wo, Rng& rng) const;
  EvalAndSample eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const;

  Rgb rest(const Vec3& wo, const Vec3& wi) const;
  Rgb rest_stderr(const Vec3& wo, const Vec3& wi) const;
  Rgb film_reflectance(double cosine) const;
  Rgb albedo(const Vec3& wo) const;

  const Material& material() const { return material_; }
  bool is_smooth() const { return smooth_; }

 private:
  // What the viewer decides, for any number of lights.
  struct Viewer {
    Viewer(const BoundTable& table, const Vec3& wo);

    Color4 end;  // see ends_
    FacetViewer facets;
    EvenPosition pairs, rows;  // in pairs_ and of both samplers

    float first_chance() const { return end[3]; }
  };

  struct Places;
  template <int kLights>
  std::array<Parts, kLights> parts(const Viewer& viewer, const Vec3& wo,
                                   const std::array<Vec3, kLights>& wi) const;
  Vec3 draw(const Viewer& viewer, float lot, const Vec3& wo, Rng& rng) const;
  BsdfSample mirrored(const Viewer& viewer, const Vec3& wo) const;
  Vec3 draw_first(const Viewer& viewer, int row, const Vec3& wo, Rng& rng) const;
  Vec3 draw_rest(int row, Rng& rng) const;

  void take_rest(const Table& table, Arithmetic arithmetic);
  void prepare_sampling();
  void prepare_pairs();
  struct Moments {
    double first = 0, second = 0;
    double least_cosine = 1;  // of what is drawn
  };
  Moments first_moments(const Vec3& wo, std::size_t cell, int nodes) const;
  double add_first_row(const Vec3& wo);
  double add_rest_row(std::span<const Vec3> viewers);
  Rgb first_albedo(const Vec3& wo, int nodes) const;
  Rgb rest_albedo(const Vec3& wo) const;
  void visit_azimuth_mean(const Vec3& wo,
                          const std::function<void(const std::function<Rgb(double)>&)>& visit) const;
  bool has_cells() const { return facets_.u2 == facets_.v2; }

  static constexpr int kPairs = BoundRest::kRatioCosines, kRows = FacetCells::kRows;
  static_assert((kPairs - 1) % (kRows - 1) == 0 && (kPairs - 1) % (CosineRows::kNodes - 1) == 0,
                "what is linear between rows and nodes of sampling must be so between pairs");

  Material material_;
  Symmetry symmetry_;
  double noise_ = 0;  // relative standard error of a factored rest
  Ggx normals_;
  Facets facets_;
  bool smooth_;
  std::variant<std::monostate, DenseRest, BoundRest> rest_;
  bool has_scales_ = false;  // an isotropic factored rest has
  // Over even cosines, and one node more: that scale, and in the last lane the chance that sample() tries the
  // first surface for a viewer there.
  std::vector<Color4> ends_;
  std::vector<Color4> film_;  // over even cosines
  // (root of the viewer's cosine, root of the light's), both even: the ratio of an isotropic factored rest,
  // and in the last lane CosineRows's density.
  std::vector<Color4> pairs_;
  CosineRows rest_sampler_;
  FacetCells first_sampler_;  // an isotropic rough film's
};

}  // namespace sunbeam::inline v1
