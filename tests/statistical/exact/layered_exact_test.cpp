// The deterministic evaluators on layered films: against closed forms, single films, and finer nodes.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/exact/exact_bsdf.h"
#include "sunbeam/core/rng.h"
#include "sunbeam/detail/film_stack.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/layered_films.h"
#include "tests/support/materials.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

const ExactResolution kFine{14, 36, 18, 24, 40};

ExactRest exact_of(const test::LayeredFilm& design, const ExactResolution& resolution = {}) {
  return ExactRest(design.material, design.wavelengths, resolution);
}

void expect_relative(const Rgb& value, const Rgb& expected, double tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(value[c], expected[c], tolerance * std::abs(expected[c])) << what << " channel " << c;
}

FilmStack stack_of(const test::LayeredFilm& design, std::size_t k) {
  const Material& m = design.material;
  return {m.exterior_ior, design.wavelengths.layers[k], m.base_ior, design.wavelengths.film_periods};
}

// Reflectance from below at a cosine there.
double below(const FilmStack& stack, bool is_straight, double cosine, double nm) {
  if (is_straight)
    return reflectance_below(stack, cosine, nm).value_or(stack_power(stack, cosine, nm).reflectance);
  const FilmStack reversed{stack.base_index.real(),
                           {stack.layers.rbegin(), stack.layers.rend()},
                           stack.exterior_ior,
                           stack.periods};
  return stack_power(reversed, cosine, nm).reflectance;
}

// s kd/pi A(wo) A(wi) / (1 - kd rho) with A and rho by the closed form of the stack.
double smooth_sum(const test::LayeredFilm& design, std::size_t k, double cos_o, double cos_i) {
  const Material& m = design.material;
  const FilmStack stack = stack_of(design, k);
  const double nm = design.wavelengths.nm[k], tau = m.optical_depth(), kd = design.wavelengths.albedo[k];
  const bool is_straight = m.transmission == Transmission::straight;
  const auto arriving = [&](double cosine) {
    return stack_power(stack, cosine, nm).transmittance * std::exp(-tau / m.cosine_below(cosine));
  };
  const double critical = is_straight ? 0 : std::sqrt(std::max(0.0, 1 - square(m.exterior_ior / m.base_ior)));
  double rho = 0;
  for (const auto& [low, high] : {std::pair{0.0, critical}, std::pair{critical, 1.0}})
    rho += test::integrate(0, 1, 200, [&, low = low, high = high](double t) {
      const double mu = low + (high - low) * t * t * (3 - 2 * t);
      return 6 * t * (1 - t) * (high - low) * 2 * mu * std::exp(-2 * tau / mu) *
             below(stack, is_straight, mu, nm);
    });
  return m.radiance_scale() * kd * kInvPi * arriving(cos_o) * arriving(cos_i) / (1 - kd * rho);
}

TEST(LayeredExact, SmoothStackIsTheClosedForm) {
  for (const auto& [name, m] : test::all_modes()) {
    if (!m.is_smooth() || m.absorption_path != AbsorptionPath::sum) continue;
    for (const auto& design :
         {test::clear_mirror(m), test::butterfly(m), test::beetle(m), test::silver_cavity(m)}) {
      const ExactRest exact = exact_of(design);
      for (const double cos_o : {0.98, 0.6, 0.2}) {
        const Rgb rest = exact.rest(direction_from_cosine(cos_o, 0), direction_from_cosine(0.8, 1));
        for (std::size_t k = 0; k < 3; ++k) {
          const double expected = smooth_sum(design, k, cos_o, 0.8);
          EXPECT_NEAR(rest[static_cast<int>(k)], expected, 1e-6 * expected + 1e-8) << name << design.name;
        }
      }
    }
  }
}

