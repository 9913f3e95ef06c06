// The live model where the answer is known in closed form.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "tests/support/airy_reference.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/materials.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

Material bright(Transmission transmission, double roughness, double optical_depth) {
  Material m;
  m.transmission = transmission;
  m.absorption_path = AbsorptionPath::sum;
  m.film_thickness_nm = 420;
  m.film_ior = 1.53;
  m.base_ior = 1.35;
  m.absorption_per_nm = optical_depth / m.pigment_thickness_nm;
  m.albedo = {0.9, 0.7, 0.5};
  m.roughness = roughness;
  return m;
}

// With the "sum" path the base is a product of a function of wi and the same function of wo, so the geometric
// series over visits sums up: rest = s kd / pi A(wi) A(wo) / (1 - kd rho), with s = (n0/n2)^2 (refract) or 1,
//   A(w) = T(w) exp(-tau / mu'),   rho = 2 Int_0^1 mu R_below(mu) exp(-2 tau / mu) dmu.
// R_below has a square-root kink at the critical angle mu_c; mu = mu_c + (1 - mu_c) t^2 smooths it.
struct SmoothSumModel {
  Material m;

  test::AiryReference film(double cosine, double wavelength) const {
    return test::airy_reference(m.exterior_ior, m.film_ior, m.base_ior, m.film_thickness_nm, cosine,
                                wavelength);
  }
  double below(double mu, double wavelength) const {
    if (m.transmission == Transmission::straight)
      return static_cast<double>(film(mu, wavelength).reflectance);
    return static_cast<double>(
        test::airy_reference(m.base_ior, m.film_ior, m.exterior_ior, m.film_thickness_nm, mu, wavelength)
            .reflectance);
  }
  double arriving(const Vec3& w, double wavelength) const {
    const double sine2 = 1 - w.z * w.z, ratio = m.exterior_ior / m.base_ior;
    const double mu = m.transmission == Transmission::straight ? w.z : std::sqrt(1 - ratio * ratio * sine2);
    return static_cast<double>(film(w.z, wavelength).transmittance) * std::exp(-m.optical_depth() / mu);
  }
  double rho(double wavelength) const {
    const bool straight = m.transmission == Transmission::straight;
    const double critical = straight ? 0 : std::sqrt(1 - square(m.exterior_ior / m.base_ior));
    const auto f = [&](double mu) {
      return 2 * mu * below(mu, wavelength) * std::exp(-2 * m.optical_depth() / mu);
    };
    double total = critical > 0 ? test::integrate(0, critical, 200, f) : 0;
    return total + test::integrate(0, 1, 200, [&](double t) {
             return f(critical + (1 - critical) * t * t) * 2 * t * (1 - critical);
           });
  }
  double rest(const Vec3& wo, const Vec3& wi, int channel) const {
    const double wavelength = Wavelengths::rgb3(m).nm[channel], kd = m.albedo[channel];
    const double scale = m.transmission == Transmission::straight ? 1 : square(m.exterior_ior / m.base_ior);
    return scale * kd / kPi * arriving(wi, wavelength) * arriving(wo, wavelength) /
           (1 - kd * rho(wavelength));
  }
};

// 2 modes x 3 depths x 2 pairs x 3 channels at 4.5 standard errors (7e-6): 2.5e-4 in all.
TEST(Exact, SmoothSumIsRankOne) {
  const Vec3 pairs[][2] = {{spherical_direction(0.2, 0), spherical_direction(0.9, 2)},
                           {spherical_direction(1.2, 0), spherical_direction(0.5, 1)}};
  for (const auto transmission : {Transmission::straight, Transmission::refract})
    for (const double depth : {0.0, 0.1, 1.0})
      for (const auto& pair : pairs) {
        const SmoothSumModel model{bright(transmission, 0, depth)};
        const Pfmc pfmc(model.m);
        Rng rng(1, 0);
        test::RgbMean mean;
        for (int i = 0; i < 20000; ++i) mean.add(pfmc.estimate_rest(pair[0], pair[1], rng));
        for (int c = 0; c < 3; ++c) {
          const double expected = model.rest(pair[0], pair[1], c);
          EXPECT_NEAR(mean[c].mean(), expected, 4.5 * mean[c].std_error() + 1e-9 * expected)
              << to_string(transmission) << " tau " << depth << " channel " << c;
          EXPECT_LT(mean[c].std_error(), 0.003 * expected);
        }
      }
}

