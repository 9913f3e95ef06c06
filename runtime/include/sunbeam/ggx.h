// The isotropic GGX microfacet distribution with Smith masking, shared by the live model and the tables.
//
// Frame: local, macro normal = z. `w` and `h` are unit vectors; w.z > 0. `alpha` is the GGX roughness itself
// (not its square), > 0. Sources: Walter et al. 2007; Heitz 2014 (Smith, height-correlated); Dupuy and
// Benyoub 2023 (sampling visible normals by spherical caps).
#pragma once

#include "sunbeam/core/vec.h"
#include "sunbeam/core/warp.h"

namespace sunbeam {

class Ggx {
 public:
  explicit Ggx(double alpha) : alpha_(alpha), alpha2_(alpha * alpha) {}

  double alpha() const { return alpha_; }

  // Density of microfacet normals, 1/sr: Int D(h) cos(h) dh = 1. Written with sin^2 so that a narrow lobe
  // keeps its precision near the pole.
  double d(const Vec3& h) const {
    if (h.z <= 0) return 0;
    const double sin2 = h.x * h.x + h.y * h.y;
    return alpha2_ / (kPi * square(alpha2_ * h.z * h.z + sin2));
  }

  // Smith's Lambda of a direction on either side (only |w.z| matters).
  double lambda(const Vec3& w) const {
    const double cos2 = w.z * w.z;
    const double sin2 = w.x * w.x + w.y * w.y;
    return (std::sqrt(1 + alpha2_ * sin2 / cos2) - 1) / 2;
  }

  double g1(const Vec3& w) const { return 1 / (1 + lambda(w)); }

  // Height-correlated masking-shadowing; by definition of the model the same form serves transmission.
  double g2(const Vec3& a, const Vec3& b) const { return 1 / (1 + lambda(a) + lambda(b)); }

  // G2(a, b) / G1(a).
  double g2_over_g1(const Vec3& a, const Vec3& b) const {
    const double la = lambda(a);
    return (1 + la) / (1 + la + lambda(b));
  }

  // D_vis(h; w) = G1(w) max(0, w.h) D(h) / cos(w): density of normals seen from w, 1/sr over h.
  double visible_pdf(const Vec3& w, const Vec3& h) const {
    return g1(w) * std::max(0.0, dot(w, h)) * d(h) / w.z;
  }

  // A normal with density D_vis(h; w).
  Vec3 sample_visible(const Vec3& w, const Point2& u) const {
    const Vec3 stretched = normalize({alpha_ * w.x, alpha_ * w.y, w.z});
    const double phi = 2 * kPi * u.x;
    const double z = (1 - u.y) * (1 + stretched.z) - stretched.z;
    const double sin_theta = std::sqrt(std::max(0.0, 1 - z * z));
    const Vec3 cap = Vec3{sin_theta * std::cos(phi), sin_theta * std::sin(phi), z} + stretched;
    return normalize({alpha_ * cap.x, alpha_ * cap.y, std::max(1e-12, cap.z)});
  }

  // The lobe of a reflecting surface without its reflectance: D(h) G2 / (4 cos_o cos_i), 1/sr.
  double reflection(const Vec3& wo, const Vec3& wi, const Vec3& h) const {
    return d(h) * g2(wo, wi) / (4 * wo.z * wi.z);
  }

  // Density over wi of reflecting wo at a visible normal, 1/sr: D_vis(h; wo) / (4 wo.h).
  double reflection_pdf(const Vec3& wo, const Vec3& h) const { return g1(wo) * d(h) / (4 * wo.z); }

 private:
  double alpha_, alpha2_;
};

}  // namespace sunbeam
