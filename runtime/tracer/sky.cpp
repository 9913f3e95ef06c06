#include "runtime/tracer/sky.h"

#include <fmt/format.h>

#include <array>

#include "sunbeam/core/color_space.h"
#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr double kSunAngularRadius = 0.53 / 2 * kPi / 180;
constexpr double kLumensPerWatt = 683;

void check(const Sky& sky) {
  const Vec3& sun = sky.sun_direction;
  if (!std::isfinite(length(sun)) || !(length(sun) > 0) || sun.z < 0)
    throw Error(
        fmt::format("sky: the direction to the sun is [{:g}, {:g}, {:g}]; allowed: z from 0, not all zero",
                    sun.x, sun.y, sun.z));
  if (!(sky.turbidity >= 2 && sky.turbidity <= 10))
    throw Error(fmt::format("sky: found turbidity {:g}; allowed: 2 to 10", sky.turbidity));
  for (int channel = 0; channel < 3; ++channel)
    if (!(sky.ground_albedo[channel] >= 0 && sky.ground_albedo[channel] <= 1))
      throw Error(fmt::format("sky: found ground albedo {:g}; allowed: 0 to 1", sky.ground_albedo[channel]));
  if (!(sky.scale > 0) || !std::isfinite(sky.scale))
    throw Error(fmt::format("sky: found scale {:g}; allowed: above 0", sky.scale));
}

Rgb rec709(const ColorMatrix& from_xyz, const Vec3& xyz) {
  return clip_negative(from_xyz * Rgb{xyz.x, xyz.y, xyz.z}, ColorSpace::rec709).clipped;
}

// Perez's relative luminance; here also of chromaticities.
struct Perez {
  double a, b, c, d, e;

  double operator()(double cos_theta, double gamma) const {
    return (1 + a * std::exp(b / cos_theta)) * (1 + c * std::exp(d * gamma) + e * square(std::cos(gamma)));
  }
};

// Coefficients linear in turbidity, appendix A.2.
Perez luminance_shape(double t) {
  return {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
          -0.0670 * t + 0.3703};
}
Perez x_shape(double t) {
  return {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
          -0.0033 * t + 0.0452};
}
Perez y_shape(double t) {
  return {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
          -0.0109 * t + 0.0529};
}

// Values at the zenith, the sun `s` radians from it.
double zenith_luminance(double t, double s) {
  return (4.0453 * t - 4.9710) * std::tan((4.0 / 9 - t / 120) * (kPi - 2 * s)) - 0.2155 * t + 2.4192;
}

double cubic(double s, double c3, double c2, double c1, double c0) {
  return ((c3 * s + c2) * s + c1) * s + c0;
}

double zenith_x(double t, double s) {
  return t * t * cubic(s, 0.00166, -0.00375, 0.00209, 0) +
         t * cubic(s, -0.02903, 0.06377, -0.03202, 0.00394) + cubic(s, 0.11693, -0.21196, 0.06052, 0.25886);
}
double zenith_y(double t, double s) {
  return t * t * cubic(s, 0.00275, -0.00610, 0.00317, 0) +
         t * cubic(s, -0.04214, 0.08970, -0.04153, 0.00516) + cubic(s, 0.15346, -0.26756, 0.06670, 0.26688);
}

// A quantity over the sky: its shape times what it is at the zenith.
class Quantity {
 public:
  Quantity(const Perez& shape, double zenith, double sun_theta)
      : shape_(shape), factor_(zenith / shape(1, sun_theta)) {}
  double operator()(double cos_theta, double gamma) const { return factor_ * shape_(cos_theta, gamma); }

 private:
  Perez shape_;
  double factor_;
};

class ClearSky {
 public:
  explicit ClearSky(const Sky& sky)
      : sun_(normalize(sky.sun_direction)),
        scale_(sky.scale),
        luminance_(luminance_shape(sky.turbidity), zenith_luminance(sky.turbidity, theta()), theta()),
        x_(x_shape(sky.turbidity), zenith_x(sky.turbidity, theta()), theta()),
        y_(y_shape(sky.turbidity), zenith_y(sky.turbidity, theta()), theta()) {}

