// A bare slab by adding and doubling: reflectance and transmittance of light from one direction, all
// azimuths together, with Henyey and Greenstein's phase function. No film, black below or a Lambertian base.
//
// Radiance at Gauss nodes of each half of the cosine; cosines asked for are further nodes of weight zero.
// The matrices R and T map radiance that arrives to radiance that leaves. The phase function is its Legendre
// series as far as the nodes integrate it exactly, so energy is conserved to rounding. By reciprocity what
// light from a cosine loses to one side is the radiance there under light 1 from all directions: a row's sum.
// A layer so thin that the diamond rule is exact to 1e-8 is doubled until it has the wanted thickness.
// Source: van de Hulst, Multiple Light Scattering (1980), ch. 4; Prahl, van Gemert, Welch 1993.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "sunbeam/core/vec.h"

namespace sunbeam::test {

// Just what doubling needs.
class Matrix {
 public:
  explicit Matrix(std::size_t n, double diagonal = 0) : n_(n), values_(n * n) {
    for (std::size_t i = 0; i < n; ++i) (*this)(i, i) = diagonal;
  }
  double& operator()(std::size_t i, std::size_t j) { return values_[i * n_ + j]; }
  double operator()(std::size_t i, std::size_t j) const { return values_[i * n_ + j]; }
  std::size_t size() const { return n_; }

  friend Matrix combine(double a, const Matrix& x, double b, const Matrix& y) {
    Matrix result(x.n_);
    for (std::size_t k = 0; k < result.values_.size(); ++k)
      result.values_[k] = a * x.values_[k] + b * y.values_[k];
    return result;
  }
  friend Matrix operator+(const Matrix& x, const Matrix& y) { return combine(1, x, 1, y); }
  friend Matrix operator-(const Matrix& x, const Matrix& y) { return combine(1, x, -1, y); }
  friend Matrix operator*(const Matrix& x, const Matrix& y) {
    Matrix result(x.n_);
    for (std::size_t i = 0; i < x.n_; ++i)
      for (std::size_t k = 0; k < x.n_; ++k)
        for (std::size_t j = 0; j < x.n_; ++j) result(i, j) += x(i, k) * y(k, j);
    return result;
  }

  // A^-1 B by elimination; every A here is diagonally dominant or close to it, still pivots are chosen.
  friend Matrix solve(Matrix a, Matrix b) {
    const std::size_t n = a.n_;
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < n; ++i)
        if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
      for (std::size_t j = 0; j < n; ++j) {
        std::swap(a(k, j), a(pivot, j));
        std::swap(b(k, j), b(pivot, j));
      }
      for (std::size_t i = 0; i < n; ++i) {
        if (i == k) continue;
        const double factor = a(i, k) / a(k, k);
        if (factor == 0) continue;
        for (std::size_t j = k; j < n; ++j) a(i, j) -= factor * a(k, j);
        for (std::size_t j = 0; j < n; ++j) b(i, j) -= factor * b(k, j);
      }
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) b(i, j) /= a(i, i);
    return b;
  }

 private:
  std::size_t n_;
  std::vector<double> values_;
};

// P_0(x) to P_{count - 1}(x).
inline std::vector<double> legendre(double x, std::size_t count) {
  std::vector<double> p{1, x};
  while (p.size() < count) {
    const double k = static_cast<double>(p.size()) - 1;
    p.push_back(((2 * k + 1) * x * p[p.size() - 1] - k * p[p.size() - 2]) / (k + 1));
  }
  p.resize(count);
  return p;
}

struct GaussRule {
  std::vector<double> nodes, weights;
};

