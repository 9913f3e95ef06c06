#include "sunbeam/textured_table.h"

#include <cmath>

#include "facets.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"
#include "textured_rest.h"

namespace sunbeam {
namespace {

const Table& supported(const Table& table) {
  const auto refuse = [](const std::string& what) { throw Error("textured parameters: " + what); };
  if (!table.is_factored()) refuse("found a dense table; allowed: factored");
  if (table.symmetry != Symmetry::isotropic) refuse("found an anisotropic film; allowed: isotropic");
  if (table.material.absorption_path != AbsorptionPath::sum)
    refuse("found absorption_path product; allowed: sum");
  return table;
}

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
  explicit TexturedData(const Table& table)
      : material(supported(table).material),
        rest(table),
        frame(table.material),
        facets(table.material.roughness),
        smooth(table.material.is_smooth()) {}

  // B B over T T; one exponential serves both.
  Color4 rest_factor(const TexturedPlace& place, const TexturedFrame& at, const TexturedEnd& o,
                     const TexturedEnd& i) const {
    const float paths = o.per_pigment_cosine + i.per_pigment_cosine;
    return exp4(rest.at(place, o.at) + rest.at(place, i.at) - (at.optical_depth * paths) * rest.absorption());
  }

  Material material;
  TexturedRest rest;
  TexturedMaterial frame;
  Facets facets;
  bool smooth;
};

// What a viewer decides; L is on its way.
struct TexturedViewer {
  TexturedViewer(const TexturedData& data, const TexturedPlace& place, const TexturedFrame& frame,
                 const Vec3& wo)
      : facets(data.facets, wo), end(data.rest, data.frame, place, frame, facets.cosine, facets.root) {
    data.rest.prefetch(place, end.at);
    first_chance = data.rest.first_chance(place, end.at);
  }
  FacetViewer facets;
  TexturedEnd end;
  float first_chance;
};

TexturedTable::TexturedTable(const Table& table) : data_(std::make_shared<TexturedData>(table)) {}

std::size_t TexturedTable::bytes() const { return data_->rest.bytes(); }

TexturedTable::At TexturedTable::at(const Parameters& p) const noexcept {
  const TexturedRest& rest = data_->rest;
  return {*data_,
          {rest.axis(0).clamped(p.film_thickness_nm), rest.axis(1).clamped(p.base_ior),
           rest.axis(2).clamped(p.absorption_per_nm)}};
}

TexturedTable::At TexturedTable::at(const Parameters& parameters, OutsideGrid outside) const {
  for (std::size_t k = 0; k < kParameterNames.size() && outside == OutsideGrid::refuse; ++k) {
    const EvenAxis& axis = data_->rest.axis(k);
    const double value = parameters.values()[k];
    if (axis.clamped(value) != value)
      throw Error("key '" + std::string(kParameterNames[k]) + "': found " + to_text(value) +
                  "; the table holds " + to_text(axis.low()) + " to " + to_text(axis.high()));
  }
  return at(parameters);
}

TexturedTable::At::At(const TexturedData& data, const Parameters& parameters)
    : data_(&data),
      parameters_(parameters),
      place_(data.rest.place(parameters)),
      frame_(data.frame, parameters.base_ior, parameters.absorption_per_nm * data.frame.pigment_thickness_nm),
      rest_density_(rest_exponent(frame_, data.rest.absorption()[3])) {}

// Reflectances of the film at up to three cosines, at the price of little more than one.
inline void TexturedTable::At::fold(std::span<const float> cosines, FloatRgb* reflectance) const {
  data_->rest.film().fold(parameters_.film_thickness_nm, parameters_.base_ior, cosines, reflectance);
}

Rgb TexturedTable::At::dirac(const Vec3& wo) const {
  if (!data_->smooth || wo.z <= 0) return {};
  const auto cosine = static_cast<float>(wo.z);
  FloatRgb r;
  fold({&cosine, 1}, &r);
  return {r.r, r.g, r.b};
}

double TexturedTable::At::albedo(const Vec3& wo) const {
  if (wo.z <= 0) return 0;
  const TexturedViewer viewer(*data_, place_, frame_, wo);
  const float cosine = std::sqrt(data_->frame.film_cosine_squared(viewer.facets.cosine));
  FloatRgb r;
  fold({&cosine, 1}, &r);
  return double{r.r + r.g + r.b} / 3 / double{data_->rest.at(place_, viewer.end.at)[3]};
}

inline EvalPdf TexturedTable::At::eval_pdf(const TexturedViewer& viewer, const Vec3& wo,
                                           const Vec3& wi) const {
  const TexturedData& data = *data_;
  const FacetPair pair(data.facets, viewer.facets, wo, wi);
  const TexturedEnd i(data.rest, data.frame, place_, frame_, pair.cosine, pair.root);
  data.rest.prefetch(place_, i.at);
  FloatRgb film[2];
  if (data.smooth) {
    const float cosines[] = {viewer.facets.cosine, pair.cosine};
    fold(cosines, film);
  } else {
    const float half_cosine = std::min(pair.half_cosine, 1.0f);
    fold({&half_cosine, 1}, film);
  }

  const Color4 rest = data.rest_factor(place_, frame_, viewer.end, i);
  const float chance = viewer.first_chance, rest_pdf = (1 - chance) * rest_density_.pdf(pair.cosine);
  if (data.smooth)
    return {to_rgb(data.rest.passing(film[0]) * data.rest.passing(film[1]) * rest), double{rest_pdf}};
  const float passing = viewer.end.passing * i.passing;
  const Color4 reflectance{film[0].r, film[0].g, film[0].b, 0};
  return {to_rgb(passing * rest + pair.lobe * reflectance), double{rest_pdf + chance * pair.pdf}};
}

EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return eval_pdf(TexturedViewer(*data_, place_, frame_, wo), wo, wi);
}

std::optional<BsdfSample> TexturedTable::At::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const TexturedData& data = *data_;
  const TexturedViewer viewer(data, place_, frame_, wo);
  const double chance{viewer.first_chance};
  Vec3 wi;
  if (rng.uniform() < chance) {
    if (data.smooth) return BsdfSample{{-wo.x, -wo.y, wo.z}, dirac(wo) / chance, true, 0};
    const float turn = uniform_float(rng);
    wi = viewer.facets.mirrored(data.facets, wo, turn, uniform_float(rng));
  } else {
    wi = at_random_azimuth(rest_density_.sample(rng), rng);
  }
  if (wi.z <= 0) return {};
  const EvalPdf at = eval_pdf(viewer, wo, wi);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false, at.pdf};
}

}  // namespace sunbeam
