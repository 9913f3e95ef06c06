// This file holds several functions of x in [0, 1] at once, as polynomials on panels that they share. They
// are dear to make and cheap to evaluate.
//
// A panel is halved until the last two coefficients of every function's Chebyshev series are small; where the
// series converges geometrically, as it does for analytic functions, its error is smaller still.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace sunbeam {
inline namespace v1 {

// Evaluates a polynomial of degree 7 by Estrin's scheme, which keeps chains of operations short. The
// coefficients are `stride` apart.
inline double panel_polynomial(const double* c, std::size_t stride, double s) {
  const double s2 = s * s, s4 = s2 * s2;
  return ((c[0] + s * c[stride]) + s2 * (c[2 * stride] + s * c[3 * stride])) +
         s4 * ((c[4 * stride] + s * c[5 * stride]) + s2 * (c[6 * stride] + s * c[7 * stride]));
}

class PanelCurve {
 public:
  // Bounds the two last coefficients together: they are at most relative * (least magnitude at the panel's
  // nodes) + absolute. Panels not wider than `narrowest` are taken as they are.
  struct Accuracy {
    double relative, absolute, narrowest;
  };
  // Fills in the values of all functions at x.
  using Functions = std::function<void(double x, std::span<double> values)>;

  PanelCurve() = default;
  PanelCurve(std::size_t count, const Functions& functions, const Accuracy& accuracy,
             std::span<const double> edges = {});  // inside (0, 1), where the functions are not smooth

  std::size_t count() const { return count_; }
  std::size_t panels() const { return panels_.size(); }
  // Returns where the panel of this number ends; panels ascend.
  double end(std::size_t panel) const { return panels_[panel].end; }

  // Returns how many numbers at() writes: count(), filled up to a multiple of four unless it is 1.
  std::size_t lanes() const { return lanes_; }

  // Writes all values at x, which is clamped to [0, 1].
  void at(double x, double* values) const {
    const Place place = find(x);
    if (lanes_ == 1)
      values[0] = panel_polynomial(place.coefficients, 1, place.s);
    else
      polynomials(place.coefficients, place.s, values);
  }

  // Holds where x lies, for values of few functions.
  struct Place {
    const double* coefficients;
    double s;
  };
  Place find(double x) const {
    x = std::clamp(x, 0.0, 1.0);
    std::size_t p = first_panel_[static_cast<std::size_t>(x * kBins)];
    while (x > panels_[p].end) ++p;
    return {coefficients_.data() + p * kCoefficients * lanes_, (x - panels_[p].centre) * panels_[p].scale};
  }
  // Returns the value of one function, by its number below count().
  double value(const Place& place, std::size_t function) const {
    return panel_polynomial(place.coefficients + function, lanes_, place.s);
  }

 private:
  static constexpr std::size_t kCoefficients = 8;
  static constexpr std::size_t kBins = 256;
  struct Panel {
    double end, centre, scale;  // s = (x - centre) scale in [-1, 1]
  };

  void polynomials(const double* c, double s, double* values) const;
  void fit(double low, double high, const Functions& functions, const Accuracy& accuracy);

  std::size_t count_ = 0, lanes_ = 0;
  std::vector<Panel> panels_;
  std::vector<double> coefficients_;      // of the powers of s: panel, power, lane
  std::vector<std::size_t> first_panel_;  // by bin of x: the panel at its start
};

}  // namespace v1
}  // namespace sunbeam
