// This file holds the GGX roughness along the two tangents of the shading frame.
#pragma once

namespace sunbeam {
inline namespace v1 {

// Below this roughness a film would be numerically a mirror.
inline constexpr double kMinRoughness = 1e-3;

struct Roughness {
  double u = 0;  // alpha along x
  double v = 0;  // alpha along y

  constexpr Roughness(double alpha = 0) : u(alpha), v(alpha) {}
  constexpr Roughness(double alpha_u, double alpha_v) : u(alpha_u), v(alpha_v) {}

  // Says whether it is smooth (0, 0), or both lie between kMinRoughness and 1.
  constexpr bool is_allowed() const {
    const auto is_rough = [](double alpha) { return alpha >= kMinRoughness && alpha <= 1; };
    return (u == 0 && v == 0) || (is_rough(u) && is_rough(v));
  }
  constexpr bool is_isotropic() const { return u == v; }
  constexpr bool operator==(const Roughness&) const = default;
};

}  // namespace v1
}  // namespace sunbeam
