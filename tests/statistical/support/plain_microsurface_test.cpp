// The yardstick of multiple-scattering facets by itself: normals, energy, the first bounce in closed form,
// reciprocity. Fixed seeds; the stated rates of false alarm hold when a seed is changed.
#include "tests/support/plain_microsurface.h"

#include <gtest/gtest.h>

#include "sunbeam/detail/ggx.h"

namespace sunbeam {
namespace {

using test::PlainMicrosurface;

Material rough(const Roughness& roughness, Transmission transmission = Transmission::refract) {
  Material m;
  m.transmission = transmission;
  m.film_thickness_nm = 350;
  m.base_ior = 1.4;
  m.roughness = roughness;
  return m;
}

const Roughness kSurfaces[] = {Roughness(0.3), Roughness(1), Roughness(0.2, 0.7)};
const Rgb kNm(650, 510, 475);

Vec3 flip(const Vec3& w) { return {w.x, w.y, -w.z}; }

// Against the density of Heitz 2014 for rays from above and (signed Lambda) from below, in cells of the
// normal. 3 surfaces x 4 directions, 1e-3 in all.
TEST(PlainMicrosurface, NormalsFollowTheirDensity) {
  const test::CellGrid grid{.polar = 8, .azimuthal = 12};
  for (const auto& roughness : kSurfaces)
    for (const double cosine : {1.0, 0.5, 0.05, -0.2}) {
      const test::PlainHeightfield surface(roughness);
      const Vec3 w = direction_from_cosine(cosine, 0.5);
      Rng rng(1, 0);
      constexpr int kCount = 100000;
      test::PowerHistogram found(grid);
      for (int i = 0; i < kCount; ++i) found.add_walk(surface.visible_normal(w, rng), Rgb(1));
      const auto cells = found.cells();
      const Ggx ggx(roughness);
      std::vector<test::Cell> counts;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        double sum = 0;
        constexpr int kFine = 64;
        for (int a = 0; a < kFine; ++a)
          for (int b = 0; b < kFine; ++b) {
            const Vec3 h = grid.point(i, {(a + 0.5) / kFine, (b + 0.5) / kFine});
            sum += ggx.d(h) * std::max(0.0, dot(w, h)) / (w.z * (1 + surface.lambda(w)));
          }
        counts.push_back({cells[i].mean.g * kCount, kCount * sum * grid.solid_angle() / (kFine * kFine), 0});
      }
      EXPECT_GT(test::chi_square(counts).p_value, test::sidak(1e-3, 12)) << roughness.u << ' ' << cosine;
    }
}

// A walk that carries one wavelength never loses or gains.
TEST(PlainMicrosurface, RefractingFacetsKeepEnergyExactly) {
  for (const auto& roughness : kSurfaces)
    for (const double cosine : {0.9, 0.2, -0.3, -0.9}) {
      const PlainMicrosurface surface(rough(roughness), Rgb(550));
      Rng rng(2, 0);
      for (int i = 0; i < 10000; ++i) {
        const auto o = surface.walk(direction_from_cosine(cosine, 1), rng);
        ASSERT_NEAR(o.power.g, 1, 1e-12);
        ASSERT_EQ(o.travel.z > 0, o.is_outside);
        ASSERT_NEAR(length(o.travel), 1, 1e-12);
      }
    }
}

// Three wavelengths chosen between by their mean: each keeps 1 on average. 3 x 4 x 3 tests at 4.5 standard
// errors: 2.5e-4.
TEST(PlainMicrosurface, EveryWavelengthKeepsItsEnergy) {
  for (const auto& roughness : kSurfaces)
    for (const double cosine : {0.9, 0.2, -0.3, -0.9}) {
      const PlainMicrosurface surface(rough(roughness), kNm);
      Rng rng(3, 0);
      test::RgbMean power;
      for (int i = 0; i < 50000; ++i) power.add(surface.walk(direction_from_cosine(cosine, 1), rng).power);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(power[c].mean(), 1, 4.5 * power[c].std_error()) << roughness.u << ' ' << cosine;
    }
}

TEST(PlainMicrosurface, MirrorsReturnAllLight) {
  for (const auto& roughness : kSurfaces)
    for (const double cosine : {1.0, 0.5, 0.1, -0.5}) {
      const auto surface = PlainMicrosurface::mirrors(roughness);
      Rng rng(4, 0);
      for (int i = 0; i < 10000; ++i) {
        const auto o = surface.walk(direction_from_cosine(cosine, 1), rng);
        ASSERT_EQ(o.power.g, 1);
        ASSERT_EQ(o.is_outside, cosine > 0);
      }
    }
}

// One bounce off the surface is D G2 R / (4 cos_i cos_o), from outside and from inside. 3 surfaces x 2 modes
// x 2 directions x 2 sides x 3 channels: 72 tests, 1e-3 in all.
TEST(PlainMicrosurface, OneBounceIsTheFirstSurface) {
  const test::CellGrid grid;
  for (const auto& roughness : kSurfaces)
    for (const auto transmission : {Transmission::refract, Transmission::straight})
      for (const double cosine : {0.8, 0.3})
        for (const double side : {1.0, -1.0}) {
          const Material m = rough(roughness, transmission);
          const PlainMicrosurface surface(m, kNm);
          const ThinFilm film = side > 0 || transmission == Transmission::straight
                                    ? ThinFilm::of(m)
                                    : ThinFilm::of(m).reversed();
          const Ggx ggx(roughness);
          const Vec3 wi = direction_from_cosine(cosine, 0.7);
          Rng rng(5, 0);
          test::PowerHistogram found(grid);
          for (int i = 0; i < 100000; ++i) {
            const auto o = surface.walk(side * wi, rng);
            if (o.bounces == 1 && o.is_outside == (side > 0))
              found.add_walk(side * o.travel, o.power);
            else
              found.add_walk();
          }
          const auto expected = test::integrate_cells(grid, 4000, rng, [&](const Vec3& wo, Rng&) {
            const Vec3 h = normalize(wo + wi);
            return airy(film, std::min(dot(wo, h), 1.0), kNm).reflectance *
                   (ggx.reflection(wo, wi, h) * wo.z);
          });
          EXPECT_GT(test::least_p_value(found.cells(), expected), test::sidak(1e-3, 72))
              << roughness.u << ' ' << to_string(transmission) << ' ' << cosine << ' ' << side;
        }
}

// Light refracted at its first facet leaves downwards unmasked with the mean of (1 - C1)^Lambda_t over the
// heights it arrives at, Beta(1 + Lambda_i, 1 + Lambda_t) (1 + Lambda_i) (Heitz et al. 2016): the
// integral over C1 of (1 + Lambda_i) C1^Lambda_i (1 - C1)^Lambda_t. 3 x 2 tests at 4.5 standard errors: 4e-5.
TEST(PlainMicrosurface, OneRefractionHasTheBetaFunction) {
  for (const auto& roughness : kSurfaces)
    for (const double cosine : {0.8, 0.3}) {
      const Material m = rough(roughness);
      const PlainMicrosurface surface(m, Rgb(550));
      const Ggx ggx(roughness);
      const Vec3 wi = direction_from_cosine(cosine, 0.7);
      const double ratio = m.exterior_ior / m.base_ior;
      Rng rng(6, 0);
      test::RunningMean found, expected;
      for (int i = 0; i < 200000; ++i) {
        const auto o = surface.walk(wi, rng);
        found.add(o.bounces == 1 && !o.is_outside ? o.power.g : 0);
        const Vec3 h = ggx.sample_visible(wi, {rng.uniform(), rng.uniform()});
        const double c = dot(wi, h), far = std::sqrt(1 - square(ratio) * (1 - c * c));
        const Vec3 down = ratio * -wi + (ratio * c - far) * h;
        const double i_ = ggx.lambda(wi), t_ = ggx.lambda(down);
        const double beta = std::exp(std::lgamma(1 + i_) + std::lgamma(1 + t_) - std::lgamma(2 + i_ + t_));
        const double passes = airy(ThinFilm::of(m), std::min(c, 1.0), Rgb(550)).transmittance.g;
        expected.add(down.z < 0 ? passes * beta * (1 + i_) : 0);
      }
      EXPECT_NEAR(found.mean(), expected.mean(), 4.5 * std::hypot(found.std_error(), expected.std_error()))
          << roughness.u << ' ' << cosine;
    }
}

// Cells of the upper (first) and lower hemisphere. Row i: light that arrives evenly, with radiance 1, from
// cell i; column j: what of it leaves by cell j, over the squared index there.
std::vector<std::vector<test::CellPower>> exchange(const Material& m, const test::CellGrid& grid, int walks) {
  const PlainMicrosurface surface(m, kNm);
  std::vector<std::vector<test::CellPower>> rows;
  for (std::size_t i = 0; i < 2 * grid.size(); ++i) {
    Rng rng(7, i);
    test::PowerHistogram upper(grid), lower(grid);
    for (int k = 0; k < walks; ++k) {
      const std::size_t cell = i % grid.size();
      const double row = static_cast<double>(cell / grid.azimuthal);
      const double z2 = (square(row) + rng.uniform() * (2 * row + 1)) / square(grid.polar);
      const Vec3 within = grid.point(cell, {0.5, rng.uniform()});
      const Vec3 w = direction_from_cosine(std::sqrt(z2), std::atan2(within.y, within.x));
      const auto o = surface.walk(i < grid.size() ? w : flip(w), rng);
      o.is_outside ? upper.add_walk(o.travel, o.power) : upper.add_walk();
      o.is_outside ? lower.add_walk() : lower.add_walk(flip(o.travel), o.power);
    }
    rows.push_back(upper.cells());
    for (const auto& cell : lower.cells()) rows.back().push_back(cell);
    for (std::size_t j = 0; j < rows.back().size(); ++j) {
      const double index = j < grid.size() ? m.exterior_ior : m.base_ior;
      const double scale = grid.projected(i % grid.size()) / square(index);
      rows.back()[j].mean *= scale;
      rows.back()[j].variance *= square(scale);
    }
  }
  return rows;
}

// f(i, o) = f(o, i) of reflection and f_t(i, o) / n_o^2 = f_t(o, i) / n_i^2 of transmission, all bounces. 4
// surfaces x 3 channels, 1e-3 in all.
TEST(PlainMicrosurface, IsReciprocal) {
  const test::CellGrid grid{.polar = 3, .azimuthal = 4};
  for (const auto& m : {rough(0.3), rough(1), rough({0.2, 0.7}), rough(0.8, Transmission::straight)}) {
    const auto power = exchange(m, grid, 40000);
    std::vector<test::CellPower> there, back;
    for (std::size_t i = 0; i < power.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        there.push_back(power[i][j]);
        back.push_back(power[j][i]);
      }
    EXPECT_GT(test::least_p_value(there, back), test::sidak(1e-3, 12)) << m.roughness.u;
    EXPECT_GT(test::compare_cells(there, back, 1).degrees, 60) << m.roughness.u;
  }
}

// What the single-scattering model keeps of mirrors of alpha 1, by quadrature of D G2 / (4 cos).
TEST(PlainMicrosurface, SingleBounceAlbedoOfMirrors) {
  const auto surface = PlainMicrosurface::mirrors(1);
  const Ggx ggx(1);
  for (const double cosine : {1.0, 0.4}) {
    const Vec3 wi = direction_from_cosine(cosine, 0);
    Rng rng(8, 0);
    test::RunningMean single, expected;
    for (int i = 0; i < 200000; ++i) single.add(surface.walk(wi, rng).bounces == 1);
    for (const double albedo : test::integrate_stratified(200, 16, rng, [&](const Vec3&wo, Rng&) {
           return ggx.reflection(wo, wi, normalize(wo + wi)) * wo.z;
         }))
      expected.add(albedo);
    EXPECT_NEAR(single.mean(), expected.mean(), 4.5 * std::hypot(single.std_error(), expected.std_error()));
    EXPECT_LT(single.mean(), 0.9);  // and there is something to follow
  }
}

}  // namespace
}  // namespace sunbeam
