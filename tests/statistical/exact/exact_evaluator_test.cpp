// The deterministic evaluator against reference values, closed forms, itself on finer nodes, and the walks.
#include <gtest/gtest.h>

#include "bake/live/exact/exact.h"
#include "bake/live/pfmc.h"
#include "sunbeam/core/rng.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/csv.h"
#include "tests/support/materials.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

const ExactResolution kFine{14, 36, 18, 24, 40};

ExactRest exact_rgb3(const Material& m, const ExactResolution& resolution = {}) {
  return ExactRest(m, Wavelengths::rgb3(m), resolution);
}

ExactRest exact_of(const test::CsvRow& row) {
  const Material m = test::material_of(row);
  return ExactRest(m, Wavelengths::monochromatic(m, row.number("wavelength_nm")));
}

Vec3 direction(const test::CsvRow& row, const std::string& key, double azimuth = 0) {
  return spherical_direction(test::radians(row.number(key)), azimuth);
}

void expect_relative(const Rgb& value, const Rgb& expected, double tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(value[c], expected[c], tolerance * std::abs(expected[c])) << what << " channel " << c;
}

TEST(ExactEvaluator, ReferenceRest) {
  for (const auto& row : test::read_reference("eval.csv")) {
    const double expected = row.number("rest");
    const double value =
        exact_of(row).rest(direction(row, "theta_o_deg"), direction(row, "theta_i_deg", 1)).g;
    const double tolerance = test::material_of(row).is_smooth() ? 2e-6 : 2e-5;
    EXPECT_NEAR(value, expected, tolerance * expected) << "eval.csv:" << row.line;
  }
}

// Values without noise come with eight digits. 7 noisy ones at 4 standard errors: 5e-4 in all.
TEST(ExactEvaluator, ReferenceAlbedo) {
  for (const auto& row : test::read_reference("albedo.csv")) {
    const double expected = row.number("total"), error = row.number("stderr");
    const double tolerance = test::material_of(row).is_smooth() ? 2e-7 : 2e-5;
    EXPECT_NEAR(exact_of(row).albedo(direction(row, "theta_i_deg")).g, expected,
                4 * error + tolerance * expected)
        << "albedo.csv:" << row.line;
  }
}

// First surface and rest, averaged over cells of solid angle. 17 tests at 4 standard errors: 1e-3 in all.
TEST(ExactEvaluator, ReferenceCellsOfRoughRefraction) {
  constexpr int kPolar = 6, kAzimuthal = 24;
  for (const auto& row : test::read_reference("rough_refract.csv")) {
    const ExactRest exact = exact_of(row);
    const Material material = test::material_of(row);
    const Pfmc pfmc(material, Wavelengths::monochromatic(material, row.number("wavelength_nm")));
    const Vec3 wi = direction(row, "theta_i_deg");
    const double half = test::radians(row.number("half_deg")), phi = test::radians(row.number("phi_deg"));
    const double low = std::cos(test::radians(row.number("theta_o_deg")) + half);
    const double high = std::cos(std::max(0.0, test::radians(row.number("theta_o_deg")) - half));
    const double first_phi = std::max(0.0, phi - half), last_phi = std::min(kPi, phi + half);
    double sum = 0;
    for (int i = 0; i < kPolar; ++i) {
      const double cosine = lerp((i + 0.5) / kPolar, low, high);
      sum += exact.rest(direction_from_cosine(cosine, 0), wi).g / kPolar;
      for (int k = 0; k < kAzimuthal; ++k) {
        const double azimuth = lerp((k + 0.5) / kAzimuthal, first_phi, last_phi);
        sum += pfmc.first(direction_from_cosine(cosine, azimuth), wi).g / (kPolar * kAzimuthal);
      }
    }
    EXPECT_NEAR(sum, row.number("mean"), 4 * row.number("stderr") + 1e-3 * sum)
        << "rough_refract.csv:" << row.line;
  }
}

