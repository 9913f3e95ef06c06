// This file sums all visits of the base at once, with absorption path "product". The sum is `exchange` of
// sunbeam/detail/factors.h.
//
// A walk is a chain of legs, joined by the base's exp(-tau / (m m')) between light that arrives along the
// cosine m and leaves along m'. With cosines at nodes m_a, and
//
//   F_ab = exp(-tau / (m_a m_b)),
//   B_ab = the share of what leaves the base that leaves it at m_a and that the film sends back at m_b,
//   p_a  = the share of the light along w that arrives at m_a, over A(w) = sum_a p_a exp(-tau / m_a),
//
// the visits of all walks from wi to wo add up to
//
//   rest = s kd/pi A_i A_o p_i^T (F + kd F B F + (kd F B)^2 F + ...) p_o
//        = s kd/pi A_i A_o [ p_i^T f_o + kd f_i^T B y_o ],     f = F p,   (1 - kd F B) y_o = f_o.
//
// The first term is one visit, E = exp(tau (1/m_i + 1/m_o - 1/(m_i m_o))) unless facets bend light, so
// exchange = p_i^T f_o - E + kd f_i^T B y_o, with E at the cosines of FactorFrame::one_visit_cosine. What is
// kept is the mean of both directions of light, which are equal but for noise.
#pragma once

#include <span>

#include "bake/live/exact/dense.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {

// Sums the visits at one optical depth tau.
class ExchangeSolver {
 public:
  static constexpr int kNodes = 64;

  explicit ExchangeSolver(double optical_depth);

  static const Axis& cosines();  // m_a

  // Describes light along one direction as it arrives at the base.
  struct Arrived {
    Vector p;  // empty where light passes straight on: all at one cosine
    Vector f;
    double below;      // that cosine
    double one_visit;  // m of E
  };
  Arrived straight_on(double m, double one_visit) const;
  // Takes `p` not yet divided by A(w).
  Arrived bent(Vector p, double one_visit) const;

  // Holds what light along some directions meets under one film, whatever the albedo.
  struct Under {
    std::vector<Arrived> ends;
    std::vector<Vector> sent;  // f B of each
    Matrix again;              // F B
    Matrix f;                  // by columns
  };
  Under under(std::vector<Arrived> ends, const Matrix& b) const;

  // Writes the exchange of all pairs of ends, row by row.
  void exchange(const Under& film, double albedo, float* values) const;

 private:
  double first_visit(const Arrived& from, const Arrived& to) const;

  double optical_depth_;
  Matrix f_;
};

}  // namespace sunbeam
