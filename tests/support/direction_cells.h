// Power by outgoing direction: the hemisphere in cells of equal steps of cosine and azimuth, for comparing
// walks that are only counted with values that are integrated.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sunbeam/detail/warp.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam::test {

struct CellGrid {
  int polar = 4, azimuthal = 8;

  std::size_t size() const { return static_cast<std::size_t>(polar) * azimuthal; }
  double solid_angle() const { return 2 * kPi / static_cast<double>(size()); }

  std::size_t index(const Vec3& w) const {
    const auto at = [](double u, int n) { return std::clamp(static_cast<int>(u * n), 0, n - 1); };
    const double phi = std::atan2(w.y, w.x) / (2 * kPi);
    return at(w.z, polar) * static_cast<std::size_t>(azimuthal) + at(phi < 0 ? phi + 1 : phi, azimuthal);
  }
  // A direction of the cell, uniform in solid angle if `u` is uniform.
  Vec3 point(std::size_t cell, const Point2& u) const {
    const double z = (static_cast<double>(cell / azimuthal) + u.x) / polar;
    return direction_from_cosine(z, 2 * kPi * (static_cast<double>(cell % azimuthal) + u.y) / azimuthal);
  }
  // Int cos over the cell.
  double projected(std::size_t cell) const {
    const double row = static_cast<double>(cell / azimuthal);
    return (square((row + 1) / polar) - square(row / polar)) * kPi / azimuthal;
  }
};

// What falls into one cell, on average a walk, in each channel.
struct CellPower {
  Rgb mean, variance;  // variance of the mean
};

// Adds up what `walks` walks bring, each at most once.
class PowerHistogram {
 public:
  explicit PowerHistogram(const CellGrid& grid) : grid_(grid), sums_(grid.size()), squares_(grid.size()) {}

  void add_walk() { ++walks_; }
  void add_walk(const Vec3& direction, const Rgb& power) {
    ++walks_;
    const std::size_t cell = grid_.index(direction);
    sums_[cell] += power;
    squares_[cell] += power * power;
  }

  std::int64_t walks() const { return walks_; }
  std::vector<CellPower> cells() const {
    const double n = static_cast<double>(walks_);
    std::vector<CellPower> result(grid_.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i].mean = sums_[i] / n;
      result[i].variance = (squares_[i] / n - result[i].mean * result[i].mean) / n;
    }
    return result;
  }

 private:
  CellGrid grid_;
  std::int64_t walks_ = 0;
  std::vector<Rgb> sums_, squares_;
};

// The same by integration: `value(w, rng)` is an estimate of power a solid angle, at `points` directions of
// each cell.
template <class F>
std::vector<CellPower> integrate_cells(const CellGrid& grid, int points, Rng& rng, F value) {
  std::vector<CellPower> result(grid.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    RgbMean mean;
    for (int k = 0; k < points; ++k)
      mean.add(value(grid.point(i, {rng.uniform(), rng.uniform()}), rng) * grid.solid_angle());
    for (int c = 0; c < 3; ++c) {
      result[i].mean[c] = mean[c].mean();
      result[i].variance[c] = square(mean[c].std_error());
    }
  }
  return result;
}

// Chi-square of two such results in one channel. A cell that `a` knows worse than to a tenth is pooled with
// its like, so that normal errors are a fair description. A fixed number of walks makes cells repel each
// other a little, which errs on the side of agreement.
inline ChiSquare compare_cells(const std::vector<CellPower>& a, const std::vector<CellPower>& b,
                               int channel) {
  ChiSquare result;
  double thin_gap = 0, thin_variance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double gap = a[i].mean[channel] - b[i].mean[channel];
    const double variance = a[i].variance[channel] + b[i].variance[channel];
    if (a[i].variance[channel] > 0 && a[i].mean[channel] >= 10 * std::sqrt(a[i].variance[channel])) {
      result.statistic += square(gap) / variance;
      ++result.degrees;
    } else {
      thin_gap += gap;
      thin_variance += variance;
    }
  }
  if (thin_variance > 0) {
    result.statistic += square(thin_gap) / thin_variance;
    ++result.degrees;
  }
  result.p_value = result.degrees > 0 ? chi_square_tail(result.statistic, result.degrees) : 1;
  return result;
}

// The least of the three channels' p-values: three tests.
inline double least_p_value(const std::vector<CellPower>& a, const std::vector<CellPower>& b) {
  double least = 1;
  for (int c = 0; c < 3; ++c) least = std::min(least, compare_cells(a, b, c).p_value);
  return least;
}

}  // namespace sunbeam::test
