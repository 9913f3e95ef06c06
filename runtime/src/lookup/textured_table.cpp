#include "sunbeam/textured_table.h"

#include "runtime/src/lookup/textured_lookup.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

// By how much the rest falls with log cos(theta_i), where most of it leaves.
float rest_exponent(const PigmentCosines& pigment, float absorption) {
  constexpr float kCosine = 0.8f;
  const float m2 = pigment.pigment_cosine_squared(kCosine);
  return 1.2f +
         pigment.optical_depth * absorption * pigment.below_scale * kCosine * kCosine / (m2 * std::sqrt(m2));
}

}  // namespace

TexturedTable::TexturedTable(const Table& table, const BindOptions& options)
    : data_(std::make_shared<TexturedData>(table, options)) {}

std::size_t TexturedTable::bytes() const { return data_->bytes(); }

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

TexturedTable::At::At(const TexturedData& data, const Parameters& parameters)
    : data_(&data),
      parameters_(parameters),
      taps_(data.has_logs() ? data.rest->parameter_taps(parameters) : ParameterTaps{}),
      pigment_(data.film, parameters.base_ior, parameters.absorption_per_nm * data.film.pigment_thickness_nm),
      rest_density_(rest_exponent(pigment_, data.mean_absorption())) {}

// What `call` makes of the look-up that the table needs, and of the viewer.
template <class Call>
SUNBEAM_ALWAYS_INLINE auto TexturedTable::At::with_lookup(const Vec3& wo, Call call) const {
  const auto with = [&]<class Lookup>(const Lookup& lookup) {
    return call(lookup, typename Lookup::Viewer(lookup, wo));
  };
  if (data_->kind == TexturedKind::plain) return with(TexturedLookup<TexturedKind::plain>(*this));
  if (data_->kind == TexturedKind::general) return with(TexturedLookup<TexturedKind::general>(*this));
  if (data_->kind == TexturedKind::layered) return with(TexturedLookup<TexturedKind::layered>(*this));
  return with(TexturedLookup<TexturedKind::dense>(*this));
}

Rgb TexturedTable::At::dirac(const Vec3& wo) const {
  if (!data_->smooth || wo.z <= 0) return {};
  return data_->colors(
      with_lookup(wo, [&](const auto& lookup, const auto&) { return lookup.mirror_reflectance(wo); }));
}

double TexturedTable::At::albedo(const Vec3& wo) const {
  if (wo.z <= 0) return 0;
  return with_lookup(wo, [&](const auto& lookup, const auto& viewer) { return lookup.albedo(viewer); });
}

template <class Lookup, class Viewer>
SUNBEAM_ALWAYS_INLINE EvalPdf TexturedTable::At::eval_pdf_for(const Lookup& lookup, const Viewer& viewer,
                                                              const Vec3& wo, const Vec3& wi) const {
  const EvalPdf at = lookup.eval_pdf(viewer, wo, wi);
  return {data_->colors(at.f), at.pdf};
}

// A direction of the first surface, whose mirror direction is a Dirac of a smooth film, or of the rest.
template <class Lookup, class Viewer>
inline std::optional<BsdfSample> TexturedTable::At::sample_for(const Lookup& lookup, const Viewer& viewer,
                                                               const Vec3& wo, const Random3& u) const {
  const double chance{viewer.first_chance};
  Vec3 wi;
  if (u[0] < chance) {
    if (data_->smooth) {
      const Rgb weight = data_->colors(lookup.mirror_reflectance(wo)) / chance;
      return BsdfSample{{-wo.x, -wo.y, wo.z}, weight, true, 0};
    }
    wi = viewer.facets.mirrored(data_->facets, wo, FloatTurn(u[1]), static_cast<float>(u[2]));
  } else {
    wi = at_azimuth(rest_density_.sample(u[1]), FloatTurn(u[2]));
  }
  if (wi.z <= 0) return {};
  const EvalPdf at = eval_pdf_for(lookup, viewer, wo, wi);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false, at.pdf};
}

EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return with_lookup(
      wo, [&](const auto& lookup, const auto& viewer) { return eval_pdf_for(lookup, viewer, wo, wi); });
}

std::optional<BsdfSample> TexturedTable::At::sample(const Vec3& wo, const Random3& u) const {
  if (wo.z <= 0) return {};
  return with_lookup(
      wo, [&](const auto& lookup, const auto& viewer) { return sample_for(lookup, viewer, wo, u); });
}

EvalAndSample TexturedTable::At::eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u) const {
  if (wo.z <= 0) return {};
  if (wi.z <= 0) return {{}, sample(wo, u)};
  return with_lookup(wo, [&](const auto& lookup, const auto& viewer) {
    return EvalAndSample{eval_pdf_for(lookup, viewer, wo, wi), sample_for(lookup, viewer, wo, u)};
  });
}

}  // namespace v1
}  // namespace sunbeam