// Gauss and Legendre's rule on (0, 1), by Newton's method.
inline GaussRule half_range_gauss(std::size_t count) {
  GaussRule rule;
  const double n = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    double x = std::cos(kPi * (static_cast<double>(i) + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      const auto p = legendre(x, count + 1);
      slope = n * (x * p[count] - p[count - 1]) / (x * x - 1);
      const double move = p[count] / slope;
      x -= move;
      if (std::abs(move) < 1e-15) break;
    }
    rule.nodes.push_back((1 + x) / 2);
    rule.weights.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

class AddingDoubling {
 public:
  // Extinction `thickness`, single-scattering albedo, asymmetry g, and the cosines (0 to 1] to be known.
  AddingDoubling(double thickness, double albedo, double g, const std::vector<double>& cosines,
                 std::size_t nodes = 48)
      : gauss_(half_range_gauss(nodes)), reflect_(0), transmit_(0), nodes_(nodes) {
    gauss_.nodes.insert(gauss_.nodes.end(), cosines.begin(), cosines.end());
    gauss_.weights.resize(gauss_.nodes.size());
    double thinnest = 1;
    for (const double mu : gauss_.nodes) thinnest = std::min(thinnest, mu);
    int doublings = 0;
    double layer = thickness;
    for (; layer > 1e-3 * thinnest; layer /= 2) ++doublings;
    start(layer, albedo, g);
    while (doublings-- > 0) doubled();
  }

  // Of light from cosine number k: all that is reflected, all that is transmitted, scattered or not.
  double reflectance(std::size_t k) const { return row_sum(reflect_, nodes_ + k); }
  double transmittance(std::size_t k) const { return row_sum(transmit_, nodes_ + k); }

  // The same over a Lambertian base: light that has come through goes round between base and slab.
  double reflectance_over(double base_albedo, std::size_t k) const {
    const double round = base_albedo / (1 - base_albedo * diffuse(reflect_));
    return reflectance(k) + transmittance(k) * round * diffuse(transmit_);
  }

 private:
  double row_sum(const Matrix& m, std::size_t i) const {
    double sum = 0;
    for (std::size_t j = 0; j < m.size(); ++j) sum += m(i, j);
    return sum;
  }
  // Of light that is the same from all directions.
  double diffuse(const Matrix& m) const {
    double sum = 0;
    for (std::size_t i = 0; i < nodes_; ++i) sum += 2 * gauss_.nodes[i] * gauss_.weights[i] * row_sum(m, i);
    return sum;
  }

  // mu dD/dt = -D + (albedo / 2) (H+ D + H- U) and the same upwards, both sides at the middle of the layer.
  void start(double layer, double albedo, double g) {
    const std::size_t n = gauss_.nodes.size(), terms = 2 * nodes_;
    Matrix loss(n), turn(n);  // half a layer's
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = legendre(gauss_.nodes[i], terms);
      for (std::size_t j = 0; j < n; ++j) {
        const auto q = legendre(gauss_.nodes[j], terms);
        double forward = 0, backward = 0, moment = 1;
        for (std::size_t k = 0; k < terms; ++k, moment *= g) {
          const double term = (2 * static_cast<double>(k) + 1) * moment * p[k] * q[k];
          forward += term;
          backward += k % 2 == 0 ? term : -term;
        }
        const double scale = layer / (2 * gauss_.nodes[i]), share = albedo / 2 * gauss_.weights[j];
        loss(i, j) = scale * ((i == j ? 1 : 0) - share * forward);
        turn(i, j) = scale * share * backward;
      }
    }
    const Matrix one(n, 1), up = one + loss;
    const Matrix through = turn * solve(up, turn);
    transmit_ = solve(up - through, (one - loss) + through);
    reflect_ = solve(up, turn * (one + transmit_));
  }

  void doubled() {
    const Matrix one(reflect_.size(), 1);
    const Matrix between = solve(one - reflect_ * reflect_, transmit_);  // radiance down in the middle
    reflect_ = reflect_ + transmit_ * (reflect_ * between);
    transmit_ = transmit_ * between;
  }

  GaussRule gauss_;
  Matrix reflect_, transmit_;
  std::size_t nodes_;
};

}  // namespace sunbeam::test
