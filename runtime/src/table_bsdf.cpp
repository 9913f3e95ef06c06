#include "sunbeam/table_bsdf.h"

#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"
#include "sunbeam/core/warp.h"

namespace sunbeam {
namespace {

constexpr std::size_t kCurveNodes = 129;
constexpr std::size_t kSamplingNodes = 33;  // over cos(theta_o)
constexpr std::size_t kMarginalBins = 32;   // over cos(theta_i)
constexpr int kViewerAzimuths = 4;          // of wo in a quadrant, which sampling data are averaged over
constexpr int kNormalNodes = 96;            // quadrature over visible normals, each way, for an albedo
constexpr int kSamplingNormalNodes = 16;    // the same for the chance of sampling the first surface
constexpr double kSmallestCosine = 1e-4;    // sampling data near grazing are taken here

Parameters checked(const Table& table, const Parameters& parameters, OutsideGrid outside) {
  auto values = parameters.values();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Axis& axis = table.parameter_axis(k);
    const double inside = std::clamp(values[k], axis.low(), axis.high());
    if (inside != values[k] && outside == OutsideGrid::refuse)
      throw Error("key '" + axis.name + "': found " + to_text(values[k]) + "; the table holds " +
                  to_text(axis.low()) + " to " + to_text(axis.high()));
    values[k] = inside;
  }
  return {values[0], values[1], values[2]};
}

// Shares of the interval between an axis' ends that belong to its nodes, for a function linear between them.
std::vector<double> trapezoid(const Axis& axis) {
  const std::size_t n = axis.size();
  if (n == 1) return {1};
  std::vector<double> weights(n);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double half = (axis.nodes[k + 1] - axis.nodes[k]) / (2 * (axis.high() - axis.low()));
    weights[k] += half;
    weights[k + 1] += half;
  }
  return weights;
}

template <class F>
CosineCurve sampled_curve(std::size_t nodes, F f) {
  std::vector<Rgb> values(nodes);
  for (std::size_t i = 0; i < nodes; ++i)
    values[i] = f(static_cast<double>(i) / static_cast<double>(nodes - 1));
  return CosineCurve(std::move(values));
}

}  // namespace

TableBsdf::TableBsdf(const Table& table, const Parameters& parameters, OutsideGrid outside)
    : material_(checked(table, parameters, outside).applied_to(table.material)),
      symmetry_(table.symmetry),
      frame_(material_, table.first_visit),
      ggx_(material_.roughness) {
  const auto point = Parameters::of(material_).values();
  remainder_ = table.remainder.slice(point);
  stderr_ = table.rest_stderr.slice(point);
  has_azimuth_ = remainder_.axes()[1].size() > 1 || remainder_.axes()[3].size() > 1;
  const auto film_at = [&](double c) { return std::array{point[0], point[1], c}; };
  reflectance_ =
      sampled_curve(kCurveNodes, [&](double c) { return table.film_reflectance.interpolate(film_at(c)); });
  transmittance_ = sampled_curve(kCurveNodes, [&](double c) { return table.transmittance(film_at(c)); });

  first_chance_ = sampled_curve(kSamplingNodes, [&](double c) { return Rgb(make_sampling_node(c)); });
}

// Appends the marginal of the rest for viewers at this cosine and returns the chance of the first surface;
// both are means over the viewer's azimuth.
double TableBsdf::make_sampling_node(double cos_o) {
  const int azimuths = symmetry_ == Symmetry::anisotropic ? kViewerAzimuths : 1;
  std::vector<double> marginal(kMarginalBins);
  Rgb rest, first;
  for (int a = 0; a < azimuths; ++a) {
    const double phi = azimuths == 1 ? 0 : kPi / 2 * (a + 0.5) / azimuths;
    const Vec3 wo = direction_from_cosine(std::max(cos_o, kSmallestCosine), phi);
    rest += rest_albedo(wo, &marginal) / azimuths;
    first += first_albedo(wo, kSamplingNormalNodes) / azimuths;
  }
  rest_marginals_.emplace_back(marginal);
  const double of_rest = std::max(0.0, mean(rest)), of_first = std::max(0.0, mean(first));
  return of_first + of_rest > 0 ? of_first / (of_first + of_rest) : 0.5;
}

Rgb TableBsdf::first(const Vec3& wo, const Vec3& wi) const {
  if (material_.is_smooth() || wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  return ggx_.reflection(wo, wi, h) * reflectance_(dot(wo, h));
}

std::array<double, 4> TableBsdf::coordinates(const Vec3& wo, const Vec3& wi) const {
  if (!has_azimuth_) return {wi.z, 0, wo.z, 0};
  const AngleCoordinates c = to_coordinates(symmetry_, {wo, wi});
  return {c.cos_i, c.phi_i, c.cos_o, c.phi_o};
}

Rgb TableBsdf::rest(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const Rgb remainder = remainder_.interpolate(coordinates(wo, wi));
  return frame_.decode(remainder, wi.z, wo.z, transmittance_(wi.z), transmittance_(wo.z));
}

Rgb TableBsdf::rest_stderr(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  return stderr_.interpolate(coordinates(wo, wi));
}

// Int f_first cos dwi by midpoints in the unit square of visible normals, which turns it into a mean of R
// G2/G1.
Rgb TableBsdf::albedo(const Vec3& wo) const {
  return first_albedo(wo, kNormalNodes) + rest_albedo(wo, nullptr);
}

Rgb TableBsdf::first_albedo(const Vec3& wo, int nodes) const {
  if (material_.is_smooth()) return reflectance_(wo.z);
  Rgb sum;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const Point2 u{(i + 0.5) / nodes, (j + 0.5) / nodes};
      const Vec3 h = ggx_.sample_visible(wo, u);
      const Vec3 wi = reflect(wo, h);
      if (wi.z > 0) sum += reflectance_(dot(wo, h)) * ggx_.g2_over_g1(wo, wi);
    }
  return sum / (nodes * nodes);
}

