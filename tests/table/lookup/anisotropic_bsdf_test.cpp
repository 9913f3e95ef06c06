// A table of an anisotropic film as a BSDF: what it gives out agrees with itself, follows the film's mirrors,
// and is that of an isotropic table where nothing is anisotropic.
#include <gtest/gtest.h>

#include "sunbeam/table_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

constexpr std::size_t kCosines = 7, kAzimuths = 16;  // round; a quadrant has kAzimuths / 4 + 1

using Remainder = std::function<double(const AngleCoordinates&)>;

// A film that reflects a fifth at every angle over an absorbing base.
Table make_table(Symmetry symmetry, const Roughness& roughness, const Remainder& remainder) {
  Table table;
  table.symmetry = symmetry;
  table.material.roughness = roughness;
  const auto parameters = Parameters::of(table.material).values();
  const std::vector<Axis> film = {test::axis(kParameterNames[0], {parameters[0]}),
                                  test::axis(kParameterNames[1], {parameters[1]}),
                                  test::axis("cos_theta", {0, 1})};
  table.film_reflectance = NdArray("film_reflectance", film, Precision::single_float);
  table.film_transmittance = NdArray("film_transmittance", film, Precision::single_float);
  for (std::size_t cell = 0; cell < 2; ++cell) {
    table.film_reflectance.set(cell, Rgb(0.2, 0.25, 0.3));
    table.film_transmittance.set(cell, Rgb(0.7));
  }
  const bool isotropic = symmetry == Symmetry::isotropic;
  const auto cosines = spaced_nodes(0.01, 1, kCosines);
  const std::vector<Axis> axes = {
      film[0],
      film[1],
      test::axis(kParameterNames[2], {parameters[2]}),
      test::axis("cos_theta_i", cosines),
      test::axis("phi_i", isotropic ? std::vector{0.0} : spaced_nodes(0, kPi / 2, kAzimuths / 4 + 1)),
      test::axis("cos_theta_o", cosines),
      isotropic ? test::axis("phi_o", spaced_nodes(0, kPi, kAzimuths / 2 + 1))
                : test::full_circle("phi_o", kAzimuths)};
  table.remainder = NdArray("remainder", axes, Precision::single_float);
  table.rest_stderr = NdArray("rest_stderr", axes, Precision::single_float, 1);
  std::size_t cell = 0;
  for (const double cos_i : cosines)
    for (const double phi_i : axes[4].nodes)
      for (const double cos_o : cosines)
        for (const double phi_o : axes[6].nodes)
          table.remainder.set(cell++, remainder({cos_i, phi_i, cos_o, phi_o}) * Rgb(1, 0.8, 0.6));
  table.info = test::complete_info();
  return table;
}

TableBsdf bsdf_of(const Table& table) { return TableBsdf(table, Parameters::of(table.material)); }

// More light along x than along y and to the mirror side, of mirror symmetry and reciprocal.
double brushed(const AngleCoordinates& c) {
  const double sines = std::sqrt((1 - square(c.cos_i)) * (1 - square(c.cos_o)));
  return 0.1 + 0.04 * sines * (std::cos(c.phi_i) * std::cos(c.phi_o) - std::cos(c.phi_i - c.phi_o)) +
         0.02 * (square(std::cos(c.phi_i)) * (1 - square(c.cos_i)) +
                 square(std::cos(c.phi_o)) * (1 - square(c.cos_o)));
}

Table brushed_table(const Roughness& roughness = {0.08, 0.4}) {
  return make_table(Symmetry::anisotropic, roughness, brushed);
}

const Roughness kRoughnesses[] = {{0.08, 0.4}, {0.5, 0.1}};

// Along the grooves, across them, between; steep and near grazing.
const Vec3 kViewers[] = {spherical_direction(0.8, 0), spherical_direction(0.8, kPi / 2),
                         spherical_direction(0.3, 2.2), spherical_direction(1.35, 5.5)};

Vec3 random_direction(Rng& rng) { return test::uniform_hemisphere({rng.uniform(), rng.uniform()}); }

// 8 cases, false alarm 1e-4 in all.
TEST(AnisotropicTable, SamplesFollowThePdf) {
  for (const Roughness& roughness : kRoughnesses)
    for (const Vec3& wo : kViewers) {
      const auto result =
          test::chi_square_of_sampling(bsdf_of(brushed_table(roughness)), wo, {.samples = 100000}, 1);
      EXPECT_GT(result.p_value, test::sidak(1e-4, 8)) << roughness.u << ' ' << wo.x << ' ' << wo.y;
      EXPECT_GT(result.degrees, 100);
    }
}