// Walks until the standard error of their grey is 0.1 %; 6 materials x 3 channels at 4 standard
// errors: 1.1e-3 in all.
TEST(ExactEvaluator, WalksAgreeOnRoughRefraction) {
  struct Case {
    AbsorptionPath path;
    double roughness, optical_depth, base_ior, theta_o, theta_i;
  };
  const Case cases[] = {
      {AbsorptionPath::sum, 0.1, 0.1, 1.4, 0.3, 0.9},     {AbsorptionPath::sum, 0.5, 0.3, 1.8, 1.2, 0.2},
      {AbsorptionPath::sum, 0.3, 0.05, 1, 0.7, 0.5},      {AbsorptionPath::product, 0.1, 0.2, 1.6, 0.4, 1.1},
      {AbsorptionPath::product, 0.6, 0.1, 1.3, 1.2, 1.2}, {AbsorptionPath::product, 0.3, 0, 2.2, 0, 0.8}};
  for (const Case& c : cases) {
    Material m;
    m.absorption_path = c.path;
    m.film_thickness_nm = 500;
    m.base_ior = c.base_ior;
    m.roughness = c.roughness;
    m.absorption_per_nm = c.optical_depth / m.pigment_thickness_nm;
    m.albedo = {0.9, 0.8, 0.6};
    const Pfmc pfmc(m);
    const Vec3 wo = spherical_direction(c.theta_o, 0), wi = spherical_direction(c.theta_i, 2);
    const Rgb expected = exact_rgb3(m).rest(wo, wi);
    Rng rng(11, 0);
    test::RgbMean mean;
    for (int block = 0; block < 200; ++block) {
      for (int i = 0; i < 50000; ++i) mean.add(pfmc.estimate_rest(wo, wi, rng));
      if (mean.grey.std_error() < 0.001 * mean.grey.mean()) break;
    }
    EXPECT_LE(mean.grey.std_error(), 0.001 * mean.grey.mean()) << "roughness " << c.roughness;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(mean[k].mean(), expected[k], 4 * mean[k].std_error())
          << "roughness " << c.roughness << " base " << c.base_ior << " channel " << k;
  }
}

// Nothing absorbs and a smooth film loses nothing; base_ior 2 keeps most of the light inside for long.
TEST(ExactEvaluator, WhiteFurnace) {
  for (auto [name, m] : test::all_modes(0.3, 0, Rgb(1)))
    for (const double base_ior : {1.0, 1.35, 2.0}) {
      if (!m.is_smooth()) continue;
      m.base_ior = base_ior;
      const ExactRest exact = exact_rgb3(m);
      for (const double theta : {0.0, 0.7, 1.3, 1.55})
        expect_relative(exact.albedo(spherical_direction(theta, 0)), Rgb(1), 1e-9, name);
    }
}

// A rough film's facets lose energy and never gain any.
TEST(ExactEvaluator, RoughWhiteFurnaceIsNotAboveOne) {
  for (const double roughness : {0.05, 0.9})
    for (const auto& [name, m] : test::all_modes(roughness, 0, Rgb(1))) {
      if (m.is_smooth()) continue;
      for (const double theta : {0.0, 0.7, 1.4}) {
        const Rgb albedo = exact_rgb3(m).albedo(spherical_direction(theta, 0));
        EXPECT_LE(max_component(albedo), 1 + 1e-5) << name;
        EXPECT_GT(max_component(albedo), roughness < 0.1 ? 0.9 : 0.3) << name;
      }
    }
}

// Without pigment both paths are the same model: the rank-one sum checks the integral equation.
TEST(ExactEvaluator, PathsAgreeWithoutPigment) {
  for (const double roughness : {0.02, 0.4})
    for (const auto& [name, m] : test::all_modes(roughness, 0)) {
      Material other = m;
      other.absorption_path = AbsorptionPath::sum;
      const Vec3 wo = spherical_direction(1.3, 0), wi = spherical_direction(0.4, 2);
      const ExactRest exact = exact_rgb3(m), sum = exact_rgb3(other);
      expect_relative(exact.rest(wo, wi), sum.rest(wo, wi), 1e-10, name);
      expect_relative(exact.albedo(wo), sum.albedo(wo), 1e-10, name);
    }
}

