// This file evaluates GGX facets (ggx.h) as look-ups meet them, in single floats: their lobe, and bounded
// visible normals drawn and their density (Eto and Tokuyoshi 2023). All roots and divisions are made several
// at a time.
//
// With h = wo + wi not normalised, l = |h|, q = D's quadratic form of h, r = cosine (1 + 2 Lambda), s = 1 +
// sin_o and a the lesser roughness,
//     D = (u v)^3 l^4 / (pi q^2),  lobe = D G2 / (4 c_o c_i) = D / (2 (r_o c_i + r_i c_o)),
//     pdf = D / (2 (k c_o + r_o)),  k = (1 - a^2) s^2 / (s^2 + a^2 c_o^2).
#pragma once

#include "runtime/src/base/color4.h"
#include "runtime/src/sampling/float_turn.h"
#include "sunbeam/detail/roughness.h"

namespace sunbeam {
inline namespace v1 {

// Returns a unit vector. The floats' length is off by 1e-7, and its inverse by Newton's step from 1 by 1e-14.
inline Vec3 at_azimuth(double cosine, const FloatTurn& phi) {
  const double x{phi.cosine}, y{phi.sine};
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)) * (1.5 - 0.5 * (x * x + y * y));
  return {sine * x, sine * y, cosine};
}

// Holds what does not depend on directions. All is 0 for a smooth film.
struct Facets {
  explicit Facets(const Roughness& roughness)
      : u(static_cast<float>(roughness.u)),
        v(static_cast<float>(roughness.v)),
        u2(static_cast<float>(square(roughness.u))),
        v2(static_cast<float>(square(roughness.v))),
        u2v2(static_cast<float>(square(roughness.u * roughness.v))),
        uv3_per_pi(
            static_cast<float>(square(roughness.u * roughness.v) * roughness.u * roughness.v * kInvPi)),
        least2(std::min(u2, v2)) {}

  float u, v, u2, v2, u2v2, uv3_per_pi, least2;
};

// Holds what one viewer adds; wo.z > 0.
struct FacetViewer {
  FacetViewer(const Facets& facets, const Vec3& wo)
      : x(static_cast<float>(wo.x)), y(static_cast<float>(wo.y)), cosine(static_cast<float>(wo.z)) {
    const float x2 = x * x, y2 = y * y, c2 = cosine * cosine;
    sine2 = x2 + y2;
    const Color4 roots = sqrt4(Color4{cosine, c2 + facets.u2 * x2 + facets.v2 * y2, sine2, 1});
    root = roots[0];
    r = roots[1];
    sine = roots[2];
    const float s2 = (1 + sine) * (1 + sine), bound = s2 + facets.least2 * c2;
    const float part = (1 - facets.least2) * s2 * cosine;
    const float ring_sine = sine2 > 0 ? sine : 1;
    const Color4 quotients = Color4{bound, part, 1, 1} / Color4{2 * (part + bound * r), bound, ring_sine, 1};
    pdf_per_d = quotients[0];
    bottom = quotients[1];
    per_sine = quotients[2];
  }

  // Returns wo mirrored at a visible normal; fewer go below the horizon than with the whole cap. phi is
  // turned from the azimuth of wo, height goes from the cap's top, 0, to its bottom, 1. Stretched to
  // roughness 1, and there all lengths times r, normals lie between wo and a point of the cap, which is
  // uniform in the square. Reflection itself keeps the length of wo to the last digit.
  Vec3 mirrored(const Facets& facets, const Vec3& wo, const FloatTurn& phi, float height) const {
    const float below_top = height * (r + bottom), z = r - below_top;
    const bool is_vertical = sine2 == 0;
    const float ring = std::sqrt(std::max(below_top * (r + z), 0.0f)) * per_sine;
    const float along = is_vertical ? 1 : x, across = y;
    const Vec3 h{double{facets.u * (ring * (phi.cosine * along - phi.sine * across) + facets.u * x)},
                 double{facets.v * (ring * (phi.sine * along + phi.cosine * across) + facets.v * y)},
                 double{std::max(1e-12f, z + cosine)}};
    return (2 * dot(wo, h) / dot(h, h)) * h - wo;
  }

