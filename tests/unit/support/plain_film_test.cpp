#include "tests/support/plain_film.h"

#include <gtest/gtest.h>

#include "tests/support/airy_reference.h"
#include "tests/support/quadrature.h"
#include "tests/support/stats.h"

namespace sunbeam {
namespace {

const Rgb kWavelengths(650, 510, 475);

Material material(Transmission transmission, double roughness, double base_ior) {
  Material m;
  m.transmission = transmission;
  m.roughness = roughness;
  m.base_ior = base_ior;
  m.film_thickness_nm = 600;
  return m;
}
test::FacetedFilm refracting(double roughness, double base_ior) {
  return {material(Transmission::refract, roughness, base_ior), kWavelengths};
}
test::FacetedFilm straight(double roughness) {
  return {material(Transmission::straight, roughness, 1.5), kWavelengths};
}

const Vec3 kDirections[] = {spherical_direction(0.1, 0), spherical_direction(0.8, 0.5),
                            spherical_direction(1.3, 2)};

// sin m = sin w / n2, same azimuth; T of the independent film; nothing but reflection and crossing.
TEST(FacetedFilm, SmoothCrossingObeysSnell) {
  const test::FacetedFilm film = refracting(0, 1.5);
  Rng rng(1, 0);
  for (const Vec3& w : kDirections) {
    const test::Facet facet = film.meet_from_outside(w, rng);
    const auto crossing = film.cross(w, facet);
    const auto mirrored = film.reflect_up(w, facet);
    ASSERT_TRUE(crossing && mirrored);
    EXPECT_NEAR(crossing->inside.x, w.x / 1.5, 1e-15);
    EXPECT_NEAR(crossing->inside.y, w.y / 1.5, 1e-15);
    EXPECT_NEAR(length(crossing->inside), 1, 1e-15);
    EXPECT_EQ(crossing->density, 0);  // a single direction
    EXPECT_NEAR(mirrored->direction.x, -w.x, 1e-15);
    for (int c = 0; c < 3; ++c) {
      const auto expected = test::airy_reference(1, 1.56, 1.5, 600, w.z, kWavelengths[c]);
      EXPECT_NEAR(crossing->weight[c], static_cast<double>(expected.transmittance), 1e-12);
      EXPECT_NEAR(mirrored->weight[c] + crossing->weight[c], 1, 1e-12);
    }
  }
}

TEST(FacetedFilm, SmoothLeavingUndoesCrossing) {
  const test::FacetedFilm film = refracting(0, 1.5);
  Rng rng(1, 0);
  for (const Vec3& w : kDirections) {
    const auto crossing = film.cross(w, film.meet_from_outside(w, rng));
    const auto out = film.leave(crossing->inside, film.meet_from_below(crossing->inside, rng));
    ASSERT_TRUE(out);
    EXPECT_NEAR(length(out->direction - w), 0, 1e-14);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(out->weight[c], crossing->weight[c], 1e-12);
    // dw / dm = n2^2 cos m / cos w; the walk from m reaches w surely: density 1 per dm against dw.
    EXPECT_NEAR(crossing->reverse_ratio, w.z / (1.5 * 1.5 * crossing->inside.z), 1e-14);
  }
}

TEST(FacetedFilm, SmoothTotalReflectionFromBelow) {
  const test::FacetedFilm film = refracting(0, 1.5);
  Rng rng(1, 0);
  const Vec3 m = spherical_direction(std::asin(1 / 1.5) + 0.01, 0.3);
  const test::Facet facet = film.meet_from_below(m, rng);
  EXPECT_EQ(facet.reflect_chance, 1);
  EXPECT_FALSE(film.leave(m, facet));
  const auto back = film.reflect_down(m, facet);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->weight, Rgb(1));
  EXPECT_NEAR(back->direction.z, m.z, 1e-15);
}

TEST(FacetedFilm, StraightKeepsTheDirectionBothWays) {
  for (const double roughness : {0.0, 0.3}) {
    const test::FacetedFilm film = straight(roughness);
    Rng rng(2, 0);
    const Vec3 w = kDirections[1];
    const auto in = film.cross(w, film.meet_from_outside(w, rng));
    const auto out = film.leave(w, film.meet_from_below(w, rng));
    ASSERT_TRUE(in && out);
    EXPECT_EQ(length(in->inside - w), 0);
    EXPECT_EQ(length(out->direction - w), 0);
    EXPECT_EQ(in->density, 0);
    EXPECT_EQ(in->reverse_ratio, 1);
    EXPECT_FALSE(film.has_glossy_crossing());
  }
}

// Expectation of draw(rng) against `expected`. 5 standard errors: 6e-7 a comparison.
template <class Draw>
void expect_mean(const Rgb& expected, int count, std::uint64_t seed, Draw draw,
                 double quadrature_error = 1e-4) {
  Rng rng(seed, 0);
  test::RunningMean mean[3];
  for (int i = 0; i < count; ++i) {
    const Rgb x = draw(rng);
    for (int c = 0; c < 3; ++c) mean[c].add(x[c]);
  }
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(mean[c].mean(), expected[c], 5 * mean[c].std_error() + quadrature_error) << "channel " << c;
}

template <class F>
Rgb integrate_visible(double alpha, const Vec3& w, F f) {
  const Ggx ggx(alpha);
  Rgb total;
  for (int c = 0; c < 3; ++c)
    total[c] = test::integrate_normals(alpha, 400, 200, [&](const Vec3& h) {
      const double density = ggx.visible_pdf(w, h);
      return density > 0 ? density * f(std::min(1.0, dot(w, h)))[c] : 0.0;
    });
  return total;
}

// Tbar = 1 - Int D_vis R: no shadowing in "straight" mode.
TEST(FacetedFilm, RoughStraightWeightIsTbar) {
  const test::FacetedFilm film = straight(0.4);
  for (const Vec3& w : kDirections) {
    const Rgb lost = integrate_visible(0.4, w, [&](double cosine) { return film.power(cosine).reflectance; });
    expect_mean(Rgb(1) - lost, 50000, 3,
                [&](Rng& rng) { return film.cross(w, film.meet_from_outside(w, rng))->weight; });
  }
}

// Index-matched "refract": Int D_vis T G2(w, -w) / G1(w), which is not Tbar.
TEST(FacetedFilm, RoughIndexMatchedWeightIsWaltersLimit) {
  const test::FacetedFilm film = refracting(0.4, 1);
  EXPECT_FALSE(film.has_glossy_crossing());
  const Ggx ggx(0.4);
  for (const Vec3& w : kDirections) {
    const double shadowing = (1 + ggx.lambda(w)) / (1 + 2 * ggx.lambda(w));
    const Rgb passed = integrate_visible(0.4, w, [&](double c) { return film.power(c).transmittance; });
    expect_mean(passed * shadowing, 50000, 4,
                [&](Rng& rng) { return film.cross(w, film.meet_from_outside(w, rng))->weight; });
  }
}

// The drawn crossing and the closed form speak of the same function: f_t(w -> m) = f_t(m -> w) (n2/n0)^2, so
// weight = f_t(m -> w) (n2/n0)^2 cos_m / density, and the densities agree.
TEST(FacetedFilm, CrossAgreesWithExitPointwise) {
  Rng rng(5, 0);
  for (const double base_ior : {1.05, 1.5, 2.2}) {
    const test::FacetedFilm film = refracting(0.3, base_ior);
    int compared = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 w = kDirections[i % 3];
      const auto crossing = film.cross(w, film.meet_from_outside(w, rng));
      if (!crossing || crossing->inside.z < 1e-3) continue;
      const test::Exit exit = film.exit(crossing->inside, w);
      if (!(exit.density > 0)) continue;
      ++compared;
      EXPECT_NEAR(exit.density / crossing->density, 1, 1e-6);
      for (int c = 0; c < 3; ++c) {
        const double weight = exit.value[c] * square(base_ior) * crossing->inside.z / exit.density;
        EXPECT_NEAR(weight, crossing->weight[c], 1e-6);
      }
    }
    EXPECT_GT(compared, 290);
  }
}

