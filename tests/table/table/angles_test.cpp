#include "sunbeam/detail/angles.h"

#include <gtest/gtest.h>

#include "tests/support/angle_pairs.h"
#include "tests/support/bsdf_checks.h"

namespace sunbeam {
namespace {

constexpr Symmetry kBoth[] = {Symmetry::isotropic, Symmetry::anisotropic};

void expect_near(const Vec3& a, const Vec3& b) { EXPECT_LT(length(a - b), 1e-14); }

Vec3 random_direction(Rng& rng) { return test::uniform_hemisphere({rng.uniform(), rng.uniform()}); }

Vec3 turned(const Vec3& w, double angle) {
  return {w.x * std::cos(angle) - w.y * std::sin(angle), w.x * std::sin(angle) + w.y * std::cos(angle), w.z};
}

Vec3 mirrored(const Vec3& w, bool x, bool y) { return {x ? -w.x : w.x, y ? -w.y : w.y, w.z}; }

// The round trip gives the mirror image whose wi lies in the first quadrant, the pair itself if it does so.
TEST(Angles, AnisotropicRoundTripGivesThePairMirrored) {
  Rng rng(1, 0);
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair{random_direction(rng), random_direction(rng)};
    const DirectionPair back = to_directions(to_coordinates(Symmetry::anisotropic, pair));
    expect_near(back.wi, mirrored(pair.wi, pair.wi.x < 0, pair.wi.y < 0));
    expect_near(back.wo, mirrored(pair.wo, pair.wi.x < 0, pair.wi.y < 0));
  }
}

// Mirror images in x and y, half turns among them, have one set of coordinates to the last bit.
TEST(Angles, AnisotropicCoordinatesOfMirrorImages) {
  Rng rng(7, 0);
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair{random_direction(rng), random_direction(rng)};
    const AngleCoordinates c = to_coordinates(Symmetry::anisotropic, pair);
    for (const bool x : {false, true})
      for (const bool y : {false, true}) {
        const DirectionPair image{mirrored(pair.wo, x, y), mirrored(pair.wi, x, y)};
        const AngleCoordinates same = to_coordinates(Symmetry::anisotropic, image);
        EXPECT_EQ(same.phi_i, c.phi_i);
        EXPECT_EQ(same.phi_o, c.phi_o);
      }
    // One of the two alone is another pair.
    const AngleCoordinates other =
        to_coordinates(Symmetry::anisotropic, {pair.wo, mirrored(pair.wi, true, false)});
    EXPECT_NE(other.phi_o, c.phi_o);
  }
}

// An isotropic coordinate stands for the pair up to a common turn and a reflection: the turn that brings wi
// into the xz plane, and the sign that brings wo to y >= 0.
TEST(Angles, IsotropicRoundTripGivesThePairTurned) {
  Rng rng(2, 0);
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair{random_direction(rng), random_direction(rng)};
    const DirectionPair back = to_directions(to_coordinates(Symmetry::isotropic, pair));
    const double angle = -azimuth(pair.wi);
    Vec3 wo = turned(pair.wo, angle);
    wo.y = std::abs(wo.y);
    expect_near(back.wi, turned(pair.wi, angle));
    expect_near(back.wo, wo);
  }
}

TEST(Angles, CoordinatesSurviveTheRoundTrip) {
  Rng rng(3, 0);
  for (const Symmetry symmetry : kBoth)
    for (int k = 0; k < 1000; ++k) {
      const DirectionPair pair{random_direction(rng), random_direction(rng)};
      const AngleCoordinates c = to_coordinates(symmetry, pair);
      const AngleCoordinates again = to_coordinates(symmetry, to_directions(c));
      EXPECT_EQ(again.cos_i, c.cos_i);
      EXPECT_EQ(again.cos_o, c.cos_o);
      // Azimuths near the pole of a direction have few digits: 1e-12 for sin(theta) > 1e-3.
      if (std::min(1 - c.cos_i, 1 - c.cos_o) < 1e-6) continue;
      EXPECT_NEAR(std::remainder(again.phi_i - c.phi_i, 2 * kPi), 0, 1e-12);
      EXPECT_NEAR(std::remainder(again.phi_o - c.phi_o, 2 * kPi), 0, 1e-12);
    }
}

// Across the x axis: azimuths 0.1 and 2 pi - 0.2 are 0.3 apart, not 2 pi - 0.3.
TEST(Angles, SeamOfTheAzimuth) {
  const Vec3 above = spherical_direction(0.7, 0.1), below = spherical_direction(0.4, -0.2);
  for (const DirectionPair& pair : {DirectionPair{above, below}, DirectionPair{below, above}})
    EXPECT_NEAR(to_coordinates(Symmetry::isotropic, pair).phi_o, 0.3, 1e-14);
  // wi below the axis is mirrored, and wo with it.
  const AngleCoordinates c = to_coordinates(Symmetry::anisotropic, {above, below});
  EXPECT_NEAR(c.phi_o, 2 * kPi - 0.1, 1e-14);
  EXPECT_NEAR(c.phi_i, 0.2, 1e-14);
}

