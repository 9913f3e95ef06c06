// Tables of folded spectra: what their file must say, and their frame.
#include <gtest/gtest.h>

#include "sunbeam/detail/rest_frame.h"
#include "sunbeam/table_bsdf.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

std::string refusal_without(const std::string& what) {
  Table table = test::small_full_table();
  table.info.erase(what);
  if (what == "first_visit") table.first_visit = {};
  std::string messages;
  for (const auto& form : test::forms()) messages += test::refusal(form, form.bytes(table), "t") + "\n";
  return messages;
}

TEST(FullSpectrumTable, EveryPartIsRequired) {
  for (const std::string what : {"color_space", "illuminant", "wavelengths", "first_visit"})
    EXPECT_NE(refusal_without(what).find("'" + what + "' is missing"), std::string::npos)
        << refusal_without(what);
}

TEST(FullSpectrumTable, UnknownSpectraAndSpacesAreRefused) {
  for (const auto& [key, value] :
       std::map<std::string, std::string>{{"spectrum", "hero"}, {"color_space", "srgb"}}) {
    Table table = test::small_full_table();
    table.info[key] = value;
    for (const auto& form : test::forms()) {
      const std::string message = test::refusal(form, form.bytes(table), "t");
      EXPECT_NE(message.find("'" + key + "'"), std::string::npos) << message;
      EXPECT_NE(message.find("'" + value + "'"), std::string::npos) << message;
    }
  }
}

TEST(FullSpectrumTable, ColourSpaceOfEveryMode) {
  EXPECT_EQ(test::small_table().color_space(), ColorSpace::rec709);
  EXPECT_EQ(test::small_full_table().color_space(), ColorSpace::acescg);
  EXPECT_FALSE(test::small_table().is_full_spectrum());
  EXPECT_FALSE(Table().is_full_spectrum());
}

// F falls to and through 0 in a channel, or starts below it; the frame stays finite and encode() its inverse.
TEST(FoldedRestFrame, EncodeAndDecodeAreInverseWhateverTheSigns) {
  Rng rng(3, 0);
  const auto draw = [&](double low, double high) {
    return Rgb(lerp(rng.uniform(), low, high), lerp(rng.uniform(), low, high),
               lerp(rng.uniform(), low, high));
  };
  for (int k = 0; k < 2000; ++k) {
    NdArray first_visit("first_visit", {test::axis("optical_path", {0, 1, 10}, 3)}, Precision::single_float);
    test::fill_randomly(first_visit, -0.1, 0.9, static_cast<std::uint64_t>(k));
    Material m;
    m.absorption_per_nm = 3 * rng.uniform();
    m.absorption_path = k % 2 ? AbsorptionPath::sum : AbsorptionPath::product;
    const RestFrame frame(m, first_visit);
    const double i = 0.01 + 0.99 * rng.uniform(), o = 0.01 + 0.99 * rng.uniform();
    const Rgb t_i = draw(0, 1.1), t_o = draw(0, 1.1), rest = draw(-0.05, 0.3);
    const Rgb remainder = frame.encode(rest, i, o, t_i, t_o);
    ASSERT_TRUE(is_finite(remainder));
    const Rgb back = frame.decode(remainder, i, o, t_i, t_o);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], rest[c], 1e-9) << k;
  }
}

// One wavelength: F = kd exp(-x) is the frame of rgb3.
TEST(FoldedRestFrame, OfOneWavelengthIsThatOfRgb3) {
  std::vector<double> nodes = spaced_nodes(0, 100, 4096, 3);
  NdArray first_visit("first_visit", {Axis{"optical_path", "1", nodes, 3}}, Precision::single_float);
  for (std::size_t k = 0; k < nodes.size(); ++k) first_visit.set(k, Rgb(0.4 * std::exp(-nodes[k])));
  Material m;
  m.albedo = Rgb(0.4);
  for (const auto path : {AbsorptionPath::sum, AbsorptionPath::product}) {
    m.absorption_path = path;
    const Rgb plain = RestFrame(m).decode(Rgb(0.2), 0.5, 0.8, Rgb(0.7), Rgb(0.9));
    const Rgb folded = RestFrame(m, first_visit).decode(Rgb(0.2), 0.5, 0.8, Rgb(0.7), Rgb(0.9));
    EXPECT_NEAR(folded.g, plain.g, 1e-5 * plain.g);
  }
}

// What a remainder is multiplied by, at normal incidence of a straight film that passes all: F has fallen to
// a half, to a two hundredth and, from a negative start, somewhere; 0.335 on average. A factor beyond a tenth
// and ten times of the mean's is held there, and a channel without a start takes the mean's.
TEST(FoldedRestFrame, DecaysWithinTenTimesTheMean) {
  NdArray first_visit("first_visit", {test::axis("optical_path", {0, 1, 10}, 3)}, Precision::single_float);
  Material m;
  m.transmission = Transmission::straight;
  m.absorption_per_nm = 0.25;
  m.pigment_thickness_nm = 2;
  const auto decay = [&](const Rgb& start, const Rgb& value) {
    first_visit.set(0, start);
    first_visit.set(1, value);
    const RestFrame frame(m, first_visit);
    return frame.decode(Rgb(1), 1, 1, Rgb(1), Rgb(1)) - frame.decode(Rgb(0), 1, 1, Rgb(1), Rgb(1));
  };
  const Rgb held = decay(Rgb(0.6), {0.3, 0.3, 0.003}), negative = decay({0.9, 0.9, -0.3}, {0.3, 0.3, 0.1});
  EXPECT_NEAR(held.r, 0.5, 1e-6);
  EXPECT_NEAR(held.b, 0.0335, 1e-6);
  EXPECT_NEAR(negative.r, 1.0 / 3, 1e-6);
  EXPECT_NEAR(negative.b, 0.7 / 1.5, 1e-6);
}

// Values and sampling of a table whose colours may be negative.
TEST(FullSpectrumTable, BindsAndSamples) {
  const Table table = test::small_full_table();
  const TableBsdf bsdf(table, Parameters::of(table.material), {.outside = OutsideGrid::clamp});
  const Vec3 wo = spherical_direction(0.5, 0);
  Rng rng(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const auto sample = bsdf.sample(wo, rng);
    if (!sample) continue;
    EXPECT_TRUE(is_finite(sample->throughput));
    EXPECT_GT(bsdf.mis_pdf(wo, sample->wi), 0);
  }
}

}  // namespace
}  // namespace sunbeam
