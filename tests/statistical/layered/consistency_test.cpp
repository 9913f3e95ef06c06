// Light through layered films is reciprocal, and samples follow their density. Fixed seeds; the stated rates
// of false alarm hold when a seed is changed.
#include <gtest/gtest.h>

#include "bake/live/live_bsdf.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/estimates.h"
#include "tests/support/layered_materials.h"

namespace sunbeam {
namespace {

const Vec3 kOblique = spherical_direction(0.9, 0.4);

// 2 films x 9 surfaces x 2 techniques x 3 channels at 4.5 standard errors (7e-6): 8e-4 in all.
TEST(LayeredConsistency, EvalIsReciprocal) {
  const Vec3 a = spherical_direction(0.4, 0.3), b = spherical_direction(1.1, 2);
  const auto surfaces = test::film_surfaces({0.9, 0.8, 0.6}, 0.1);
  for (const auto& [name, material, wavelengths] :
       test::with_films({test::absorbing_design(), test::leaf_design()}, surfaces))
    for (const Technique technique : test::kTechniques) {
      const Pfmc pfmc(material, wavelengths);
      Rng rng(1, 0);
      test::RgbMean gap, value;
      for (int i = 0; i < 3000; ++i) {
        const Rgb forward = pfmc.estimate_rest(a, b, rng, technique);
        gap.add(forward - pfmc.estimate_rest(b, a, rng, technique));
        value.add(forward);
      }
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(gap[c].mean(), 0, 4.5 * gap[c].std_error() + 1e-12) << name << " channel " << c;
        EXPECT_LT(gap[c].std_error(), 0.05 * value[c].mean()) << name << " channel " << c;
      }
    }
}

// Films that absorb and films that do not, over opaque bases and others, on surfaces of every kind.
std::vector<test::Configuration> sampled_configurations() {
  const auto on = [](const test::LayeredDesign& design, const std::vector<std::string>& names) {
    std::vector<test::NamedMaterial> surfaces;
    for (const auto& surface : test::film_surfaces({0.9, 0.8, 0.6}, 0.1))
      if (std::ranges::find(names, surface.name) != names.end()) surfaces.push_back(surface);
    return test::with_films({design}, surfaces);
  };
  std::vector<test::Configuration> result;
  for (const auto& some :
       {on(test::absorbing_design(), {"smooth refract", "rough under liquid", "multiple straight"}),
        on(test::leaf_design(), {"rough straight", "multiple refract", "smooth under liquid"}),
        on(test::uneven_absorbing_design(), {"rough refract"}),
        on(test::oxide_design(), {"rough refract", "multiple straight"}),
        on(test::dark_oxide_design(), {"smooth refract", "multiple refract"})})
    result.insert(result.end(), some.begin(), some.end());
  return result;
}

// 11 materials: 1e-3 in all.
TEST(LayeredConsistency, SamplesFollowThePdf) {
  for (const auto& [name, material, wavelengths] : sampled_configurations()) {
    const auto result = test::chi_square_of_sampling(LiveBsdf(material, wavelengths), kOblique,
                                                     {.samples = 30000, .points = 2, .pdf_samples = 16}, 2);
    const bool has_directions = !material.is_opaque() || !material.is_smooth();
    EXPECT_GT(result.p_value, has_directions ? test::sidak(1e-3, 11) : -1) << name;
    EXPECT_GE(result.degrees, has_directions ? 50 : 0) << name;
  }
}

// What is absorbed is an outcome as well. 11 materials at 4.5 standard errors: 8e-5.
TEST(LayeredConsistency, ProbabilitiesSumToOne) {
  for (const auto& [name, material, wavelengths] : sampled_configurations()) {
    const LiveBsdf bsdf(material, wavelengths);
    const auto density = test::integrate_pdf(bsdf, kOblique, 32, 16, 3);
    const auto sampled = test::sample_totals(bsdf, kOblique, 40000, 3);
    const double error = std::hypot(density.std_error(), sampled.seen.std_error());
    EXPECT_NEAR(density.mean() + sampled.dirac + sampled.empty, 1, 4.5 * error + 1e-9) << name;
    EXPECT_LE(error, 1e-2) << name;
  }
}

// Under a film that lets about nothing through, no walk goes on for ever: all is first, or wanders among
// facets. 9 materials x 3 channels at 4.5 standard errors: 2e-4.
TEST(LayeredConsistency, WalksEndUnderAMirror) {
  const Vec3 steep = spherical_direction(0.3, 2.5);
  for (const auto& [name, material, wavelengths] :
       test::with_films({test::mirror_design()}, test::film_surfaces(Rgb(1)))) {
    const LiveBsdf bsdf(material, wavelengths);
    const Pfmc pfmc(material, wavelengths);
    Material onto_black = material;
    onto_black.albedo = Rgb(0);
    Wavelengths black = wavelengths;
    black.albedo = {0, 0, 0};
    const auto found = test::sample_totals(bsdf, kOblique, 2000, 8).albedo;
    const auto expected = test::sample_totals(LiveBsdf(onto_black, black), kOblique, 2000, 9).albedo;
    test::expect_agree(found, expected, 4.5, 1e-9, name);
    Rng rng(8, 0);
    for (int i = 0; i < 500; ++i) {
      EXPECT_TRUE(std::isfinite(bsdf.pdf(kOblique, steep, rng))) << name;
      for (const Technique technique : test::kTechniques) {
        const Rgb rest = pfmc.estimate_rest(kOblique, steep, rng, technique);
        EXPECT_LE(max_component(rest), material.has_multiple_facets() ? 1e3 : 1e-9) << name;
      }
    }
  }
}

// 18 materials x 3 channels at 4.5 standard errors: 4e-4 in all.
TEST(LayeredConsistency, TechniquesAgree) {
  const Vec3 steep = spherical_direction(0.3, 2.5);
  const auto surfaces = test::film_surfaces({0.9, 0.8, 0.6}, 0.1, {0.15, 0.4});
  for (const auto& [name, material, wavelengths] :
       test::with_films({test::leaf_design(), test::dispersive_design()}, surfaces)) {
    const Pfmc pfmc(material, wavelengths);
    Rng rng(5, 0);
    test::RgbMean one, two;
    for (int i = 0; i < 3000; ++i) {
      one.add(pfmc.estimate_rest(kOblique, steep, rng, Technique::unidirectional));
      two.add(pfmc.estimate_rest(kOblique, steep, rng, Technique::bidirectional));
    }
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(test::deviation(one[c].mean(), one[c].std_error(), two[c].mean(), two[c].std_error()), 4.5)
          << name << " channel " << c;
  }
}

// Light that passes facets in and out again and never sees the black base, as it does under a liquid: a third
// of the whole, of a film that absorbs half. 3 channels at 4.5 standard errors: 2e-5.
TEST(LayeredConsistency, LightPassesInAndOutAmongFacets) {
  Material material;
  material.exterior_ior = 1.5;
  material.base_ior = 1.05;
  material.albedo = Rgb(0);
  material.roughness = 1;
  material.microfacet = Microfacet::multiple;
  const test::LayeredDesign film{"dark", [](double) { return std::vector<FilmLayer>{{30, {1.4, 0.7}}}; }};
  const auto [name, m, wavelengths] = test::with_film(film, {"under liquid", material});
  const LiveBsdf bsdf(m, wavelengths);
  const Vec3 grazing = spherical_direction(1.45, 0.4);
  const auto sampled = test::sample_totals(bsdf, grazing, 40000, 8).albedo;
  const auto valued = test::albedo_by_eval(bsdf, grazing, 16, 40, 8);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(
        test::deviation(sampled[c].mean(), sampled[c].std_error(), valued[c].mean(), valued[c].std_error()),
        4.5)
        << name << " channel " << c;
    EXPECT_LE(valued[c].std_error(), 0.03 * valued[c].mean());
  }
}

