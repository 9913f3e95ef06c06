// One look-up behind several calls: of a bound table of every kind, eval() is first() and rest() together,
// and a list of lights has the values of its lights one by one.
#include <gtest/gtest.h>

#include "sunbeam/table_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr int kPairs = 300;

std::string name_of(const Table& table) {
  return table.info.at("encoding") + ", " + table.info.at("spectrum") + ", roughness " +
         to_string(table.material.roughness) +
         (table.material.absorption_path == AbsorptionPath::sum ? ", sum" : ", product");
}

// The pole and the horizon among them.
std::vector<Vec3> directions(std::uint64_t stream) {
  Rng rng(21, stream);
  std::vector<Vec3> all = {{0, 0, 1}, direction_from_cosine(1e-5, 1)};
  while (all.size() < kPairs) all.push_back(test::uniform_hemisphere({rng.uniform(), rng.uniform()}));
  return all;
}

double largest(const Rgb& x) { return std::max({std::abs(x.r), std::abs(x.g), std::abs(x.b)}); }

template <class Check>
void for_each_table(Check check) {
  for (const Table& table : test::tables_of_every_kind()) {
    SCOPED_TRACE(name_of(table));
    check(table.bind({250, 1.45, 0.1}));
  }
}

// Both parts are floats, or doubles that are rounded to floats, and so is their sum: two roundings of 2^-24
// of either part.
TEST(BoundParts, EvalIsFirstAndRest) {
  constexpr double kRounding = 2 * 0x1p-24;
  for_each_table([](const TableBsdf& bsdf) {
    const auto wo = directions(0), wi = directions(1);
    bool is_bright = false;
    for (std::size_t k = 0; k < kPairs; ++k) {
      const Rgb f = bsdf.eval_pdf(wo[k], wi[k]).f, first = bsdf.first(wo[k], wi[k]),
                rest = bsdf.rest(wo[k], wi[k]);
      is_bright = is_bright || mean(rest) > 0.001;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(f[c], first[c] + rest[c], kRounding * (std::abs(first[c]) + std::abs(rest[c]))) << k;
    }
    EXPECT_TRUE(is_bright);
  });
}

// The list multiplies by the viewer's factor before it interpolates, single look-ups after it: a dozen float
// operations of 2^-24 each, relative to the brightest channel, since a folded colour may pass through 0.
TEST(BoundParts, AListHasTheValuesOfItsLights) {
  constexpr double kRounding = 12 * 0x1p-24;
  for_each_table([](const TableBsdf& bsdf) {
    auto wi = directions(2);
    wi.insert(wi.begin() + 5, spherical_direction(2, 1));  // below the horizon
    std::vector<Rgb> f(wi.size());
    for (const Vec3& wo : {Vec3{0, 0, 1}, spherical_direction(0.9, 0.4), spherical_direction(1.5, 4)})
      for (const std::size_t count : {wi.size(), std::size_t{7}}) {
        bsdf.eval(wo, {wi.data(), count}, f);
        for (std::size_t k = 0; k < count; ++k) {
          const Rgb alone = bsdf.eval_pdf(wo, wi[k]).f;
          ASSERT_LE(largest(f[k] - alone), kRounding * largest(alone)) << k;
        }
      }
  });
}

}  // namespace
}  // namespace sunbeam
