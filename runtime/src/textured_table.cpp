#include "sunbeam/textured_table.h"

#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"
#include "sunbeam/ggx.h"
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

// What a direction brings with it, all roots and the division at once.
struct TexturedEnd {
  TexturedEnd(const TexturedFrame& frame, float alpha2, const Vec3& w) : cosine(static_cast<float>(w.z)) {
    const float c2 = cosine * cosine;
    const Color4 roots =
        sqrt4(Color4{cosine, frame.film_cosine_squared(cosine), frame.pigment_cosine_squared(cosine),
                     c2 + alpha2 * std::max(0.0f, 1 - c2)});
    root = roots[0];
    film_cosine = std::min(roots[1], 1.0f);
    path = 1 / roots[2];
    ggx_root = roots[3];
  }
  float cosine, root;
  float film_cosine;  // c~
  float path;         // 1 / m~
  float ggx_root;     // cosine (1 + 2 Lambda)
  Color4 l{};         // L, where it has been asked for
};

struct TexturedData {
  explicit TexturedData(const Table& table)
      : material(table.material),
        rest(supported(table)),
        normals(table.material.roughness),
        smooth(table.material.is_smooth()),
        alpha2(static_cast<float>(square(table.material.roughness.u))) {}

  // B from L.
  Color4 rest_factor(const Color4& l, const TexturedFrame& frame, const TexturedEnd& end,
                     const FloatRgb& reflectance) const {
    return rest.passing(reflectance) * exp4(l - (frame.optical_depth * end.path) * rest.absorption());
  }

  struct Lobe {
    float value, pdf;
  };
  Lobe first_lobe(const Vec3& wo, const TexturedEnd& o, const TexturedEnd& i, const Vec3& h, float l2) const;

  Material material;
  TexturedRest rest;
  Ggx normals;
  bool smooth;
  float alpha2;
};

// The lobe of ggx.h without its reflectance, and its bounded density, with h = wo + wi not normalised: with
// l = |h|, a the roughness, q = a^2 h.z^2 + h.x^2 + h.y^2, r = cosine (1 + 2 Lambda), s = 1 + sin_o,
//     D = a^2 l^4 / (pi q^2),  value = D / (2 (r_o c_i + r_i c_o)),
//     pdf = D / (2 (k c_o + r_o)),  k = (1 - a^2) s^2 / (s^2 + a^2 c_o^2).
inline TexturedData::Lobe TexturedData::first_lobe(const Vec3& wo, const TexturedEnd& o, const TexturedEnd& i,
                                                   const Vec3& h, float l2) const {
  const auto x = static_cast<float>(h.x), y = static_cast<float>(h.y), z = static_cast<float>(h.z);
  const float q = alpha2 * z * z + x * x + y * y;
  const auto sine2 = static_cast<float>(wo.x * wo.x + wo.y * wo.y);
  const float s = 1 + std::sqrt(sine2), s2 = s * s, bound = s2 + alpha2 * o.cosine * o.cosine;
  const Color4 per = Color4{1, 1, 1, 1} / Color4{q, 2 * (o.ggx_root * i.cosine + i.ggx_root * o.cosine),
                                                 2 * ((1 - alpha2) * s2 * o.cosine + bound * o.ggx_root), 1};
  const float l2_per_q = l2 * per[0], d = alpha2 * static_cast<float>(kInvPi) * l2_per_q * l2_per_q;
  return {d * per[1], d * bound * per[2]};
}

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
      frame_(data.material, parameters.base_ior,
             parameters.absorption_per_nm * data.material.pigment_thickness_nm),
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
  const TexturedEnd o(frame_, data_->alpha2, wo);
  FloatRgb r;
  fold({&o.film_cosine, 1}, &r);
  return double{r.r + r.g + r.b} / 3 / double{data_->rest.at(place_, o.root)[3]};
}

// The viewer has its L.
inline EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const TexturedEnd& o, const Vec3& wi) const {
  const TexturedData& data = *data_;
  const TexturedEnd i(frame_, data.alpha2, wi);
  data.rest.prefetch(place_, i.root);
  const Vec3 h = wo + wi;
  const auto l2 = static_cast<float>(dot(h, h));
  const float cosines[] = {o.film_cosine, i.film_cosine, std::min(0.5f * std::sqrt(l2), 1.0f)};
  FloatRgb film[3];
  fold({cosines, data.smooth ? 2u : 3u}, film);

  const Color4 rest = data.rest_factor(o.l, frame_, o, film[0]) *
                      data.rest_factor(data.rest.at(place_, i.root), frame_, i, film[1]);
  const float chance = o.l[3], rest_pdf = (1 - chance) * rest_density_.pdf(i.cosine);
  if (data.smooth) return {to_rgb(rest), double{rest_pdf}};
  const auto lobe = data.first_lobe(wo, o, i, h, l2);
  const Color4 reflectance{film[2].r, film[2].g, film[2].b, 0};
  return {to_rgb(rest + lobe.value * reflectance), double{rest_pdf + chance * lobe.pdf}};
}

EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  TexturedEnd o(frame_, data_->alpha2, wo);
  o.l = data_->rest.at(place_, o.root);
  return eval_pdf(wo, o, wi);
}

std::optional<BsdfSample> TexturedTable::At::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const TexturedData& data = *data_;
  TexturedEnd o(frame_, data.alpha2, wo);
  o.l = data.rest.at(place_, o.root);
  Vec3 wi;
  if (const double chance{o.l[3]}; rng.uniform() < chance) {
    if (data.smooth) return BsdfSample{{-wo.x, -wo.y, wo.z}, dirac(wo) / chance, true};
    const double u = rng.uniform();
    wi = data.normals.sample_mirrored(wo, {u, rng.uniform()});
  } else {
    const double cosine = rest_density_.sample(rng), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Turn phi(rng.uniform());
    wi = {sine * phi.cosine, sine * phi.sine, cosine};
  }
  if (wi.z <= 0) return {};
  const EvalPdf at = eval_pdf(wo, o, wi);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false};
}

}  // namespace sunbeam
