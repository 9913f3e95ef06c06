// Values that are finite and nonsense are refused by the ranges of the format; within them look-ups are
// finite whatever the nodes hold.
#include "sunbeam/detail/table_ranges.h"

#include <gmock/gmock.h>

#include <limits>

#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"
#include "tests/support/error_of.h"
#include "tests/table/layered_tables.h"

namespace sunbeam {
namespace {

using test::fill_randomly;
using test::refusal;
using test::small_factored_table;
using test::small_table;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kName = "some.table";

using Change = std::function<void(Table&)>;

void expect_refused(const Table& sound, const Change& change, const std::vector<std::string>& named) {
  for (const test::Form& form : test::forms()) {
    ASSERT_EQ(refusal(form, form.bytes(sound), kName), "accepted");
    Table table = sound;
    change(table);
    const std::string message = refusal(form, form.bytes(table), kName);
    for (const std::string& part : named) EXPECT_THAT(message, HasSubstr(part)) << form.name;
  }
}

Table factored(AbsorptionPath path, const Roughness& roughness = 0.3) {
  return small_factored_table(roughness, path, Precision::single_float);
}
Table dense() { return small_table(Precision::single_float); }

// The first number of an array becomes `value`.
template <class Owner>
Change with_value(NdArray Owner::*array, double value) {
  return [=](Table& table) {
    if constexpr (std::is_same_v<Owner, Table>)
      (table.*array).values()[0] = static_cast<float>(value);
    else
      (table.factors.*array).values()[0] = static_cast<float>(value);
  };
}

Change with_wavelengths(const std::function<void(Wavelengths&)>& change) {
  return [=](Table& table) { change(table.factors.wavelengths); };
}

TEST(TableRanges, ArraysOfFactors) {
  for (const double value : {-101.0, 1.1e6})
    expect_refused(factored(AbsorptionPath::sum), with_value(&Factors::arrival, value),
                   {"array 'arrival' leaves -100 to 1e+06"});
  for (const double value : {-1.1e30, 1.1e30})
    expect_refused(factored(AbsorptionPath::product), with_value(&Factors::exchange, value),
                   {"array 'exchange' leaves -1e+30 to 1e+30"});
}

// All visits of the base add up to 1 / (1 - albedo returned).
TEST(TableRanges, AllLightThatComesBackToAWhiteBase) {
  const auto white = [](Table& table) {
    table.factors.wavelengths.albedo.back() = 1;
    table.factors.returned.values()[0] = 1;
  };
  expect_refused(factored(AbsorptionPath::sum), white,
                 {"array 'returned' times attribute 'spectral.albedo' reaches 1; allowed: up to 0.999"});
}

TEST(TableRanges, ArraysOfADenseTable) {
  for (const double value : {-0.01, 1.02, 100.0}) {
    expect_refused(dense(), with_value(&Table::film_reflectance, value),
                   {"array 'film_reflectance' leaves -0.001 to 1.01"});
    expect_refused(dense(), with_value(&Table::film_transmittance, value),
                   {"array 'film_transmittance' leaves -0.001 to 1.01"});
  }
  for (const double value : {-1.01, 2.01}) {
    expect_refused(test::small_full_table(), with_value(&Table::film_reflectance, value),
                   {"array 'film_reflectance' leaves -1 to 2"});
    expect_refused(test::small_full_table(), with_value(&Table::first_visit, value),
                   {"array 'first_visit' leaves -1 to 2"});
  }
  for (const double value : {-1.1e7, 1e30})
    expect_refused(dense(), with_value(&Table::remainder, value),
                   {"array 'remainder' leaves -1e+07 to 1e+07"});
  for (const double value : {-1e-6, 1e30})
    expect_refused(dense(), with_value(&Table::rest_stderr, value),
                   {"array 'rest_stderr' leaves 0 to 1e+07"});
}

TEST(TableRanges, WavelengthsAndWeights) {
  for (const double nm : {1.0, 299.0, 1001.0, 1e300})
    expect_refused(factored(AbsorptionPath::sum), with_wavelengths([=](Wavelengths& w) { w.nm[0] = nm; }),
                   {"'spectral.nm' holds", "300 to 1000"});
  expect_refused(factored(AbsorptionPath::sum),
                 with_wavelengths([](Wavelengths& w) { w.absorption[0] = 1e13; }),
                 {"'spectral.absorption' holds", "0 to 1e+12"});
  for (const double weight : {-2.1, 1e30})
    expect_refused(factored(AbsorptionPath::sum),
                   with_wavelengths([=](Wavelengths& w) { w.weight[0].g = weight; }),
                   {"'spectral.weight_g' holds", "-2 to 2"});
  expect_refused(factored(AbsorptionPath::sum), with_wavelengths([](Wavelengths& w) {
                   for (Rgb& weight : w.weight) weight.b = 0;
                 }),
                 {"'spectral.weight_b' adds up to 0; allowed: 0.5 to 2"});
}

TEST(TableRanges, OpticalDepthOfPathProduct) {
  const auto deep = [](Table& table) { table.material.pigment_thickness_nm = 200; };
  expect_refused(factored(AbsorptionPath::product), deep,
                 {"optical depth of 60", "path product: up to 40"});  // 0.1 x 200 x 3
  for (const test::Form& form : test::forms()) {
    Table sum = factored(AbsorptionPath::sum);
    deep(sum);
    EXPECT_EQ(refusal(form, form.bytes(sum), kName), "accepted");
  }
}

TEST(TableRanges, AxesOfArrays) {
  const auto arrival_axis = [](std::size_t k, const std::function<void(Axis&)>& change) {
    return [=](Table& table) {
      auto axes = table.factors.arrival.axes();
      change(axes[k]);
      table.factors.arrival = NdArray("arrival", axes, Precision::single_float, 1);
    };
  };
  const Table table = factored(AbsorptionPath::sum);
  expect_refused(table, arrival_axis(2, [](Axis& a) { a.nodes.back() = 2e4; }),
                 {"axis 'fringe_order' leaves 0 to 10000"});
  for (const std::size_t k : {0u, 1u, 2u, 3u})
    expect_refused(
        table,
        arrival_axis(k, [](Axis& a) { a.is_cubic = false, a.period = 1e4, a.origin = -1, a.power = 1; }),
        {"has period 10000; expected 0"});
  expect_refused(dense(),
                 [](Table& t) {
                   for (NdArray* film : {&t.film_reflectance, &t.film_transmittance}) {
                     auto axes = film->axes();
                     axes[0].nodes.back() = 1e6;
                     *film = NdArray(film->name(), axes, Precision::single_float);
                   }
                 },
                 {"axis 'film_thickness_nm' leaves 0 to 1e+05"});
}

// What a message quotes or lists is short, whatever the file holds.
TEST(TableRanges, MessagesAreShort) {
  const std::string endless(1000000, 'x');
  const test::Form form = test::forms().front();
  const auto expect_short = [&](const Change& change) {
    Table table = factored(AbsorptionPath::sum);
    change(table);
    EXPECT_LT(refusal(form, form.bytes(table), kName).size(), 1000u);
  };
  for (const char* key : {"encoding", "spectrum", "seed", "noise"})
    expect_short([&](Table& t) { t.info[key] = endless; });
  expect_short([&](Table& t) { t.factors.grid[0].name = endless; });
  expect_short([&](Table& t) { t.factors.grid[0].unit = endless; });
}

TEST(TableRanges, AxisOfFirstVisit) {
  for (const double end : {2000.0, 1e300})
    expect_refused(test::small_full_table(),
                   [=](Table& t) {
                     auto axes = t.first_visit.axes();
                     axes[0].nodes = {0, end};
                     t.first_visit = NdArray("first_visit", axes, Precision::single_float);
                   },
                   {"axis 'optical_path' leaves 0 to 1000"});
}

TEST(TableRanges, TextsOfTheFile) {
  const auto with_info = [](const std::string& key, const std::string& value) {
    return [=](Table& table) { table.info[key] = value; };
  };
  const Table table = factored(AbsorptionPath::sum);
  for (const std::string key : {"seed", "samples"})
    for (const std::string value : {"<img>", "-1", "1e3", "", "99999999999999999999999"})
      expect_refused(table, with_info(key, value),
                     {"attribute '" + key + "' is '" + value + "'; allowed: a whole number"});
  for (const std::string value : {"nan", "-1", "1e9", "1 2", "x"})
    expect_refused(table, with_info("noise", value), {"attribute 'noise'"});
  for (const std::string value : {"\x1b[31m", "\xff", "a\rb"})
    expect_refused(table, with_info("estimator", value),
                   {"attribute 'estimator' is not UTF-8, or holds a control character"});
}

void expect_finite(const Bsdf& bsdf) {
  Rng rng(1, 2);
  const std::vector<Vec3> directions = {
      {0, 0, 1}, normalize(Vec3{0.5, -0.2, 0.3}), normalize(Vec3{-1, 0.1, 1e-3})};
  for (const Vec3& wo : directions)
    for (const Vec3& wi : directions) {
      const EvalPdf at = bsdf.eval_pdf(wo, wi, rng);
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(static_cast<float>(at.f[c])));
      ASSERT_TRUE(std::isfinite(at.pdf) && at.pdf >= 0);
      const auto sample = bsdf.sample(wo, rng);
      for (int c = 0; sample && c < 3; ++c) ASSERT_TRUE(std::isfinite(sample->throughput[c]));
    }
}

void expect_finite(const Table& table) {
  const test::Form form = test::forms().front();
  ASSERT_EQ(refusal(form, form.bytes(table), kName), "accepted");
  const Parameters at{250, 1.43, table.parameter_axis(2).high()};
  expect_finite(table.bind(at, {.outside = OutsideGrid::clamp}));
  expect_finite(TexturedTable(table).at(at));
}

// Nodes at both ends of a range, by turns: interpolation overshoots as far as it can.
void fill_with_ends(NdArray& array, double low, double high) {
  Rng rng(3, 4);
  for (float& value : array.values()) value = static_cast<float>(rng.uniform() < 0.5 ? low : high);
}

TEST(TableRanges, LookUpsAreFiniteAtTheirEnds) {
  for (const Roughness& roughness : {Roughness(0), Roughness(0.3), Roughness(0.3, 0.1)})
    for (const AbsorptionPath path : {AbsorptionPath::sum, AbsorptionPath::product})
      for (const double ior : {1.0, 1.45}) {
        if (roughness.u > 0 && ior > 1) continue;  // a rough film's table has other axes there
        Table table = factored(path, roughness);
        table.material.exterior_ior = ior;
        if (!table.factors.arrival.empty()) fill_with_ends(table.factors.arrival, -100, 1e6);
        if (!table.factors.exchange.empty()) fill_with_ends(table.factors.exchange, -1e30, 1e30);
        if (!table.factors.returned.empty()) fill_with_ends(table.factors.returned, 0, 1);
        table.factors.wavelengths.albedo[0] = 0.999;
        SCOPED_TRACE(to_string(roughness) + " " + std::string(to_string(path)));
        expect_finite(table);
      }
}

// Cosines that jump from 0 to 1 among the facets.
void fill_with_a_jump(NdArray& cosines) {
  const std::size_t ranks = cosines.axes().back().size();
  for (std::size_t cell = 0; cell < cosines.cells(); ++cell)
    cosines.set(cell, Rgb(cell % ranks < ranks / 2 ? 0 : 1));
}

TEST(TableRanges, LookUpsOfLayeredFilmsAreFiniteAtTheirEnds) {
  for (Table table : test::layered_tables()) {
    if (!table.is_factored()) continue;
    Factors& factors = table.factors;
    for (NdArray* cosines : {&factors.facet_cosine, &factors.return_cosine})
      if (!cosines->empty()) fill_with_a_jump(*cosines);
    if (!factors.crossing.empty()) fill_with_ends(factors.crossing, -100, 1e6);
    if (!factors.returning.empty()) fill_with_ends(factors.returning, 0, 1);
    if (!factors.exchange.empty()) fill_with_ends(factors.exchange, -65504, 65504);
    for (auto& layers : factors.wavelengths.layers) {
      layers[0].index = {kLargestIor, 0};
      layers[1].index = {kLeastIor, kMostExtinction};
    }
    factors.wavelengths.albedo[0] = 0.999;
    SCOPED_TRACE(to_string(table.material.roughness));
    expect_finite(table);
  }
}

// A rough film's table whose base IORs reach below the exterior's.
Table below_exterior() {
  Table table = factored(AbsorptionPath::sum);
  table.material.exterior_ior = 1.45;
  const auto moved = [](const NdArray& array) {
    auto axes = array.axes();
    axes[0].nodes = {1.4, 1.45, 1.5};
    axes[0].origin = 1.45;
    for (Axis& axis : axes)
      if (axis.name == "cos_theta") axis = test::cubic_axis("warped_cos", {0, 0.5, 1});
    return NdArray(array.name(), axes, array.precision(), 1);
  };
  table.factors.grid[1].nodes = {1.4, 1.45, 1.5};
  table.factors.grid[1].origin = 1.45;
  for (NdArray* array : {&table.factors.arrival, &table.factors.returned}) *array = moved(*array);
  return table;
}

// The base reflects only where weights are negative in every channel.
TEST(TableRanges, LookUpsOfNegativeLightAreFinite) {
  Table table = below_exterior();
  table.factors.wavelengths.albedo = {1, 0, 0, 0, 0};
  table.factors.wavelengths.weight = {Rgb(-2), Rgb(2), Rgb(1), Rgb(0), Rgb(0)};
  expect_finite(table);
  const Vec3 wo = normalize(Vec3{0.3, 0, 1}), wi = normalize(Vec3{-0.2, 0.4, 1});
  const Rgb f = TexturedTable(table).at({250, 1.43, 0.1}).eval_pdf(wo, wi).f;
  for (int c = 0; c < 3; ++c) EXPECT_LT(std::abs(f[c]), 10) << c;
}

TEST(TableRanges, LookUpsOfADenseTableAreFiniteAtTheirEnds) {
  for (Table table : {dense(), small_table(Precision::single_float, false), test::small_full_table(),
                      test::small_anisotropic_table(Precision::single_float)}) {
    const bool is_full = table.is_full_spectrum();
    fill_with_ends(table.film_reflectance, is_full ? -1 : 0, is_full ? 2 : 1);
    if (!table.film_transmittance.empty())
      fill_with_ends(table.film_transmittance, is_full ? -1 : 0, is_full ? 2 : 1);
    if (is_full) fill_with_ends(table.first_visit, -1, 2);
    if (is_full) table.first_visit.set(0, Rgb(1e-40));
    fill_with_ends(table.remainder, table.remainder.precision() == Precision::half_float ? -65504 : -1e7,
                   65504);
    fill_with_ends(table.rest_stderr, 0, 65504);
    expect_finite(table);
  }
}

// Films of a tenth of a millimetre at the ends of the indices have thousands of fringes.
TEST(TableRanges, TexturedLookUpsOfTooManyFringes) {
  Table table = factored(AbsorptionPath::product);
  table.factors.grid[0].nodes = {0, 1e5};
  table.material.film_ior = 5;
  EXPECT_THAT(test::error_of([&] { TexturedTable{table}; }),
              AllOf(HasSubstr("textured look-ups of films up to 1e+05 nm take"),
                    HasSubstr("allowed: up to 4000 MB")));
}

}  // namespace
}  // namespace sunbeam
