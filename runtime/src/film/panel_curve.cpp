#include "sunbeam/detail/panel_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/src/base/vector_clones.h"
#include "sunbeam/core/vec.h"

namespace sunbeam {
inline namespace v1 {
namespace {

template <std::size_t kCount>
using Square = std::array<std::array<double, kCount>, kCount>;

// Angle of node j: its s is the cosine.
template <std::size_t kCount>
double node_angle(std::size_t j) {
  return kPi * (static_cast<double>(j) + 0.5) / kCount;
}

// Chebyshev coefficients of the polynomial through values at the nodes.
template <std::size_t kCount>
Square<kCount> make_chebyshev_transform() {
  Square<kCount> t;
  for (std::size_t k = 0; k < kCount; ++k)
    for (std::size_t j = 0; j < kCount; ++j)
      t[k][j] = (k == 0 ? 1.0 : 2.0) / kCount * std::cos(static_cast<double>(k) * node_angle<kCount>(j));
  return t;
}

// Powers of s in the Chebyshev polynomials: T_k = 2 s T_(k-1) - T_(k-2).
template <std::size_t kCount>
constexpr Square<kCount> make_powers() {
  Square<kCount> t{};
  t[0][0] = t[1][1] = 1;
  for (std::size_t k = 2; k < kCount; ++k)
    for (std::size_t j = 0; j < kCount; ++j) t[k][j] = (j > 0 ? 2 * t[k - 1][j - 1] : 0) - t[k - 2][j];
  return t;
}

// Not a member: callers of the header must not see that it exists more than once.
SUNBEAM_VECTOR_CLONES
void write_polynomials(const double* c, std::size_t lanes, double s, double* values) {
  for (std::size_t k = 0; k < lanes; k += 4) {
    std::array<double, 4> block;
    for (std::size_t j = 0; j < 4; ++j) block[j] = panel_polynomial(c + k + j, lanes, s);
    std::copy(block.begin(), block.end(), values + k);
  }
}

}  // namespace

PanelCurve::PanelCurve(std::size_t count, const Functions& functions, const Accuracy& accuracy,
                       std::span<const double> edges)
    : count_(count), lanes_(count == 1 ? 1 : (count + 3) / 4 * 4) {
  std::vector<double> ends(edges.begin(), edges.end());
  ends.push_back(1);
  std::sort(ends.begin(), ends.end());
  double low = 0;
  for (const double high : ends) {
    if (high > low) fit(low, high, functions, accuracy);
    low = std::max(low, high);
  }
  std::size_t p = 0;
  for (std::size_t bin = 0; bin <= kBins; ++bin) {
    while (static_cast<double>(bin) / kBins > panels_[p].end) ++p;
    first_panel_.push_back(p);
  }
}

void PanelCurve::polynomials(const double* c, double s, double* values) const {
  write_polynomials(c, lanes_, s, values);
}

void PanelCurve::fit(double low, double high, const Functions& functions, const Accuracy& accuracy) {
  static const auto kTransform = make_chebyshev_transform<kCoefficients>();
  static constexpr auto kPowers = make_powers<kCoefficients>();
  const double centre = (low + high) / 2, half = (high - low) / 2;
  std::vector<double> values(kCoefficients * count_), powers(kCoefficients * lanes_);
  for (std::size_t j = 0; j < kCoefficients; ++j)
    functions(centre + half * std::cos(node_angle<kCoefficients>(j)),
              std::span(values).subspan(j * count_, count_));
  for (std::size_t i = 0; i < count_; ++i) {
    std::array<double, kCoefficients> series{};
    double least = std::abs(values[i]);
    for (std::size_t j = 0; j < kCoefficients; ++j) {
      least = std::min(least, std::abs(values[j * count_ + i]));
      for (std::size_t k = 0; k < kCoefficients; ++k) series[k] += kTransform[k][j] * values[j * count_ + i];
    }
    const double tail = std::abs(series[kCoefficients - 1]) + std::abs(series[kCoefficients - 2]);
    if (high - low > accuracy.narrowest && tail > accuracy.relative * least + accuracy.absolute) {
      fit(low, centre, functions, accuracy);
      fit(centre, high, functions, accuracy);
      return;
    }
    for (std::size_t k = 0; k < kCoefficients; ++k)
      for (std::size_t j = 0; j < kCoefficients; ++j) powers[j * lanes_ + i] += series[k] * kPowers[k][j];
  }
  panels_.push_back({high, centre, 1 / half});
  coefficients_.insert(coefficients_.end(), powers.begin(), powers.end());
}

}  // namespace v1
}  // namespace sunbeam
