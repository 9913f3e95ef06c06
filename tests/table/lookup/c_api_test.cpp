// The C interface: the values of the C++ one, and a message for every misuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sunbeam/sunbeam.h"
#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using ::testing::HasSubstr;

const std::string kPath = std::string(SUNBEAM_SOURCE_DIR) + "/tables/golden/preview.exr";
constexpr sunbeam_parameters kAt = {430, 1, 0.7};
constexpr double kWo[] = {0.6, 0, 0.8}, kWi[] = {-0.48, 0.36, 0.8}, kU[] = {0.3, 0.6, 0.1};

class CApi : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(table_, nullptr) << sunbeam_error(); }
  void TearDown() override { sunbeam_free_table(table_); }

  sunbeam_table* table_ = sunbeam_load(kPath.c_str());
  const Table same_ = load_table_exr(kPath);
};

TEST_F(CApi, HasTheValuesOfCpp) {
  const sunbeam_options options = {0, SUNBEAM_REC2020, 1};
  const BindOptions same = {.color_space = ColorSpace::rec2020, .clip_negative = true};
  const TableBsdf bound = same_.bind({430, 1, 0.7}, same);
  sunbeam_bsdf* bsdf = sunbeam_bind(table_, &kAt, &options);
  double f[3], pdf;
  ASSERT_EQ(sunbeam_eval(bsdf, 1, kWo, kWi, f, &pdf), 0);
  const EvalPdf expected = bound.eval_pdf({0.6, 0, 0.8}, {-0.48, 0.36, 0.8});
  EXPECT_EQ(Rgb(f[0], f[1], f[2]), expected.f);
  EXPECT_EQ(pdf, expected.pdf);
  sunbeam_sample_result sample;
  ASSERT_EQ(sunbeam_sample(bsdf, 1, kWo, kU, &sample), 0);
  const auto drawn = bound.sample({0.6, 0, 0.8}, {0.3, 0.6, 0.1});
  ASSERT_TRUE(drawn);
  EXPECT_EQ(sample.wi[0], drawn->wi.x);
  EXPECT_EQ(sample.throughput[1], drawn->throughput.g);
  EXPECT_EQ(sample.pdf, drawn->mis_pdf);
  EXPECT_EQ(sample.is_empty, 0);
  sunbeam_free_bsdf(bsdf);
}

TEST_F(CApi, HasTheValuesOfTexturedTables) {
  sunbeam_textured* textured = sunbeam_make_textured(table_, nullptr);
  double f[3];
  ASSERT_EQ(sunbeam_eval_at(textured, 1, &kAt, kWo, kWi, f, nullptr), 0);
  const TexturedTable same(same_);
  EXPECT_EQ(f[1], same.at({430, 1, 0.7}).eval({0.6, 0, 0.8}, {-0.48, 0.36, 0.8}).g);
  sunbeam_sample_result sample;
  ASSERT_EQ(sunbeam_sample_at(textured, 1, &kAt, kWo, kU, &sample), 0);
  sunbeam_free_textured(textured);
}

TEST_F(CApi, SaysWhatIsWrong) {
  EXPECT_EQ(sunbeam_load("none.exr"), nullptr);
  EXPECT_THAT(sunbeam_error(), HasSubstr("none.exr"));
  const sunbeam_parameters far_off = {9000, 1, 0.7};
  EXPECT_EQ(sunbeam_bind(table_, &far_off, nullptr), nullptr);
  EXPECT_THAT(sunbeam_error(), HasSubstr("film_thickness_nm"));
  const sunbeam_options odd = {0, 9, 0};
  EXPECT_EQ(sunbeam_bind(table_, &kAt, &odd), nullptr);
  EXPECT_THAT(sunbeam_error(), HasSubstr("color_space: found 9"));
  sunbeam_bsdf* bsdf = sunbeam_bind(table_, &kAt, nullptr);
  const double beyond[] = {0.5, 1, 0.5};
  sunbeam_sample_result sample;
  EXPECT_EQ(sunbeam_sample(bsdf, 1, kWo, beyond, &sample), -1);
  EXPECT_THAT(sunbeam_error(), HasSubstr("u: found 1"));
  sunbeam_free_bsdf(bsdf);
}

