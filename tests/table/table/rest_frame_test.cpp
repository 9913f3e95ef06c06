// The frame that remainders are stored in, against its formula in table.h.
#include "sunbeam/detail/rest_frame.h"

#include <gtest/gtest.h>

#include <limits>

#include "sunbeam/core/rng.h"
#include "sunbeam/table.h"

namespace sunbeam {
namespace {

constexpr double kLargestHalf = 65504;

struct Case {
  Material material;
  double cos_i, cos_o;
  Rgb t_i, t_o;
};

Rgb random_colour(Rng& rng, double low, double high) {
  const double r = lerp(rng.uniform(), low, high), g = lerp(rng.uniform(), low, high);
  return {r, g, lerp(rng.uniform(), low, high)};
}

// Cosines down to the table's lowest, optical depths up to 3, both modes of both choices.
Case random_case(Rng& rng) {
  Case c;
  c.material.transmission = rng.uniform() < 0.5 ? Transmission::straight : Transmission::refract;
  c.material.absorption_path = rng.uniform() < 0.5 ? AbsorptionPath::product : AbsorptionPath::sum;
  c.material.exterior_ior = 1 + 0.3 * rng.uniform();
  c.material.base_ior = c.material.exterior_ior * (1 + rng.uniform());
  c.material.pigment_thickness_nm = 2;
  c.material.absorption_per_nm = rng.uniform() < 0.2 ? 0 : 1.5 * rng.uniform();
  c.material.albedo = random_colour(rng, 0, 1);
  const auto cosine = [&] { return rng.uniform() < 0.3 ? 0.01 : lerp(rng.uniform(), 0.01, 1); };
  c.cos_i = cosine();
  c.cos_o = cosine();
  c.t_i = random_colour(rng, 0.01, 1);
  c.t_o = random_colour(rng, 0.01, 1);
  return c;
}

// table.h once more, written down independently.
struct Formula {
  Rgb front, first_visit;
  double decay;
  explicit Formula(const Case& c) {
    const Material& m = c.material;
    const double ratio = m.exterior_ior / m.base_ior, tau = m.absorption_per_nm * m.pigment_thickness_nm;
    const bool straight = m.transmission == Transmission::straight;
    const auto below = [&](double x) { return straight ? x : std::sqrt(1 - ratio * ratio * (1 - x * x)); };
    const double i = below(c.cos_i), o = below(c.cos_o), sum = 1 / i + 1 / o;
    const double path = m.absorption_path == AbsorptionPath::sum ? sum : 1 / (i * o);
    front = (straight ? 1 : ratio * ratio) * c.t_i * c.t_o;
    first_visit = m.albedo * (std::exp(-tau * path) / kPi);
    decay = std::exp(-std::min(tau * sum, 12.0));
  }
};

TEST(RestFrame, DecodeIsTheFormula) {
  Rng rng(1, 0);
  for (int k = 0; k < 10000; ++k) {
    const Case c = random_case(rng);
    const Formula formula(c);
    const Rgb remainder = random_colour(rng, 0, 2);
    const Rgb found = RestFrame(c.material).decode(remainder, c.cos_i, c.cos_o, c.t_i, c.t_o);
    const Rgb expected = formula.front * (formula.first_visit + formula.decay * remainder);
    // The exponents reach 6e4, where an exp of them is 0 anyway; below 700 its relative error is 1e-13.
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(found[j], expected[j], 1e-12 * expected[j] + 1e-300);
  }
}

// Noise can leave a remainder so negative that the rest would be; light is not.
TEST(RestFrame, DecodeIsNeverNegative) {
  Rng rng(2, 0);
  for (int k = 0; k < 10000; ++k) {
    const Case c = random_case(rng);
    const Rgb rest =
        RestFrame(c.material).decode(random_colour(rng, -1, -0.5), c.cos_i, c.cos_o, c.t_i, c.t_o);
    EXPECT_GE(std::min({rest.r, rest.g, rest.b}), 0);
  }
}

// What the model can hold: the first visit or more by the later ones. With rho <= 0.9 of the light thrown
// back below the film they add at most kd/pi decay kd rho / (1 - kd rho) < 9 / pi decay.
TEST(RestFrame, EncodeAndDecodeAreInverse) {
  Rng rng(3, 0);
  for (int k = 0; k < 20000; ++k) {
    const Case c = random_case(rng);
    const Formula formula(c);
    const Rgb rest =
        formula.front * (formula.first_visit + formula.decay * random_colour(rng, 0, 9 * kInvPi));
    const RestFrame frame(c.material);
    const Rgb remainder = frame.encode(rest, c.cos_i, c.cos_o, c.t_i, c.t_o);
    ASSERT_TRUE(is_finite(remainder)) << k;
    // Subtracting the first visit costs digits of it: 1e-15 of first / decay, which is at most e^12 / pi.
    EXPECT_LT(max_component(remainder), 9 * kInvPi + 1e-9) << k;
    EXPECT_LT(max_component(remainder), kLargestHalf);
    const Rgb back = frame.decode(remainder, c.cos_i, c.cos_o, c.t_i, c.t_o);
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(back[j], rest[j], 1e-13 * (rest[j] + formula.front[j] * formula.first_visit[j])) << k;
  }
}

// The product path from 0.01 to 0.01 at tau = 3 is an exponent of 30000, the sum one of 600; the decay stays
// at its cap of exp(-12) and a rest of nothing but noise, 1e-6, is still a half.
TEST(RestFrame, DarkestCornerIsFinite) {
  for (const auto path : {AbsorptionPath::product, AbsorptionPath::sum})
    for (const auto transmission : {Transmission::straight, Transmission::refract}) {
      Material m;
      m.absorption_path = path;
      m.transmission = transmission;
      m.absorption_per_nm = 1.5;
      const RestFrame frame(m);
      for (const double rest : {0.0, 1e-300, 1e-6}) {
        const Rgb remainder = frame.encode(Rgb(rest), 0.01, 0.01, Rgb(1), Rgb(1));
        EXPECT_TRUE(is_finite(remainder));
        EXPECT_LT(max_component(remainder), kLargestHalf);
        const Rgb back = frame.decode(remainder, 0.01, 0.01, Rgb(1), Rgb(1));
        EXPECT_NEAR(back.r, rest, 1e-15 + 1e-13 * rest);
      }
    }
}

// A pigment that scatters, multiple facets, or both.
Case random_case_without_decay(Rng& rng) {
  Case c = random_case(rng);
  const double kind = rng.uniform();
  if (kind < 0.7) {
    c.material.absorption_path = AbsorptionPath::sum;
    c.material.scattering_per_nm = std::pow(10, -4 + 5 * rng.uniform());
    c.material.anisotropy = rng.uniform() < 0.3 ? 0.99 : 0.99 * (2 * rng.uniform() - 1);
  }
  if (kind > 0.4) {
    c.material.microfacet = Microfacet::multiple;
    c.material.roughness = {0.001 + 0.999 * rng.uniform(), 0.001 + 0.999 * rng.uniform()};
    if (rng.uniform() < 0.3) c.t_i = random_colour(rng, 0, 1e-6);  // R -> 1
  }
  return c;
}

// table.h for them: neither term decays with the remainder, T is raised over multiple facets.
struct FormulaWithoutDecay : Formula {
  explicit FormulaWithoutDecay(const Case& c) : Formula(raised(c)) {
    const Material& m = c.material;
    const double ratio = m.exterior_ior / m.base_ior;
    const bool straight = m.transmission == Transmission::straight;
    const auto below = [&](double x) { return straight ? x : std::sqrt(1 - ratio * ratio * (1 - x * x)); };
    first_visit *= std::exp(-m.scattering_per_nm * 2 * (1 / below(c.cos_i) + 1 / below(c.cos_o)));
    decay = 1;
  }
  static Case raised(Case c) {
    if (c.material.microfacet == Microfacet::multiple)
      for (Rgb* t : {&c.t_i, &c.t_o}) *t = transform(*t, [](double x) { return std::max(x, 0.25); });
    return c;
  }
};

TEST(RestFrame, WithoutDecayDecodeIsTheFormula) {
  Rng rng(5, 0);
  for (int k = 0; k < 10000; ++k) {
    const Case c = random_case_without_decay(rng);
    const FormulaWithoutDecay formula(c);
    const Rgb remainder = random_colour(rng, 0, 2);
    const Rgb found = RestFrame(c.material).decode(remainder, c.cos_i, c.cos_o, c.t_i, c.t_o);
    const Rgb expected = formula.front * (formula.first_visit + remainder);
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(found[j], expected[j], 1e-12 * expected[j]) << k;
  }
}

// Scattered once near the top, p / (m_i + m_o) in all, with p the Henyey-Greenstein lobe of up to
// (1 + g) / (1 - g)^2 / (4 pi), and what facets throw at each other, below 1000 but for nearly smooth ones at
// grazing. Stored as halves, 2^-11 of the value and 3e-8 are lost; larger values are cut, not infinite.
TEST(RestFrame, WithoutDecayRoundTripsInHalfPrecision) {
  Rng rng(6, 0);
  int cut = 0;
  for (int k = 0; k < 20000; ++k) {
    const Case c = random_case_without_decay(rng);
    const FormulaWithoutDecay formula(c);
    const double g = c.material.anisotropy, above = std::pow(10, -6 + 9 * rng.uniform());
    const double lobe = (1 + std::abs(g)) / square(1 - std::abs(g)) / (4 * kPi) * rng.uniform();
    const Rgb rest = formula.front * (formula.first_visit + Rgb(lobe / (c.cos_i + c.cos_o))) +
                     Rgb(c.material.has_multiple_facets() ? above : 0);
    const RestFrame frame(c.material);
    const Rgb remainder = frame.encode(rest, c.cos_i, c.cos_o, c.t_i, c.t_o);
    const Rgb stored = transform(remainder, [](double x) { return round_to(Precision::half_float, x); });
    ASSERT_TRUE(is_finite(stored)) << k;
    const Rgb back = frame.decode(stored, c.cos_i, c.cos_o, c.t_i, c.t_o);
    for (int j = 0; j < 3; ++j) {
      const double exact = rest[j] / formula.front[j] - formula.first_visit[j];
      if (exact > RestFrame::kLargestRemainder) {
        ++cut;
        EXPECT_EQ(remainder[j], RestFrame::kLargestRemainder);
      } else {
        EXPECT_NEAR(back[j], rest[j], formula.front[j] * (0x1p-11 * exact + 3.1e-8) + 1e-13 * rest[j]) << k;
      }
    }
  }
  EXPECT_GT(cut, 0);
  EXPECT_LT(cut, 3 * 20000 / 20);  // the cut is for corners
}

// Whatever noise or a spike makes of the rest.
TEST(RestFrame, WithoutDecayNothingOverflows) {
  Rng rng(7, 0);
  for (int k = 0; k < 20000; ++k) {
    Case c = random_case_without_decay(rng);
    if (k % 2) c.t_o = random_colour(rng, 0, 1e-12);
    const Rgb rest = random_colour(rng, 0, std::pow(10, -10 + 30 * rng.uniform()));
    const Rgb remainder = RestFrame(c.material).encode(rest, c.cos_i, c.cos_o, c.t_i, c.t_o);
    for (int j = 0; j < 3; ++j) ASSERT_LT(std::abs(remainder[j]), kLargestHalf) << k;
  }
}

// Continuous in the first visit: a trace of scattering changes what the remainder means, not the visit.
TEST(RestFrame, ATraceOfScatteringLeavesTheFirstVisit) {
  Material m;
  const Rgb plain = RestFrame(m).decode(Rgb(0), 0.5, 0.7, Rgb(0.8), Rgb(0.9));
  m.scattering_per_nm = 1e-9;
  const Rgb trace = RestFrame(m).decode(Rgb(0), 0.5, 0.7, Rgb(0.8), Rgb(0.9));
  EXPECT_NEAR(trace.g, plain.g, 1e-8 * plain.g);
}

// Where the film lets nothing through there is no rest, and nothing to divide by.
TEST(RestFrame, OpaqueFilm) {
  const RestFrame frame{Material()};
  EXPECT_EQ(frame.encode(Rgb(0), 0.5, 0.5, Rgb(0), Rgb(1)), Rgb(0));
  EXPECT_EQ(frame.decode(Rgb(1), 0.5, 0.5, Rgb(0), Rgb(1)), Rgb(0));
}

// Layers may let nothing through, or so little that T between nodes is noise. What little rest there is comes
// back, T is raised to 0.01 in front of it, and nothing is divided by 0.
TEST(RestFrame, OfALayeredFilmRaisesWhatPasses) {
  Rng rng(8, 0);
  for (int k = 0; k < 10000; ++k) {
    Case c = random_case(rng), raised = c;
    if (k % 2) c.t_i = random_colour(rng, -1e-3, 0.01), raised.t_i = Rgb(0.01);
    if (k % 3) c.t_o = Rgb(0), raised.t_o = Rgb(0.01);
    const Formula formula(raised);
    const RestFrame frame(c.material, NdArray(), true);
    const Rgb remainder = random_colour(rng, 0, 2);
    const Rgb rest = frame.decode(remainder, c.cos_i, c.cos_o, c.t_i, c.t_o);
    for (int j = 0; j < 3; ++j) {
      const double expected = formula.front[j] * (formula.first_visit[j] + formula.decay * remainder[j]);
      EXPECT_NEAR(rest[j], expected, 1e-12 * expected + 1e-300) << k;
    }
    const Rgb again = frame.encode(rest, c.cos_i, c.cos_o, c.t_i, c.t_o);
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(again[j], remainder[j], 1e-12 * (remainder[j] + formula.first_visit[j] / formula.decay))
          << k;
    const Rgb dark = frame.encode(Rgb(0), c.cos_i, c.cos_o, c.t_i, c.t_o);
    ASSERT_TRUE(is_finite(dark)) << k;
    EXPECT_LT(max_component(frame.decode(dark, c.cos_i, c.cos_o, c.t_i, c.t_o)), 1e-13) << k;
  }
}

// Nothing is seen below an opaque base: a rest of nothing comes back as nothing from halves.
TEST(RestFrame, OverAnOpaqueBaseIsBlack) {
  Material m;
  m.base_ior = 0.3;
  m.base_extinction = 3;
  m.albedo = Rgb(0);
  m.absorption_per_nm = 0;
  for (const bool has_many : {false, true}) {
    m.microfacet = has_many ? Microfacet::multiple : Microfacet::single;
    const RestFrame frame(m, NdArray(), true);
    EXPECT_EQ(frame.encode(Rgb(0), 0.5, 0.01, Rgb(0), Rgb(0)), Rgb(0));
    EXPECT_EQ(frame.decode(Rgb(0), 0.5, 0.01, Rgb(0), Rgb(0)), Rgb(0));
  }
}

// For the sum path and a smooth film the rest is s T T kd/pi exp(-tau (1/m_i + 1/m_o)) / (1 - kd rho): the
// remainder is then kd/pi kd rho / (1 - kd rho) wherever the decay is below its cap. tau (1/m_i + 1/m_o) <=
// 0.2 * 20 = 4 here.
TEST(RestFrame, RankOneRestHasAConstantRemainder) {
  Material m;
  m.transmission = Transmission::straight;
  m.absorption_per_nm = 0.1;
  m.pigment_thickness_nm = 2;
  m.albedo = Rgb(0.5);
  const double rho = 0.4, expected = 0.5 * kInvPi * 0.2 / 0.8;
  for (const double i : {0.1, 0.4, 1.0})
    for (const double o : {0.1, 0.7, 1.0}) {
      const double rest = 0.8 * 0.6 * 0.5 * kInvPi * std::exp(-0.2 * (1 / i + 1 / o)) / (1 - 0.5 * rho);
      EXPECT_NEAR(RestFrame(m).encode(Rgb(rest), i, o, Rgb(0.8), Rgb(0.6)).g, expected, 1e-14)
          << i << ' ' << o;
    }
}

// A film above a rarer base, n0 > n2: beyond the critical angle no direction below exists (cosine 0), yet the
// facets of a rough film let light through. Rest and remainder stay finite.
TEST(RestFrame, BeyondTheCriticalAngleIsFinite) {
  for (const double absorption : {0.0, 0.01, 0.5, 1.5})
    for (const auto path : {AbsorptionPath::product, AbsorptionPath::sum}) {
      Material m;
      m.exterior_ior = 1.5;
      m.base_ior = 1.2;  // critical cosine 0.6
      m.absorption_per_nm = absorption;
      m.absorption_path = path;
      const RestFrame frame(m);
      for (const double i : {0.01, 0.3, 0.9}) {
        const Rgb remainder = frame.encode(Rgb(1e-3), i, 0.3, Rgb(0.3), Rgb(0.3));
        EXPECT_TRUE(is_finite(remainder)) << absorption << ' ' << i;
        const Rgb rest = frame.decode(remainder, i, 0.3, Rgb(0.3), Rgb(0.3));
        EXPECT_NEAR(rest.r, 1e-3, 1e-12) << absorption << ' ' << i;
      }
    }
}

}  // namespace
}  // namespace sunbeam
