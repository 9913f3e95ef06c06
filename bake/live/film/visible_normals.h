// This file gives the GGX normals (sunbeam/detail/ggx.h) visible from one direction in coordinates for a
// quadrature. What light does there changes smoothly between the edges that are given.
//
// The normals visible from w, by stretching the surface to roughness 1, where their density over half the
// angle between w and its mirror image is uniform (Heitz 2018): polar angle about the stretched w, azimuth
// from the horizon nearest to it. A normal is k / |k|, k = k0 + k1(azimuth) tan(polar), and conics cross the
// normals where what the light does changes abruptly:
//   cones      w.k = c |k|: total reflection at the base, and at the film where light tunnels beyond it;
//   rim        m.z = 0 for light refracted to k ~ ratio w - m, ratio = n0 / n2 > 1. In slopes k.x / k.z and
//              k.y / k.z a circle about w. Only its arc with m.k > 0 is real; the rest costs a few nodes and
//              no error.
// Along k each is a quadratic in tan(polar). If the film is isotropic, azimuths in [0, pi] stand for all.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bake/optics/thin_film.h"
#include "sunbeam/detail/ggx.h"

namespace sunbeam {

// Returns the cosine of total reflection at the film's base, as seen from its exterior; 0 if there is none.
inline double critical_cosine(const ThinFilm& film) {
  return critical_cosine(film.exterior_ior, film.base_ior);
}

class VisibleNormals {
 public:
  // `ratio` is n0 / n2 if facets bend light, else 1.
  VisibleNormals(const Vec3& w, const Roughness& roughness, const ThinFilm& film, double ratio);

  Vec3 normal(double polar, double azimuth) const {
    const Vec3 k = std::cos(polar) * k0() + std::sin(polar) * k1(azimuth);
    return normalize({k.x, k.y, std::max(0.0, k.z)});
  }

  // Returns the density over polar angle and azimuth, between the first and the last of azimuth_edges().
  double density(double polar) const {
    return (is_halved() ? 2 : 1) * std::sin(2 * polar) / (kPi * (1 + axis_.z));
  }

  // Returns the azimuths between which the bounds of polar_edges() are smooth: the horizon is met between -pi
  // / 2 and pi / 2; a conic is touched by two, and two go through where it leaves the horizon or its arc
  // ends.
  std::vector<double> azimuth_edges() const;

  // Returns 0, where the conics begin and end, and the horizon; ascending.
  std::array<double, 8> polar_edges(double azimuth) const;

  // Returns the polar angle, at most `end`, up to which w is mirrored above the horizon. Such normals are a
  // convex set, which holds the axis and no rim.
  double mirrored_end(double azimuth, double end) const;

 private:
  // Describes a cone of normals k: there the symmetric bilinear form of k with itself vanishes.
  struct Conic {
    Vec3 w;
    double cone, ratio;  // one of them is 0

    // Evaluates the form, which is 0 for w.k = cone |k|, or for |(k.x, k.y) w.z - k.z (w.x, w.y)| = k.z /
    // ratio.
    double operator()(const Vec3& a, const Vec3& b) const {
      if (cone > 0) return dot(a, b) - dot(w, a) * dot(w, b) / square(cone);
      const auto x = [&](const Vec3& k) { return k.x * w.z - k.z * w.x; };
      const auto y = [&](const Vec3& k) { return k.y * w.z - k.z * w.y; };
      return x(a) * x(b) + y(a) * y(b) - a.z * b.z / square(ratio);
    }
  };
  // Stands for c + 2 b t + a t^2, t = tan(polar).
  struct Quadratic {
    double c, b, a;
  };

  bool is_halved() const { return roughness_.is_isotropic(); }
  double sine_of_w() const { return std::hypot(w_.x, w_.y); }
  Vec3 stretched(const Vec3& a) const { return {roughness_.u * a.x, roughness_.v * a.y, a.z}; }
  Vec3 k0() const { return stretched(axis_); }
  Vec3 k1(double azimuth) const {
    return stretched(std::cos(azimuth) * forward_ + std::sin(azimuth) * sideways_);
  }
  double azimuth_of(const Vec3& k) const;
  static void cut(const Quadratic& q, double end, double* edges);
  std::vector<double> tangents(const Conic& conic) const;
  std::vector<double> ends(const Conic& conic) const;

  Vec3 w_;
  Roughness roughness_;
  double ratio_;
  Vec3 axis_, forward_, sideways_;  // of the stretched space: w, towards the horizon, along the horizon
  std::vector<Conic> conics_;
};

}  // namespace sunbeam
