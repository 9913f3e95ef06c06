// Bound look-ups of layered films over pigments with path "product" against single films and the exact
// evaluator.
#include "bake/base/error_floor.h"
#include "bake/check/verify.h"
#include "bake/live/exact/exact.h"
#include "tests/accuracy/factored/support.h"

namespace sunbeam {
namespace {

constexpr const char* kDark = "[0.05, 0.1, 0.2]";
constexpr const char* kBright = "[0.8, 0.7, 0.5]";

constexpr const char* kMirror =
    "film_periods = 5\n[[material.film]]\nthickness_nm = 60\nior = 2.4\n"
    "[[material.film]]\nthickness_nm = 90\nior = 1.46\n";
constexpr const char* kDispersive =
    "film_periods = 5\n[[material.film]]\nthickness_nm = 60\nior = {cauchy = [2.2, 5e4]}\n"
    "[[material.film]]\nthickness_nm = 90\nior = {cauchy = [1.45, 3500]}\n";
constexpr const char* kAbsorbing =
    "film_periods = 8\n[[material.film]]\nthickness_nm = 80\nior = 1.56\n"
    "[[material.film]]\nthickness_nm = 70\nior = 1.7\nextinction = 0.05\n";
constexpr const char* kEqual =
    "[[material.film]]\nthickness_nm = 150\nior = 1.56\n[[material.film]]\nthickness_nm = 400\nior = 1.56\n"
    "[[material.film]]\nthickness_nm = 200\nior = 1.56\n";
constexpr const char* kSingle = "film_thickness_nm = 750\nfilm_ior = 1.56\n";

struct Surface {
  std::string film, albedo, roughness, transmission;
};

Recipe recipe_of(const Surface& surface, const std::string& path = "product") {
  return parse_recipe(
      "[material]\nabsorption_path = \"" + path +
          "\"\npigment_thickness_nm = 2\nbase_ior = 1.5\ntransmission = "
          "\"" +
          surface.transmission + "\"\nroughness = " + surface.roughness + "\nalbedo = " + surface.albedo +
          "\n" + surface.film +
          "[grid]\nfilm_thickness_nm = [650.0, 800.0]\nabsorption_per_nm = {from = 0, to = 0.3, count = 8}\n"
          "[table]\nencoding = \"factored\"\nangles = 12\n[accuracy]\nnoise = 0.001\n",
      "layered.toml");
}

Table baked(const Recipe& recipe) { return bake_table(recipe, {.seed = 1, .threads = 0, .on_progress = {}}); }

// Where a look-up is held against another: parameters, the viewer and lights by the cosine.
struct Point {
  Parameters parameters;
  Vec3 wi;
  std::vector<Vec3> wo;
};

std::vector<Point> points(const Recipe& recipe) {
  constexpr int kPoints = 12, kLights = 12;
  std::vector<Point> result;
  for (int p = 0; p < kPoints; ++p) {
    Rng rng(99, p);
    std::array<double, 3> x;
    for (std::size_t i = 0; i < 3; ++i)
      x[i] = lerp(rng.uniform(), recipe.grid[i].low(), recipe.grid[i].high());
    Point point{{x[0], x[1], x[2]}, direction_from_cosine(lerp(rng.uniform(), 0.0175, 1), 0), {}};
    for (int o = 0; o < kLights; ++o)
      point.wo.push_back(
          direction_from_cosine(std::sqrt((o + rng.uniform()) / kLights), 2 * kPi * rng.uniform()));
    result.push_back(std::move(point));
  }
  return result;
}

std::vector<Rgb> rest_of(const TableBsdf& bsdf, const Point& point) {
  std::vector<Rgb> values;
  for (const Vec3& wo : point.wo) values.push_back(bsdf.rest(wo, point.wi));
  return values;
}

std::vector<Rgb> exact_rest(const Recipe& recipe, const Point& point) {
  Material m = recipe.material;
  m.film_thickness_nm = point.parameters.film_thickness_nm;
  m.base_ior = point.parameters.base_ior;
  m.absorption_per_nm = point.parameters.absorption_per_nm;
  return ExactRest(m, recipe.spectrum.wavelengths(m)).rest(point.wo, point.wi);
}

// The error of verify: Int |f - expected| over Int |expected|.
double error_of(const std::vector<Rgb>& values, const std::vector<Rgb>& expected) {
  double difference = 0, whole = 0;
  for (std::size_t o = 0; o < expected.size(); ++o) {
    difference += mean_abs(values[o] - expected[o]);
    whole += mean_abs(expected[o]);
  }
  return difference / std::max(whole, kDarkestValue * static_cast<double>(expected.size()));
}

TableBsdf bound(const Table& table, const Point& point) { return TableBsdf(table, point.parameters); }

// Both are walked with the same random numbers; what is left is interpolation over orders and facets.
TEST(LayeredExchangeOfOneFilm, EqualLayersAreASingleFilm) {
  for (const std::string transmission : {"straight", "refract"}) {
    const Recipe recipe = recipe_of({kEqual, kBright, "0", transmission});
    const Table table = baked(recipe), single = baked(recipe_of({kSingle, kBright, "0", transmission}));
    for (const Point& point : points(recipe))
      EXPECT_LT(error_of(rest_of(bound(table, point), point), rest_of(bound(single, point), point)), 3e-3)
          << transmission << ' ' << point.wi.z;
  }
}

// The largest median and maximum, two to three times what is measured.
struct Bound {
  std::string name;
  Surface surface;
  double median, largest;

