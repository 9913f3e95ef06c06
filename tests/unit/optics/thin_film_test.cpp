#include "bake/optics/thin_film.h"

#include <gtest/gtest.h>

#include "sunbeam/core/rng.h"
#include "tests/support/airy_reference.h"
#include "tests/support/csv.h"

namespace sunbeam {
namespace {

double reflectance(const ThinFilm& film, double cosine, double wavelength_nm = 550) {
  return airy(film, cosine, Rgb(wavelength_nm)).reflectance.r;
}
double transmittance(const ThinFilm& film, double cosine, double wavelength_nm = 550) {
  return airy(film, cosine, Rgb(wavelength_nm)).transmittance.r;
}
double cosine_of_sine(double sine) { return std::sqrt((1 - sine) * (1 + sine)); }

const double kCosines[] = {1, 0.99, 0.8, 0.5, 0.3, 0.1, 0.01};

TEST(ThinFilm, ReferenceTable) {
  for (const auto& row : test::read_reference("film.csv")) {
    const ThinFilm film{row.number("exterior_ior"), row.number("film_ior"), row.number("base_ior"),
                        row.number("film_thickness_nm")};
    const double cosine = std::cos(test::radians(row.number("theta_i_deg")));
    EXPECT_NEAR(reflectance(film, cosine, row.number("wavelength_nm")), row.number("reflectance"), 1e-9)
        << "film.csv:" << row.line;
  }
}

TEST(ThinFilm, ThreeWavelengthsAreThreeFilms) {
  const ThinFilm film{1, 1.56, 1.3, 700};
  const FilmPower all = airy(film, 0.7, {650, 510, 475});
  EXPECT_EQ(all.reflectance.r, reflectance(film, 0.7, 650));
  EXPECT_EQ(all.reflectance.g, reflectance(film, 0.7, 510));
  EXPECT_EQ(all.reflectance.b, reflectance(film, 0.7, 475));
  EXPECT_NE(all.reflectance.r, all.reflectance.b);
}

TEST(ThinFilm, NoThicknessIsTheBareInterface) {
  for (const double n2 : {1.0, 1.2, 1.5, 2.5})
    for (const double cosine : kCosines) {
      EXPECT_NEAR(reflectance({1, 1.56, n2, 0}, cosine), test::fresnel_reference(1, n2, cosine), 1e-13);
      EXPECT_NEAR(reflectance({n2, 1.1, 1, 0}, cosine), test::fresnel_reference(n2, 1, cosine), 1e-13);
    }
}

// At normal incidence ((1 - 1.5) / (1 + 1.5))^2 = 0.04.
TEST(ThinFilm, BareInterfaceByHand) { EXPECT_NEAR(reflectance({1, 2.2, 1.5, 0}, 1), 0.04, 1e-15); }

TEST(ThinFilm, IndexMatchedFilmIsInvisible) {
  for (const double thickness : {10.0, 300.0, 2000.0})
    for (const double cosine : kCosines) {
      const double bare = test::fresnel_reference(1, 1.56, cosine);
      EXPECT_NEAR(reflectance({1, 1.56, 1.56, thickness}, cosine), bare, 1e-12);
      EXPECT_NEAR(reflectance({1, 1, 1.56, thickness}, cosine), bare, 1e-12);
    }
}

TEST(ThinFilm, NothingAtAllReflectsNothing) {
  for (const double cosine : kCosines) EXPECT_NEAR(reflectance({1.3, 1.3, 1.3, 400}, cosine), 0, 1e-12);
}

// 2 n1 d cos1 = m lambda: the film has no effect at that wavelength.
TEST(ThinFilm, HalfWaveIsInvisible) {
  for (const double cosine : kCosines)
    for (const int order : {1, 2, 7}) {
      const double cos1 = std::sqrt(1 - (1 - cosine * cosine) / square(1.56));
      const double thickness = order * 550 / (2 * 1.56 * cos1);
      EXPECT_NEAR(reflectance({1, 1.56, 1.33, thickness}, cosine), test::fresnel_reference(1, 1.33, cosine),
                  1e-11);
    }
}

// n1^2 = n0 n2 and n1 d = lambda / 4 at normal incidence: the two reflections cancel.
TEST(ThinFilm, QuarterWaveCoatingKillsTheReflection) {
  const double n1 = std::sqrt(1.0 * 2.25);
  EXPECT_NEAR(reflectance({1, n1, 2.25, 550 / (4 * n1)}, 1), 0, 1e-30);
}

// A quarter wave of any n1 at normal incidence acts as n1^2 / n2 would: R = ((n0 n2 - n1^2) / (n0 n2 +
// n1^2))^2.
TEST(ThinFilm, QuarterWaveByHand) {
  const double expected = square((1.5 - 4) / (1.5 + 4));
  EXPECT_NEAR(reflectance({1, 2, 1.5, 550.0 / 8}, 1), expected, 1e-15);
}

// Stokes: seen from the other side along the refracted direction the film reflects the same.
TEST(ThinFilm, ReversalKeepsTheReflectance) {
  Rng rng(1, 0);
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const ThinFilm film{1 + rng.uniform(), 1 + rng.uniform(), 1 + rng.uniform(), 2000 * rng.uniform()};
    const double cosine = 0.02 + 0.98 * rng.uniform();
    const double far2 = refracted_cosine_squared(film.exterior_ior, film.base_ior, cosine);
    if (far2 < 1e-4) continue;
    ++checked;
    EXPECT_NEAR(reflectance(film.reversed(), std::sqrt(far2)), reflectance(film, cosine), 1e-11);
  }
  EXPECT_GT(checked, 1000);
}

// Against complex amplitudes with their signs: all regimes, evanescent films included.
TEST(ThinFilm, AgreesWithComplexAmplitudes) {
  Rng rng(2, 0);
  int evanescent = 0, total = 0;
  for (int i = 0; i < 5000; ++i) {
    const ThinFilm film{1 + 1.5 * rng.uniform(), 1 + rng.uniform(), 1 + 1.5 * rng.uniform(),
                        1500 * rng.uniform()};
    const double cosine = 0.02 + 0.98 * rng.uniform(), sine = film.exterior_ior * cosine_of_sine(cosine);
    if (std::abs(sine - film.film_ior) < 1e-5 || std::abs(sine - film.base_ior) < 1e-5) continue;
    const auto expected =
        test::airy_reference(film.exterior_ior, film.film_ior, film.base_ior, film.thickness_nm, cosine, 550);
    const FilmPower found = airy(film, cosine, Rgb(550));
    EXPECT_NEAR(found.reflectance.r, static_cast<double>(expected.reflectance), 1e-10);
    EXPECT_NEAR(found.transmittance.r, static_cast<double>(expected.transmittance), 1e-10);
    evanescent += sine > film.film_ior && sine < film.base_ior;
    total += sine > film.base_ior;
  }
  EXPECT_GT(evanescent, 50);  // the sweep did visit frustrated and plain total reflection
  EXPECT_GT(total, 200);
}

// Total reflection begins at n0 sin = n2, whatever n1.
TEST(ThinFilm, TotalReflectionBelongsToTheBase) {
  for (const double n1 : {1.05, 1.2, 1.4, 2.0}) {
    const ThinFilm film{1.5, n1, 1.2, 200};
    for (const double sine : {0.8 + 1e-9, 0.85, 0.95, 1.0}) {  // critical at 1.2 / 1.5
      EXPECT_EQ(reflectance(film, cosine_of_sine(sine)), 1) << n1;
      EXPECT_EQ(transmittance(film, cosine_of_sine(sine)), 0) << n1;
    }
    for (const double sine : {0.8 - 1e-6, 0.75, 0.5, 0.0}) {
      EXPECT_LT(reflectance(film, cosine_of_sine(sine)), 1) << n1;
      EXPECT_GT(transmittance(film, cosine_of_sine(sine)), 0) << n1;
    }
  }
}

// Frustrated total reflection: n1 < n0 sin < n2. The wave dies as exp(-k kappa d) on its way through, its
// power as the square: doubling a thick film squares that factor. kappa = sqrt((n0 sin)^2 - n1^2).
TEST(ThinFilm, FrustratedTotalReflectionLeaks) {
  const double sine = 0.9, wavelength = 550;
  const auto film = [](double thickness) { return ThinFilm{1.5, 1.1, 1.5, thickness}; };
  const double kappa = std::sqrt(square(1.5 * sine) - square(1.1));
  const double d = 600;
  const double ratio =
      transmittance(film(2 * d), cosine_of_sine(sine)) / transmittance(film(d), cosine_of_sine(sine));
  const double decay = std::exp(-4 * kPi * kappa * d / wavelength);
  EXPECT_NEAR(ratio / decay, 1, 0.01);
  EXPECT_GT(transmittance(film(50), cosine_of_sine(sine)), 0.3);
  EXPECT_LT(decay, 1e-4);  // else the test above would say nothing
}

// The deep evanescent T keeps its digits: 1e-30 and less, against extended precision.
TEST(ThinFilm, DeepEvanescentTransmittanceKeepsDigits) {
  for (const double thickness : {1000.0, 3000.0, 6000.0}) {
    const double cosine = cosine_of_sine(0.9);
    const auto expected = test::airy_reference(1.5, 1.1, 1.5, thickness, cosine, 550);
    const double found = transmittance({1.5, 1.1, 1.5, thickness}, cosine);
    EXPECT_NEAR(found / static_cast<double>(expected.transmittance), 1, 1e-11) << thickness;
  }
}

TEST(ThinFilm, GrazingReflectsAll) {
  for (const double n1 : {1.0, 1.3, 1.56})
    for (const double n2 : {1.1, 1.5}) {
      EXPECT_EQ(reflectance({1, n1, n2, 300}, 0), 1);
      EXPECT_NEAR(reflectance({1, n1, n2, 300}, 1e-9), 1, 1e-7);
    }
}

// Towards grazing T falls as cos: 1 - R would have lost its digits long before 1e-8.
TEST(ThinFilm, TransmittanceKeepsRelativePrecisionAtGrazing) {
  for (const double n1 : {1.2, 1.56})
    for (const double n2 : {1.05, 1.33, 2.0})
      for (const double cosine : {0.1, 1e-2, 1e-4, 1e-6, 1e-8}) {
        const auto expected = test::airy_reference(1, n1, n2, 900, cosine, 550);
        const double found = transmittance({1, n1, n2, 900}, cosine);
        EXPECT_NEAR(found / static_cast<double>(expected.transmittance), 1, 1e-10)
            << n1 << ' ' << n2 << ' ' << cosine;
      }
}

// The same with equal media on both sides, where the cosine beyond is the cosine itself.
TEST(ThinFilm, TransmittanceKeepsRelativePrecisionAtGrazingBetweenEqualMedia) {
  for (const double cosine : {0.1, 1e-2, 1e-4, 1e-6, 1e-8}) {
    const auto expected = test::airy_reference(1, 1.56, 1, 900, cosine, 550);
    const double found = transmittance({1, 1.56, 1, 900}, cosine);
    EXPECT_NEAR(found / static_cast<double>(expected.transmittance), 1, 1e-8) << cosine;
  }
}

// n0 sin = n1 exactly: cos1 = 0 and the usual formula is 0/0. With 1.25 * 0.8 = 1 the limit of the phase term
// sin(k c1) / c1 is k, so with q0, q2 the admittances r = (q0 - q2 - i k b) / (q0 + q2 - i k b'), where
// s: b = b' = q0 q2 / n1;  p: b = b' = p0 p2 n1.
TEST(ThinFilm, FiniteWhereTheFilmAngleIsGrazing) {
  const ThinFilm film{1.25, 1, 1.5, 300};
  const double cos0 = 0.6, cos2 = std::sqrt(1 - square(1 / 1.5)), k = 2 * kPi * 300 / 550;
  const auto power = [&](double q0, double q2) {
    return (square(q0 - q2) + square(k * q0 * q2)) / (square(q0 + q2) + square(k * q0 * q2));
  };
  const double expected = (power(1.25 * cos0, 1.5 * cos2) + power(cos0 / 1.25, cos2 / 1.5)) / 2;
  EXPECT_NEAR(reflectance(film, cos0), expected, 1e-13);
  for (const double step : {1e-12, 1e-9, 1e-7}) {
    EXPECT_NEAR(reflectance(film, cos0 + step), expected, 20 * step + 1e-13);
    EXPECT_NEAR(reflectance(film, cos0 - step), expected, 20 * step + 1e-13);
  }
}

// About that angle, against complex amplitudes in extended precision: the small R of a film between nearly
// equal media keeps its digits.
TEST(ThinFilm, KeepsDigitsAboutTheFilmsCriticalAngle) {
  for (const double thickness : {1.0, 30.0, 300.0, 1500.0})
    for (const double step : {1e-9, 1e-7, 1e-5, 1e-3, 1e-2})
      for (const double cosine : {0.6 - step, 0.6 + step}) {
        const auto expected = test::airy_reference(1.25L, 1, 1.3L, thickness, cosine, 550);
        const FilmPower found = airy({1.25, 1, 1.3, thickness}, cosine, Rgb(550));
        EXPECT_NEAR(found.reflectance.r / static_cast<double>(expected.reflectance), 1, 1e-14)
            << thickness << ' ' << cosine;
        EXPECT_NEAR(found.transmittance.r / static_cast<double>(expected.transmittance), 1, 3e-14)
            << thickness << ' ' << cosine;
      }
}

TEST(ThinFilm, ExtremeStacksStayFiniteAndConserve) {
  for (const double n0 : {1.0, 1.5, 5.0})
    for (const double n1 : {1.0, 1.56, 5.0})
      for (const double n2 : {1.0, 1.5, 5.0})
        for (const double thickness : {0.0, 1e-6, 900.0, 1e5})
          for (const double cosine : {0.0, 1e-300, 1e-12, 1e-4, 0.3, 0.6, 1 - 1e-15, 1.0})
            for (const double wavelength : {380.0, 780.0}) {
              const FilmPower p = airy({n0, n1, n2, thickness}, cosine, Rgb(wavelength));
              EXPECT_NEAR(p.reflectance.r + p.transmittance.r, 1, 1e-12)
                  << n0 << '|' << n1 << '|' << n2 << " d " << thickness << " cos " << cosine;
              EXPECT_GE(p.reflectance.r, 0);
              EXPECT_LE(p.reflectance.r, 1 + 1e-15);
              EXPECT_GE(p.transmittance.r, 0);
            }
}

}  // namespace
}  // namespace sunbeam
