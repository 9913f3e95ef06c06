// A smooth function of both directions with no symmetry but the film's mirrors, through a table and its
// files.
//
// It knows nothing of materials: the rest of a clear straight film that reflects nothing over a black base is
// the remainder itself (front factor and decay 1, first visit 0), so TableBsdf::rest must return it.
#include <gtest/gtest.h>

#include "sunbeam/table_bsdf.h"
#include "tests/support/angle_pairs.h"
#include "tests/support/bsdf_checks.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

constexpr double kLowest = 0.01;  // cosine; look-ups below are clamped
constexpr std::size_t kCosines = 9, kAzimuthsI = 9, kAzimuthsO = 32;

// f = 2 + 0.5 a cos(2 pi) ci + 0.3 b cos(2 po) co^2 + 0.4 cos(pi - po) (ci + 0.5 co^2) + 0.2 a ci^3 with
// weights a, b of the channel: mirror symmetric (the azimuths change sign or become pi minus themselves), but
// neither reciprocal nor a function of po - pi.
double channel(double a, double b, const AngleCoordinates& c) {
  return 2 + 0.5 * a * std::cos(2 * c.phi_i) * c.cos_i + 0.3 * b * std::cos(2 * c.phi_o) * square(c.cos_o) +
         0.4 * std::cos(c.phi_i - c.phi_o) * (c.cos_i + 0.5 * square(c.cos_o)) +
         0.2 * a * c.cos_i * c.cos_i * c.cos_i;
}
Rgb exact(const AngleCoordinates& c) {
  return {channel(1, -0.5, c), channel(-0.7, 1, c), channel(0.4, -1, c)};
}

// Multilinear interpolation errs by at most sum_k h_k^2 / 8 max|d^2 f / dx_k^2| (each axis' interpolation is
// an average, so that errors add and do not grow). For f above, |ci|, |co|, |a|, |b| <= 1:
//   ci:  0.2 * 6 ci              <= 1.2     co:  0.3 * 2 + 0.4        <= 1.0
//   pi:  0.5 * 4 + 0.4 * 1.5     <= 2.6     po:  0.3 * 4 + 0.4 * 1.5  <= 1.8
double interpolation_bound() {
  const double h_cos = (1 - kLowest) / (kCosines - 1);
  const double h_i = kPi / 2 / (kAzimuthsI - 1), h_o = 2 * kPi / kAzimuthsO;
  return (square(h_cos) * (1.2 + 1.0) + square(h_i) * 2.6 + square(h_o) * 1.8) / 8;
}

// |f| <= 2 + 0.5 + 0.3 + 0.6 + 0.2 < 4: half a unit in the last place is 2^-23 for floats, which every value
// becomes first, and 2^-10 for halves.
double rounding_bound(Precision precision) {
  return 0x1p-22 + (precision == Precision::half_float ? 0x1p-10 : 0);
}

Table make_table(Precision precision) {
  Table table;
  table.symmetry = Symmetry::anisotropic;
  table.material.transmission = Transmission::straight;
  table.material.absorption_per_nm = 0;
  table.material.albedo = Rgb(0);
  table.material.roughness = {0.1, 0.3};
  const auto parameters = Parameters::of(table.material).values();
  const std::vector<Axis> film = {test::axis(kParameterNames[0], {parameters[0]}),
                                  test::axis(kParameterNames[1], {parameters[1]}),
                                  test::axis("cos_theta", {0, 1})};
  table.film_reflectance = NdArray("film_reflectance", film, Precision::single_float);  // 0
  table.film_transmittance = NdArray("film_transmittance", film, Precision::single_float);
  for (std::size_t cell = 0; cell < 2; ++cell) table.film_transmittance.set(cell, Rgb(1));
  const auto cosines = spaced_nodes(kLowest, 1, kCosines);
  std::vector<Axis> axes = {film[0],
                            film[1],
                            test::axis(kParameterNames[2], {0}),
                            test::axis("cos_theta_i", cosines),
                            test::axis("phi_i", spaced_nodes(0, kPi / 2, kAzimuthsI)),
                            test::axis("cos_theta_o", cosines),
                            test::full_circle("phi_o", kAzimuthsO)};
  table.remainder = NdArray("remainder", axes, precision);
  table.rest_stderr = NdArray("rest_stderr", axes, precision, 1);
  std::size_t cell = 0;
  for (const double cos_i : cosines)
    for (const double phi_i : axes[4].nodes)
      for (const double cos_o : cosines)
        for (const double phi_o : axes[6].nodes) {
          table.remainder.set(cell, exact({cos_i, phi_i, cos_o, phi_o}));
          table.rest_stderr.set(cell++, 0.001 * exact({cos_i, phi_i, cos_o, phi_o}));
        }
  table.info = test::complete_info();
  return table;
}