// Two halves, three unequal parts and a layer of no thickness are the film itself, by curves and by rings of
// facets here and in closed form and by visible normals there.
TEST(LayeredExact, EqualLayersAreOne) {
  std::vector<test::NamedMaterial> modes = test::all_modes();
  for (const auto& mode : test::all_modes(0.05))
    if (!mode.material.is_smooth()) modes.push_back(mode);
  for (const auto& mode : test::general_modes())
    if (ExactRest::is_valid_for(mode.material)) modes.push_back(mode);
  for (const auto& [name, m] : modes) {
    const Wavelengths single = Wavelengths::rgb3(m);
    const ExactRest expected(m, single);
    for (const double thin : {1.0, 0.0}) {
      Wavelengths layered = single;
      layered.layers.assign(3, {{1, m.film_ior}, {thin, thin > 0 ? m.film_ior : 2.5}, {0.5, m.film_ior}});
      const ExactRest exact(m, layered);
      const double tolerance = m.is_smooth() ? 1e-7 : m.roughness.is_isotropic() ? 2e-5 : 3e-4;
      for (const double theta : {0.2, 0.9, 1.4}) {
        const Vec3 wo = spherical_direction(theta, 0.3), wi = spherical_direction(0.6, 2);
        expect_relative(exact.rest(wo, wi), expected.rest(wo, wi), tolerance, name);
        expect_relative(exact.albedo(wo), expected.albedo(wo), tolerance, name);
      }
    }
  }
}

TEST(LayeredExact, NoLayersAreNoFilm) {
  for (auto [name, m] : test::all_modes()) {
    m.film_thickness_nm = 0;
    m.film_ior = m.base_ior;
    const ExactRest bare(m, Wavelengths::rgb3(m)), exact(m, test::two_halves(m, Wavelengths::rgb3(m)));
    const Vec3 wo = spherical_direction(1.1, 0), wi = spherical_direction(0.6, 2);
    expect_relative(exact.rest(wo, wi), bare.rest(wo, wi), m.is_smooth() ? 1e-7 : 2e-5, name);
  }
}

// Clear layers keep all light, whatever they are.
TEST(LayeredExact, WhiteFurnace) {
  for (auto [name, m] : test::all_modes(0.3, 0, Rgb(1)))
    for (const double exterior_ior : {1.0, 1.5}) {
      if (!m.is_smooth()) continue;
      m.exterior_ior = exterior_ior;
      for (const auto& design : {test::clear_mirror(m), test::butterfly(m)}) {
        const ExactRest exact = exact_of(design);
        for (const double theta : {0.0, 0.7, 1.3})
          expect_relative(exact.albedo(spherical_direction(theta, 0)), Rgb(1), 1e-7, name + design.name);
      }
    }
}

TEST(LayeredExact, AbsorbingLayersKeepLess) {
  for (const auto& [name, m] : test::all_modes(0.3, 0, Rgb(1)))
    for (const auto& design : {test::beetle(m), test::silver_cavity(m)})
      EXPECT_LT(max_component(exact_of(design).albedo(spherical_direction(0.5, 0))), 0.95) << name;
}

TEST(LayeredExact, Reciprocity) {
  for (const auto& [name, m] : test::all_modes())
    for (const auto& design : {test::butterfly(m), test::beetle(m), test::dispersive(m)}) {
      const ExactRest exact = exact_of(design);
      const Vec3 wo = spherical_direction(1.2, 0), wi = spherical_direction(0.3, 2);
      expect_relative(exact.rest(wo, wi), exact.rest(wi, wo), 1e-12, name + design.name);
    }
}

// The albedo is the first surface and the integral of rest() over the hemisphere: what passes the film
// upwards is T, not 1 - R.
TEST(LayeredExact, AlbedoIsTheIntegralOfRest) {
  for (const auto& [name, m] : test::all_modes()) {
    const auto design = test::beetle(m);
    test::LayeredFilm black = design;
    black.wavelengths.albedo.assign(3, 0);
    const ExactRest exact = exact_of(design);
    const Vec3 wo = spherical_direction(0.6, 0);
    Rgb expected = exact_of(black).albedo(wo);
    for (int c = 0; c < 3; ++c)
      expected[c] += test::integrate(
          0, 1, 3, [&](double mu) { return 2 * kPi * mu * exact.rest(wo, direction_from_cosine(mu, 0))[c]; });
    expect_relative(exact.albedo(wo), expected, 5e-5, name);
  }
}