// Twelve wavelengths, of which LiveBsdf draws four in every call, each under a film of its own.
std::vector<test::Configuration> many_wavelengths() {
  std::vector<test::Configuration> result;
  for (const auto& surface : test::film_surfaces({0.9, 0.8, 0.6}, 0.1)) {
    const auto three = test::with_film(test::absorbing_design(), surface);
    const Wavelengths twelve =
        test::layered(test::absorbing_design(), test::twelve_wavelengths(three.material));
    if (surface.name.ends_with("refract") || surface.name == "multiple straight")
      result.push_back({three.name, three.material, twelve});
  }
  return result;
}

// 4 surfaces x 2 models x 3 channels at 4.5 standard errors: 2e-4.
TEST(LayeredConsistency, ManyWavelengthsAreAsManySingleOnes) {
  const Vec3 steep = spherical_direction(0.3, 2.5);
  for (const auto& [name, material, wavelengths] : many_wavelengths()) {
    const LiveBsdf live(material, wavelengths);
    const Pfmc together(material, wavelengths);
    std::vector<Pfmc> apart;
    for (std::size_t k = 0; k < wavelengths.size(); ++k)
      apart.emplace_back(material, test::at_one(wavelengths, k));
    const Rgb first = together.first(kOblique, steep);
    Rng rng(6, 0);
    test::RgbMean expected, carried, drawn;
    for (int i = 0; i < 1500; ++i) {
      Rgb sum;
      for (std::size_t k = 0; k < wavelengths.size(); ++k)
        sum += wavelengths.weight[k] * apart[k].estimate_rest(kOblique, steep, rng).g;
      expected.add(sum);
      carried.add(together.estimate_rest(kOblique, steep, rng));
      drawn.add(live.eval(kOblique, steep, rng) - first);
    }
    test::expect_agree(carried, expected, 4.5, 1e-7, name + ", carried");
    test::expect_agree(drawn, expected, 4.5, 1e-7, name + ", drawn");
    EXPECT_LE(drawn.g.std_error(), 0.05 * drawn.g.mean()) << name;
  }
}

// The same for samples.
TEST(LayeredConsistency, SamplesOfManyWavelengthsAreThoseOfSingleOnes) {
  for (const auto& [name, material, wavelengths] : many_wavelengths()) {
    Rgb expected, variance;
    for (std::size_t k = 0; k < wavelengths.size(); ++k) {
      const LiveBsdf one(material, test::at_one(wavelengths, k));
      const auto grey = test::sample_totals(one, kOblique, 3000, 7 + k).albedo.g;
      expected += wavelengths.weight[k] * grey.mean();
      variance += wavelengths.weight[k] * wavelengths.weight[k] * square(grey.std_error());
    }
    const auto found = test::sample_totals(LiveBsdf(material, wavelengths), kOblique, 20000, 6).albedo;
    for (int c = 0; c < 3; ++c) {
      const double error = std::hypot(found[c].std_error(), std::sqrt(variance[c]));
      EXPECT_NEAR(found[c].mean(), expected[c], 4.5 * error) << name << ' ' << c;
      EXPECT_LE(error, 0.05 * expected[c]) << name << ' ' << c;
    }
  }
}

}  // namespace
}  // namespace sunbeam
