#include "bake/live/exact/exact_bsdf.h"

#include <array>

#include "bake/live/film/visible_normals.h"
#include "runtime/src/base/vector_clones.h"
#include "sunbeam/detail/bracket.h"

namespace sunbeam {
namespace {

// The narrowest panels end the halving where quadrature errors, not the function, are left to resolve.
constexpr PanelCurve::Accuracy kReflectanceAccuracy{1e-6, 1e-8, 1e-9};
constexpr PanelCurve::Accuracy kSmoothAccuracy{1e-6, 1e-16, 1e-9};
constexpr PanelCurve::Accuracy kRoughAccuracy{2e-6, 1e-15, 1.0 / 32768};
// Powers of layered films come from curves themselves, whose steps are not to be resolved.
constexpr PanelCurve::Accuracy kLayeredAccuracy{1e-6, 1e-7, 1e-7};
constexpr PanelCurve::Accuracy kLayeredRoughAccuracy{1e-5, 1e-7, 1.0 / 4096};

constexpr std::size_t kChanceNodes = 65;
constexpr std::size_t kMarginalBins = 128;
constexpr int kNormalNodes = 16;          // quadrature over visible normals, each way, for the chances
constexpr double kSmallestCosine = 1e-4;  // the chance at grazing is taken here

}  // namespace

ExactBsdf::ExactBsdf(const Material& material, const Wavelengths& wavelengths)
    : film_(outline(material, wavelengths)),
      layered_(is_layered(material, wavelengths)),
      smooth_(material.is_smooth()),
      rarer_base_(film_.base_ior < film_.exterior_ior),
      critical_(critical_cosine(film_)),
      ggx_(material.roughness) {
  const ExactRest exact(material, wavelengths);
  const auto gain = exact.gain();
  for (std::size_t k = 0; k < gain.size(); ++k) weight_.push_back(gain[k] * wavelengths.weight[k]);
  for (int c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < gain.size(); ++k) fold_[c][k] = weight_[k][c];
  tabulate_reflectance(exact);
  tabulate_arriving(exact);
  prepare_sampling();
}

// The smaller of a direction's cosine and that of its refraction into the base, 0 under total reflection. The
// film's powers are analytic in it: the other cosine is a root of 1 + its square that does not vanish.
double ExactBsdf::film_coordinate(double cosine) const {
  if (!rarer_base_) return cosine;
  return std::sqrt(std::max(0.0, refracted_cosine_squared(film_.exterior_ior, film_.base_ior, cosine)));
}

double ExactBsdf::cosine_at(double coordinate) const {
  if (!rarer_base_) return coordinate;
  return std::sqrt(refracted_cosine_squared(film_.base_ior, film_.exterior_ior, coordinate));
}

void ExactBsdf::tabulate_reflectance(const ExactRest& exact) {
  const auto folded = [&](double cosine, std::span<double> rgb) {
    const Rgb sum = exact.wavelengths().fold(exact.facet_reflectance(cosine));
    for (int c = 0; c < 3; ++c) rgb[c] = sum[c];
  };
  reflectance_ = PanelCurve(
      3, [&](double x, std::span<double> rgb) { folded(cosine_at(x), rgb); },
      layered_ ? kLayeredAccuracy : kReflectanceAccuracy);
  if (!layered_ || critical_ == 0) return;
  total_ = PanelCurve(
      3, [&](double x, std::span<double> rgb) { folded(x * critical_, rgb); }, kLayeredAccuracy);
}

void ExactBsdf::tabulate_arriving(const ExactRest& exact) {
  const auto at = [&](double x, std::span<double> values) {
    const auto power = exact.arriving(direction_from_cosine(smooth_ ? cosine_at(x) : x, 0));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = is_divided() ? power[k] / x : power[k];
  };
  if (smooth_) {
    arriving_ = PanelCurve(weight_.size(), at, layered_ ? kLayeredAccuracy : kSmoothAccuracy);
    return;
  }
  // Where a smooth film would begin to pass light a rough one still does so within its roughness.
  std::vector<double> edges;
  for (const double ior : {film_.film_ior, film_.base_ior})
    if (ior < film_.exterior_ior) edges.push_back(std::sqrt(1 - square(ior / film_.exterior_ior)));
  arriving_ = PanelCurve(weight_.size(), at, layered_ ? kLayeredRoughAccuracy : kRoughAccuracy, edges);
}

Rgb ExactBsdf::reflectance(double cosine) const {
  std::array<double, 4> rgb;
  if (total_.panels() > 0 && cosine < critical_)
    total_.at(cosine / critical_, rgb.data());
  else
    reflectance_.at(film_coordinate(cosine), rgb.data());
  return {rgb[0], rgb[1], rgb[2]};
}

void ExactBsdf::arriving(double cosine, double* values) const {
  if (!smooth_) return arriving_.at(cosine, values);
  const double x = film_coordinate(cosine);
  arriving_.at(x, values);
  for (std::size_t k = 0; k < arriving_.lanes(); ++k)
    values[k] = is_divided() ? values[k] * x : x > 0 ? std::max(0.0, values[k]) : 0;
}

// Means over the channels are what directions are chosen by.
void ExactBsdf::prepare_sampling() {
  std::array<double, kMostWavelengths> a;
  std::vector<double> bins(kMarginalBins), strength(weight_.size());
  constexpr int kSubBins = 4;
  for (int pass = 0; pass < 2; ++pass)  // first the power each wavelength sends out, then where it goes
    for (std::size_t i = 0; i < kSubBins * kMarginalBins; ++i) {
      const double cos2 = (static_cast<double>(i) + 0.5) / (kSubBins * kMarginalBins);
      arriving(std::sqrt(cos2), a.data());
      for (std::size_t k = 0; k < weight_.size(); ++k) {
        if (pass == 0) strength[k] += std::abs(mean(weight_[k])) * a[k] * kPi / (kSubBins * kMarginalBins);
        if (pass == 1) bins[i / kSubBins] += strength[k] * a[k];
      }
    }
  rest_marginal_ = PiecewiseConstant(bins);
  for (std::size_t i = 0; i < kChanceNodes; ++i) {
    const double cosine = std::max(kSmallestCosine, static_cast<double>(i) / (kChanceNodes - 1));
    arriving(cosine, a.data());
    double rest = 0;
    for (std::size_t k = 0; k < weight_.size(); ++k) rest += strength[k] * a[k];
    const double first = std::max(0.0, first_albedo(direction_from_cosine(cosine, 0)));
    chance_.push_back(first + rest > 0 ? first / (first + rest) : 0.5);
  }
}

// Midpoints in the unit square of visible normals: a mean of R G2 / G1.
double ExactBsdf::first_albedo(const Vec3& wo) const {
  if (smooth_) return mean(reflectance(wo.z));
  double sum = 0;
  for (int i = 0; i < kNormalNodes; ++i)
    for (int j = 0; j < kNormalNodes; ++j) {
      const Vec3 h = ggx_.sample_visible(wo, {(i + 0.5) / kNormalNodes, (j + 0.5) / kNormalNodes});
      const Vec3 wi = reflect(wo, h);
      if (wi.z > 0) sum += mean(reflectance(dot(wo, h))) * ggx_.g2_over_g1(wo, wi);
    }
  return sum / square(kNormalNodes);
}

Rgb ExactBsdf::first(const Vec3& wo, const Vec3& wi) const {
  if (smooth_ || wo.z <= 0 || wi.z <= 0) return {};
  return first_at(wo, wi, normalize(wo + wi));
}

Rgb ExactBsdf::first_at(const Vec3& wo, const Vec3& wi, const Vec3& h) const {
  return smooth_ ? Rgb() : ggx_.reflection(wo, wi, h) * reflectance(dot(wo, h));
}

// sum_k weight_k a_k b_k, four partial sums a channel.
SUNBEAM_VECTOR_CLONES
Rgb ExactBsdf::fold(const double* a, const double* b) const {
  Rgb rgb;
  for (int c = 0; c < 3; ++c) {
    std::array<double, 4> sum{};
    for (std::size_t k = 0; k < arriving_.lanes(); k += 4)
      for (std::size_t j = 0; j < 4; ++j) sum[j] += a[k + j] * b[k + j] * fold_[c][k + j];
    rgb[c] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
  return rgb;
}

Rgb ExactBsdf::rest(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  std::array<double, kMostWavelengths> a, b;
  arriving(wo.z, a.data());
  arriving(wi.z, b.data());
  if (arriving_.lanes() == 1) return (a[0] * b[0]) * weight_[0];
  return fold(a.data(), b.data());
}

double ExactBsdf::first_chance(double cosine) const {
  const Bracket at = even_bracket(cosine, chance_.size());
  return lerp(at.upper_weight, chance_[at.lower], chance_[at.upper]);
}

std::optional<BsdfSample> ExactBsdf::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const double chance = first_chance(wo.z);
  Vec3 wi, h;
  if (rng.uniform() < chance) {
    if (smooth_) return BsdfSample{{-wo.x, -wo.y, wo.z}, reflectance(wo.z) / chance, true, 0};
    h = ggx_.sample_visible(wo, {rng.uniform(), rng.uniform()});
    wi = reflect(wo, h);
    if (wi.z <= 0) return {};
  } else {
    const double cosine = std::sqrt(rest_marginal_.sample(rng.uniform()));
    wi = direction_from_cosine(cosine, 2 * kPi * rng.uniform());
    if (!smooth_) h = normalize(wo + wi);
  }
  const double density = density_at(wo, wi, h);
  if (density <= 0) return {};
  return BsdfSample{wi, (first_at(wo, wi, h) + rest(wo, wi)) * (wi.z / density), false, density};
}

double ExactBsdf::mis_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  return density_at(wo, wi, smooth_ ? Vec3() : normalize(wo + wi));
}

double ExactBsdf::density_at(const Vec3& wo, const Vec3& wi, const Vec3& h) const {
  const double chance = first_chance(wo.z);
  const double rest = (1 - chance) * rest_pdf(wi.z);
  return smooth_ ? rest : rest + chance * ggx_.reflection_pdf(wo, h);
}

}  // namespace sunbeam
