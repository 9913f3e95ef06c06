// Checks of any sunbeam::Bsdf through its contract alone, live or tabulated.
//
// The hemisphere is cut into cells of equal solid angle, equal steps of cosine and azimuth. All checks take a
// seed and are repeatable. Costs are counted in calls, which the caller chooses.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sunbeam/bsdf.h"
#include "tests/support/stats.h"
#include "tests/support/warps.h"

namespace sunbeam::test {

// Channel by channel, and of their mean, whose noise is smaller than theirs: walks choose by such means.
struct RgbMean {
  RunningMean r, g, b, grey;
  void add(const Rgb& x) { r.add(x.r), g.add(x.g), b.add(x.b), grey.add(sunbeam::mean(x)); }
  const RunningMean& operator[](int channel) const { return channel == 0 ? r : channel == 1 ? g : b; }
  Rgb mean() const { return {r.mean(), g.mean(), b.mean()}; }
};

// Difference of two independent estimates in standard errors, after forgiving an absolute `slack`.
inline double deviation(double a, double error_a, double b, double error_b, double slack = 0) {
  const double excess = std::max(0.0, std::abs(a - b) - slack);
  return excess == 0 ? 0 : excess / std::hypot(error_a, error_b);
}

// A direction by cosine 1 - u.x and azimuth 2 pi u.y: solid angle 2 pi du.
inline Vec3 uniform_hemisphere(const Point2& u) { return direction_from_cosine(1 - u.x, 2 * kPi * u.y); }

// The mean of f(u, rng) over the unit square from one point in each of grid x grid equal cells.
template <class F>
auto stratified_mean(int grid, Rng& rng, F f) {
  decltype(f(Point2(), rng)) total{};
  for (int i = 0; i < grid; ++i)
    for (int j = 0; j < grid; ++j)
      total = total + f(Point2{(i + rng.uniform()) / grid, (j + rng.uniform()) / grid}, rng);
  return total * (1.0 / (static_cast<double>(grid) * grid));
}

// Int f(w, rng) dw over the hemisphere from one point in each of grid x grid equal cells, `repeats` times
// over. The grid removes the variance of a smooth f, so what is left is f's own noise; its standard error is
// that of the repeats, or an upper bound.
template <class F>
auto integrate_stratified(int grid, int repeats, Rng& rng, F f) {
  std::vector<decltype(f(Vec3(), rng))> totals;
  for (int k = 0; k < repeats; ++k)
    totals.push_back(stratified_mean(
        grid, rng, [&](const Point2& u, Rng& r) { return f(uniform_hemisphere(u), r) * (2 * kPi); }));
  return totals;
}

struct SampleTotals {
  RgbMean albedo;               // all outcomes, Dirac ones included
  RgbMean non_dirac_albedo;     // what eval() sees
  RunningMean seen;             // 1 if the outcome is one pdf() sees: neither Dirac nor empty
  double dirac = 0, empty = 0;  // frequencies
};

inline SampleTotals sample_totals(const Bsdf& bsdf, const Vec3& wo, int count, std::uint64_t seed) {
  Rng rng(seed, 1);
  SampleTotals totals;
  std::int64_t dirac = 0, empty = 0;
  for (int i = 0; i < count; ++i) {
    const auto s = bsdf.sample(wo, rng);
    totals.albedo.add(s ? s->throughput : Rgb());
    totals.non_dirac_albedo.add(s && !s->is_dirac ? s->throughput : Rgb());
    totals.seen.add(s && !s->is_dirac ? 1 : 0);
    dirac += s && s->is_dirac;
    empty += !s;
  }
  totals.dirac = static_cast<double>(dirac) / count;
  totals.empty = static_cast<double>(empty) / count;
  return totals;
}

// Int f cos: the non-Dirac albedo by integrating eval().
inline RgbMean albedo_by_eval(const Bsdf& bsdf, const Vec3& wo, int grid, int repeats, std::uint64_t seed) {
  Rng rng(seed, 2);
  RgbMean result;
  for (const Rgb& total : integrate_stratified(
           grid, repeats, rng, [&](const Vec3&wi, Rng&r) { return bsdf.eval(wo, wi, r) * wi.z; }))
    result.add(total);
  return result;
}

// Int pdf: should be 1 - P(Dirac) - P(empty).
inline RunningMean integrate_pdf(const Bsdf& bsdf, const Vec3& wo, int grid, int repeats,
                                 std::uint64_t seed) {
  Rng rng(seed, 3);
  RunningMean result;
  for (const double total :
       integrate_stratified(grid, repeats, rng, [&](const Vec3&wi, Rng&r) { return bsdf.pdf(wo, wi, r); }))
    result.add(total);
  return result;
}

struct ChiSquareOptions {
  int polar = 12, azimuthal = 24;  // cells
  int samples = 200000;            // mean number of sample() calls
  int points = 4;                  // quadrature points of pdf a cell: points x points, jittered
  int pdf_samples = 32;  // independent repetitions of that quadrature; 1 point set needs at least 16
};

// Directions of sample() against pdf(), which may be exact or a noisy estimate: its cell averages come with
// their standard error, which widens the cell's variance. The number of sample() calls is itself Poisson, so
// that the cells are independent whatever share of the outcomes is Dirac or empty.
inline ChiSquare chi_square_of_sampling(const Bsdf& bsdf, const Vec3& wo, const ChiSquareOptions& o,
                                        std::uint64_t seed) {
  Rng rng(seed, 4);
  const double gauss = std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(2 * kPi * rng.uniform());
  const auto calls = std::llround(o.samples + std::sqrt(o.samples) * gauss);  // Poisson, at this size normal

  const auto at = [](double u, int n) { return std::clamp(static_cast<int>(u * n), 0, n - 1); };
  std::vector<Cell> cells(static_cast<std::size_t>(o.polar) * o.azimuthal);
  for (std::int64_t i = 0; i < calls; ++i) {
    const auto s = bsdf.sample(wo, rng);
    if (!s || s->is_dirac) continue;
    const Point2 u{1 - s->wi.z, invert_cosine(s->wi).y};
    cells[at(u.x, o.polar) * o.azimuthal + at(u.y, o.azimuthal)].observed += 1;
  }
  for (int i = 0; i < o.polar; ++i)
    for (int j = 0; j < o.azimuthal; ++j) {
      RunningMean pdf;  // mean over the cell
      for (int k = 0; k < o.pdf_samples; ++k) {
        double sum = 0;
        for (int a = 0; a < o.points; ++a)
          for (int b = 0; b < o.points; ++b) {
            const Vec3 wi = uniform_hemisphere({(i + (a + rng.uniform()) / o.points) / o.polar,
                                                (j + (b + rng.uniform()) / o.points) / o.azimuthal});
            sum += bsdf.pdf(wo, wi, rng);
          }
        pdf.add(sum / (o.points * o.points));
      }
      const double scale = o.samples * 2 * kPi / (o.polar * o.azimuthal);
      Cell& cell = cells[i * o.azimuthal + j];
      cell.expected = scale * pdf.mean();
      cell.expected_variance = square(scale * pdf.std_error());
    }
  return chi_square(cells);
}

// eval(a, b) - eval(b, a), estimated from `count` independent pairs of calls.
inline RgbMean reciprocity_gap(const Bsdf& bsdf, const Vec3& a, const Vec3& b, int count,
                               std::uint64_t seed) {
  Rng rng(seed, 5);
  RgbMean gap;
  for (int i = 0; i < count; ++i) {
    const Rgb forward = bsdf.eval(a, b, rng);
    gap.add(forward - bsdf.eval(b, a, rng));
  }
  return gap;
}

// The largest relative difference between eval_and_sample() and eval_pdf() followed by sample(), over `pairs`
// pairs of directions anywhere; infinite where one of them has a sample and the other has not, or another
// one.
inline double difference_together(const Bsdf& bsdf, int pairs, std::uint64_t seed) {
  const auto relative = [](double a, double b) {
    return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
  };
  Rng together(seed, 0), apart(seed, 0), directions(seed, 1);
  double largest = 0;
  for (int k = 0; k < pairs; ++k) {
    const Vec3 wo = sample_sphere({directions.uniform(), directions.uniform()}),
               wi = sample_sphere({directions.uniform(), directions.uniform()});
    const auto [eval, sample] = bsdf.eval_and_sample(wo, wi, together);
    const EvalPdf value = bsdf.eval_pdf(wo, wi, apart);
    const auto alone = bsdf.sample(wo, apart);
    largest = std::max(largest, relative(eval.pdf, value.pdf));
    for (int c = 0; c < 3; ++c) largest = std::max(largest, relative(eval.f[c], value.f[c]));
    if (sample.has_value() != alone.has_value()) return HUGE_VAL;
    if (!sample) continue;
    if (sample->wi.x != alone->wi.x || sample->is_dirac != alone->is_dirac) return HUGE_VAL;
    largest = std::max(largest, relative(sample->mis_pdf, alone->mis_pdf));
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, relative(sample->throughput[c], alone->throughput[c]));
  }
  return largest;
}

}  // namespace sunbeam::test
