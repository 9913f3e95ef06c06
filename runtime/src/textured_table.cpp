#include "sunbeam/textured_table.h"

#include <cmath>

#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"
#include "sunbeam/ggx.h"
#include "textured_rest.h"

namespace sunbeam {
namespace {

constexpr float kLeastChance = 0.02f;  // of either technique: their estimates may be far off

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
};

struct TexturedData {
  explicit TexturedData(const Table& table)
      : material(table.material),
        rest(supported(table)),
        normals(table.material.roughness),
        smooth(table.material.is_smooth()),
        alpha2(static_cast<float>(square(table.material.roughness.u))) {}

  // B; the last lane is the albedo of the rest.
  Color4 rest_factor(const TexturedPlace& place, const TexturedFrame& frame, const TexturedEnd& end,
                     const FloatRgb& reflectance) const {
    const Color4 exponent = rest.at(place, end.root) - (frame.optical_depth * end.path) * rest.absorption();
    return rest.passing(reflectance) * exp4(exponent);
  }

  // Of sampling the first surface.
  float first_chance(const FloatRgb& reflectance, const Color4& rest_factor) const {
    const float of_first = std::max(0.0f, (reflectance.r + reflectance.g + reflectance.b) * (1.0f / 3));
    return std::min(std::max(of_first / (of_first + rest_factor[3]), kLeastChance), 1 - kLeastChance);
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
  return double{r.r + r.g + r.b} / 3 + double{data_->rest_factor(place_, frame_, o, r)[3]};
}

// The viewer's own part of a path.
struct TexturedTable::At::Viewer {
  TexturedEnd end;
  FloatRgb reflectance;
  Color4 factor;
  float chance;  // of sampling the first surface
};

// The film at the two cosines that depend on wi.
inline EvalPdf TexturedTable::At::finish(const Vec3& wo, const Viewer& o, const TexturedEnd& i, const Vec3& h,
                                         float l2, const FloatRgb* film) const {
  const TexturedData& data = *data_;
  const Color4 rest = o.factor * data.rest_factor(place_, frame_, i, film[0]);
  const float rest_pdf = (1 - o.chance) * rest_density_.pdf(i.cosine);
  if (data.smooth) return {to_rgb(rest), double{rest_pdf}};
  const auto lobe = data.first_lobe(wo, o.end, i, h, l2);
  const Color4 reflectance{film[1].r, film[1].g, film[1].b, 0};
  return {to_rgb(rest + lobe.value * reflectance), double{rest_pdf + o.chance * lobe.pdf}};
}

inline TexturedTable::At::Viewer TexturedTable::At::viewer(const TexturedEnd& o, const FloatRgb& film) const {
  const Color4 factor = data_->rest_factor(place_, frame_, o, film);
  return {o, film, factor, data_->first_chance(film, factor)};
}

EvalPdf TexturedTable::At::eval_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const TexturedEnd o(frame_, data_->alpha2, wo), i(frame_, data_->alpha2, wi);
  data_->rest.prefetch(place_, o.root);
  data_->rest.prefetch(place_, i.root);
  const Vec3 h = wo + wi;
  const auto l2 = static_cast<float>(dot(h, h));
  const float cosines[] = {o.film_cosine, i.film_cosine, std::min(0.5f * std::sqrt(l2), 1.0f)};
  FloatRgb film[3];
  fold({cosines, data_->smooth ? 2u : 3u}, film);
  return finish(wo, viewer(o, film[0]), i, h, l2, film + 1);
}

std::optional<BsdfSample> TexturedTable::At::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const TexturedData& data = *data_;
  const TexturedEnd end(frame_, data.alpha2, wo);
  data.rest.prefetch(place_, end.root);
  FloatRgb film[2];
  fold({&end.film_cosine, 1}, film);
  const Viewer o = viewer(end, film[0]);
  Vec3 wi;
  if (rng.uniform() < double{o.chance}) {
    const Rgb mirrored(o.reflectance.r, o.reflectance.g, o.reflectance.b);
    if (data.smooth) return BsdfSample{{-wo.x, -wo.y, wo.z}, mirrored / double{o.chance}, true};
    const double u = rng.uniform();
    wi = data.normals.sample_mirrored(wo, {u, rng.uniform()});
  } else {
    const double cosine = rest_density_.sample(rng), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Turn phi(rng.uniform());
    wi = {sine * phi.cosine, sine * phi.sine, cosine};
  }
  if (wi.z <= 0) return {};
  const TexturedEnd i(frame_, data.alpha2, wi);
  data.rest.prefetch(place_, i.root);
  const Vec3 h = wo + wi;
  const auto l2 = static_cast<float>(dot(h, h));
  const float cosines[] = {i.film_cosine, std::min(0.5f * std::sqrt(l2), 1.0f)};
  fold({cosines, data.smooth ? 1u : 2u}, film);
  const EvalPdf at = finish(wo, o, i, h, l2, film);
  if (at.pdf <= 0) return {};
  return BsdfSample{wi, at.f * (wi.z / at.pdf), false};
}

}  // namespace sunbeam
