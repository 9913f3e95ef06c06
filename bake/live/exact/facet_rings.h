// This file gives the GGX normals (sunbeam/detail/ggx.h) visible from one direction as nodes of a quadrature
// that resolves a layered film: by rings about the direction, on each of which the film's powers are
// constant.
//
// With theta the angle of a ring, h = cos(theta) w + sin(theta) (cos(psi) a + sin(psi) b) and a towards the
// macro normal, dh = sin(theta) dtheta dpsi. What light does at a normal changes abruptly where its way on
// grazes the surface: a bound on h.z, and so on psi. Over theta and psi go coordinates that widen the peaks
// of D: tan(x) of the distance from the macro normal over the roughness, and tan((psi - psi_0) / 2) = q tan(y
// / 2) about a peak at psi_0. D is 1 / F^2 with F = (h.x / u)^2 + (h.y / v)^2 + h.z^2 up to a factor; a ring
// has one peak, or two if the film is anisotropic, and is divided where F is largest.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sunbeam/detail/ggx.h"
#include "sunbeam/detail/quadrature.h"

namespace sunbeam {

class FacetRings {
 public:
  // Holds rules of quadrature: rings of a panel, the film on a part of a panel, and facets of half a ring.
  struct Rules {
    explicit Rules(int nodes);
    const GaussRule& of_width(double share) const;  // of a panel, at most 1

    int panels;  // that rings are divided into
    GaussInterpolation panel;
    std::vector<GaussRule> film;
    GaussRule around, around_peak;  // half a ring, or a peak of an anisotropic film's
  };

  // Says how the light of a direction goes on; `ratio` is n0 / n2 if facets bend it, else 1, and `critical`
  // the cosine with the normal at which it is reflected totally.
  struct Film {
    Roughness roughness;
    double ratio, critical;
  };
  // `edges` are ascending cosines, from 0 to 1, between which the film's powers are smooth.
  FacetRings(const Vec3& w, const Film& film, std::span<const double> edges, const Rules& rules);

  // Int D_vis(h; w) power(w.h) f(h) dh is the sum of weight * power * f(normal), with the power integrated
  // over neighbouring rings.
  struct Node {
    Vec3 normal;
    double weight;
    Rgb power;
  };
  using Power = std::function<Rgb(double cosine)>;
  // Return the normals that mirror w above the horizon, or that let it pass to below.
  std::vector<Node> mirroring(const Power& power) const;
  std::vector<Node> crossing(const Power& power) const;

  // Return the normals of the ring at this angle from w, in rad: those visible from w, and of these the ones
  // that mirror it above the horizon or let it pass to below. Int D_vis f sin(angle) dpsi is the sum of
  // weight * f(normal).
  std::vector<Node> visible_ring(double angle) const { return nodes_of(angle, visible_arc(angle)); }
  std::vector<Node> mirroring_ring(double angle) const { return nodes_of(angle, mirroring_arc(angle)); }
  std::vector<Node> crossing_ring(double angle) const { return nodes_of(angle, crossing_arc(angle)); }

  // Angles go by a coordinate over which D_vis is about as wide at any direction and roughness.
  double coordinate(double angle) const { return std::asinh((angle - tilt_) / width_); }
  double angle_at(double x) const { return tilt_ + width_ * std::sinh(x); }
  double angle_slope(double x) const { return width_ * std::cosh(x); }

 private:
  // Holds the cosines of psi between which a ring counts.
  struct Arc {
    double low, high;
  };
  // Stands for x = low + width smooth_step(t), from <= t <= to.
  struct Panel {
    double low, width, from, to;
    double at(double t) const;
  };

  Arc visible_arc(double angle) const { return {cosine_of_psi(angle, 0), 1}; }
  Arc mirroring_arc(double angle) const { return {cosine_of_psi(angle, w_.z / (2 * std::cos(angle))), 1}; }
  Arc crossing_arc(double angle) const;
  std::vector<Node> nodes_of(double angle, const Arc& arc) const {
    std::vector<Node> nodes;
    add_ring(angle, 1, arc, Rgb(1), nodes);
    return nodes;
  }

  template <class ArcOf>
  std::vector<Node> nodes(std::vector<double> angles, ArcOf arc_of, const Power& power) const;
  std::vector<Rgb> moments(const Panel& panel, const Power& power) const;
  // Holds where D peaks on a ring, and psi between which no other peak lies.
  struct Peak {
    double psi, q, low, high;
  };
  struct Ring;
  Ring ring(double angle) const;
  static double half_width(const Ring& ring, double psi, double end);
  std::vector<Peak> peaks(double angle) const;
  void add_ring(double angle, double weight, const Arc& arc, const Rgb& power,
                std::vector<Node>& nodes) const;
  void add_part(double angle, double weight, const Peak& peak, double low, double high, const Rgb& power,
                const GaussRule& rule, std::vector<Node>& nodes) const;
  Vec3 normal(double angle, double psi) const;
  double angle_of_ridge(double tilt) const;
  double cosine_of_psi(double angle, double normal_z) const;

  Vec3 w_;
  Film film_;
  std::span<const double> edges_;
  const Rules& rules_;
  Ggx ggx_;
  double sine_, tilt_;  // of the angle of w with the macro normal, and the angle
  double width_;        // of D
  Vec3 towards_, aside_;
  Vec3 ridge_;  // the axis of the larger roughness of an anisotropic film
};

}  // namespace sunbeam
