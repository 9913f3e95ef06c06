// This file looks a textured table up (sunbeam/textured_table.h). It says what the table holds, what a viewer
// decides, and what mixture.h asks for, of each kind of table.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "runtime/src/fit/dense_albedos.h"
#include "runtime/src/lookup/textured_rest.h"
#include "runtime/src/rest/dense_rest.h"
#include "runtime/src/sampling/facets.h"
#include "runtime/src/textured/layered_rest.h"
#include "sunbeam/detail/layered_film.h"
#include "sunbeam/textured_table.h"

namespace sunbeam {
inline namespace v1 {

// The kinds are: factored, isotropic and of path "sum"; any other factored one; factored with a layered film;
// dense.
enum class TexturedKind { plain, general, layered, dense };

inline bool is_layered(const Table& table) {
  return table.is_factored() && is_layered(table.material, table.factors.wavelengths);
}

// Says where a direction lies among the nodes of L, and holds its closed forms.
struct TexturedEnd {
  // `root` is that of the cosine.
  TexturedEnd(const TexturedRest& rest, const FilmCosines& film, const ParameterTaps& taps,
              const PigmentCosines& pigment, float cosine, float root)
      : roots(sqrt4(Color4{film.path_squared(cosine), pigment.pigment_cosine_squared(cosine),
                           film.film_cosine_squared(cosine), pigment.warp_radicand(cosine)})),
        coordinate(film.is_warped ? pigment.warped(cosine, roots[3]) : root),
        at(rest.direction(taps, roots[0], coordinate)),
        per_pigment_cosine(1 / roots[1]),
        passing(FilmCosines::passing(roots[2])) {}

  Color4 roots;
  float coordinate;  // among the nodes of L and X
  TexturedRest::Direction at;
  float per_pigment_cosine;  // 1 / m~
  float passing;             // of a rough film
};

struct TexturedData {
  TexturedData(const Table& table, const BindOptions& options)
      : material(table.material),
        to(rgb_to_rgb(table.color_space(), options.color_space.value_or(table.color_space()))),
        keeps_colors(options.color_space.value_or(table.color_space()) == table.color_space() &&
                     !options.clip_negative),
        least(options.clip_negative ? 0 : std::numeric_limits<double>::lowest()),
        film(table.material, table.is_factored() && !is_layered(table) &&
                                 FactorFrame(table.material, reaches_below(table)).is_warped()),
        facets(table.material.roughness),
        smooth(table.material.is_smooth()) {
    if (is_layered(table)) {
      layered.emplace(table);
    } else if (table.is_factored()) {
      rest.emplace(table, options.arithmetic);
    } else {
      dense.emplace(table);
      albedos.emplace(table);
    }
    kind = layered            ? TexturedKind::layered
           : dense            ? TexturedKind::dense
           : rest->is_plain() ? TexturedKind::plain
                              : TexturedKind::general;
  }

  const EvenAxis& axis(std::size_t k) const {
    if (kind == TexturedKind::layered) return layered->axis(k);
    return kind == TexturedKind::dense ? albedos->axis(k) : rest->axis(k);
  }
  // Says whether `rest` is there.
  bool has_logs() const { return kind == TexturedKind::plain || kind == TexturedKind::general; }
  std::size_t bytes() const {
    if (layered) return layered->bytes();
    return rest ? rest->bytes() : dense->bytes() + albedos->bytes();
  }
  // Returns the mean absorption of the pigment relative to the parameter, as far as the rest decays with it.
  float mean_absorption() const {
    if (kind == TexturedKind::layered) return layered->absorption()[3];
    if (kind != TexturedKind::dense) return rest->media().absorption[3];
    return material.scatters() || material.has_multiple_facets() ? 0 : 1;
  }

  // Returns a colour of the table as the caller wants it.
  Rgb colors(const Rgb& color) const {
    if (keeps_colors) return color;
    return transform(to * color, [this](double c) { return std::max(c, least); });
  }

  // Returns B B over T T; one exponential serves both.
  Color4 rest_factor(const ParameterTaps& taps, const PigmentCosines& pigment, const TexturedEnd& o,
                     const TexturedEnd& i) const {
    const float paths = o.per_pigment_cosine + i.per_pigment_cosine;
    return exp4(rest->at(taps, o.at) + rest->at(taps, i.at) -
                (pigment.optical_depth * paths) * rest->media().absorption);
  }

  // Returns the same for an anisotropic film or path "product", times its bracket V1 + X.
  SUNBEAM_NOINLINE Color4 general_factor(const Parameters& parameters, const ParameterTaps& taps,
                                         const PigmentCosines& pigment, const TexturedEnd& o,
                                         const TexturedEnd& i, const Vec3& wo, const Vec3& wi) const {
    const TexturedRest::PairEnd end_o{o.coordinate, quadrant(wo)}, end_i{i.coordinate, quadrant(wi)};
    const float paths = o.per_pigment_cosine + i.per_pigment_cosine;
    const Color4 factor = exp4(rest->at(taps, o.at, end_o.phi) + rest->at(taps, i.at, end_i.phi) -
                               (pigment.optical_depth * paths) * rest->media().absorption);
    if (!rest->is_product()) return factor;
    return factor *
           (one_visit(pigment, rest->media().absorption, wo, wi) + rest->exchange(parameters, end_o, end_i));
  }

  // Returns V1.
  static Color4 one_visit(const PigmentCosines& pigment, const Color4& absorption, const Vec3& wo,
                          const Vec3& wi) {
    const float beyond_o = 1 / pigment.cosine_below(static_cast<float>(wo.z)) - 1,
                beyond_i = 1 / pigment.cosine_below(static_cast<float>(wi.z)) - 1;
    return exp4((pigment.optical_depth * (1 - beyond_o * beyond_i)) * absorption);
  }

  // Returns the azimuth folded into a quadrant, over pi/2; it is of no matter for an isotropic film.
  float quadrant(const Vec3& w) const {
    if (facets.u2 == facets.v2) return 0;
    return static_cast<float>(std::atan2(std::abs(w.y), std::abs(w.x)) * (2 / kPi));
  }

  TexturedKind kind;
  Material material;
  ColorMatrix to;                      // from the colours of the table to the caller's
  bool keeps_colors;                   // where neither changes them
  double least;                        // of each component
  std::optional<TexturedRest> rest;    // of a factored table,
  std::optional<LayeredRest> layered;  // of one with a layered film
  std::optional<DenseRest> dense;      // or of a dense one
  std::optional<DenseAlbedos> albedos;
  FilmCosines film;
  Facets facets;
  bool smooth;
};

// Looks up one parameter point of a factored table; the dense kind is below. Directions lie above the
// horizon.
template <TexturedKind kKind>
class TexturedLookup {
 public:
  explicit TexturedLookup(const TexturedTable::At& at) : at_(at), data_(*at.data_) {}

  // Holds what a viewer decides; L is on its way.
  struct Viewer {
    Viewer(const TexturedLookup& lookup, const Vec3& wo)
        : facets(lookup.data_.facets, wo), end(lookup.end(facets.cosine, facets.root)) {
      lookup.data_.rest->prefetch(lookup.at_.taps_, end.at);
      first_chance = lookup.data_.rest->first_chance(lookup.at_.taps_, end.at);
    }
    FacetViewer facets;
    TexturedEnd end;
    float first_chance;
  };

  Rgb mirror_reflectance(const Vec3& wo) const { return to_rgb(film_at(static_cast<float>(wo.z))); }

  SUNBEAM_ALWAYS_INLINE EvalPdf eval_pdf(const Viewer& viewer, const Vec3& wo, const Vec3& wi) const {
    const FacetPair pair(data_.facets, viewer.facets, wo, wi);
    const TexturedEnd i = end(pair.cosine, pair.root);
    data_.rest->prefetch(at_.taps_, i.at);
    FloatRgb film[2];
    if (data_.smooth) {
      const float cosines[] = {viewer.facets.cosine, pair.cosine};
      fold(cosines, film);
    } else {
      const float half_cosine = std::min(pair.half_cosine, 1.0f);
      fold({&half_cosine, 1}, film);
    }

    const Color4 rest = rest_factor(viewer, i, wo, wi);
    const float chance = viewer.first_chance, rest_pdf = (1 - chance) * at_.rest_density_.pdf(pair.cosine);
    const TexturedMedia& media = data_.rest->media();
    if (data_.smooth)
      return {to_rgb(media.passing(film[0]) * media.passing(film[1]) * rest), double{rest_pdf}};
    const float passing = viewer.end.passing * i.passing;
    const Color4 reflectance{film[0].r, film[0].g, film[0].b, 0};
    return {to_rgb(passing * rest + pair.lobe * reflectance), double{rest_pdf + chance * pair.pdf}};
  }

  // Estimates the albedo, mean over channels.
  double albedo(const Viewer& viewer) const {
    const Color4 first = film_at(std::sqrt(data_.film.film_cosine_squared(viewer.facets.cosine)));
    return double{first[0] + first[1] + first[2]} / 3 / double{data_.rest->at(at_.taps_, viewer.end.at)[3]};
  }

 private:
  TexturedEnd end(float cosine, float root) const {
    return {*data_.rest, data_.film, at_.taps_, at_.pigment_, cosine, root};
  }

  // Writes the film's reflectances at up to three cosines, at the price of little more than one.
  void fold(std::span<const float> cosines, FloatRgb* reflectance) const {
    const Parameters& at = at_.parameters_;
    data_.rest->media().film.fold(at.film_thickness_nm, at.base_ior, cosines, reflectance);
  }
  Color4 film_at(float cosine) const {
    FloatRgb film;
    fold({&cosine, 1}, &film);
    return Color4{film.r, film.g, film.b, 0};
  }

  SUNBEAM_ALWAYS_INLINE Color4 rest_factor(const Viewer& viewer, const TexturedEnd& i, const Vec3& wo,
                                           const Vec3& wi) const {
    if constexpr (kKind == TexturedKind::plain)
      return data_.rest_factor(at_.taps_, at_.pigment_, viewer.end, i);
    else
      return data_.general_factor(at_.parameters_, at_.taps_, at_.pigment_, viewer.end, i, wo, wi);
  }

  const TexturedTable::At& at_;
  const TexturedData& data_;
};

template <>
class TexturedLookup<TexturedKind::layered> {
 public:
  explicit TexturedLookup(const TexturedTable::At& at)
      : at_(at), data_(*at.data_), point_(data_.layered->point(at.parameters_)) {}

  struct Viewer {
    Viewer(const TexturedLookup& lookup, const Vec3& wo)
        : facets(lookup.data_.facets, wo), end(lookup.end(wo, facets.cosine)) {
      const LayeredRest& layered = *lookup.data_.layered;
      first_chance = layered.first_chance(lookup.point_, end);
      if (layered.has_rest()) factor = layered.factor(lookup.point_, end);
    }
    FacetViewer facets;
    LayeredRest::End end;
    LayeredRest::Factor factor;
    float first_chance;
  };

  Rgb mirror_reflectance(const Vec3& wo) const { return to_rgb(film_at(static_cast<float>(wo.z))); }

  EvalPdf eval_pdf(const Viewer& viewer, const Vec3& wo, const Vec3& wi) const {
    const FacetPair pair(data_.facets, viewer.facets, wo, wi);
    const float chance = viewer.first_chance, rest_pdf = (1 - chance) * at_.rest_density_.pdf(pair.cosine);
    Color4 f{};
    if (data_.layered->has_rest()) f = rest(viewer, end(wi, pair.cosine), wo, wi);
    if (data_.smooth) return {to_rgb(f), double{rest_pdf}};
    return {to_rgb(f + pair.lobe * film_at(pair.half_cosine)), double{rest_pdf + chance * pair.pdf}};
  }

  double albedo(const Viewer& viewer) const {
    const Color4 first = film_at(std::sqrt(data_.film.film_cosine_squared(viewer.facets.cosine)));
    return double{first[0] + first[1] + first[2]} / 3 / double{viewer.first_chance};
  }

 private:
  LayeredRest::End end(const Vec3& w, float cosine) const {
    return {cosine, 1 / std::sqrt(at_.pigment_.pigment_cosine_squared(cosine)), data_.quadrant(w)};
  }
  Color4 film_at(float cosine) const { return data_.layered->reflectance(point_, std::min(cosine, 1.0f)); }
  Color4 rest(const Viewer& viewer, const LayeredRest::End& i, const Vec3& wo, const Vec3& wi) const {
    const LayeredRest& layered = *data_.layered;
    const LayeredRest::PairRows rows = layered.pair_rows(point_, viewer.end, i);
    const Color4 factors = layered.product(viewer.factor, layered.factor(point_, i));
    Color4 bracket = LayeredRest::exchange(rows);
    if (layered.is_product()) bracket += TexturedData::one_visit(at_.pigment_, layered.absorption(), wo, wi);
    return factors * bracket;
  }

  const TexturedTable::At& at_;
  const TexturedData& data_;
  LayeredRest::Point point_;
};

template <>
class TexturedLookup<TexturedKind::dense> {
 public:
  explicit TexturedLookup(const TexturedTable::At& at) : at_(at), data_(*at.data_) {}

  struct Viewer {
    Viewer(const TexturedLookup& lookup, const Vec3& wo)
        : facets(lookup.data_.facets, wo),
          rest_albedo(lookup.data_.albedos->at(lookup.at_.parameters_, std::min(facets.root, 1.0f))) {
      constexpr float kLeastChance = 0.05f;  // of either technique
      const float cosine = std::min(std::sqrt(lookup.data_.film.film_cosine_squared(facets.cosine)), 1.0f);
      first_albedo = std::max(0.0f, static_cast<float>(mean(lookup.film_at(double{cosine}))));
      const float share = first_albedo / std::max(first_albedo + rest_albedo, 1e-9f);
      first_chance = std::clamp(share, kLeastChance, 1 - kLeastChance);
    }
    FacetViewer facets;
    float rest_albedo, first_albedo, first_chance;
  };

  Rgb mirror_reflectance(const Vec3& wo) const { return film_at(std::min(wo.z, 1.0)); }

  EvalPdf eval_pdf(const Viewer& viewer, const Vec3& wo, const Vec3& wi) const {
    const FacetPair pair(data_.facets, viewer.facets, wo, wi);
    const Rgb rest = data_.dense->rest(at_.parameters_, wo, wi);
    const float chance = viewer.first_chance, rest_pdf = (1 - chance) * at_.rest_density_.pdf(pair.cosine);
    if (data_.smooth) return {rest, double{rest_pdf}};
    const Rgb film = film_at(std::min(double{pair.half_cosine}, 1.0));
    return {rest + double{pair.lobe} * film, double{rest_pdf + chance * pair.pdf}};
  }

  double albedo(const Viewer& viewer) const { return double{viewer.first_albedo + viewer.rest_albedo}; }

 private:
  Rgb film_at(double cosine) const { return data_.dense->reflectance().at(at_.parameters_, cosine); }

  const TexturedTable::At& at_;
  const TexturedData& data_;
};

}  // namespace v1
}  // namespace sunbeam