  Rgb radiance(const Vec3& w) const {
    const double cos_theta = std::max(w.z, kHorizon);
    const double gamma = std::acos(std::clamp(dot(w, sun_), -1.0, 1.0));
    const double luminance = luminance_(cos_theta, gamma), x = x_(cos_theta, gamma), y = y_(cos_theta, gamma);
    return scale_ * rec709(from_xyz_, luminance / y * Vec3{x, y, 1 - x - y});
  }

 private:
  static constexpr double kHorizon = 1e-6;  // keeps exp(b / cos) from 0 / 0; the limit is reached long before

  double theta() const { return std::acos(std::clamp(sun_.z, -1.0, 1.0)); }

  Vec3 sun_;
  double scale_;
  Quantity luminance_, x_, y_;
  ColorMatrix from_xyz_ = inverse(rgb_to_xyz(ColorSpace::rec709));
};

// Of sunlight, 380 to 750 nm.
struct SolarEntry {
  double radiance;  // above the atmosphere, W/(m^2 sr nm)
  double ozone;     // absorption, 1/cm
  double water;     // absorption of vapour, 1/cm
};
constexpr double kFirstNm = 380, kStepNm = 10;
// clang-format off
constexpr std::array<SolarEntry, 38> kSolar = {{
    {16559.0, 0.0008, 0}, {16233.7, 0.0012, 0}, {21127.5, 0.0015, 0}, {25888.2, 0.0018, 0},  // 380 nm
    {25829.1, 0.0022, 0}, {24232.3, 0.0025, 0}, {26760.5, 0.0028, 0}, {29658.3, 0.003, 0},
    {30545.4, 0.006, 0}, {30057.5, 0.009, 0}, {30663.7, 0.014, 0}, {28830.4, 0.021, 0},      // 460 nm
    {28712.1, 0.030, 0}, {27825.0, 0.040, 0}, {27100.6, 0.048, 0}, {27233.6, 0.063, 0},
    {26361.3, 0.075, 0}, {25503.8, 0.085, 0}, {25060.2, 0.103, 0}, {25311.6, 0.120, 0},      // 540 nm
    {25355.9, 0.120, 0}, {25134.2, 0.115, 0}, {24631.5, 0.125, 0}, {24173.2, 0.120, 0},
    {23685.3, 0.105, 0}, {23212.1, 0.090, 0}, {22827.7, 0.079, 0}, {22339.8, 0.067, 0},      // 620 nm
    {21970.2, 0.057, 0}, {21526.7, 0.048, 0}, {21097.9, 0.036, 0}, {20728.3, 0.028, 0.016},
    {20240.4, 0.023, 0.024}, {19870.8, 0.018, 0.0125}, {19427.2, 0.014, 1}, {19072.4, 0.011, 0.87},  // 700 nm
    {18628.9, 0.010, 0.061}, {18259.2, 0.009, 0.001}}};
// clang-format on

// Share of sunlight that arrives, appendix A.1: Rayleigh scattering, Angstrom's turbidity formula for
// aerosols, 0.35 cm of ozone, 2 cm of vapour. Mixed gases absorb beyond 759 nm only.
double transmittance(double nm, const SolarEntry& entry, double turbidity, double air_mass) {
  const double um = nm / 1000;
  const double beta = 0.04608 * turbidity - 0.04586;
  const double water = 2 * entry.water * air_mass;
  return std::exp(-air_mass *
                      (0.008735 * std::pow(um, -4.08) + beta * std::pow(um, -1.3) + 0.35 * entry.ozone) -
                  0.2385 * water / std::pow(1 + 20.07 * water, 0.45));
}

