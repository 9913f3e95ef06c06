#include "sunbeam/textured_table.h"

#include <cmath>
#include <type_traits>

#include "runtime/src/fit/dense_albedos.h"
#include "runtime/src/lookup/dense_rest.h"
#include "runtime/src/lookup/facets.h"
#include "runtime/src/lookup/textured_rest.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam::inline v1 {
namespace {

constexpr float kLeastChance = 0.05f;  // of either technique of a dense table

// By how much the rest falls with log cos(theta_i), where most of it leaves.
float rest_exponent(const TexturedFrame& frame, float absorption) {
  constexpr float kCosine = 0.8f;
  const float m2 = frame.pigment_cosine_squared(kCosine);
  return 1.2f +
         frame.optical_depth * absorption * frame.below_scale * kCosine * kCosine / (m2 * std::sqrt(m2));
}

}  // namespace

// Where a direction lies among the nodes of L, and what its frame says of it.
struct TexturedEnd {
  TexturedEnd(const TexturedRest& rest, const TexturedMaterial& material, const TexturedPlace& place,
              const TexturedFrame& frame, float cosine, float root)
      : roots(sqrt4(Color4{material.path_squared(cosine), frame.pigment_cosine_squared(cosine),
                           material.film_cosine_squared(cosine), 1})),
        at(rest.direction(place, roots[0], root)),
        per_pigment_cosine(1 / roots[1]),
        passing(TexturedMaterial::passing(roots[2])) {}

  Color4 roots;
  TexturedRest::Direction at;
  float per_pigment_cosine;  // 1 / m~
  float passing;             // of a rough film
};

struct TexturedData {
  TexturedData(const Table& table, Arithmetic arithmetic)
      : material(table.material),
        frame(table.material),
        facets(table.material.roughness),
        smooth(table.material.is_smooth()) {
    if (table.is_factored()) {
      rest.emplace(table, arithmetic);
    } else {
      dense.emplace(table);
      albedos.emplace(table);
    }
    kind = !rest ? Kind::dense : rest->is_plain() ? Kind::plain : Kind::general;
  }

  const EvenAxis& axis(std::size_t k) const { return kind == Kind::dense ? albedos->axis(k) : rest->axis(k); }
  // Of the pigment relative to the parameter, as far as the rest decays with it.
  float mean_absorption() const {
    if (kind != Kind::dense) return rest->media().absorption[3];
    return material.scatters() || material.has_multiple_facets() ? 0 : 1;
  }

  // B B over T T; one exponential serves both.
  Color4 rest_factor(const TexturedPlace& place, const TexturedFrame& at, const TexturedEnd& o,
                     const TexturedEnd& i) const {
    const float paths = o.per_pigment_cosine + i.per_pigment_cosine;
    return exp4(rest->at(place, o.at) + rest->at(place, i.at) -
                (at.optical_depth * paths) * rest->media().absorption);
  }

  // The same for an anisotropic film or path "product", times its bracket.
  SUNBEAM_NOINLINE Color4 general_factor(const Parameters& parameters, const TexturedPlace& place,
                                         const TexturedFrame& at, const TexturedEnd& o, const TexturedEnd& i,
                                         const Vec3& wo, const Vec3& wi) const {
    const TexturedRest::PairEnd end_o{std::sqrt(static_cast<float>(wo.z)), quadrant(wo)},
        end_i{std::sqrt(static_cast<float>(wi.z)), quadrant(wi)};
    const float paths = o.per_pigment_cosine + i.per_pigment_cosine;
    const Color4 factor = exp4(rest->at(place, o.at, end_o.phi) + rest->at(place, i.at, end_i.phi) -
                               (at.optical_depth * paths) * rest->media().absorption);
    if (!rest->is_product()) return factor;
    const float beyond_o = 1 / at.cosine_below(static_cast<float>(wo.z)) - 1,
                beyond_i = 1 / at.cosine_below(static_cast<float>(wi.z)) - 1;
    const Color4 one_visit = exp4((at.optical_depth * (1 - beyond_o * beyond_i)) * rest->media().absorption);
    return factor * (one_visit + rest->exchange(parameters, end_o, end_i));
  }

  // The azimuth folded into a quadrant, over pi/2; of no matter for an isotropic film.
  float quadrant(const Vec3& w) const {
    if (facets.u2 == facets.v2) return 0;
    return static_cast<float>(std::atan2(std::abs(w.y), std::abs(w.x)) * (2 / kPi));
  }

  // Factored, isotropic and of path "sum"; any other factored one; dense.
  enum class Kind { plain, general, dense } kind;
  Material material;
  std::optional<TexturedRest> rest;  // of a factored table
  std::optional<DenseRest> dense;    // or of a dense one
  std::optional<DenseAlbedos> albedos;
  TexturedMaterial frame;
  Facets facets;
  bool smooth;
};