  friend void PrintTo(const Bound& row, std::ostream* out) { *out << row.name; }
};

std::vector<Bound> bounds() {
  return {
      {"mirror_smooth", {kMirror, kBright, "0", "refract"}, 7e-4, 2e-3},
      {"mirror_straight", {kMirror, kBright, "0.1", "straight"}, 4e-4, 2e-3},
      {"mirror_rough", {kMirror, kBright, "0.3", "refract"}, 5e-4, 2e-3},
      {"mirror_dark", {kMirror, kDark, "0.1", "refract"}, 3e-4, 1e-3},
      {"dispersive_smooth", {kDispersive, kDark, "0", "straight"}, 3e-4, 1e-3},
      {"dispersive_rough", {kDispersive, kBright, "0.1", "refract"}, 7e-4, 3e-3},
      {"absorbing_smooth", {kAbsorbing, kBright, "0", "refract"}, 3e-4, 1.5e-3},
      {"absorbing_rough", {kAbsorbing, kBright, "0.3", "straight"}, 6e-4, 3e-3},
  };
}

class LayeredExchange : public ::testing::TestWithParam<Bound> {};

// At each of three wavelengths the light that reaches the base cancels in the quotient of the paths, so that
// it is the exact one on both sides. Neither has noise but the bake's own: no false alarm, the same figures
// for every thread count.
TEST_P(LayeredExchange, AgreesWithTheExactEvaluator) {
  const Bound& row = GetParam();
  const Recipe product = recipe_of(row.surface), sum = recipe_of(row.surface, "sum");
  const Table table = baked(product), sum_table = baked(sum);
  std::vector<double> errors;
  for (const Point& point : points(product)) {
    const auto looked_up = rest_of(bound(table, point), point),
               of_sum = rest_of(bound(sum_table, point), point);
    const auto exact_sum = exact_rest(sum, point);
    std::vector<Rgb> values;
    for (std::size_t o = 0; o < looked_up.size(); ++o)
      values.push_back(looked_up[o] * exact_sum[o] / of_sum[o]);
    errors.push_back(error_of(values, exact_rest(product, point)));
  }
  EXPECT_LT(quantile(errors, 0.5), row.median);
  EXPECT_LT(quantile(errors, 1), row.largest);
}

INSTANTIATE_TEST_SUITE_P(Films, LayeredExchange, ::testing::ValuesIn(bounds()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace sunbeam