// "[0, pi/2]", "[0, 2 pi)" and "[0, pi]", also where atan2 is just below 0 and rounding could give 2 pi
// itself.
TEST(Angles, AzimuthsStayInTheirIntervals) {
  Rng rng(4, 0);
  for (int k = 0; k < 1000; ++k) {
    const double tiny = std::pow(10.0, -20 * rng.uniform());
    const DirectionPair pair{{0.6, -0.8 * tiny, 0.8}, random_direction(rng)};
    const AngleCoordinates a = to_coordinates(Symmetry::anisotropic, pair);
    EXPECT_GE(a.phi_o, 0);
    EXPECT_LT(a.phi_o, 2 * kPi) << "y = " << pair.wo.y;
    const AngleCoordinates exchanged = to_coordinates(Symmetry::anisotropic, {pair.wi, pair.wo});
    for (const double phi_i : {a.phi_i, exchanged.phi_i}) {
      EXPECT_GE(phi_i, 0);
      EXPECT_LE(phi_i, kPi / 2);
    }
    const AngleCoordinates b = to_coordinates(Symmetry::isotropic, pair);
    EXPECT_EQ(b.phi_i, 0);
    EXPECT_GE(b.phi_o, 0);
    EXPECT_LE(b.phi_o, kPi);
  }
  for (const double x : {0.0, -0.0})
    for (const double y : {0.0, -0.0})
      EXPECT_EQ(to_coordinates(Symmetry::anisotropic, {{x, y, 1}, {x, y, 1}}).phi_i, 0);
}

TEST(Angles, MirrorSideIsPi) {
  const Vec3 w = spherical_direction(0.8, 1.9);
  EXPECT_NEAR(to_coordinates(Symmetry::isotropic, {{-w.x, -w.y, w.z}, w}).phi_o, kPi, 1e-14);
  EXPECT_EQ(to_coordinates(Symmetry::isotropic, {w, w}).phi_o, 0);
}

TEST(Angles, IsotropicCoordinatesAreReciprocal) {
  Rng rng(5, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 a = random_direction(rng), b = random_direction(rng);
    const AngleCoordinates ab = to_coordinates(Symmetry::isotropic, {a, b});
    const AngleCoordinates ba = to_coordinates(Symmetry::isotropic, {b, a});
    EXPECT_EQ(ab.phi_o, ba.phi_o);
    EXPECT_EQ(ab.cos_i, ba.cos_o);
  }
}

// All pairs of the two hemispheres: (2 pi)^2 sr^2, of coordinates 1 * 1 * pi or 1 * pi/2 * 1 * 2 pi.
TEST(Angles, MeasureOfAllPairs) {
  EXPECT_NEAR(pair_measure(Symmetry::isotropic) * kPi, square(2 * kPi), 1e-12);
  EXPECT_NEAR(pair_measure(Symmetry::anisotropic) * (kPi / 2) * (2 * kPi), square(2 * kPi), 1e-12);
}

// The coordinates of uniform pairs fall into boxes as the constant measure says: volume * measure / (2 pi)^2
// of them. Eight cells an axis at most, 4^3 and 3^4 cells; chi-square, false alarm 1e-4 in all.
TEST(Angles, MeasureByMonteCarlo) {
  constexpr int kPairs = 200000;
  for (const Symmetry symmetry : kBoth) {
    const bool isotropic = symmetry == Symmetry::isotropic;
    const int n = isotropic ? 4 : 3;
    const double phi_o_range = isotropic ? kPi : 2 * kPi, phi_i_range = kPi / 2;
    const double volume = isotropic ? phi_o_range / (n * n * n) : phi_i_range * phi_o_range / (n * n * n * n);
    std::vector<test::Cell> cells(isotropic ? n * n * n : n * n * n * n,
                                  {0, kPairs * volume * pair_measure(symmetry) / square(2 * kPi), 0});
    Rng rng(6, isotropic);
    for (int k = 0; k < kPairs; ++k) {
      const AngleCoordinates c = to_coordinates(symmetry, {random_direction(rng), random_direction(rng)});
      const auto bin = [n](double x) { return std::clamp(static_cast<int>(x * n), 0, n - 1); };
      int cell = (bin(c.cos_i) * n + bin(c.cos_o)) * n + bin(c.phi_o / phi_o_range);
      if (!isotropic) cell = cell * n + bin(c.phi_i / phi_i_range);
      cells[cell].observed += 1;
    }
    // Totals are fixed here, which only lowers the statistic.
    EXPECT_GT(test::chi_square(cells).p_value, test::sidak(1e-4, 2)) << "isotropic " << isotropic;
  }
}

}  // namespace
}  // namespace sunbeam
