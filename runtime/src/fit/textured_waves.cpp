#include "runtime/src/fit/textured_waves.h"

#include "runtime/src/base/exp4.h"
#include "sunbeam/detail/textured_point.h"

namespace sunbeam {
inline namespace v1 {
namespace {

void exponentiate(std::vector<float>& values) {
  for (std::size_t k = 0; k < values.size(); k += 4) {
    Color4 four{};
    const std::size_t count = std::min<std::size_t>(4, values.size() - k);
    std::copy_n(values.data() + k, count, reinterpret_cast<float*>(&four));
    four = exp4(four);
    std::copy_n(reinterpret_cast<const float*>(&four), count, values.data() + k);
  }
}

// From (fringe_order, direction) to (fringe_order, column).
std::vector<float> at_columns(const NdArray& slice, const TexturedGrid& grid, const FactorFrame& frame) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  const std::size_t orders = slice.axes()[0].size(), stride = slice.stride(0);
  std::vector<float> result((orders + kMoreOrders) * columns);
  for (std::size_t column = 0; column < columns; ++column) {
    const int c = static_cast<int>(column) % grid.cosines, p = static_cast<int>(column) / grid.cosines;
    const auto taps = direction_taps(slice.axes()[1], slice.axes()[2],
                                     frame.coordinate(grid.cosine(frame, c)), grid.phi(p));
    for (std::size_t o = 0; o < orders; ++o) {
      double sum = 0;
      for (const DirectionTap& tap : taps) sum += tap.weight * double{slice.values()[o * stride + tap.node]};
      result[o * columns + column] = static_cast<float>(sum);
    }
  }
  return result;
}

}  // namespace

OrderStencil::OrderStencil(const Axis& axis, double order) {
  const Stencil at = axis.stencil(order);
  first = at.node[0];
  for (std::size_t k = 0; k < 4; ++k) weight[k] = k < at.count ? static_cast<float>(at.weight[k]) : 0;
}

TexturedOrders::TexturedOrders(const Table& table, const TexturedGrid& grid, const FactorFrame& frame)
    : waves(table.factors.wavelengths.size()), cosines(static_cast<std::size_t>(grid.cosines)) {
  const Factors& factors = table.factors;
  const double straight_down = fringe_order(table.material, 1);
  const Axis& of_visits = factors.exchange.empty() ? factors.returned.axes()[2] : factors.exchange.axes()[3];
  for (int d = 0; d < grid.axes[0].size(); ++d)
    for (const double nm : factors.wavelengths.nm) {
      const double per = grid.axes[0].node(d) / nm;
      visits.emplace_back(of_visits, straight_down * per);
      if (factors.arrival.empty()) continue;
      for (int c = 0; c < grid.cosines; ++c)
        arrival.emplace_back(factors.arrival.axes()[2],
                             fringe_order(table.material, grid.cosine(frame, c)) * per);
    }
  if (factors.arrival.empty()) return;
  for (int p = 0; p < grid.paths; ++p)
    for (const double nm : factors.wavelengths.nm)
      path.emplace_back(factors.arrival.axes()[2], straight_down * grid.path_nm(p) / nm);
}

TexturedWaves::TexturedWaves(const Table& table, const Material& material, const TexturedGrid& grid,
                             const TexturedOrders& orders, const FilmSpectrum& film)
    : grid_(grid),
      orders_(orders),
      film_(film),
      field_(table, material),
      columns_(static_cast<std::size_t>(grid.columns())) {
  take_cosines();
  take_pigment();
  for (const NdArray& slice : field_.arrivals()) arrivals_.push_back(at_columns(slice, grid, field_.frame()));
  if (!table.factors.returned.empty()) take_returned(table.factors.returned);
}

void TexturedWaves::take_cosines() {
  constexpr double kLeastBelow = 0.05;  // where m~ is m yet
  for (int c = 0; c < cosines(); ++c)
    cosines_.push_back(entering_cosine(field_.material(), grid_.cosine(field_.frame(), c), kLeastBelow));
}

double TexturedWaves::measure(int c) const {
  const double x = grid_.coordinate(c);
  if (grid_.is_warped) return 2 * kPi * cosine(c) * field_.frame().slope(x);
  return cosine(c) > grid_.cosine(field_.frame(), c) ? 0 : 4 * kPi * x * x * x;
}

// What the pigment leaves of each wavelength, relative to the one that it absorbs least.
void TexturedWaves::take_pigment() {
  const Wavelengths& waves = field_.wavelengths();
  const double least = *std::min_element(waves.absorption.begin(), waves.absorption.end());
  const double depth = field_.material().optical_depth();
  pigment_.resize(field_.size() * columns_);
  for (int c = 0; c < cosines(); ++c) {
    const double per_cosine = 1 / field_.frame().pigment_cosine(cosine(c));
    least_decay_.push_back(depth * least * per_cosine);
    for (std::size_t k = 0; k < field_.size(); ++k)
      for (std::size_t column = c; column < columns_; column += grid_.cosines)
        pigment_[k * columns_ + column] =
            static_cast<float>(-depth * (waves.absorption[k] - least) * per_cosine);
  }
}

void TexturedWaves::take_returned(const NdArray& returned) {
  for (std::size_t k = 0; k < field_.size(); ++k) {
    if (k > 0 && field_.depth(k) == field_.depth(k - 1)) {
      returned_.push_back(returned_.back());
      continue;
    }
    const NdArray slice = returned.slice(std::array{field_.material().base_ior, field_.depth(k)});
    returned_.emplace_back(slice.values().begin(), slice.values().end());
    returned_.back().resize(slice.cells() + kMoreOrders);
  }
}

double TexturedWaves::gain(int d, std::size_t k) const {
  if (returned_.empty()) return field_.gain(k);
  return field_.gain(k, double{blend(returned_[k], orders_.visits_at(d, k), 1, 0)});
}

double TexturedWaves::thickness_nm(int p, int c) const {
  return grid_.path_nm(p) / textured_path(field_.material(), cosine(c));
}

std::vector<float> TexturedWaves::at_thickness(int d) const {
  return shares([&](std::size_t k,
                    std::size_t c) -> const OrderStencil& { return orders_.arrival_at_thickness(d, k, c); },
                [&](int) { return grid_.axes[0].node(d); });
}

std::vector<float> TexturedWaves::at_path(int p) const {
  return shares(
      [&](std::size_t k, std::size_t) -> const OrderStencil& { return orders_.arrival_at_path(p, k); },
      [&](int c) { return thickness_nm(p, c); });
}

// `arrival_at` of a wavelength and cosine, `thickness_at` of a cosine.
template <class ArrivalAt, class ThicknessAt>
std::vector<float> TexturedWaves::shares(ArrivalAt arrival_at, ThicknessAt thickness_at) const {
  std::vector<float> result = pigment_;
  const auto floor = static_cast<float>(field_.frame().floor());
  if (floor > 0) std::fill(result.begin(), result.end(), 0.0f);
  if (!arrivals_.empty())
    for (std::size_t k = 0; k < field_.size(); ++k) {
      const std::vector<float>& arrival = arrivals_[field_.slice(k)];
      for (std::size_t c = 0; c < columns_; ++c)
        result[k * columns_ + c] += blend(arrival, arrival_at(k, c % orders_.cosines), columns_, c);
    }
  exponentiate(result);
  if (arrivals_.empty()) let_pass(thickness_at, result);
  for (std::size_t k = 0; floor > 0 && k < result.size(); ++k)
    result[k] = std::max(result[k] - floor, 0.0f) * std::exp(pigment_[k]);
  return result;
}

// A smooth film's transmittance; it has no arrival and no azimuths.
template <class ThicknessAt>
void TexturedWaves::let_pass(ThicknessAt thickness_at, std::vector<float>& shares) const {
  std::array<float, kMostWavelengths> passing;
  for (int c = 0; c < cosines(); ++c) {
    film_.powers(thickness_at(c), field_.material().base_ior, static_cast<float>(cosine(c)), passing.data());
    for (std::size_t k = 0; k < field_.size(); ++k)
      shares[k * orders_.cosines + static_cast<std::size_t>(c)] *= passing[k];
  }
}

}  // namespace v1
}  // namespace sunbeam