TEST_F(CApi, TakesNullForAnError) {
  double f[3];
  EXPECT_EQ(sunbeam_load(nullptr), nullptr);
  EXPECT_EQ(sunbeam_bind(nullptr, &kAt, nullptr), nullptr);
  EXPECT_EQ(sunbeam_bind(table_, nullptr, nullptr), nullptr);
  EXPECT_EQ(sunbeam_eval(nullptr, 1, kWo, kWi, f, nullptr), -1);
  EXPECT_THAT(sunbeam_error(), HasSubstr("'bsdf' is null"));
  sunbeam_bsdf* bsdf = sunbeam_bind(table_, &kAt, nullptr);
  EXPECT_EQ(sunbeam_eval(bsdf, 1, nullptr, kWi, f, nullptr), -1);
  EXPECT_EQ(sunbeam_sample(bsdf, 1, kWo, kU, nullptr), -1);
  sunbeam_free_bsdf(bsdf);
  sunbeam_free_bsdf(nullptr);
  sunbeam_free_table(nullptr);
  sunbeam_free_textured(nullptr);
}

TEST_F(CApi, TakesUnitVectorsAlone) {
  sunbeam_bsdf* bsdf = sunbeam_bind(table_, &kAt, nullptr);
  sunbeam_textured* textured = sunbeam_make_textured(table_, nullptr);
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const double wrong[][3] = {{nan, 0, 1},  {0.6, 0, nan}, {infinite, 0, 1},
                             {1e30, 0, 1}, {0, 0, 0},     {0, 0, 1.002}};
  double f[3];
  sunbeam_sample_result sample;
  for (const double* w : wrong) {
    EXPECT_EQ(sunbeam_eval(bsdf, 1, w, kWi, f, nullptr), -1);
    EXPECT_THAT(sunbeam_error(), HasSubstr("wo: direction 0 is ("));
    EXPECT_EQ(sunbeam_eval(bsdf, 1, kWo, w, f, nullptr), -1);
    EXPECT_THAT(sunbeam_error(), HasSubstr("wi: direction 0 is ("));
    EXPECT_EQ(sunbeam_sample(bsdf, 1, w, kU, &sample), -1);
    EXPECT_EQ(sunbeam_eval_at(textured, 1, &kAt, w, kWi, f, nullptr), -1);
    EXPECT_EQ(sunbeam_sample_at(textured, 1, &kAt, w, kU, &sample), -1);
  }
  const double rounded[] = {0, 0, 1.0000001};
  EXPECT_EQ(sunbeam_eval(bsdf, 1, rounded, kWi, f, nullptr), 0) << sunbeam_error();
  sunbeam_free_textured(textured);
  sunbeam_free_bsdf(bsdf);
}

TEST_F(CApi, TakesNoParameterThatIsNan) {
  sunbeam_textured* textured = sunbeam_make_textured(table_, nullptr);
  const sunbeam_options clamp = {1, 0, 0};
  const double nan = std::nan("");
  double f[3];
  for (const sunbeam_parameters& at : {sunbeam_parameters{nan, 1, 0.7}, {430, nan, 0.7}, {430, 1, nan}}) {
    EXPECT_EQ(sunbeam_bind(table_, &at, &clamp), nullptr);
    EXPECT_THAT(sunbeam_error(), HasSubstr("found nan"));
    EXPECT_EQ(sunbeam_eval_at(textured, 1, &at, kWo, kWi, f, nullptr), -1);
  }
  sunbeam_free_textured(textured);
}

}  // namespace
}  // namespace sunbeam