// The stated errors hold for narrow resonances too. The exterior is denser than the base for half of the
// modes.
TEST(LayeredExact, MoreNodesChangeNothing) {
  Rng rng(12, 0);
  for (auto [name, m] : test::all_modes(0.3)) {
    if (m.absorption_path == AbsorptionPath::sum) m.exterior_ior = 1.5;
    m.roughness = m.is_smooth() ? 0 : 0.04 + 0.6 * rng.uniform();
    for (const auto& design : {test::clear_mirror(m), test::butterfly(m), test::silver_cavity(m)}) {
      const ExactRest exact = exact_of(design), finer = exact_of(design, kFine);
      const Vec3 wo = spherical_direction(1.4 * rng.uniform(), 0);
      const Vec3 wi = spherical_direction(1.4 * rng.uniform(), 1);
      const double tolerance = m.is_smooth() ? 1e-7 : 1e-4;
      const Rgb expected = finer.rest(wo, wi), rest = exact.rest(wo, wi);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(rest[c], expected[c], tolerance * expected[c] + 1e-9) << name << ' ' << design.name;
    }
  }
}

// The base only reflects: there is no rest, and what comes back is the mean reflectance of the facets.
TEST(LayeredExact, OpaqueBase) {
  constexpr int kGrid = 50;
  for (auto [name, m] : test::all_modes()) {
    const auto design = test::opaque(m);
    const ExactRest exact = exact_of(design);
    const Vec3 wo = spherical_direction(0.8, 0);
    EXPECT_EQ(exact.rest(wo, spherical_direction(0.3, 1)), Rgb()) << name;
    EXPECT_EQ(exact.rest_albedo(wo), Rgb()) << name;
    const Rgb albedo = exact.albedo(wo);
    Rgb expected;
    const auto add = [&](double cosine, double weight) {
      for (int k = 0; k < 3; ++k) {
        const FilmStack stack{m.exterior_ior, design.wavelengths.layers[k], design.wavelengths.base_index[k]};
        expected[k] += weight * stack_power(stack, cosine, design.wavelengths.nm[k]).reflectance;
      }
    };
    if (m.is_smooth()) {
      add(wo.z, 1);
    } else {
      const Ggx ggx(m.roughness);
      for (int i = 0; i < kGrid; ++i)
        for (int j = 0; j < kGrid; ++j) {
          const Vec3 h = ggx.sample_visible(wo, {(i + 0.5) / kGrid, (j + 0.5) / kGrid});
          const Vec3 wi = reflect(wo, h);
          if (wi.z > 0) add(dot(wo, h), ggx.g2_over_g1(wo, wi) / square(kGrid));
        }
    }
    expect_relative(albedo, expected, m.is_smooth() ? 1e-7 : 1e-3, name);
  }
}

// Every wavelength has layers of its own, also the last of a triple that is filled up.
TEST(LayeredExact, WavelengthsAreIndependent) {
  for (const auto& [name, m] : test::all_modes()) {
    Wavelengths four = Wavelengths::rgb3(m);
    four.nm.push_back(430);
    four.albedo.push_back(0.4);
    four.absorption.push_back(0.7);
    four.weight.push_back({0.1, 0.2, 0.3});
    for (std::size_t k = 0; k < 4; ++k)
      four.layers.push_back({{1, 1.4 + 0.1 * static_cast<double>(k)}, {2, {1.8, 0.03}}});
    const Vec3 wo = spherical_direction(1.1, 0), wi = spherical_direction(0.4, 2);
    Rgb rest;
    for (std::size_t k = 0; k < 4; ++k) {
      const Wavelengths alone{
          {four.nm[k]}, {four.albedo[k]}, {four.absorption[k]}, {four.weight[k]}, {four.layers[k]}};
      rest += ExactRest(m, alone).rest(wo, wi);
    }
    expect_relative(ExactRest(m, four).rest(wo, wi), rest, 1e-5, name);
  }
}

