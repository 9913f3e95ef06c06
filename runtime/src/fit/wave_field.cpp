#include "runtime/src/fit/wave_field.h"

namespace sunbeam {
inline namespace v1 {

WaveField::WaveField(const Table& table, const Material& material)
    : factors_(table.factors), material_(material), frame_(material, reaches_below(table)) {
  for (const double absorption : wavelengths().absorption)
    depths_.push_back(material.optical_depth() * absorption);
  if (factors_.arrival.empty()) return;
  const bool has_depths = factors_.arrival.axes()[1].size() > 1;
  for (std::size_t k = 0; k < size(); ++k) {
    const bool is_new = k == 0 || (has_depths && depths_[k] != depths_[k - 1]);
    if (is_new) arrivals_.push_back(factors_.arrival.slice(std::array{material.base_ior, depths_[k]}));
    slice_.push_back(arrivals_.size() - 1);
  }
}

double WaveField::gain(std::size_t k, double returned) const {
  constexpr double kMostReturned = 0.9999;  // interpolation may overshoot what nodes hold
  const double once = material_.radiance_scale() * wavelengths().albedo[k] * kInvPi;
  return once / (1 - std::min(wavelengths().albedo[k] * returned, kMostReturned));
}

std::vector<DirectionTap> direction_taps(const Axis& cosines, const Axis& phis, double coordinate,
                                         double phi) {
  const Stencil c = cosines.stencil(coordinate), p = phis.stencil(phi);
  std::vector<DirectionTap> taps;
  for (std::size_t a = 0; a < c.count; ++a)
    for (std::size_t b = 0; b < p.count; ++b)
      taps.push_back({c.node[a] * phis.size() + p.node[b], c.weight[a] * p.weight[b]});
  return taps;
}

void contract(std::span<const float> exchange, std::span<const DirectionTap> from, std::span<double> row) {
  for (const DirectionTap& tap : from)
    for (std::size_t b = 0; b < row.size(); ++b)
      row[b] += tap.weight * double{exchange[tap.node * row.size() + b]};
}

double bracket(double depth, double m_i, double m_o, std::span<const double> row,
               std::span<const DirectionTap> to) {
  double sum = one_visit_of_product(depth, m_i, m_o);
  for (const DirectionTap& tap : to) sum += tap.weight * row[tap.node];
  return sum;
}

}  // namespace v1
}  // namespace sunbeam