// Int pdf + P(empty) = 1: 8 cases at 4.5 standard errors, 6e-5 in all. The lobe seen near grazing is narrow.
TEST(AnisotropicTable, ProbabilitiesAddUpToOne) {
  for (const Roughness& roughness : kRoughnesses) {
    const TableBsdf bsdf = bsdf_of(brushed_table(roughness));
    for (const Vec3& wo : kViewers) {
      const auto totals = test::sample_totals(bsdf, wo, 100000, 2);
      const auto integral = test::integrate_pdf(bsdf, wo, 400, 8, 2);
      EXPECT_EQ(totals.dirac, 0);
      EXPECT_LT(test::deviation(totals.seen.mean(), totals.seen.std_error(), integral.mean(),
                                integral.std_error(), 1e-6),
                4.5)
          << roughness.u << ' ' << wo.x << ' ' << wo.y;
    }
  }
}

// By sampling, by integrating eval, and by the table's own quadrature, at any azimuth of the viewer. 4.5
// standard errors and 1e-3 for the quadratures: 8 cases x 3 channels x 2, 3e-4 in all.
TEST(AnisotropicTable, AlbedoThreeWays) {
  for (const Roughness& roughness : kRoughnesses) {
    const TableBsdf bsdf = bsdf_of(brushed_table(roughness));
    for (const Vec3& wo : kViewers) {
      const Rgb albedo = bsdf.albedo(wo);
      const auto sampled = test::sample_totals(bsdf, wo, 200000, 3).albedo;
      const auto integrated = test::albedo_by_eval(bsdf, wo, 300, 8, 3);
      for (int c = 0; c < 3; ++c) {
        EXPECT_LT(sampled[c].std_error(), 2e-3 * albedo[c]);
        for (const auto* other : {&sampled[c], &integrated[c]})
          EXPECT_LT(test::deviation(other->mean(), other->std_error(), albedo[c], 0, 1e-3 * albedo[c]), 4.5)
              << roughness.u << ' ' << wo.x << ' ' << wo.y << ' ' << c;
      }
    }
  }
}

// The choice of technique is that of the mean azimuth. Where the film is seen otherwise the throughput, whose
// mean is the albedo, still stays within a few albedos.
TEST(AnisotropicTable, ThroughputIsBounded) {
  for (const Roughness& roughness : kRoughnesses) {
    const TableBsdf bsdf = bsdf_of(brushed_table(roughness));
    for (const Vec3& wo : kViewers) {
      Rng rng(4, 0);
      double largest = 0;
      for (int k = 0; k < 20000; ++k) {
        const auto s = bsdf.sample(wo, rng);
        if (s) largest = std::max(largest, mean(s->throughput));
      }
      EXPECT_LT(largest, 2.5 * mean(bsdf.albedo(wo))) << roughness.u << ' ' << wo.x << ' ' << wo.y;
    }
  }
}

TEST(AnisotropicTable, MirrorsChangeNothing) {
  const TableBsdf bsdf = bsdf_of(brushed_table());
  Rng rng(5, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 wo = random_direction(rng), wi = random_direction(rng);
    const Rgb value = bsdf.eval(wo, wi, rng);
    for (const double x : {1.0, -1.0})
      for (const double y : {1.0, -1.0}) {
        const Vec3 wo_image{x * wo.x, y * wo.y, wo.z}, wi_image{x * wi.x, y * wi.y, wi.z};
        ASSERT_EQ(bsdf.eval(wo_image, wi_image, rng), value);
        ASSERT_EQ(bsdf.mis_pdf(wo_image, wi_image), bsdf.mis_pdf(wo, wi));
      }
  }
}

// Nodes that are reciprocal make values between them reciprocal: folding maps cells of nodes to cells.
TEST(AnisotropicTable, ReciprocalNodesMakeReciprocalValues) {
  const TableBsdf bsdf = bsdf_of(brushed_table());
  Rng rng(6, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 a = random_direction(rng), b = random_direction(rng);
    const double ab = bsdf.eval(a, b, rng).g, ba = bsdf.eval(b, a, rng).g;
    ASSERT_NEAR(ab, ba, 1e-6 * ab);  // of single precision
  }
}

TEST(AnisotropicTable, ContinuousAcrossTheAxes) {
  const TableBsdf bsdf = bsdf_of(brushed_table());
  Rng rng(7, 0);
  for (const double axis : {0.0, kPi / 2, kPi, 3 * kPi / 2})
    for (int k = 0; k < 200; ++k) {
      const Vec3 wo = random_direction(rng);
      const double cosine = rng.uniform();
      const Rgb before = bsdf.rest(wo, direction_from_cosine(cosine, axis - 1e-9));
      const Rgb behind = bsdf.rest(wo, direction_from_cosine(cosine, axis + 1e-9));
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(before[c], behind[c], 1e-6 * before[c]);
    }
}