Parameters parameters_of(const Table& table) { return Parameters::of(table.material); }

double largest(const Rgb& a) {
  return max_component(transform(a, [](double x) { return std::abs(x); }));
}

class FourDimensional : public ::testing::TestWithParam<Precision> {};

TEST_P(FourDimensional, SurvivesBothFileForms) {
  const Table table = make_table(GetParam());
  const ScratchFolder folder;
  for (const std::string name : {"t.exr", "t.vdb"}) {
    save_table(table, folder.file(name));
    const Table loaded = load_table(folder.file(name));
    EXPECT_TRUE(loaded == table) << name;
    EXPECT_EQ(loaded.symmetry, Symmetry::anisotropic);
    EXPECT_EQ(loaded.remainder.axes()[6].period, 2 * kPi);
    EXPECT_EQ(loaded.remainder.precision(), GetParam());
  }
}

TEST_P(FourDimensional, NodesAreExactToRounding) {
  const Table table = make_table(GetParam());
  const TableBsdf bsdf(table, parameters_of(table));
  const auto& axes = table.remainder.axes();
  for (const double cos_i : axes[3].nodes)
    for (const double phi_i : axes[4].nodes)
      for (const double cos_o : axes[5].nodes)
        for (const double phi_o : axes[6].nodes) {
          const AngleCoordinates c{cos_i, phi_i, cos_o, phi_o};
          const Rgb at_node = table.remainder.interpolate(
              std::array{300.0, axes[1].nodes[0], 0.0, c.cos_i, c.phi_i, c.cos_o, c.phi_o});
          ASSERT_LT(largest(at_node - exact(c)), rounding_bound(GetParam()));
          if (cos_i == 1 || cos_o == 1) continue;  // the pole of a direction has no azimuth
          // Slope at most 2.5 a radian, directions exact to 1e-15: the same but for rounding.
          const DirectionPair pair = to_directions(c);
          ASSERT_LT(largest(bsdf.rest(pair.wo, pair.wi) - exact(c)), rounding_bound(GetParam()) + 1e-6);
        }
}