TEST(ExactEvaluator, Reciprocity) {
  for (const auto& [name, m] : test::all_modes()) {
    const ExactRest exact = exact_rgb3(m);
    for (const double a : {0.1, 0.8, 1.5})
      for (const double b : {0.3, 1.2}) {
        const Vec3 wo = spherical_direction(a, 0), wi = spherical_direction(b, 2);
        expect_relative(exact.rest(wo, wi), exact.rest(wi, wo), 1e-12, name);
      }
  }
}

// The albedo is the first surface and the integral of rest() over the hemisphere.
TEST(ExactEvaluator, AlbedoIsTheIntegralOfRest) {
  for (const auto& [name, m] : test::all_modes()) {
    const ExactRest exact = exact_rgb3(m);
    Material black = m;
    black.albedo = Rgb(0);
    const Vec3 wo = spherical_direction(0.6, 0);
    Rgb expected = exact_rgb3(black).albedo(wo);
    for (int c = 0; c < 3; ++c)
      expected[c] += test::integrate(
          0, 1, 5, [&](double mu) { return 2 * kPi * mu * exact.rest(wo, direction_from_cosine(mu, 0))[c]; });
    expect_relative(exact.albedo(wo), expected, m.is_smooth() ? 1e-5 : 5e-5, name);
  }
}

// More nodes change nothing beyond the stated errors: random materials, and a few that are hard.
TEST(ExactEvaluator, MoreNodesChangeNothing) {
  Rng rng(12, 0);
  for (int trial = 0; trial < 40; ++trial) {
    Material m = test::all_modes(0.05 + 0.9 * rng.uniform())[trial % 8].material;
    m.film_thickness_nm = 1500 * rng.uniform();
    m.base_ior = trial < 8 ? 1.0001 : 1.05 + rng.uniform();
    m.absorption_per_nm = std::pow(10, -4 + 4 * rng.uniform());
    const ExactRest exact = exact_rgb3(m), finer = exact_rgb3(m, kFine);
    const Vec3 wo = spherical_direction(1.5 * rng.uniform(), 0);
    const Vec3 wi = spherical_direction(1.5 * rng.uniform(), 0);
    const Rgb expected = finer.rest(wo, wi);
    const double tolerance = m.is_smooth() ? 1e-7 : trial < 8 ? 3e-4 : 1e-4;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(exact.rest(wo, wi)[c], expected[c], tolerance * expected[c] + 1e-15) << "trial " << trial;
    expect_relative(exact.albedo(wo), finer.albedo(wo), tolerance, "trial " + std::to_string(trial));
  }
}

// The same where facets bend light into a lower index: they send it down to grazing the base and no further,
// and a film of lower index than both neighbours lets it tunnel.
TEST(ExactEvaluator, MoreNodesChangeNothingOverARarerBase) {
  Rng rng(13, 0);
  for (int trial = 0; trial < 40; ++trial) {
    Material m = test::all_modes(0.02 + 0.9 * square(rng.uniform()))[6 + trial % 2].material;
    m.film_thickness_nm = 1500 * rng.uniform();
    m.exterior_ior = 1.05 + 0.95 * rng.uniform();
    m.base_ior = lerp(rng.uniform(), 1, m.exterior_ior - 0.01);
    m.absorption_per_nm = std::pow(10, -4 + 4 * rng.uniform());
    const ExactRest exact = exact_rgb3(m), finer = exact_rgb3(m, kFine);
    for (const double theta : {0.4, 0.9, 1.5}) {
      const Vec3 wo = spherical_direction(theta, 0), wi = spherical_direction(1.5 * rng.uniform(), 0);
      const Rgb expected = finer.rest(wo, wi);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(exact.rest(wo, wi)[c], expected[c], 5e-4 * expected[c] + 1e-15) << "trial " << trial;
      expect_relative(exact.albedo(wo), finer.albedo(wo), 5e-4, "trial " + std::to_string(trial));
    }
  }
}

