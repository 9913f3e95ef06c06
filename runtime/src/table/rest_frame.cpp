#include "sunbeam/detail/rest_frame.h"

#include <utility>

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kLargestDecay = 12;
// Beyond the critical angle of a base thinner than the exterior nothing arrives; any finite frame will do.
constexpr double kSmallestCosine = 1e-6;
// What multiple facets reflect must not be divided by next to nothing, and what passes the film should keep
// the fringes of T in front: a film of index 1.56 in air, whatever its thickness, lets through more than this
// at cosines above 0.2.
constexpr double kLeastOverMultipleFacets = 0.25;
// Layers may let through so little that nodes of T do not hold it, and the rest must not be divided by what
// is left of it.
constexpr double kLeastOfLayers = 0.01;

// How far F has fallen from `start`, per channel. A channel that starts or ends near 0, or beyond, while
// others have light stays within a factor of 10 of their mean, so that the remainder stays bounded.
Rgb decay_of(const Rgb& start, const Rgb& value) {
  constexpr double kMostRatio = 10, kMostGrowth = 1000;
  const double of_mean =
      mean(start) > 0 ? std::clamp(mean(value) / mean(start), std::exp(-kLargestDecay), kMostGrowth) : 1;
  Rgb decay;
  for (int c = 0; c < 3; ++c)
    decay[c] =
        start[c] > 0 ? std::clamp(value[c] / start[c], of_mean / kMostRatio, of_mean * kMostRatio) : of_mean;
  return decay;
}

// RestFrame::FirstVisit.
std::shared_ptr<const std::vector<Rgb>> even_steps(const NdArray& first_visit) {
  if (first_visit.empty()) return {};
  constexpr int kSteps = 1024;  // linear to 1e-5 of a white base, as the array itself
  std::vector<Rgb> steps;
  for (int i = 0; i < kSteps; ++i) {
    const double s = static_cast<double>(i) / kSteps;
    steps.push_back(first_visit.interpolate(std::array{s / (1 - s)}));
  }
  steps.push_back(first_visit.interpolate(std::array{first_visit.axes()[0].high()}));
  return std::make_shared<const std::vector<Rgb>>(std::move(steps));
}

// What facets bend to a base below the exterior does not arrive at the one cosine that a decay would take.
bool bends_below_exterior(const Material& m) {
  return m.base_ior < m.exterior_ior && m.transmission == Transmission::refract && !m.is_smooth();
}

}  // namespace

RestFrame::RestFrame(const Material& material, FirstVisit first_visit, bool is_layered)
    : material_(material),
      is_layered_(is_layered),
      scale_(material.radiance_scale()),
      least_transmittance_(material.has_multiple_facets() ? kLeastOverMultipleFacets
                           : is_layered                   ? kLeastOfLayers
                                                          : 0),
      decays_(!material.scatters() && !material.has_multiple_facets() && !bends_below_exterior(material)),
      first_visit_(std::move(first_visit)) {}

RestFrame::RestFrame(const Material& material, const NdArray& first_visit, bool is_layered)
    : RestFrame(material, even_steps(first_visit), is_layered) {}

// No counting of owners: threads would wait for each other.
RestFrame RestFrame::over(const Material& material) const {
  return {material, FirstVisit(FirstVisit(), first_visit_.get()), is_layered_};
}

RestFrame::Terms RestFrame::terms(double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const {
  const double m_i = one_visit_cosine(cos_i), m_o = one_visit_cosine(cos_o);
  Terms t = !first_visit_ ? rgb3_terms(m_i, m_o) : folded_terms(m_i, m_o);
  t.front = scale_ * factor(t_i) * factor(t_o);
  if (decays_) return t;
  t.first_visit *= std::exp(-material_.scattering_depth() * (1 / m_i + 1 / m_o));
  t.decay = Rgb(1);
  return t;
}

double RestFrame::one_visit_cosine(double cosine) const {
  const double below = std::max(material_.cosine_below(cosine), kSmallestCosine);
  if (!bends_below_exterior(material_)) return below;
  return std::hypot(below, std::sqrt(material_.roughness.u * material_.roughness.v) / 2);
}

// A transmittance as a factor that the remainder can be divided by. A folded one may be negative.
Rgb RestFrame::factor(const Rgb& transmittance) const {
  constexpr double kSmallestShare = 0.3;  // of the mean
  const double share = !first_visit_ ? 0 : kSmallestShare * mean(transmittance);
  const double smallest = std::max(share, least_transmittance_);
  return transform(transmittance, [&](double t) { return std::max(t, smallest); });
}

Rgb RestFrame::first_visit(double optical_path) const {
  const std::vector<Rgb>& steps = *first_visit_;
  const double position = optical_path / (1 + optical_path) * static_cast<double>(steps.size() - 1);
  const auto lower = std::min(static_cast<std::size_t>(position), steps.size() - 2);
  const double t = position - static_cast<double>(lower);
  return (1 - t) * steps[lower] + t * steps[lower + 1];
}

RestFrame::Terms RestFrame::rgb3_terms(double m_i, double m_o) const {
  return {{},
          material_.albedo * (kInvPi * std::exp(material_.absorption_exponent(m_i, m_o))),
          Rgb(std::exp(-std::min(material_.optical_depth() * (1 / m_i + 1 / m_o), kLargestDecay)))};
}

RestFrame::Terms RestFrame::folded_terms(double m_i, double m_o) const {
  const Rgb one_visit = first_visit(-material_.absorption_exponent(m_i, m_o));
  if (!decays_) return {{}, kInvPi * one_visit, Rgb(1)};
  const Rgb at_sum = material_.absorption_path == AbsorptionPath::sum
                         ? one_visit
                         : first_visit(material_.optical_depth() * (1 / m_i + 1 / m_o));
  return {{}, kInvPi * one_visit, decay_of(first_visit_->front(), at_sum)};
}

Rgb RestFrame::decode(const Rgb& remainder, double cos_i, double cos_o, const Rgb& t_i,
                      const Rgb& t_o) const {
  const Terms t = terms(cos_i, cos_o, t_i, t_o);
  const Rgb rest = t.front * (t.first_visit + t.decay * remainder);
  if (first_visit_) return rest;
  return transform(rest, [](double x) { return std::max(0.0, x); });
}

Rgb RestFrame::encode(const Rgb& rest, double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const {
  const Terms t = terms(cos_i, cos_o, t_i, t_o);
  Rgb remainder;
  for (int c = 0; c < 3; ++c)
    if (t.front[c] > 0) remainder[c] = (rest[c] / t.front[c] - t.first_visit[c]) / t.decay[c];
  if (decays_) return remainder;
  return transform(remainder, [](double x) { return std::clamp(x, -kLargestRemainder, kLargestRemainder); });
}

}  // namespace v1
}  // namespace sunbeam