// What a viewer decides; L is on its way.
struct TexturedViewer {
  TexturedViewer(const TexturedData& data, const TexturedPlace& place, const TexturedFrame& frame,
                 const Vec3& wo)
      : facets(data.facets, wo), end(*data.rest, data.frame, place, frame, facets.cosine, facets.root) {
    data.rest->prefetch(place, end.at);
    first_chance = data.rest->first_chance(place, end.at);
  }
  FacetViewer facets;
  TexturedEnd end;
  float first_chance;
};

// The same of a table with azimuths or path "product".
struct TexturedGeneralViewer : TexturedViewer {
  using TexturedViewer::TexturedViewer;
};

// And of a dense one.
struct TexturedDenseViewer {
  TexturedDenseViewer(const TexturedData& data, const Parameters& at, const Vec3& wo)
      : facets(data.facets, wo), rest_albedo(data.albedos->at(at, std::min(facets.root, 1.0f))) {
    const float cosine = std::min(std::sqrt(data.frame.film_cosine_squared(facets.cosine)), 1.0f);
    first_albedo = std::max(0.0f, static_cast<float>(mean(data.dense->reflectance().at(at, double{cosine}))));
    const float share = first_albedo / std::max(first_albedo + rest_albedo, 1e-9f);
    first_chance = std::clamp(share, kLeastChance, 1 - kLeastChance);
  }
  FacetViewer facets;
  float rest_albedo, first_albedo, first_chance;
};

TexturedTable::TexturedTable(const Table& table, Arithmetic arithmetic)
    : data_(std::make_shared<TexturedData>(table, arithmetic)) {}

std::size_t TexturedTable::bytes() const {
  return data_->rest ? data_->rest->bytes() : data_->dense->bytes() + data_->albedos->bytes();
}

TexturedTable::At TexturedTable::at(const Parameters& p) const noexcept {
  const TexturedData& data = *data_;
  return {data,
          {data.axis(0).clamped(p.film_thickness_nm), data.axis(1).clamped(p.base_ior),
           data.axis(2).clamped(p.absorption_per_nm)}};
}

TexturedTable::At TexturedTable::at(const Parameters& parameters, OutsideGrid outside) const {
  for (std::size_t k = 0; k < kParameterNames.size() && outside == OutsideGrid::refuse; ++k) {
    const EvenAxis& axis = data_->axis(k);
    const double value = parameters.values()[k];
    if (axis.clamped(value) != value)
      throw Error("key '" + std::string(kParameterNames[k]) + "': found " + to_text(value) +
                  "; the table holds " + to_text(axis.low()) + " to " + to_text(axis.high()));
  }
  return at(parameters);
}

using Kind = TexturedData::Kind;

TexturedTable::At::At(const TexturedData& data, const Parameters& parameters)
    : data_(&data),
      parameters_(parameters),
      place_(data.kind == Kind::dense ? TexturedPlace{} : data.rest->place(parameters)),
      frame_(data.frame, parameters.base_ior, parameters.absorption_per_nm * data.frame.pigment_thickness_nm),
      rest_density_(rest_exponent(frame_, data.mean_absorption())) {}

// Reflectances of the film at up to three cosines, at the price of little more than one.
inline void TexturedTable::At::fold(std::span<const float> cosines, FloatRgb* reflectance) const {
  data_->rest->media().film.fold(parameters_.film_thickness_nm, parameters_.base_ior, cosines, reflectance);
}

Rgb TexturedTable::At::dirac(const Vec3& wo) const {
  if (!data_->smooth || wo.z <= 0) return {};
  if (data_->kind == Kind::dense) return data_->dense->reflectance().at(parameters_, std::min(wo.z, 1.0));
  const auto cosine = static_cast<float>(wo.z);
  FloatRgb r;
  fold({&cosine, 1}, &r);
  return {r.r, r.g, r.b};
}

double TexturedTable::At::albedo(const Vec3& wo) const {
  if (wo.z <= 0) return 0;
  if (data_->kind == Kind::dense) {
    const TexturedDenseViewer viewer(*data_, parameters_, wo);
    return double{viewer.first_albedo + viewer.rest_albedo};
  }
  const TexturedViewer viewer(*data_, place_, frame_, wo);
  const float cosine = std::sqrt(data_->frame.film_cosine_squared(viewer.facets.cosine));
  FloatRgb r;
  fold({&cosine, 1}, &r);
  return double{r.r + r.g + r.b} / 3 / double{data_->rest->at(place_, viewer.end.at)[3]};
}