// A peak of width s1 below and s2 above its centre, nm.
double peak(double nm, double height, double center, double s1, double s2) {
  return height * std::exp(-square((nm - center) / (nm < center ? s1 : s2)) / 2);
}

// CIE 1931 observer, x-bar, y-bar, z-bar, by the fit of Wyman, Sloan, Shirley, JCGT 2(2), 2013, equation 4.
Vec3 observer_fit(double nm) {
  return {peak(nm, 1.056, 599.8, 37.9, 31.0) + peak(nm, 0.362, 442.0, 16.0, 26.7) +
              peak(nm, -0.065, 501.1, 20.4, 26.2),
          peak(nm, 0.821, 568.8, 46.9, 40.5) + peak(nm, 0.286, 530.9, 16.3, 31.1),
          peak(nm, 1.217, 437.0, 11.8, 36.0) + peak(nm, 0.681, 459.0, 26.0, 13.8)};
}

// Of Kasten's formula, for the cosine of the angle from the zenith.
double relative_air_mass(double cos_theta) {
  const double degrees = std::acos(cos_theta) * 180 / kPi;
  return 1 / (cos_theta + 0.15 * std::pow(93.885 - degrees, -1.253));
}

// Arriving from the sky on level ground. `map` holds the sky above the horizon; rows have their own weights
// of cosine and solid angle, so that a row that crosses the horizon counts by its upper part.
Rgb sky_irradiance(const Image& map) {
  Rgb sum;
  for (int y = 0; 2 * y < map.height; ++y) {
    const auto squared_sine = [&](int edge) {
      return square(std::sin(std::min(kPi * edge / map.height, kPi / 2)));
    };
    const double weight = (squared_sine(y + 1) - squared_sine(y)) / 2 * 2 * kPi / map.width;
    for (int x = 0; x < map.width; ++x) sum += weight * map.get(x, y);
  }
  return sum;
}

// Centre of a texel, by the mapping of EnvironmentSource.
Vec3 texel_direction(const Image& map, int x, int y) {
  return spherical_direction(kPi * (y + 0.5) / map.height, kPi * (1 - 2 * (x + 0.5) / map.width));
}

}  // namespace

Rgb sky_radiance(const Sky& sky, const Vec3& w) {
  check(sky);
  return ClearSky(sky).radiance(w);
}

Image sky_map(const Sky& sky, int width, int height) {
  const SunLight sun = sun_light(sky);  // checks
  const ClearSky clear(sky);
  Image map(width, height);
  const int first_below = (height + 1) / 2;  // a row on the horizon shows sky
  for (int y = 0; y < first_below; ++y)
    for (int x = 0; x < width; ++x) map.set(x, y, clear.radiance(texel_direction(map, x, y)));
  const Rgb irradiance = sky_irradiance(map) + sun.irradiance * sun.direction.z;
  const Rgb ground = sky.ground_albedo * irradiance * kInvPi;
  for (int y = first_below; y < height; ++y)
    for (int x = 0; x < width; ++x) map.set(x, y, ground);
  return map;
}

SunLight sun_light(const Sky& sky) {
  check(sky);
  const Vec3 direction = normalize(sky.sun_direction);
  const double air_mass = relative_air_mass(std::min(direction.z, 1.0));
  Vec3 xyz;
  for (std::size_t k = 0; k < kSolar.size(); ++k) {
    const double nm = kFirstNm + kStepNm * static_cast<double>(k);
    const double spectral = kSolar[k].radiance * transmittance(nm, kSolar[k], sky.turbidity, air_mass);
    xyz = xyz + kStepNm * spectral * observer_fit(nm);
  }
  const Rgb radiance =
      sky.scale * kLumensPerWatt / 1000 * rec709(inverse(rgb_to_xyz(ColorSpace::rec709)), xyz);
  const double solid_angle = 2 * kPi * (1 - std::cos(kSunAngularRadius));
  return {direction, kSunAngularRadius, radiance, solid_angle * radiance};
}

}  // namespace sunbeam