// E[weight; crossing] = Int f_t(w -> m) cos_m dm, with f_t by Walter's formula from exit().
TEST(FacetedFilm, MeanCrossingIsTheIntegralOfTheLobe) {
  for (const double base_ior : {1.33, 2.0}) {
    const test::FacetedFilm film = refracting(0.5, base_ior);
    for (const Vec3& w : kDirections) {
      Rgb expected;
      for (int c = 0; c < 3; ++c)
        expected[c] = test::integrate_hemisphere(
            600, 300, [&](const Vec3& m) { return film.exit(m, w).value[c] * square(base_ior) * m.z; });
      EXPECT_LT(max_component(expected), 1);
      expect_mean(expected, 100000, 6, [&](Rng& rng) {
        const auto crossing = film.cross(w, film.meet_from_outside(w, rng));
        return crossing ? crossing->weight : Rgb();
      });
    }
  }
}

// E[weight; leaving] = Int f_t(m -> w) cos_w dw <= 1.
TEST(FacetedFilm, MeanLeavingIsTheIntegralOfTheLobe) {
  const test::FacetedFilm film = refracting(0.5, 1.5);
  for (const Vec3& m : kDirections) {
    Rgb expected;
    for (int c = 0; c < 3; ++c)
      expected[c] =
          test::integrate_hemisphere(600, 300, [&](const Vec3& w) { return film.exit(m, w).value[c] * w.z; });
    EXPECT_LE(max_component(expected), 1);
    EXPECT_GT(max_component(expected), 0.01);
    expect_mean(expected, 100000, 7, [&](Rng& rng) {
      const auto out = film.leave(m, film.meet_from_below(m, rng));
      return out ? out->weight : Rgb();
    });
  }
}