TEST_P(FourDimensional, InterpolatesWithinTheBoundEverywhere) {
  const Table table = make_table(GetParam());
  const TableBsdf bsdf(table, parameters_of(table));
  const double bound = interpolation_bound() + rounding_bound(GetParam());
  ASSERT_LT(bound, 0.04);  // of a function that swings by more than 1
  const double last_o = table.remainder.axes()[6].nodes.back();
  Rng rng(1, 0);
  double worst = 0;
  Rgb lowest(9), highest(-9);
  for (int k = 0; k < 40000; ++k) {
    AngleCoordinates c{lerp(rng.uniform(), kLowest, 1), 2 * kPi * rng.uniform(),
                       lerp(rng.uniform(), kLowest, 1), 2 * kPi * rng.uniform()};
    if (k % 2) c.phi_o = lerp(rng.uniform(), last_o, 2 * kPi);  // half across the seam
    const DirectionPair pair = to_directions(c);                // three quarters mirrored
    const AngleCoordinates in = to_coordinates(Symmetry::anisotropic, pair);
    const Rgb truth = exact(c);
    const Rgb error = bsdf.rest(pair.wo, pair.wi) - truth;
    ASSERT_LT(largest(error), bound) << c.cos_i << ' ' << c.phi_i << ' ' << c.cos_o << ' ' << c.phi_o;
    const Rgb array_error = table.remainder.interpolate(std::array{300.0, 1.5, 0.0, in.cos_i, in.phi_i,
                                                                   in.cos_o, in.phi_o + 2 * kPi}) -
                            truth;  // an azimuth a turn off: the axis is periodic
    ASSERT_LT(largest(array_error), bound);
    ASSERT_NEAR(bsdf.rest_stderr(pair.wo, pair.wi).g, 0.001 * truth.r, 0.001 * bound + 1e-6);  // one number
    worst = std::max(worst, largest(error));
    for (int j = 0; j < 3; ++j) {
      lowest[j] = std::min(lowest[j], truth[j]);
      highest[j] = std::max(highest[j], truth[j]);
    }
  }
  EXPECT_GT(worst, bound / 4);  // the bound is not idle
  for (int j = 0; j < 3; ++j) EXPECT_GT(highest[j] - lowest[j], 1);
}

// Mirrored or turned half round the pair has the same value to the last bit, exchanged or turned otherwise
// another. A reader that mixed up its axes would pass none of the tests above; this shows why.
TEST_P(FourDimensional, HasNoSymmetryButMirrors) {
  const Table table = make_table(GetParam());
  const TableBsdf bsdf(table, parameters_of(table));
  const Vec3 wi = spherical_direction(0.5, 1), wo = spherical_direction(1.1, 2.5);
  const Rgb value = bsdf.rest(wo, wi);
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      EXPECT_EQ(bsdf.rest({x * wo.x, y * wo.y, wo.z}, {x * wi.x, y * wi.y, wi.z}), value);
  const auto turned = [](Vec3 w) { return Vec3{-w.y, w.x, w.z}; };
  const double bound = 2 * interpolation_bound();
  EXPECT_GT(largest(value - bsdf.rest(wi, wo)), bound);
  EXPECT_GT(largest(value - bsdf.rest({wo.x, -wo.y, wo.z}, wi)), bound);
  EXPECT_GT(largest(value - bsdf.rest(turned(wo), turned(wi))), bound);
}

// Sampling and density of an anisotropic table agree too. False alarm 1e-4.
TEST_P(FourDimensional, SamplesFollowThePdf) {
  const Table table = make_table(GetParam());
  const TableBsdf bsdf(table, parameters_of(table));
  const auto result = test::chi_square_of_sampling(bsdf, spherical_direction(0.8, 5), {.samples = 100000}, 1);
  EXPECT_GT(result.p_value, 1e-4);
  EXPECT_GT(result.degrees, 200);
}

// albedo(wo) by its own quadrature (cosine bins of 1/32, the azimuths of the nodes) against sampling: the
// interpolant's error does not matter, both see the same. 4.5 standard errors, and 1e-3 for kinks inside the
// bins.
TEST_P(FourDimensional, AlbedoFollowsTheViewersAzimuth) {
  const Table table = make_table(GetParam());
  const TableBsdf bsdf(table, parameters_of(table));
  for (const double phi : {0.0, 2.0, 6.2}) {
    const Vec3 wo = spherical_direction(0.8, phi);
    const auto sampled = test::sample_totals(bsdf, wo, 100000, 2).albedo;
    const Rgb albedo = bsdf.albedo(wo);
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(test::deviation(sampled[c].mean(), sampled[c].std_error(), albedo[c], 0, 1e-3 * albedo[c]),
                4.5)
          << phi << " channel " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Precision, FourDimensional,
                         ::testing::Values(Precision::half_float, Precision::single_float),
                         [](const auto& info) {
                           return info.param == Precision::half_float ? "half" : "single";
                         });

}  // namespace
}  // namespace sunbeam