// The table is linear between azimuths, so that the trapezoids of its nodes are exact. Those of an isotropic
// table are azimuths of wi from wo; those of an anisotropic one are of a quadrant, and wo mirrored stands for
// wi in the other three.
std::vector<TableBsdf::AzimuthNode> TableBsdf::azimuths_around(const Vec3& wo) const {
  const bool isotropic = symmetry_ == Symmetry::isotropic;
  const Axis& axis = remainder_.axes()[isotropic ? 3 : 1];
  const auto weights = trapezoid(axis);
  std::vector<AzimuthNode> result;
  for (std::size_t k = 0; k < axis.size(); ++k) {
    if (isotropic) {
      result.push_back({0, axis.nodes[k], weights[k]});
      continue;
    }
    for (const double x : {wo.x, -wo.x})
      for (const double y : {wo.y, -wo.y})
        result.push_back({axis.nodes[k], azimuth({x, y, wo.z}), weights[k] / 4});
  }
  return result;
}

// Int f_rest cos dwi by four-point Gauss-Legendre in each bin of cos(theta_i); the bins' mean values, which
// are added to `marginal`, are the sampling density over that cosine.
Rgb TableBsdf::rest_albedo(const Vec3& wo, std::vector<double>* marginal) const {
  constexpr double kNode[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  constexpr double kWeight[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                0.1739274225687269};
  if (wo.z <= 0) return {};
  const auto azimuths = azimuths_around(wo);
  const Rgb t_o = transmittance_(wo.z);
  Rgb total;
  for (std::size_t bin = 0; bin < kMarginalBins; ++bin) {
    Rgb in_bin;
    for (std::size_t g = 0; g < 4; ++g) {
      const double cos_i = (static_cast<double>(bin) + kNode[g]) / kMarginalBins;
      Rgb remainder;  // its mean over the azimuth of wi
      for (const AzimuthNode& a : azimuths)
        remainder += a.weight * remainder_.interpolate(std::array{cos_i, a.phi_i, wo.z, a.phi_o});
      const Rgb mean_value = frame_.decode(remainder, cos_i, wo.z, transmittance_(cos_i), t_o);
      in_bin += mean_value * (kWeight[g] * cos_i * 2 * kPi);
    }
    if (marginal) (*marginal)[bin] += std::max(0.0, mean(in_bin));
    total += in_bin / kMarginalBins;
  }
  return total;
}

double TableBsdf::first_chance(double cos_o) const { return first_chance_(cos_o).r; }

// Density over wi, 1/sr: a mixture of the two nearest nodes' marginals, uniform in azimuth.
double TableBsdf::rest_pdf(double cos_o, double cos_i) const {
  const Bracket at = even_bracket(cos_o, kSamplingNodes);
  return lerp(at.upper_weight, rest_marginals_[at.lower].pdf(cos_i), rest_marginals_[at.upper].pdf(cos_i)) /
         (2 * kPi);
}

Vec3 TableBsdf::sample_rest(const Vec3& wo, Rng& rng) const {
  const Bracket at = even_bracket(wo.z, kSamplingNodes);
  const auto& marginal = rest_marginals_[rng.uniform() < at.upper_weight ? at.upper : at.lower];
  const double cosine = marginal.sample(rng.uniform());
  return direction_from_cosine(cosine, 2 * kPi * rng.uniform());
}

std::optional<BsdfSample> TableBsdf::sample(const Vec3& wo, Rng& rng) const {
  if (wo.z <= 0) return {};
  const double chance = first_chance(wo.z);
  Vec3 wi;
  if (rng.uniform() < chance) {
    if (material_.is_smooth()) return BsdfSample{{-wo.x, -wo.y, wo.z}, reflectance_(wo.z) / chance, true};
    wi = reflect(wo, ggx_.sample_visible(wo, {rng.uniform(), rng.uniform()}));
  } else {
    wi = sample_rest(wo, rng);
  }
  const double density = mis_pdf(wo, wi);
  if (wi.z <= 0 || density <= 0) return {};
  return BsdfSample{wi, (first(wo, wi) + rest(wo, wi)) * (wi.z / density), false};
}

double TableBsdf::mis_pdf(const Vec3& wo, const Vec3& wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  const double chance = first_chance(wo.z);
  const double rest = (1 - chance) * rest_pdf(wo.z, wi.z);
  if (material_.is_smooth()) return rest;
  return rest + chance * ggx_.reflection_pdf(wo, normalize(wo + wi));
}

}  // namespace sunbeam
