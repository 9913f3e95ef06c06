#include "sunbeam/table.h"

namespace sunbeam {

Rgb Table::transmittance(const std::array<double, 3>& x) const {
  if (film_transmittance.empty()) return Rgb(1) - film_reflectance.interpolate(x);
  return film_transmittance.interpolate(x);
}

bool Table::is_full_spectrum() const {
  const auto at = info.find("spectrum");
  return at != info.end() && at->second == "full";
}

ColorSpace Table::color_space() const {
  return is_full_spectrum() ? color_space_from(info.at("color_space")) : ColorSpace::rec709;
}

bool Table::operator==(const Table& other) const {
  for (const auto& key : material_keys())
    if (get_text(material, key) != get_text(other.material, key)) return false;
  return symmetry == other.symmetry && film_reflectance == other.film_reflectance &&
         film_transmittance == other.film_transmittance && remainder == other.remainder &&
         rest_stderr == other.rest_stderr && info == other.info;
}

namespace {

// A folded transmittance as a factor that the remainder can be divided by.
Rgb kept_positive(const Rgb& transmittance) {
  constexpr double kSmallestShare = 0.05;  // of the mean
  const double smallest = kSmallestShare * mean(transmittance);
  return transform(transmittance, [&](double t) { return std::max(t, smallest); });
}

}  // namespace

RestFrame::Terms RestFrame::terms(double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const {
  constexpr double kLargestDecay = 12;
  // Beyond the critical angle of a base thinner than the exterior nothing arrives; any finite frame will do.
  constexpr double kSmallestCosine = 1e-6;
  const double m_i = std::max(material_.cosine_below(cos_i), kSmallestCosine);
  const double m_o = std::max(material_.cosine_below(cos_o), kSmallestCosine);
  const Rgb front = is_folded_ ? kept_positive(t_i) * kept_positive(t_o) : t_i * t_o;
  return {scale_ * front, material_.albedo * (kInvPi * std::exp(material_.absorption_exponent(m_i, m_o))),
          std::exp(-std::min(material_.optical_depth() * (1 / m_i + 1 / m_o), kLargestDecay))};
}

Rgb RestFrame::decode(const Rgb& remainder, double cos_i, double cos_o, const Rgb& t_i,
                      const Rgb& t_o) const {
  const Terms t = terms(cos_i, cos_o, t_i, t_o);
  const Rgb rest = t.front * (t.first_visit + t.decay * remainder);
  if (is_folded_) return rest;
  return transform(rest, [](double x) { return std::max(0.0, x); });
}

Rgb RestFrame::encode(const Rgb& rest, double cos_i, double cos_o, const Rgb& t_i, const Rgb& t_o) const {
  const Terms t = terms(cos_i, cos_o, t_i, t_o);
  Rgb remainder;
  for (int c = 0; c < 3; ++c)
    if (t.front[c] > 0) remainder[c] = (rest[c] / t.front[c] - t.first_visit[c]) / t.decay;
  return remainder;
}

}  // namespace sunbeam
