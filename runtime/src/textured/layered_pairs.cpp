#include "runtime/src/textured/layered_pairs.h"

#include <algorithm>
#include <cmath>

#include "sunbeam/detail/layered_film.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kFirstDirection = 5;  // of the axes of `exchange`

// X as a float that stays one when it is multiplied by two factors. What has no value is where no light is
// left.
double bounded(double x) {
  constexpr double kMost = 1e18;
  return std::isfinite(x) ? std::clamp(x, -kMost, kMost) : 0;
}

}  // namespace

LayeredPairs::LayeredPairs(const Table& table, const LayeredGrid& grid, const LayeredFactor& factor)
    : table_(table), factor_(factor), grid_(grid) {
  for (int end = 0; end < grid.ends(); ++end) columns_.push_back(grid.column_of_end(end));
  if (!grid.is_product) return;
  const FactorFrame& frame = factor.field().frame();
  const std::vector<Axis>& axes = table.factors.exchange.axes();
  for (const int column : columns_) {
    const double cosine = factor.cosine_of(column);
    below_.push_back(frame.one_visit_cosine(cosine));
    taps_.push_back(direction_taps(axes[kFirstDirection], axes[kFirstDirection + 1], frame.coordinate(cosine),
                                   grid.phi_of_column(column)));
  }
}

void LayeredPairs::take(Color4* pairs) const {
  const std::size_t ends = columns_.size();
  std::vector<Rgb> sum(ends * ends);
  for (std::size_t k = 0; k < factor_.field().size(); ++k) add_wavelength(k, sum);
  const std::vector<Rgb>& values = factor_.values();
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const Rgb scale =
          values[static_cast<std::size_t>(columns_[a])] * values[static_cast<std::size_t>(columns_[b])];
      const Rgb left = sum[a * ends + b] / scale - one_visit(columns_[a], columns_[b]);
      pairs[a * ends + b] = pairs[b * ends + a] = to_color4(transform(left, bounded));
    }
}

// Adds one wavelength's part of the rest to the pairs whose second end is not beyond the first.
void LayeredPairs::add_wavelength(std::size_t k, std::vector<Rgb>& sum) const {
  const std::size_t ends = columns_.size();
  const std::vector<double> visits = grid_.is_product ? brackets(k) : std::vector<double>();
  const Rgb scale = factor_.gain(k) * factor_.field().wavelengths().weight[k];
  for (std::size_t a = 0; a < ends; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const double shares = factor_.shares(columns_[a])[k] * factor_.shares(columns_[b])[k];
      sum[a * ends + b] += shares * (visits.empty() ? 1 : visits[a * ends + b]) * scale;
    }
}

double LayeredPairs::order(std::size_t k) const {
  const Wavelengths& waves = factor_.field().wavelengths();
  const Material& material = factor_.field().material();
  return material.film_thickness_nm * path_per_thickness(material, waves, k) / waves.nm[k];
}

// V of a wavelength at each pair.
std::vector<double> LayeredPairs::brackets(std::size_t k) const {
  const WaveField& field = factor_.field();
  const NdArray slice = table_.factors.exchange.slice(std::array{field.material().base_ior, field.depth(k),
                                                                 field.wavelengths().albedo[k],
                                                                 field.wavelengths().nm[k], order(k)});
  std::vector<double> row(slice.stride(1)), result;
  for (std::size_t a = 0; a < columns_.size(); ++a) {
    std::fill(row.begin(), row.end(), 0);
    contract(slice.values(), taps_[a], row);
    for (std::size_t b = 0; b < columns_.size(); ++b)
      result.push_back(bracket(field.depth(k), below_[a], below_[b], row, taps_[b]));
  }
  return result;
}

// What of a pair of columns X leaves to its closed form.
Rgb LayeredPairs::one_visit(int a, int b) const {
  if (!grid_.is_product) return Rgb(0);
  const Material& material = factor_.field().material();
  const double m_a = std::max(material.cosine_below(factor_.cosine_of(a)), 1e-6),
               m_b = std::max(material.cosine_below(factor_.cosine_of(b)), 1e-6);
  Rgb result;
  for (int channel = 0; channel < 3; ++channel)
    result[channel] =
        one_visit_of_product(material.optical_depth() * double{factor_.absorption()[channel]}, m_a, m_b);
  return result;
}

}  // namespace v1
}  // namespace sunbeam