// Any film is rank one with "sum": rest(a, b) rest(c, d) = rest(a, d) rest(c, b). 2 x 3 tests at 4.5 standard
// errors.
TEST(Exact, RoughSumHasRankOneCrossRatio) {
  const Vec3 a = spherical_direction(0.2, 0), b = spherical_direction(0.9, 2),
             c = spherical_direction(1.1, 0.5), d = spherical_direction(0.5, 3);
  for (const auto transmission : {Transmission::straight, Transmission::refract}) {
    const Pfmc pfmc(bright(transmission, 0.3, 0.1));
    const Vec3 pairs[4][2] = {{a, b}, {c, d}, {a, d}, {c, b}};
    test::RgbMean mean[4];
    for (int k = 0; k < 4; ++k) {
      Rng rng(2, k);
      for (int i = 0; i < 40000; ++i) mean[k].add(pfmc.estimate_rest(pairs[k][0], pairs[k][1], rng));
    }
    for (int ch = 0; ch < 3; ++ch) {
      double error2 = 0;
      for (const auto& m : mean) error2 += square(m[ch].std_error() / m[ch].mean());
      const double ratio =
          mean[0][ch].mean() * mean[1][ch].mean() / (mean[2][ch].mean() * mean[3][ch].mean());
      EXPECT_NEAR(ratio, 1, 4.5 * std::sqrt(error2)) << to_string(transmission) << " channel " << ch;
      EXPECT_LT(error2, square(0.005));
    }
  }
}

// No film at all: eval is albedo / pi exactly, the pigment's attenuation besides.
TEST(Exact, IndexMatchedIsThePlainBase) {
  for (const auto path : {AbsorptionPath::product, AbsorptionPath::sum})
    for (const double depth : {0.0, 0.4}) {
      Material m = bright(Transmission::refract, 0, depth);
      m.absorption_path = path;
      m.film_thickness_nm = 0;
      m.film_ior = m.base_ior = m.exterior_ior = 1;
      const LiveBsdf bsdf(m);
      Rng rng(6, 0);
      for (const double a : {0.1, 0.9, 1.4})
        for (const double b : {0.3, 1.2}) {
          const Rgb f = bsdf.eval(spherical_direction(a, 0), spherical_direction(b, 2), rng);
          const double length = path == AbsorptionPath::sum ? 1 / std::cos(a) + 1 / std::cos(b)
                                                            : 1 / (std::cos(a) * std::cos(b));
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], m.albedo[c] / kPi * std::exp(-depth * length), 1e-12);
        }
    }
}

// A black base leaves the first surface only, and a dirac() that is the film's reflectance.
TEST(Exact, BlackBaseHasNoRest) {
  for (auto [name, m] : test::all_modes()) {
    m.albedo = Rgb(0);
    const Pfmc pfmc(m);
    Rng rng(7, 0);
    const Vec3 wo = spherical_direction(0.4, 0), wi = spherical_direction(0.6, 2);
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_black(pfmc.estimate_rest(wo, wi, rng))) << name;
    const double expected = static_cast<double>(
        test::airy_reference(1, m.film_ior, m.base_ior, m.film_thickness_nm, wo.z, 510).reflectance);
    EXPECT_NEAR(pfmc.dirac(wo).g, m.is_smooth() ? expected : 0, 1e-12) << name;
  }
}

// The half vector of a crossing is 0/0 at n2 = n0: values and noise pass through it continuously. From n2 = 1
// to 1.0001 the physics moves by some 1e-4, to 1.01 by some per cent (the radiance factor alone by 2 %).
TEST(Exact, RoughRefractionIsContinuousAtEqualIndices) {
  struct Step {
    double base_ior, allowed;
  };
  const Vec3 pairs[][2] = {{spherical_direction(0.3, 0), spherical_direction(0.7, 2)},
                           {spherical_direction(1.2, 0), spherical_direction(0.9, kPi)}};
  for (const double roughness : {0.1, 0.4})
    for (const auto& pair : pairs) {
      const auto run = [&](double base_ior) {
        Material m = bright(Transmission::refract, roughness, 0.1);
        m.base_ior = base_ior;
        const Pfmc pfmc(m);
        Rng rng(8, 0);
        test::RunningMean mean;
        for (int i = 0; i < 20000; ++i) mean.add(pfmc.estimate_rest(pair[0], pair[1], rng).g);
        return mean;
      };
      const auto at_one = run(1);
      for (const Step& step :
           {Step{1 + 1e-8, 0}, Step{1 + 1e-6, 0.001}, Step{1.0001, 0.002}, Step{1.01, 0.06}}) {
        const auto near_one = run(step.base_ior);
        EXPECT_NEAR(near_one.mean(), at_one.mean(),
                    4.5 * std::hypot(near_one.std_error(), at_one.std_error()) + step.allowed * at_one.mean())
            << step.base_ior << " roughness " << roughness;
        EXPECT_LT(near_one.variance(), 3 * at_one.variance()) << step.base_ior << " roughness " << roughness;
        EXPECT_GT(near_one.variance(), at_one.variance() / 3) << step.base_ior << " roughness " << roughness;
      }
      EXPECT_LT(at_one.std_error(), 0.005 * at_one.mean());
    }
}

}  // namespace
}  // namespace sunbeam