  float x, y, cosine;
  float root;  // of the cosine
  float sine, sine2;
  float per_sine;  // 1 / sine, or 1 along the normal
  float r;         // see above
  float bottom;    // k cosine: the cap reaches down to -bottom
  float pdf_per_d;
};

// Holds the lobe and the density of a pair of directions, both above the horizon.
struct FacetPair {
  FacetPair(const Facets& facets, const FacetViewer& viewer, const Vec3& wo, const Vec3& wi)
      : x(static_cast<float>(wo.x + wi.x)),
        y(static_cast<float>(wo.y + wi.y)),
        z(static_cast<float>(wo.z + wi.z)),
        cosine(static_cast<float>(wi.z)) {
    const auto ix = static_cast<float>(wi.x), iy = static_cast<float>(wi.y);
    const float l2 = x * x + y * y + z * z;
    const Color4 roots =
        sqrt4(Color4{cosine, cosine * cosine + facets.u2 * ix * ix + facets.v2 * iy * iy, l2, 1});
    root = roots[0];
    half_cosine = 0.5f * roots[2];
    const float q = facets.u2v2 * z * z + facets.v2 * x * x + facets.u2 * y * y;
    const float to_lobe = 2 * (viewer.r * cosine + roots[1] * viewer.cosine);
    const Color4 per = Color4{1, 1, 1, 1} / Color4{q, to_lobe, root, 1};
    per_root = per[2];
    l2_per_q = l2 * per[0];
    const float d = facets.uv3_per_pi * l2_per_q * l2_per_q;
    lobe = d * per[1];
    pdf = d * viewer.pdf_per_d;
  }

  float x, y, z;  // of h, not normalised
  float l2_per_q;
  float cosine;       // of wi
  float root;         // of that cosine
  float per_root;     // 1 / root
  float half_cosine;  // between either direction and h
  float lobe;         // without the reflectance, 1/sr
  float pdf;          // of mirrored(), 1/sr
};

// Holds the lobes of four lights of one viewer, a lane each. Lights below the horizon mean nothing and have a
// cosine of 0.
struct FacetLights {
  FacetLights(const Facets& facets, const FacetViewer& viewer, const Vec3& wo, const Vec3* wi)
      : FacetLights(facets, viewer, {wi, &Vec3::x, wo}, {wi, &Vec3::y, wo}, {wi, &Vec3::z, wo}) {}

  Color4 cosine, root, half_cosine;
  Color4 lobe;

 private:
  // Holds one coordinate of the lights and of their h.
  struct Coordinate {
    Coordinate(const Vec3* wi, double Vec3::*at, const Vec3& wo) {
      const Doubles2 low{wi[0].*at, wi[1].*at}, high{wi[2].*at, wi[3].*at};
      light = to_floats(low, high);
      half = to_floats(low + wo.*at, high + wo.*at);
    }
    Color4 light, half;
  };

  FacetLights(const Facets& facets, const FacetViewer& viewer, const Coordinate& cx, const Coordinate& cy,
              const Coordinate& cz)
      : cosine(select(cz.light > 0, cz.light, Color4{})), root(sqrt4(cosine)) {
    const Color4 x2 = cx.half * cx.half, y2 = cy.half * cy.half, z2 = cz.half * cz.half, l2 = x2 + y2 + z2;
    half_cosine = 0.5f * sqrt4(l2);
    const Color4 l2_per_q = l2 / (facets.u2v2 * z2 + facets.v2 * x2 + facets.u2 * y2);
    const Color4 r =
        sqrt4(cosine * cosine + facets.u2 * cx.light * cx.light + facets.v2 * cy.light * cy.light);
    const Color4 d = facets.uv3_per_pi * l2_per_q * l2_per_q;
    lobe = d * (0.5f / (viewer.r * cosine + r * viewer.cosine));  // quotients need not wait for each other
  }
};

}  // namespace v1
}  // namespace sunbeam
