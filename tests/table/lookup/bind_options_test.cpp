// Look-ups in the caller's colour space, and from the caller's random numbers.
#include "sunbeam/bind_options.h"

#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"
#include "tests/support/bsdf_checks.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr Parameters kAt = {250, 1.45, 0.1};

template <class Check>
void for_directions(Check check) {
  Rng rng(1, 0);
  for (int k = 0; k < 200; ++k) {
    const Vec3 wo = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    const Vec3 wi = test::uniform_hemisphere({rng.uniform(), rng.uniform()});
    check(wo, wi, random3(rng));
  }
}

// Calls `check` with every table bound and textured, with and without the options.
template <class Check>
void for_lookups(const BindOptions& options, Check check) {
  for (const Table& table : test::tables_of_every_kind()) {
    SCOPED_TRACE(table.info.at("encoding") + ", roughness " + to_string(table.material.roughness));
    check(table, table.bind(kAt), table.bind(kAt, options));
    const TexturedTable plain(table), with(table, options);
    check(table, plain.at(kAt), with.at(kAt));
  }
}

double largest(const Rgb& x) { return std::max({std::abs(x.r), std::abs(x.g), std::abs(x.b)}); }

// Between nodes of a bound factored table colours are linear in products of two of them, which differs a
// little from space to space.
TEST(BindOptions, ConvertColours) {
  for (const ColorSpace space : {ColorSpace::rec709, ColorSpace::rec2020, ColorSpace::xyz})
    for_lookups({.color_space = space}, [&](const Table& table, const auto& own, const auto& other) {
      const ColorMatrix matrix = rgb_to_rgb(table.color_space(), space);
      double difference = 0, sum = 0;
      for_directions([&](const Vec3& wo, const Vec3& wi, const Random3&) {
        const Rgb expected = matrix * own.eval(wo, wi);
        difference += largest(other.eval(wo, wi) - expected);
        sum += largest(expected);
        EXPECT_LE(largest(other.dirac(wo) - matrix * own.dirac(wo)), 1e-6);
      });
      EXPECT_LE(difference, 2e-3 * sum) << to_string(space);
    });
}

TEST(BindOptions, OwnColourSpaceChangesNothing) {
  for (const Table& table : test::tables_of_every_kind()) {
    const BindOptions options = {.color_space = table.color_space()};
    const TableBsdf a = table.bind(kAt), b = table.bind(kAt, options);
    const TexturedTable c(table), d(table, options);
    for_directions([&](const Vec3& wo, const Vec3& wi, const Random3&) {
      EXPECT_EQ(a.eval(wo, wi), b.eval(wo, wi));
      EXPECT_EQ(c.at(kAt).eval(wo, wi), d.at(kAt).eval(wo, wi));
    });
  }
}

template <class A, class B>
int expect_clipped(const A& own, const B& other) {
  int clipped = 0;
  for_directions([&](const Vec3& wo, const Vec3& wi, const Random3& u) {
    const Rgb f = own.eval(wo, wi), positive = transform(f, [](double c) { return std::max(c, 0.0); });
    EXPECT_EQ(other.eval(wo, wi), positive);
    clipped += f != positive;
    const auto sample = other.sample(wo, u);
    const Rgb throughput = sample ? sample->throughput : Rgb();
    EXPECT_GE(std::min({throughput.r, throughput.g, throughput.b}), 0);
  });
  return clipped;
}

// Folded spectra of small tables are random, and a few of their colours lie beyond Rec.709.
TEST(BindOptions, ClipNegativeComponents) {
  const BindOptions own = {.color_space = ColorSpace::rec709},
                    clipping = {.color_space = ColorSpace::rec709, .clip_negative = true};
  int clipped = 0;
  for (const Table& table : test::tables_of_every_kind()) {
    clipped += expect_clipped(table.bind(kAt, own), table.bind(kAt, clipping));
    const TexturedTable a(table, own), b(table, clipping);
    clipped += expect_clipped(a.at(kAt), b.at(kAt));
  }
  EXPECT_GT(clipped, 0);
}

void expect_same(const std::optional<BsdfSample>& a, const std::optional<BsdfSample>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(length(a->wi - b->wi), 0);
  EXPECT_EQ(a->throughput, b->throughput);
  EXPECT_EQ(a->mis_pdf, b->mis_pdf);
  EXPECT_EQ(a->is_dirac, b->is_dirac);
}

// The same numbers give the same sample by every way in, and no generator is touched.
TEST(Random3, DrawsAreAPureFunction) {
  for_lookups({}, [](const Table&, const auto& bsdf, const auto&) {
    Rng rng(2, 0);
    for_directions([&](const Vec3& wo, const Vec3& wi, const Random3& u) {
      const auto sample = bsdf.sample(wo, u);
      Rng untouched = rng;
      expect_same(bsdf.sample(wo, u, rng), sample);
      EXPECT_EQ(rng.next(), untouched.next());
      expect_same(bsdf.eval_and_sample(wo, wi, u).sample, sample);
      Rng again = rng;
      expect_same(bsdf.sample(wo, again), bsdf.sample(wo, random3(rng)));
    });
  });
}

// Numbers at both ends of [0, 1) draw directions as good as any.
TEST(Random3, ReachesTheEnds) {
  constexpr double kLast = 1 - 0x1p-53;
  for_lookups({}, [](const Table&, const auto& bsdf, const auto&) {
    for (int k = 0; k < 27; ++k) {
      const auto at = [](int digit) { return digit == 0 ? 0.0 : digit == 1 ? 0.5 : kLast; };
      const auto sample = bsdf.sample(direction_from_cosine(0.4, 1), {at(k % 3), at(k / 3 % 3), at(k / 9)});
      if (!sample) continue;
      EXPECT_NEAR(length(sample->wi), 1, 1e-12) << k;
      EXPECT_GT(sample->wi.z, 0) << k;
      EXPECT_TRUE(is_finite(sample->throughput)) << k;
    }
  });
}

}  // namespace
}  // namespace sunbeam