// Equal roughnesses and a rest without azimuth: the isotropic table's values everywhere, to single floats.
// Sampling data are made by quadratures that lie otherwise: 2 % of the density.
TEST(AnisotropicTable, OfAnIsotropicFilmWithoutAzimuth) {
  const auto rest = [](const AngleCoordinates& c) { return 0.1 + 0.2 * c.cos_i * c.cos_o; };
  const TableBsdf one = bsdf_of(make_table(Symmetry::isotropic, 0.3, rest));
  const TableBsdf other = bsdf_of(make_table(Symmetry::anisotropic, {0.3, 0.3}, rest));
  Rng rng(8, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 wo = random_direction(rng), wi = random_direction(rng);
    const Rgb a = one.eval(wo, wi, rng), b = other.eval(wo, wi, rng);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 1e-6 * a[c]);
    ASSERT_NEAR(one.mis_pdf(wo, wi), other.mis_pdf(wo, wi), 0.02 * one.mis_pdf(wo, wi));
  }
  for (const Vec3& wo : kViewers) EXPECT_NEAR(one.albedo(wo).g, other.albedo(wo).g, 1e-3 * one.albedo(wo).g);
}

// Renderers skip tangents on the word of is_isotropic().
TEST(AnisotropicTable, SaysWhetherTurningChangesIt) {
  const auto rest = [](const AngleCoordinates& c) { return 0.1 - 0.05 * std::cos(c.phi_o - c.phi_i); };
  const TableBsdf isotropic = bsdf_of(make_table(Symmetry::isotropic, 0.3, rest));
  const TableBsdf brushed = bsdf_of(brushed_table());
  EXPECT_TRUE(isotropic.is_isotropic());
  EXPECT_FALSE(brushed.is_isotropic());
  const auto turned = [](const Vec3& v) { return Vec3{-v.y, v.x, v.z}; };
  Rng rng(10, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 wo = random_direction(rng), wi = random_direction(rng);
    const double value = isotropic.eval(wo, wi, rng).g;
    ASSERT_NEAR(isotropic.eval(turned(wo), turned(wi), rng).g, value, 1e-5 * value);
  }
}

// A rest of |dphi|: linear in it for wi at a node, off nodes by at most h^2 / 8 of its second derivative,
// twice: 0.05 x 0.7 (what stands in front, 0.7^2 / 1.5^2 at most) x (2 pi / 16)^2 / 4.
TEST(AnisotropicTable, OfAnIsotropicFilmWithAzimuth) {
  const auto rest = [](const AngleCoordinates& c) { return 0.1 - 0.05 * std::cos(c.phi_o - c.phi_i); };
  const TableBsdf one = bsdf_of(make_table(Symmetry::isotropic, 0.3, rest));
  const TableBsdf other = bsdf_of(make_table(Symmetry::anisotropic, {0.3, 0.3}, rest));
  Rng rng(9, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 wo = random_direction(rng), wi = random_direction(rng);
    const Vec3 at_node = direction_from_cosine(wi.z, 2 * kPi / kAzimuths * (k % kAzimuths));
    ASSERT_NEAR(one.rest(wo, at_node).g, other.rest(wo, at_node).g, 1e-6);
    ASSERT_NEAR(one.rest(wo, wi).g, other.rest(wo, wi).g, 0.05 * 0.7 * square(2 * kPi / kAzimuths) / 4);
  }
  for (const Vec3& wo : kViewers) EXPECT_NEAR(one.albedo(wo).g, other.albedo(wo).g, 1e-3 * one.albedo(wo).g);
}

// An isotropic table with azimuth gives every viewer azimuth the same albedo, that of sampling: 4.5 standard
// errors and 1e-3, 3 cases.
TEST(IsotropicTable, AlbedoOfARestWithAzimuth) {
  const auto rest = [](const AngleCoordinates& c) { return 0.1 * (1 - std::cos(c.phi_o)) * square(c.phi_o); };
  const TableBsdf bsdf = bsdf_of(make_table(Symmetry::isotropic, 0.3, rest));
  const double albedo = bsdf.albedo(spherical_direction(0.8, 0)).g;
  for (const double phi : {0.1, 1.7, 4.0}) {
    const Vec3 wo = spherical_direction(0.8, phi);
    EXPECT_NEAR(bsdf.albedo(wo).g, albedo, 1e-4 * albedo);  // visible normals have a grid of their own
    const auto sampled = test::sample_totals(bsdf, wo, 200000, 10).albedo;
    EXPECT_LT(test::deviation(sampled.g.mean(), sampled.g.std_error(), albedo, 0, 1e-3 * albedo), 4.5);
  }
}

}  // namespace
}  // namespace sunbeam