template <class Viewer>
SUNBEAM_ALWAYS_INLINE EvalPdf TexturedTable::At::factored_eval_pdf(const Viewer& viewer, const Vec3& wo,
                                                                   const Vec3& wi) const {
  const TexturedData& data = *data_;
  const FacetPair pair(data.facets, viewer.facets, wo, wi);
  const TexturedRest& nodes = *data.rest;
  const TexturedEnd i(nodes, data.frame, place_, frame_, pair.cosine, pair.root);
  nodes.prefetch(place_, i.at);
  FloatRgb film[2];
  if (data.smooth) {
    const float cosines[] = {viewer.facets.cosine, pair.cosine};
    fold(cosines, film);
  } else {
    const float half_cosine = std::min(pair.half_cosine, 1.0f);
    fold({&half_cosine, 1}, film);
  }

  Color4 rest;
  if constexpr (std::is_same_v<Viewer, TexturedViewer>)
    rest = data.rest_factor(place_, frame_, viewer.end, i);
  else
    rest = data.general_factor(parameters_, place_, frame_, viewer.end, i, wo, wi);
  const float chance = viewer.first_chance, rest_pdf = (1 - chance) * rest_density_.pdf(pair.cosine);
  if (data.smooth)
    return {to_rgb(nodes.media().passing(film[0]) * nodes.media().passing(film[1]) * rest), double{rest_pdf}};
  const float passing = viewer.end.passing * i.passing;
  const Color4 reflectance{film[0].r, film[0].g, film[0].b, 0};
  return {to_rgb(passing * rest + pair.lobe * reflectance), double{rest_pdf + chance * pair.pdf}};
}

inline EvalPdf TexturedTable::At::eval_pdf(const TexturedViewer& viewer, const Vec3& wo,
                                           const Vec3& wi) const {
  return factored_eval_pdf(viewer, wo, wi);
}

EvalPdf TexturedTable::At::eval_pdf(const TexturedGeneralViewer& viewer, const Vec3& wo,
                                    const Vec3& wi) const {
  return factored_eval_pdf(viewer, wo, wi);
}

EvalPdf TexturedTable::At::eval_pdf(const TexturedDenseViewer& viewer, const Vec3& wo, const Vec3& wi) const {
  const FacetPair pair(data_->facets, viewer.facets, wo, wi);
  const Rgb rest = data_->dense->rest(parameters_, wo, wi);
  const float chance = viewer.first_chance, rest_pdf = (1 - chance) * rest_density_.pdf(pair.cosine);
  if (data_->smooth) return {rest, double{rest_pdf}};
  const Rgb film = data_->dense->reflectance().at(parameters_, std::min(double{pair.half_cosine}, 1.0));
  return {rest + double{pair.lobe} * film, double{rest_pdf + chance * pair.pdf}};
}

template <class Viewer>
inline std::optional<BsdfSample> TexturedTable::At::sample_for(const Viewer& viewer, const Vec3& wo,
                                                               Rng& rng) const {
  const TexturedData& data = *data_;
  const double chance{viewer.first_chance};
  Vec3 wi;
  if (rng.uniform() < chance) {
    if (data.smooth) return BsdfSample{{-wo.x, -wo.y, wo.z}, dirac(wo) / chance, true, 0};
    const FloatTurn turn(rng);
    wi = viewer.facets.mirrored(data.facets, wo, turn, uniform_float(rng));
  } else {
    wi = at_random_azimuth(rest_density_.sample(rng), rng);
  }
  if (wi.z <= 0) return {};
  const EvalPdf at = eval_pdf(viewer, wo, wi);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false, at.pdf};
}

// What `call` makes of the viewer, of the kind that the table needs.
template <class Call>
SUNBEAM_ALWAYS_INLINE auto TexturedTable::At::for_viewer(const Vec3& wo, Call call) const {
  if (data_->kind == Kind::plain) return call(TexturedViewer(*data_, place_, frame_, wo));
  if (data_->kind == Kind::general) return call(TexturedGeneralViewer(*data_, place_, frame_, wo));
  return call(TexturedDenseViewer(*data_, parameters_, wo));
}

EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return for_viewer(wo, [&](const auto& viewer) { return eval_pdf(viewer, wo, wi); });
}

std::optional<BsdfSample> TexturedTable::At::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  return for_viewer(wo, [&](const auto& viewer) { return sample_for(viewer, wo, rng); });
}

EvalAndSample TexturedTable::At::eval_and_sample(const Vec3& wo, const Vec3& wi, Rng& rng) const {
  if (wo.z <= 0) return {};
  if (wi.z <= 0) return {{}, sample(wo, rng)};
  return for_viewer(wo, [&](const auto& viewer) {
    return EvalAndSample{eval_pdf(viewer, wo, wi), sample_for(viewer, wo, rng)};
  });
}

}  // namespace sunbeam::inline v1
