// This file holds the GGX microfacet distribution with Smith masking, which the live model and the tables
// share.
//
// This is the reference form: scalar, double precision, anisotropic, directions as vectors. Other forms of
// the same D, Lambda, G1, G2 and D_vis are written where lanes, precision or an integral ask for them: in
// polar cosines, as the rate of a medium, as a mean over turns of a facet, as coordinates of a quadrature
// over visible normals, in single floats. Each says so in its first lines.
//
// Frame: local, macro normal = z; roughness.u along x, roughness.v along y. `w` and `h` are unit vectors;
// w.z > 0. Roughness is the GGX alpha itself (not its square), > 0. Sources: Walter et al. 2007; Heitz 2014
// (Smith, height-correlated); Dupuy and Benyoub
// 2023 (visible normals by spherical caps).
#pragma once

#include "sunbeam/core/vec.h"
#include "sunbeam/detail/roughness.h"
#include "sunbeam/detail/warp.h"

namespace sunbeam {
inline namespace v1 {

class Ggx {
 public:
  explicit Ggx(const Roughness& roughness)
      : u_(roughness.u), v_(roughness.v), u2_(u_ * u_), v2_(v_ * v_), uv3_(u2_ * u_ * v2_ * v_) {}

  // Returns the density of microfacet normals, 1/sr: Int D(h) cos(h) dh = 1. It is written without cos^2 - 1
  // so that a narrow lobe keeps its precision near the pole.
  double d(const Vec3& h) const {
    if (h.z <= 0) return 0;
    return uv3_ / (kPi * square(u2_ * v2_ * h.z * h.z + v2_ * h.x * h.x + u2_ * h.y * h.y));
  }

  // Returns Smith's Lambda of a direction on either side (only |w.z| matters).
  double lambda(const Vec3& w) const {
    const double slope2 = (u2_ * w.x * w.x + v2_ * w.y * w.y) / (w.z * w.z);
    return (std::sqrt(1 + slope2) - 1) / 2;
  }

  double g1(const Vec3& w) const { return 1 / (1 + lambda(w)); }

  // Returns the height-correlated masking-shadowing; by definition of the model the same form serves
  // transmission.
  double g2(const Vec3& a, const Vec3& b) const { return 1 / (1 + lambda(a) + lambda(b)); }

  // Returns G2(a, b) / G1(a).
  double g2_over_g1(const Vec3& a, const Vec3& b) const {
    const double la = lambda(a);
    return (1 + la) / (1 + la + lambda(b));
  }

  // Returns D_vis(h; w) = G1(w) max(0, w.h) D(h) / cos(w), the density of normals seen from w, 1/sr over h.
  double visible_pdf(const Vec3& w, const Vec3& h) const {
    return g1(w) * std::max(0.0, dot(w, h)) * d(h) / w.z;
  }

  // Draws a normal with density D_vis(h; w).
  Vec3 sample_visible(const Vec3& w, const Point2& u) const {
    const Vec3 stretched = normalize({u_ * w.x, v_ * w.y, w.z});
    const double phi = 2 * kPi * u.x;
    const double z = (1 - u.y) * (1 + stretched.z) - stretched.z;
    const double sin_theta = std::sqrt(std::max(0.0, 1 - z * z));
    const Vec3 cap = Vec3{sin_theta * std::cos(phi), sin_theta * std::sin(phi), z} + stretched;
    return normalize({u_ * cap.x, v_ * cap.y, std::max(1e-12, cap.z)});
  }

  // Draws `w` mirrored at a visible normal, with density reflection_pdf_bounded(): fewer than by
  // sample_visible() go below the horizon (Eto and Tokuyoshi 2023). u.x turns from the azimuth of w.
  Vec3 sample_mirrored(const Vec3& w, const Point2& u) const {
    const double sine2 = w.x * w.x + w.y * w.y, r = root(w), bottom = bound(w) * w.z;
    const double z = (1 - u.y) * (r + bottom) - bottom;  // lengths in the stretched space are times r
    const Turn phi(u.x);
    const double ring = std::sqrt(std::max(0.0, r * r - z * z) / (sine2 > 0 ? sine2 : 1));
    const double x = sine2 > 0 ? w.x : 1, y = w.y;
    const Vec3 h{u_ * (ring * (phi.cosine * x - phi.sine * y) + u_ * w.x),
                 v_ * (ring * (phi.sine * x + phi.cosine * y) + v_ * w.y), std::max(1e-12, z + w.z)};
    return (2 * dot(w, h) / dot(h, h)) * h - w;
  }
  // Returns the density of sample_mirrored(), 1/sr; `h` is the half vector.
  double reflection_pdf_bounded(const Vec3& wo, const Vec3& h) const {
    return d(h) / (2 * (bound(wo) * wo.z + root(wo)));
  }
  // Returns the factor of the cap's lower end.
  double bound(const Vec3& w) const {
    const double alpha = std::min(u_, v_);
    const double s2 = square(1 + std::sqrt(std::max(0.0, w.x * w.x + w.y * w.y)));
    return (1 - alpha * alpha) * s2 / (s2 + alpha * alpha * w.z * w.z);
  }
  // Returns cosine (1 + 2 Lambda).
  double root(const Vec3& w) const { return std::sqrt(w.z * w.z + u2_ * w.x * w.x + v2_ * w.y * w.y); }

  // Returns the lobe of a reflecting surface without its reflectance: D(h) G2 / (4 cos_o cos_i), 1/sr.
  double reflection(const Vec3& wo, const Vec3& wi, const Vec3& h) const {
    return d(h) * g2(wo, wi) / (4 * wo.z * wi.z);
  }

  // Returns the density over wi of reflecting wo at a visible normal, 1/sr: D_vis(h; wo) / (4 wo.h).
  double reflection_pdf(const Vec3& wo, const Vec3& h) const { return g1(wo) * d(h) / (4 * wo.z); }

 private:
  double u_, v_, u2_, v2_, uv3_;
};

}  // namespace v1
}  // namespace sunbeam