// Wavelengths carried together are those carried alone, each with its own albedo and absorption, folded. Ten:
// the last three stand beside copies of the last.
TEST(ExactEvaluator, WavelengthsAreIndependent) {
  for (auto [name, m] : test::all_modes()) {
    Wavelengths together;
    for (int k = 0; k < 10; ++k) {
      together.nm.push_back(400 + 33 * k);
      together.albedo.push_back(0.95 - 0.08 * k);
      together.absorption.push_back(3.0 / (1 + k));
      together.weight.push_back({0.1 * k, 0.3, 1 - 0.2 * k});
    }
    const Vec3 wo = spherical_direction(1.2, 0), wi = spherical_direction(0.4, 2);
    Rgb rest, albedo;
    for (int k = 0; k < 10; ++k) {
      Material alone = m;
      alone.albedo = Rgb(together.albedo[k]);
      alone.absorption_per_nm *= together.absorption[k];
      const ExactRest exact(alone, Wavelengths::monochromatic(alone, together.nm[k]));
      rest += exact.rest(wo, wi) * together.weight[k];
      albedo += exact.albedo(wo) * together.weight[k];
    }
    const ExactRest exact(m, together);
    const double tolerance =
        m.is_smooth() ? 1e-11 : 1e-5;  // the rougher film's nodes follow the shortest wave
    expect_relative(exact.rest(wo, wi), rest, tolerance, name);
    expect_relative(exact.albedo(wo), albedo, tolerance, name);
    if (m.absorption_path == AbsorptionPath::product) continue;
    std::vector<double> terms = exact.gain();
    for (std::size_t k = 0; k < terms.size(); ++k) terms[k] *= exact.arriving(wo)[k] * exact.arriving(wi)[k];
    expect_relative(together.fold(terms), exact.rest(wo, wi), 1e-13, name);
  }
}

// No film at all is the plain base, with rough facets too: light passes them unbent.
TEST(ExactEvaluator, IndexMatchedIsThePlainBase) {
  for (auto [name, m] : test::all_modes(0.3, 0.4)) {
    if (!m.is_smooth()) continue;
    m.film_thickness_nm = 0;
    m.film_ior = m.base_ior = 1;
    const double a = std::cos(0.3), b = std::cos(1.2);
    const Rgb expected = m.albedo * (kInvPi * std::exp(m.absorption_exponent(a, b)));
    expect_relative(exact_rgb3(m).rest(spherical_direction(0.3, 0), spherical_direction(1.2, 2)), expected,
                    1e-13, name);
  }
}

// Passing by quadrature over facets that hardly bend light becomes passing unbent.
TEST(ExactEvaluator, ContinuousAtEqualIndices) {
  const Vec3 wo = spherical_direction(0.4, 0), wi = spherical_direction(1.1, 2);
  for (auto [name, m] : test::all_modes()) {
    if (m.is_smooth() || m.transmission == Transmission::straight) continue;
    m.base_ior = 1;
    const Rgb at_one = exact_rgb3(m).rest(wo, wi);
    m.base_ior = 1 + 1e-6;
    expect_relative(exact_rgb3(m).rest(wo, wi), at_one, 1e-4, name);
  }
}

TEST(ExactEvaluator, NothingWhereNothingIs) {
  for (auto [name, m] : test::all_modes()) {
    const Vec3 up = spherical_direction(0.4, 0), down = spherical_direction(2, 0);
    EXPECT_TRUE(is_black(exact_rgb3(m).rest(up, down))) << name;
    EXPECT_TRUE(is_black(exact_rgb3(m).rest(down, up))) << name;
    EXPECT_TRUE(is_black(exact_rgb3(m).albedo(down))) << name;
    m.albedo = Rgb(0);
    EXPECT_TRUE(is_black(exact_rgb3(m).rest(up, up))) << name;
    m.albedo = Rgb(0.5);
    m.absorption_per_nm = 1000;  // optical depth 2000: underflows to nothing, not to NaN
    EXPECT_LT(max_component(exact_rgb3(m).rest(up, up)), 1e-300) << name;
  }
}

}  // namespace
}  // namespace sunbeam