TEST(LayeredExact, BsdfIsTheExactRest) {
  Rng rng(2, 0);
  for (auto [name, m] : test::all_modes()) {
    if (m.absorption_path != AbsorptionPath::sum) continue;
    for (const double exterior_ior : {1.0, 1.5}) {
      m.exterior_ior = exterior_ior;
      // Curves of a rough film are dear.
      const bool is_dear = !m.is_smooth();
      for (const auto& design : is_dear ? std::vector{test::beetle(m)} : test::layered_films(m)) {
        const ExactRest exact = exact_of(design);
        const ExactBsdf bsdf(design.material, design.wavelengths);
        for (int k = 0; k < 3; ++k) {
          const Vec3 wo = direction_from_cosine(lerp(rng.uniform(), 0.05, 1), 0);
          const Vec3 wi = direction_from_cosine(lerp(rng.uniform(), 0.05, 1), 2);
          const Rgb expected = exact.rest(wo, wi), found = bsdf.rest(wo, wi);
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found[c], expected[c], 2e-5 * expected[c] + 1e-7)
                << name << ' ' << design.name << ' ' << wo.z << ' ' << wi.z;
        }
      }
    }
  }
}

// A smooth film's mirror direction has the power of the closed form, also beyond the critical angle, where
// layers absorb and R < 1.
TEST(LayeredExact, BsdfReflectsAsTheClosedForm) {
  for (auto [name, m] : test::all_modes()) {
    if (m.absorption_path != AbsorptionPath::sum || !m.is_smooth()) continue;
    m.exterior_ior = 1.5;
    for (const auto& design : {test::beetle(m), test::silver_cavity(m), test::butterfly(m)}) {
      const ExactBsdf bsdf(design.material, design.wavelengths);
      for (const double cosine : {0.9, 0.5, 0.36, 0.3, 0.1}) {
        const Rgb found = bsdf.dirac(direction_from_cosine(cosine, 0));
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR(found[static_cast<int>(k)],
                      stack_power(stack_of(design, k), cosine, design.wavelengths.nm[k]).reflectance, 1e-6)
              << name << ' ' << design.name << ' ' << cosine;
      }
    }
  }
}

// Power by sampling is the exact albedo, whether light passes or not: 8 films x 2 views x 3 channels at 4.5
// standard errors, 4e-4 in all.
TEST(LayeredExact, BsdfSamplesItsPower) {
  for (const auto& [name, m] : test::all_modes()) {
    if (m.absorption_path != AbsorptionPath::sum) continue;
    for (const auto& design : {test::opaque(m), test::beetle(m)}) {
      const ExactRest exact = exact_of(design);
      const ExactBsdf bsdf(design.material, design.wavelengths);
      for (const double theta : {0.4, 1.3}) {
        const Vec3 wo = spherical_direction(theta, 0.5);
        const auto sampled = test::sample_totals(bsdf, wo, 50000, 6).albedo;
        const Rgb expected = exact.albedo(wo);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(sampled[c].mean(), expected[c], 4.5 * sampled[c].std_error() + 5e-5)
              << name << design.name;
      }
    }
  }
}

// All that is drawn is reflected, with the density of the mirrored facets alone.
TEST(LayeredExact, OpaqueBsdfSamplesTheFirstSurfaceAlone) {
  for (const auto& [name, m] : test::all_modes()) {
    if (m.absorption_path != AbsorptionPath::sum || m.is_smooth()) continue;
    const auto design = test::opaque(m);
    const ExactBsdf bsdf(design.material, design.wavelengths);
    const Vec3 wo = spherical_direction(0.9, 0.4), wi = spherical_direction(1.1, 3.1);
    EXPECT_EQ(bsdf.mis_pdf(wo, wi), Ggx(m.roughness).reflection_pdf(wo, normalize(wo + wi))) << name;
    EXPECT_EQ(bsdf.rest(wo, wi), Rgb()) << name;
  }
}

}  // namespace
}  // namespace sunbeam
