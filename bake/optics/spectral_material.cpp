#include "bake/optics/spectral_material.h"

#include <cstdio>
#include <optional>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

std::string to_text(const Rgb& color) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", color.r, color.g, color.b);
  return text;
}

// Logits of a spectrum and the multipliers of its three colour constraints.
struct Uplift {
  std::vector<double> logit;
  Rgb multiplier;

  std::vector<double> spectrum() const {
    std::vector<double> values;
    for (const double z : logit) values.push_back(1 / (1 + std::exp(-z)));
    return values;
  }
};

// Half the derivative of the sum of squared steps by logit i.
double slope_gradient(const std::vector<double>& logit, std::size_t i) {
  double sum = 0;
  if (i > 0) sum += logit[i] - logit[i - 1];
  if (i + 1 < logit.size()) sum += logit[i] - logit[i + 1];
  return sum;
}

double dot_channels(const Rgb& a, const Rgb& b) { return a.r * b.r + a.g * b.g + a.b * b.b; }

// One Newton step on the stationarity of the Lagrangian and on the constraints fold(spectrum) = target.
// Returns the largest residual before the step, or nothing where the system is singular.
std::optional<double> newton_step(const WavelengthQuadrature& q, const Rgb& target, Uplift& state) {
  constexpr double kLargestStep = 2;  // of a logit
  const std::size_t n = q.size(), rows = n + 3;
  const std::vector<double> s = state.spectrum();
  std::vector<double> matrix(rows * rows, 0.0), rhs(rows);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix[i * rows + j]; };
  for (std::size_t i = 0; i < n; ++i) {
    const double slope = s[i] * (1 - s[i]), pull = dot_channels(state.multiplier, q.weight[i]);
    rhs[i] = -(slope_gradient(state.logit, i) + slope * pull);
    at(i, i) = (i > 0) + (i + 1 < n) + slope * (1 - 2 * s[i]) * pull;
    if (i > 0) at(i, i - 1) = at(i - 1, i) = -1;
    for (int c = 0; c < 3; ++c) at(i, n + c) = at(n + c, i) = slope * q.weight[i][c];
  }
  const Rgb missing = target - q.fold(s);
  for (int c = 0; c < 3; ++c) rhs[n + c] = missing[c];
  double residual = 0;
  for (const double r : rhs) residual = std::max(residual, std::abs(r));
  if (!solve_linear(std::move(matrix), rhs)) return std::nullopt;
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(rhs[i]));
  const double scale = std::min(1.0, kLargestStep / largest);
  for (std::size_t i = 0; i < n; ++i) state.logit[i] += scale * rhs[i];
  for (int c = 0; c < 3; ++c) state.multiplier[c] += scale * rhs[n + c];
  return residual;
}

// Newton's method from `state`; false and `state` as it was if it does not converge.
bool solve_uplift(const WavelengthQuadrature& q, const Rgb& target, Uplift& state) {
  constexpr double kTolerance = 1e-11;
  constexpr double kLargestLogit = 40;  // beyond, doubles hold only 0 and 1
  Uplift trial = state;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const std::optional<double> residual = newton_step(q, target, trial);
    if (!residual || !std::isfinite(*residual)) return false;
    for (const double z : trial.logit)
      if (!(std::abs(z) < kLargestLogit)) return false;
    if (*residual < kTolerance) {
      state = std::move(trial);
      return true;
    }
  }
  return false;
}

}  // namespace

double interpolate(const SpectralCurve& curve, double wavelength_nm) {
  if (wavelength_nm <= curve.front().first) return curve.front().second;
  if (wavelength_nm >= curve.back().first) return curve.back().second;
  std::size_t i = 1;
  while (curve[i].first < wavelength_nm) ++i;
  const auto [x0, y0] = curve[i - 1];
  const auto [x1, y1] = curve[i];
  return lerp((wavelength_nm - x0) / (x1 - x0), y0, y1);
}

std::vector<double> uplift_albedo(const WavelengthQuadrature& quadrature, const Rgb& albedo) {
  for (int c = 0; c < 3; ++c)
    if (!(albedo[c] >= 0 && albedo[c] <= 1))
      throw Error("albedo " + to_text(albedo) + ": components must lie in [0, 1]");
  if (albedo.r == albedo.g && albedo.g == albedo.b) return std::vector<double>(quadrature.size(), albedo.r);
  // Reachable colours form a convex set, so everything between grey and a reachable colour is reachable: walk
  // there in steps as long as Newton's method takes.
  constexpr double kSmallestStep = 1e-3;
  const double grey = mean(albedo);
  Uplift state{std::vector<double>(quadrature.size(), std::log(grey / (1 - grey))), Rgb(0)};
  double reached = 0, step = 1;
  const auto between = [&](double t) { return Rgb(grey) + t * (albedo - Rgb(grey)); };
  while (reached < 1) {
    const double next = std::min(reached + step, 1.0);
    if (solve_uplift(quadrature, next == 1 ? albedo : between(next), state)) {
      reached = next;
      step *= 2;
    } else if ((step /= 2) < kSmallestStep) {
      throw Error(
          "albedo " + to_text(albedo) +
          ": no reflectance between 0 and 1 has this colour; the nearest that one has, towards grey, is " +
          to_text(between(reached)));
    }
  }
  return state.spectrum();
}

AbsorptionShape AbsorptionShape::table(SpectralCurve points) {
  if (points.empty()) throw Error("absorption spectrum: at least one (wavelength, value) pair is needed");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [wavelength, value] = points[i];
    if (!(wavelength > 0 && std::isfinite(wavelength)) || (i > 0 && wavelength <= points[i - 1].first))
      throw Error("absorption spectrum: wavelength " + std::to_string(wavelength) +
                  " nm; wavelengths must be positive and ascend");
    if (!(value >= 0 && std::isfinite(value)))
      throw Error("absorption spectrum: value " + std::to_string(value) + " at " +
                  std::to_string(wavelength) + " nm; values must not be negative");
  }
  const double reference = interpolate(points, kReferenceNm);
  if (!(reference > 0)) throw Error("absorption spectrum: the value at 510 nm is 0; it must be positive");
  for (auto& point : points) point.second /= reference;
  return AbsorptionShape(std::move(points), 0);
}

AbsorptionShape AbsorptionShape::pigment(const std::string& name) {
  if (name == "eumelanin") return AbsorptionShape({}, 3.48);
  if (name == "pheomelanin") return AbsorptionShape({}, 4.75);
  throw Error("absorption spectrum: unknown pigment \"" + name + "\"; known are eumelanin, pheomelanin");
}

double AbsorptionShape::operator()(double wavelength_nm) const {
  if (points_.empty()) return std::pow(kReferenceNm / wavelength_nm, exponent_);
  return interpolate(points_, wavelength_nm);
}

}  // namespace sunbeam
