// This file holds directions, points and linear colours: three components each, in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunbeam {
inline namespace v1 {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInvPi = std::numbers::inv_pi;

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(const Vec3& a, double s) { return s * a; }
constexpr Vec3 operator/(const Vec3& a, double s) { return (1 / s) * a; }
constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(const Vec3& a) { return a / length(a); }

// Returns the mirror image of `w` about the axis `h`; both point away from the surface, |h| = 1.
constexpr Vec3 reflect(const Vec3& w, const Vec3& h) { return 2 * dot(w, h) * h - w; }

// Returns the direction with polar angle `theta` from +z and azimuth `phi` from +x, in radians.
inline Vec3 spherical_direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Does the same from the cosine of the polar angle.
inline Vec3 direction_from_cosine(double cos_theta, double phi) {
  const double sin_theta = std::sqrt(std::max(0.0, 1 - cos_theta * cos_theta));
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}

// A linear colour, or one value for each of the three wavelengths that are carried together.
struct Rgb {
  double r = 0, g = 0, b = 0;

  constexpr Rgb() = default;
  constexpr Rgb(double red, double green, double blue) : r(red), g(green), b(blue) {}
  constexpr explicit Rgb(double grey) : r(grey), g(grey), b(grey) {}

  constexpr double& operator[](int channel) { return channel == 0 ? r : channel == 1 ? g : b; }
  constexpr double operator[](int channel) const { return channel == 0 ? r : channel == 1 ? g : b; }
  constexpr Rgb& operator+=(const Rgb& o) { return *this = {r + o.r, g + o.g, b + o.b}; }
  constexpr Rgb& operator*=(const Rgb& o) { return *this = {r * o.r, g * o.g, b * o.b}; }
  constexpr Rgb& operator*=(double s) { return *this = {r * s, g * s, b * s}; }
  constexpr bool operator==(const Rgb&) const = default;
};

constexpr Rgb operator+(Rgb a, const Rgb& b) { return a += b; }
constexpr Rgb operator-(const Rgb& a, const Rgb& b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
constexpr Rgb operator*(Rgb a, const Rgb& b) { return a *= b; }
constexpr Rgb operator*(Rgb a, double s) { return a *= s; }
constexpr Rgb operator*(double s, Rgb a) { return a *= s; }
constexpr Rgb operator/(const Rgb& a, const Rgb& b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
constexpr Rgb operator/(const Rgb& a, double s) { return a * (1 / s); }
constexpr double mean(const Rgb& a) { return (a.r + a.g + a.b) / 3; }
constexpr double max_component(const Rgb& a) { return std::max({a.r, a.g, a.b}); }
constexpr bool is_black(const Rgb& a) { return a.r == 0 && a.g == 0 && a.b == 0; }
inline bool is_finite(const Rgb& a) { return std::isfinite(a.r) && std::isfinite(a.g) && std::isfinite(a.b); }
template <class F>
constexpr Rgb transform(const Rgb& a, F f) {
  return {f(a.r), f(a.g), f(a.b)};
}

constexpr double square(double x) { return x * x; }
constexpr double lerp(double t, double a, double b) { return a + t * (b - a); }

}  // namespace v1
}  // namespace sunbeam