// Int density dm = P(the facet lets w pass): every refraction into the denser side succeeds unless it points
// up. The density ends abruptly where facets turn away, so midpoints err by 1e-3.
TEST(FacetedFilm, ExitDensityIntegratesToTheChanceOfCrossing) {
  const test::FacetedFilm film = refracting(0.5, 1.5);
  for (const Vec3& w : kDirections) {
    const double expected =
        test::integrate_hemisphere(600, 300, [&](const Vec3& m) { return film.exit(m, w).density; });
    expect_mean(
        Rgb(expected), 100000, 8,
        [&](Rng& rng) { return Rgb(film.cross(w, film.meet_from_outside(w, rng)) ? 1 : 0); }, 2e-3);
  }
}

// Walter et al. 2007, eq. 17: from m, density over w = D_vis(h; m) n0^2 w.h / (n0 w.h - n2 m.h)^2.
TEST(FacetedFilm, ReverseRatioIsWaltersJacobian) {
  const double n2 = 1.5;
  const test::FacetedFilm film = refracting(0.3, n2);
  Rng rng(9, 0);
  int compared = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 w = kDirections[i % 3];
    const test::Facet facet = film.meet_from_outside(w, rng);
    const auto crossing = film.cross(w, facet);
    if (!crossing) continue;
    const Vec3 m = crossing->inside, h = facet.normal;
    const double backwards = Ggx(0.3).visible_pdf(m, h) * dot(w, h) / square(dot(w, h) - n2 * dot(m, h));
    EXPECT_NEAR(crossing->reverse_ratio * crossing->density / backwards, 1, 1e-8);
    ++compared;
  }
  EXPECT_GT(compared, 90);
}

TEST(FacetedFilm, FirstSurfaceIsReciprocalAndLosesOnlyBySingleScattering) {
  const test::FacetedFilm film = straight(0.3);
  const Rgb ab = film.first_surface(kDirections[0], kDirections[2]);
  const Rgb ba = film.first_surface(kDirections[2], kDirections[0]);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ab[c] / ba[c], 1, 1e-13);
  for (const Vec3& wo : kDirections) {
    const double reflected = test::integrate_hemisphere(
        400, 400, [&](const Vec3& wi) { return film.first_surface(wo, wi).r * wi.z; });
    const double all =
        integrate_visible(0.3, wo, [&](double cosine) { return film.power(cosine).reflectance; }).r;
    EXPECT_LT(reflected, all);
    EXPECT_GT(reflected, 0.3 * all);
  }
}

// Int first_surface_pdf = P(the walk chooses reflection and comes out above).
TEST(FacetedFilm, FirstSurfaceDensityIsTheChanceOfReflection) {
  const test::FacetedFilm film = straight(0.3);
  for (const Vec3& wo : kDirections) {
    const double expected =
        test::integrate_hemisphere(400, 400, [&](const Vec3& wi) { return film.first_surface_pdf(wo, wi); });
    expect_mean(Rgb(expected), 100000, 10, [&](Rng& rng) {
      const test::Facet facet = film.meet_from_outside(wo, rng);
      return Rgb(film.reflect_up(wo, facet) ? facet.reflect_chance : 0);
    });
  }
}

TEST(FacetedFilm, SmoothFilmHasNoLobe) {
  const test::FacetedFilm film = refracting(0, 1.5);
  EXPECT_TRUE(film.is_smooth());
  EXPECT_TRUE(is_black(film.first_surface(kDirections[0], kDirections[1])));
  EXPECT_EQ(film.first_surface_pdf(kDirections[0], kDirections[1]), 0);
}

}  // namespace
}  // namespace sunbeam
