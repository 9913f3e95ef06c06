#include "bake/factored/exchange_solver.h"

#include "bake/live/exact/resolvent.h"
#include "sunbeam/detail/factors.h"

namespace sunbeam {
namespace {

constexpr double kLeastArriving = 1e-30, kLeastCosine = 1e-6;

// kd f_i^T B y_o.
Matrix later_visits(const ExchangeSolver::Under& film, double albedo) {
  const int count = static_cast<int>(film.ends.size());
  Matrix again = film.again, result(count);
  for (int a = 0; a < ExchangeSolver::kNodes; ++a)
    for (int c = 0; c < ExchangeSolver::kNodes; ++c) again.row(a)[c] *= albedo;
  const Matrix y = resolvent(std::move(again), film.f);
  for (int i = 0; i < count; ++i) {
    Vector sent = film.sent[i];
    for (double& x : sent) x *= albedo;
    const Vector row = multiply(sent, y);
    std::copy(row.begin(), row.end(), result.row(i));
  }
  return result;
}

}  // namespace

const Axis& ExchangeSolver::cosines() {
  static const Axis axis{"", "", spaced_nodes(1e-3, 1, kNodes, 1.5), 1.5};
  return axis;
}

ExchangeSolver::ExchangeSolver(double optical_depth) : optical_depth_(optical_depth), f_(kNodes) {
  const std::vector<double>& m = cosines().nodes;
  for (int a = 0; a < kNodes; ++a)
    for (int b = 0; b < kNodes; ++b) f_.row(a)[b] = std::exp(-optical_depth / (m[a] * m[b]));
}

ExchangeSolver::Arrived ExchangeSolver::straight_on(double m, double one_visit) const {
  m = std::max(m, kLeastCosine);
  Arrived end{{}, Vector(kNodes), m, one_visit};
  for (int b = 0; b < kNodes; ++b) end.f[b] = std::exp(-optical_depth_ / m * (1 / cosines().nodes[b] - 1));
  return end;
}

ExchangeSolver::Arrived ExchangeSolver::bent(Vector p, double one_visit) const {
  double arriving = 0;
  for (int a = 0; a < kNodes; ++a) arriving += p[a] * std::exp(-optical_depth_ / cosines().nodes[a]);
  for (double& share : p) share /= std::max(arriving, kLeastArriving);
  Vector f = multiply(p, f_);
  return {std::move(p), std::move(f), 0, one_visit};
}

double ExchangeSolver::first_visit(const Arrived& from, const Arrived& to) const {
  if (!from.p.empty()) return dot(from.f, to.p);
  return one_visit_of_product(optical_depth_, from.below, to.below);
}

ExchangeSolver::Under ExchangeSolver::under(std::vector<Arrived> ends, const Matrix& b) const {
  const int count = static_cast<int>(ends.size());
  Under film{std::move(ends), {}, multiply(f_, b), Matrix(kNodes, count)};
  for (int o = 0; o < count; ++o) {
    film.sent.push_back(multiply(film.ends[o].f, b));
    for (int a = 0; a < kNodes; ++a) film.f.row(a)[o] = film.ends[o].f[a];
  }
  return film;
}

void ExchangeSolver::exchange(const Under& film, double albedo, float* values) const {
  Matrix sum = later_visits(film, albedo);
  const std::vector<Arrived>& ends = film.ends;
  const int count = sum.size();
  for (int i = 0; i < count; ++i)
    for (int o = 0; o < count; ++o) {
      const double one_visit = one_visit_of_product(optical_depth_, ends[i].one_visit, ends[o].one_visit);
      sum.row(i)[o] += first_visit(ends[i], ends[o]) - one_visit;
    }
  symmetrise(sum);
  for (int k = 0; k < count * count; ++k) values[k] = static_cast<float>(sum.row(0)[k]);
}

}  // namespace sunbeam
