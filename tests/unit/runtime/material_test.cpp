#include "sunbeam/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const std::string& key, const std::string& text) {
  Material material;
  try {
    set_from_text(material, key, text);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Material, TextRoundTripOfEveryKey) {
  Material a;
  a.transmission = Transmission::straight;
  a.absorption_path = AbsorptionPath::product;
  a.film_thickness_nm = 1.0 / 3;
  a.exterior_ior = 1.1;
  a.film_ior = 1.7;
  a.base_ior = 2.2;
  a.base_extinction = 3;
  a.thickness_spread = 0.1;
  a.absorption_per_nm = 0.7;
  a.pigment_thickness_nm = 3;
  a.albedo = {0.1, 0.2, 0.3};
  a.scattering_per_nm = 0.6;
  a.anisotropy = -0.4;
  a.roughness = {0.45, 0.2};
  a.microfacet = Microfacet::multiple;
  Material b;
  for (const auto& key : material_keys()) {
    EXPECT_NE(get_text(a, key), get_text(b, key)) << key;  // each key is really set by the loop
    set_from_text(b, key, get_text(a, key));
    EXPECT_EQ(get_text(a, key), get_text(b, key)) << key;
  }
  EXPECT_EQ(b.film_thickness_nm, 1.0 / 3);
  EXPECT_EQ(b.albedo, Rgb(0.1, 0.2, 0.3));
  EXPECT_EQ(b.transmission, Transmission::straight);
  EXPECT_EQ(b.absorption_path, AbsorptionPath::product);
  EXPECT_EQ(b.microfacet, Microfacet::multiple);
  EXPECT_EQ(b.roughness, Roughness(0.45, 0.2));
}

TEST(Material, OneAlbedoMeansGrey) {
  Material material;
  set_from_text(material, "albedo", "0.25");
  EXPECT_EQ(material.albedo, Rgb(0.25));
}

TEST(Material, RefusalNamesKeyFoundAndAllowed) {
  EXPECT_THAT(refusal("film_ior", "0.9"),
              AllOf(HasSubstr("'film_ior'"), HasSubstr("'0.9'"), HasSubstr("1 to 5")));
  EXPECT_THAT(refusal("film_thickness_nm", "-1"), HasSubstr("0 to 1"));
  EXPECT_THAT(refusal("base_ior", "one"), HasSubstr("'one'"));
  EXPECT_THAT(refusal("absorption_per_nm", "nan"), HasSubstr("0 to 1000"));
  EXPECT_THAT(refusal("albedo", "0.2;1.1;0"), AllOf(HasSubstr("'albedo'"), HasSubstr("0 to 1")));
  EXPECT_THAT(refusal("albedo", "0.2;0.3"), HasSubstr("3 separated by ';'"));
  EXPECT_THAT(refusal("exterior_ior", "1;1"), HasSubstr("one value"));
  EXPECT_THAT(refusal("transmission", "bent"), AllOf(HasSubstr("straight"), HasSubstr("refract")));
  EXPECT_THAT(refusal("absorption_path", "Sum"), AllOf(HasSubstr("product"), HasSubstr("sum")));
  EXPECT_THAT(refusal("colour", "1"), HasSubstr("'colour' is not a material key"));
}

TEST(Material, IntervalsAreClosed) {
  for (const auto& key : material_keys()) {
    if (key == "transmission" || key == "absorption_path" || key == "microfacet") continue;
    const Interval allowed = allowed_interval(key);
    EXPECT_LT(allowed.low, allowed.high) << key;
    EXPECT_EQ(refusal(key, std::to_string(allowed.low)), "accepted") << key;
    EXPECT_EQ(refusal(key, std::to_string(allowed.high)), "accepted") << key;
    EXPECT_NE(refusal(key, std::to_string(allowed.high * 1.01)), "accepted") << key;
    EXPECT_NE(refusal(key, std::to_string(allowed.low - 0.01)), "accepted") << key;
  }
}

TEST(Material, RoughnessIsZeroOrAtLeastTheLeast) {
  EXPECT_EQ(refusal("roughness", "0"), "accepted");
  EXPECT_EQ(refusal("roughness", "0.001"), "accepted");
  EXPECT_THAT(refusal("roughness", "0.0005"), HasSubstr("0 (smooth) or 0.001 to 1"));
  EXPECT_EQ(refusal("roughness", "0.2;0.2"), "accepted");
  EXPECT_EQ(refusal("roughness", "0.2;0.3"), "accepted");
  EXPECT_THAT(refusal("roughness", "0;0.3"), HasSubstr("two such values"));
  EXPECT_THAT(refusal("roughness", "0.1;0.2;0.3"), HasSubstr("2 separated by ';'"));
}

TEST(Material, ScatteringGoesWithSumAndHasALimit) {
  Material m;
  m.scattering_per_nm = 1;
  EXPECT_FALSE(m.defect());
  m.absorption_path = AbsorptionPath::product;
  EXPECT_THAT(m.defect()->message(), AllOf(HasSubstr("'absorption_path'"), HasSubstr("allowed: sum")));
  m.absorption_path = AbsorptionPath::sum;
  m.pigment_thickness_nm = 101;
  EXPECT_THAT(m.defect()->message(), AllOf(HasSubstr("'scattering_per_nm'"), HasSubstr("up to 100")));
}

TEST(Material, RefusedTextLeavesTheMaterialAlone) {
  Material material;
  EXPECT_THROW(set_from_text(material, "albedo", "0.9;2;0.9"), Error);
  EXPECT_EQ(material.albedo, Material().albedo);
}

// Snell: sin 60 / 1.5 = sqrt(3)/3, so the cosine below is sqrt(1 - 1/3).
TEST(Material, CosineBelow) {
  Material material;
  material.base_ior = 1.5;
  EXPECT_NEAR(material.cosine_below(0.5), std::sqrt(2.0 / 3), 1e-15);
  EXPECT_EQ(material.cosine_below(1), 1);
  material.transmission = Transmission::straight;
  EXPECT_EQ(material.cosine_below(0.5), 0.5);
  material.transmission = Transmission::refract;
  material.exterior_ior = 2;  // 2 sin 60 > 1.5: nothing passes
  EXPECT_EQ(material.cosine_below(0.5), 0);
}

// tau = 0.2 * 5 = 1; product 1 / (0.5 * 0.25) = 8, sum 2 + 4 = 6.
TEST(Material, AbsorptionExponent) {
  Material material;
  material.absorption_per_nm = 0.2;
  material.pigment_thickness_nm = 5;
  EXPECT_DOUBLE_EQ(material.optical_depth(), 1);
  material.absorption_path = AbsorptionPath::product;
  EXPECT_DOUBLE_EQ(material.absorption_exponent(0.5, 0.25), -8);
  material.absorption_path = AbsorptionPath::sum;
  EXPECT_DOUBLE_EQ(material.absorption_exponent(0.5, 0.25), -6);
}

TEST(Material, RadianceScale) {
  Material material;
  material.exterior_ior = 1.2;
  material.base_ior = 1.5;
  EXPECT_DOUBLE_EQ(material.radiance_scale(), 0.64);  // (1.2 / 1.5)^2
  material.transmission = Transmission::straight;
  EXPECT_EQ(material.radiance_scale(), 1);
}

}  // namespace
}  // namespace sunbeam
