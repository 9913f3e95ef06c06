#include "sunbeam/table_bsdf.h"

#include <cmath>

#include "runtime/src/base/attempt.h"
#include "runtime/src/lookup/bound_table.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

Parameters checked(const Table& table, const Parameters& parameters, OutsideGrid outside) {
  auto values = parameters.values();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Axis& axis = table.parameter_axis(k);
    const double inside = std::clamp(values[k], axis.low(), axis.high());
    if (std::isnan(values[k]) || (inside != values[k] && outside == OutsideGrid::refuse))
      throw Error("key '" + axis.name + "': found " + to_text(values[k]) + "; the table holds " +
                  to_text(axis.low()) + " to " + to_text(axis.high()));
    values[k] = inside;
  }
  return {values[0], values[1], values[2]};
}

}  // namespace

TableBsdf::TableBsdf(const Table& table, const Parameters& parameters, const BindOptions& options)
    : bound_(std::make_shared<BoundTable>(
          table, checked(table, parameters, options.outside).applied_to(table.material), options)) {}

TableBsdf Table::bind(const Parameters& parameters, const BindOptions& options) const {
  return TableBsdf(*this, parameters, options);
}

Result<TableBsdf> try_bind(const Table& table, const Parameters& parameters, const BindOptions& options) {
  return attempt([&] { return TableBsdf(table, parameters, options); });
}

std::size_t TableBsdf::bytes() const { return bound_->bytes(); }

const Material& TableBsdf::material() const { return bound_->material(); }

Rgb TableBsdf::film_reflectance(double cosine) const { return bound_->film_reflectance(cosine); }

Rgb TableBsdf::dirac(const Vec3& wo) const {
  return bound_->is_smooth() && wo.z > 0 ? bound_->dirac(wo.z) : Rgb();
}

double TableBsdf::dirac_chance(const Vec3& wo) const {
  return bound_->is_smooth() && wo.z > 0 ? bound_->first_chance(wo) : 0;
}

void TableBsdf::eval(const Vec3& wo, std::span<const Vec3> wi, std::span<Rgb> f) const {
  if (wo.z > 0) return bound_->eval(wo, wi, f);
  std::fill_n(f.begin(), wi.size(), Rgb());
}

Rgb TableBsdf::first(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return to_rgb(bound_->parts(wo, wi).first);
}

Rgb TableBsdf::rest(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return bound_->rest(wo, wi);
}

Rgb TableBsdf::rest_stderr(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return bound_->rest_stderr(wo, wi);
}

Rgb TableBsdf::albedo(const Vec3& wo) const { return bound_->albedo(wo); }

EvalPdf TableBsdf::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return bound_->eval_pdf(wo, wi);
}

EvalAndSample TableBsdf::eval_and_sample(const Vec3& wo, const Vec3& wi, const Random3& u) const {
  if (wo.z <= 0) return {};
  if (wi.z <= 0) return {{}, bound_->sample(wo, u)};
  return bound_->eval_and_sample(wo, wi, u);
}

std::optional<BsdfSample> TableBsdf::sample(const Vec3& wo, const Random3& u) const {
  if (wo.z <= 0) return {};
  return bound_->sample(wo, u);
}

}  // namespace v1
}  // namespace sunbeam
