// The spectral colour module: CIE data, colour spaces, wavelength quadratures, uplifting, absorption shapes.
// docs/theory/color.md quotes the numbers printed and enforced here.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "bake/optics/spectral_material.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/rng.h"

namespace sunbeam {
namespace {

const Illuminant kIlluminants[] = {Illuminant::d65, Illuminant::e};
const ColorSpace kSpaces[] = {ColorSpace::rec709, ColorSpace::acescg};
const char* name(Illuminant illuminant) { return illuminant == Illuminant::d65 ? "D65" : "E"; }
const char* name(ColorSpace space) { return space == ColorSpace::rec709 ? "rec709" : "acescg"; }

double largest_difference(const Rgb& a, const Rgb& b) {
  return max_component(transform(a - b, [](double d) { return std::abs(d); }));
}

Vec3 observer_sum(double step_nm) {
  Vec3 sum;
  for (double nm = 380; nm <= 780; nm += step_nm) sum = sum + observer(nm);
  return sum;
}

// ---- Observer and illuminants ----

// At 5 nm the published sums are 21.371524, 21.371327, 21.371540; at 1 nm from 360 to 830 nm they are
// 106.8655, 106.8569, 106.8923, of which 0.010, 0.0003 and 0.049 lie below 380 nm.
TEST(Cie, ObserverHasThePublishedSums) {
  const Vec3 coarse = observer_sum(5), fine = observer_sum(1);
  EXPECT_NEAR(coarse.x, 21.371524, 2e-6);
  EXPECT_NEAR(coarse.y, 21.371327, 2e-6);
  EXPECT_NEAR(coarse.z, 21.371540, 2e-6);
  EXPECT_NEAR(fine.x, 106.8655 - 0.010, 3e-3);
  EXPECT_NEAR(fine.y, 106.8569 - 0.0003, 3e-3);
  EXPECT_NEAR(fine.z, 106.8923 - 0.049, 3e-3);
  EXPECT_NEAR(fine.x / fine.y, 1, 1e-3);
  EXPECT_NEAR(fine.z / fine.y, 1, 1e-3);
}

TEST(Cie, ObserverPeaksWhereItShould) {
  Vec3 largest, where;
  for (double nm = 380; nm <= 780; ++nm) {
    const Vec3 v = observer(nm);
    if (v.x > largest.x) largest.x = v.x, where.x = nm;
    if (v.y > largest.y) largest.y = v.y, where.y = nm;
    if (v.z > largest.z) largest.z = v.z, where.z = nm;
    EXPECT_GE(std::min({v.x, v.y, v.z}), 0) << nm;
  }
  EXPECT_EQ(largest.y, 1);
  EXPECT_EQ(where.y, 555);
  EXPECT_NEAR(where.x, 599, 1);
  EXPECT_NEAR(where.z, 446, 1);
}

// A slip of the pen in one entry would break the smoothness: fourth differences of neighbours at 5 nm.
TEST(Cie, ObserverIsSmooth) {
  for (double nm = 390; nm <= 770; nm += 5) {
    const Vec3 d = observer(nm - 10) - 4 * observer(nm - 5) + 6 * observer(nm) - 4 * observer(nm + 5) +
                   observer(nm + 10);
    EXPECT_LT(std::abs(d.x), 0.04) << nm;
    EXPECT_LT(std::abs(d.y), 0.02) << nm;
    EXPECT_LT(std::abs(d.z), 0.18) << nm;
  }
}

TEST(Cie, IlluminantsHaveTheirWhitePoints) {
  const Vec3 d65 = illuminant_white(Illuminant::d65), e = illuminant_white(Illuminant::e);
  EXPECT_NEAR(d65.x / (d65.x + d65.y + d65.z), 0.3127, 1e-4);
  EXPECT_NEAR(d65.y / (d65.x + d65.y + d65.z), 0.3290, 1e-4);
  EXPECT_NEAR(e.x / (e.x + e.y + e.z), 1.0 / 3, 1e-3);
  EXPECT_NEAR(e.y / (e.x + e.y + e.z), 1.0 / 3, 1e-3);
  EXPECT_EQ(illuminant_power(Illuminant::d65, 560), 100);
  EXPECT_EQ(illuminant_power(Illuminant::e, 471), 100);
}

// D65 is the daylight of the CIE at 10 nm joined by straight lines, so its odd entries are means.
TEST(Cie, D65IsPiecewiseLinear) {
  for (double nm = 385; nm < 780; nm += 10) {
    const double before = illuminant_power(Illuminant::d65, nm - 5);
    const double after = illuminant_power(Illuminant::d65, nm + 5);
    EXPECT_NEAR(illuminant_power(Illuminant::d65, nm), (before + after) / 2, 6e-4) << nm;
  }
}

TEST(Cie, NothingOutsideTheVisible) {
  for (const double nm : {0.0, 379.9, 780.1, 5000.0}) {
    EXPECT_EQ(observer(nm).y, 0);
    EXPECT_EQ(illuminant_power(Illuminant::e, nm), 0);
  }
}

// ---- Colour spaces ----

TEST(ColorSpaces, KnownMatrices) {
  const ColorMatrix rec709 = rgb_to_xyz(ColorSpace::rec709), acescg = rgb_to_xyz(ColorSpace::acescg);
  EXPECT_NEAR(rec709.row[1].x, 0.2126, 5e-5);
  EXPECT_NEAR(rec709.row[1].y, 0.7152, 5e-5);
  EXPECT_NEAR(rec709.row[1].z, 0.0722, 5e-5);
  EXPECT_NEAR(acescg.row[0].x, 0.6624541811, 1e-9);
  EXPECT_NEAR(acescg.row[1].y, 0.6740817658, 1e-9);
  EXPECT_NEAR(acescg.row[2].z, 1.0103391003, 1e-9);
}

TEST(ColorSpaces, AdaptationMovesWhiteToWhite) {
  for (const Illuminant illuminant : kIlluminants)
    for (const ColorSpace space : kSpaces) {
      const Vec3 adapted =
          bradford(illuminant_white(illuminant), white(space)) * illuminant_white(illuminant);
      EXPECT_LT(length(adapted - white(space)), 1e-14);
      const Vec3 rgb = xyz_to_rgb(illuminant_white(illuminant), space) * illuminant_white(illuminant);
      EXPECT_LT(length(rgb - Vec3{1, 1, 1}), 1e-13);
    }
}

TEST(ColorSpaces, ThereAndBackAgain) {
  const ColorMatrix there = rgb_to_rgb(ColorSpace::acescg, ColorSpace::rec709);
  const ColorMatrix back = rgb_to_rgb(ColorSpace::rec709, ColorSpace::acescg);
  for (const Rgb& color : {Rgb(1), Rgb(0.9, 0.1, 0.1), Rgb(0, 1, 0), Rgb(-0.1, 0.3, 2)}) {
    EXPECT_LT(largest_difference(back * (there * color), color), 1e-14);
    EXPECT_NEAR(luminance(there * Rgb(color.g), ColorSpace::rec709), color.g, 1e-14);
  }
  EXPECT_LT(largest_difference(there * Rgb(1), Rgb(1)), 1e-14);
  // AP1 to Rec.709 with Bradford's adaptation, as published by many.
  EXPECT_NEAR(there.row[0].x, 1.70505, 5e-5);
  EXPECT_NEAR(there.row[0].y, -0.62179, 5e-5);
  EXPECT_NEAR(there.row[2].z, 1.15297, 5e-5);
}

TEST(ColorSpaces, ClippingIsAccountedFor) {
  ClipAccount account;
  EXPECT_EQ(account.clip({0.2, 0.4, 0.6}, ColorSpace::rec709), Rgb(0.2, 0.4, 0.6));
  EXPECT_EQ(account.clipped, 0);
  EXPECT_EQ(account.clip({-0.1, 0.4, 0.6}, ColorSpace::rec709), Rgb(0, 0.4, 0.6));
  EXPECT_EQ(account.colors, 2);
  EXPECT_EQ(account.clipped, 1);
  EXPECT_EQ(account.lowest, -0.1);
  EXPECT_NEAR(account.luminance_added, 0.1 * 0.2126, 1e-5);
  const GamutClip clip = clip_negative({-0.1, 0.4, -0.2}, ColorSpace::acescg);
  EXPECT_EQ(clip.clipped, Rgb(0, 0.4, 0));
  EXPECT_EQ(clip.added, Rgb(0.1, 0, 0.2));
}

// ---- Quadratures over random films ----

struct FilmSample {
  ThinFilm film;
  double cosine;
};

// Thickness 0 to 1500 nm, film 1.3 to 1.8, base 1 to 2, angle 0 to 90 degrees, uniform; above: air or glass.
std::vector<FilmSample> random_films(double exterior_ior = 1, int count = 2000) {
  std::vector<FilmSample> films;
  Rng rng(20240607, 1);
  for (int i = 0; i < count; ++i) {
    const double film_ior = 1.3 + 0.5 * rng.uniform(), base_ior = 1 + rng.uniform();
    const double thickness_nm = 1500 * rng.uniform(), angle = rng.uniform() * kPi / 2;
    films.push_back({{exterior_ior, film_ior, base_ior, thickness_nm}, std::cos(angle)});
  }
  return films;
}

struct ErrorSummary {
  double median, p99, largest;
};

// Over all films and channels of |R - R_reference| / max(R_reference, 0.01).
template <class Reflectance>
ErrorSummary film_errors(const std::vector<FilmSample>& films, const std::vector<Rgb>& reference,
                         Reflectance reflectance) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < films.size(); ++i)
    for (int c = 0; c < 3; ++c)
      errors.push_back(std::abs(reflectance(films[i])[c] - reference[i][c]) /
                       std::max(reference[i][c], 0.01));
  std::sort(errors.begin(), errors.end());
  return {errors[errors.size() / 2], errors[errors.size() * 99 / 100], errors.back()};
}

std::vector<Rgb> fold_films(const WavelengthQuadrature& q, const std::vector<FilmSample>& films) {
  std::vector<Rgb> result;
  for (const FilmSample& s : films) result.push_back(q.fold_film(s.film, s.cosine).reflectance);
  return result;
}

void print(const std::string& label, const ErrorSummary& e) {
  std::printf("%-28s median %8.4f %%  p99 %8.4f %%  max %8.3f %%\n", label.c_str(), 100 * e.median,
              100 * e.p99, 100 * e.largest);
}

TEST(WavelengthQuadratures, WhiteIsWhite) {
  for (const Illuminant illuminant : kIlluminants)
    for (const ColorSpace space : kSpaces)
      for (const WavelengthQuadrature& q : {brute_force(illuminant, space), fitted(illuminant, space)}) {
        EXPECT_LT(largest_difference(q.fold_function([](double) { return 1.0; }), Rgb(1)), 1e-14);
        const FilmPower power = q.fold_film({1, 1.56, 1.4, 400}, 0.6);
        EXPECT_LT(largest_difference(power.reflectance + power.transmittance, Rgb(1)), 1e-14);
      }
}

TEST(WavelengthQuadratures, NodesAreUniformInWaveNumber) {
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::acescg, 16);
  ASSERT_EQ(q.size(), 16u);
  EXPECT_NEAR(q.wavelength_nm.front(), 720, 1e-9);
  EXPECT_NEAR(q.wavelength_nm.back(), 395, 1e-9);
  for (std::size_t k = 1; k < q.size(); ++k)
    EXPECT_NEAR(1 / q.wavelength_nm[k] - 1 / q.wavelength_nm[k - 1], (1 / 395.0 - 1 / 720.0) / 15, 1e-15);
}

TEST(WavelengthQuadratures, Fringes) {
  for (const ColorSpace space : kSpaces) {
    const WavelengthQuadrature reference = brute_force(Illuminant::d65, space);
    const WavelengthQuadrature q = fitted(Illuminant::d65, space);
    for (double path = 0; path <= kDefaultLargestPathNm; path += 37) {
      const auto wave = [&](double nm) { return std::cos(2 * kPi * path / nm); };
      const auto other = [&](double nm) { return std::sin(2 * kPi * path / nm); };
      EXPECT_LT(largest_difference(q.fold_function(wave), reference.fold_function(wave)), 6e-4) << path;
      EXPECT_LT(largest_difference(q.fold_function(other), reference.fold_function(other)), 6e-4) << path;
    }
  }
}

TEST(WavelengthQuadratures, ConvergenceTable) {
  const std::vector<FilmSample> films = random_films();
  for (const Illuminant illuminant : kIlluminants)
    for (const ColorSpace space : kSpaces) {
      const std::vector<Rgb> reference = fold_films(brute_force(illuminant, space), films);
      std::printf("%s %s\n", name(illuminant), name(space));
      for (const int nodes : {12, 16, 20, 24, 28, 32}) {
        const WavelengthQuadrature q = fitted(illuminant, space, nodes);
        const ErrorSummary error = film_errors(
            films, reference, [&](const FilmSample& s) { return q.fold_film(s.film, s.cosine).reflectance; });
        print("  " + std::to_string(nodes) + " nodes", error);
        if (nodes == kDefaultNodes) {
          EXPECT_LT(error.median, 4e-5);
          EXPECT_LT(error.p99, 0.003);
        }
        if (nodes == 24) {
          EXPECT_LT(error.p99, 0.0015);
        }
      }
    }
}

// Three wavelengths taken as the three channels are another picture.
TEST(WavelengthQuadratures, ThreeWavelengthsAreFarOff) {
  const std::vector<FilmSample> films = random_films();
  const std::vector<Rgb> reference = fold_films(brute_force(Illuminant::d65, ColorSpace::rec709), films);
  const ErrorSummary error = film_errors(films, reference, [](const FilmSample& s) {
    return airy(s.film, s.cosine, {650, 510, 475}).reflectance;
  });
  print("rgb3 (650, 510, 475 nm)", error);
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::rec709);
  for (const double thickness_nm : {200.0, 400.0, 1000.0, 1500.0}) {
    const ThinFilm film{1, 1.56, 1.3, thickness_nm};
    const Rgb folded = q.fold_film(film, 1).reflectance;
    const Rgb three = airy(film, 1, {650, 510, 475}).reflectance;
    std::printf("%5.0f nm: %7.4f %7.4f %7.4f, rgb3 %7.4f %7.4f %7.4f\n", thickness_nm, folded.r, folded.g,
                folded.b, three.r, three.g, three.b);
  }
  EXPECT_GT(error.median, 0.05);
  EXPECT_GT(error.p99, 1.0);
}

// The node count in proportion to the path keeps the accuracy for thicker films.
TEST(WavelengthQuadratures, LongerPathsNeedMoreNodes) {
  EXPECT_EQ(nodes_for_path(kDefaultLargestPathNm), kDefaultNodes);
  EXPECT_EQ(nodes_for_path(100), 16);
  std::vector<FilmSample> films = random_films(1, 600);
  for (const double factor : {0.5, 2.0, 4.0}) {
    std::vector<FilmSample> scaled = films;
    for (FilmSample& s : scaled) s.film.thickness_nm *= factor;
    const double path = factor * kDefaultLargestPathNm;
    const std::vector<Rgb> reference = fold_films(brute_force(Illuminant::d65, ColorSpace::acescg), scaled);
    const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::acescg, nodes_for_path(path), path);
    const ErrorSummary error = film_errors(
        scaled, reference, [&](const FilmSample& s) { return q.fold_film(s.film, s.cosine).reflectance; });
    print("path " + std::to_string(static_cast<int>(path)) + " nm, " + std::to_string(q.size()) + " nodes",
          error);
    EXPECT_LT(error.p99, 0.003);
  }
}

// Under glass, films of lower index leak beyond their critical angle; nothing is special there.
TEST(WavelengthQuadratures, FrustratedTotalReflection) {
  std::vector<FilmSample> films = random_films(1.6, 1000);
  for (FilmSample& s : films) s.film.film_ior -= 0.3;
  const std::vector<Rgb> reference = fold_films(brute_force(Illuminant::d65, ColorSpace::acescg), films);
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::acescg);
  const ErrorSummary error = film_errors(
      films, reference, [&](const FilmSample& s) { return q.fold_film(s.film, s.cosine).reflectance; });
  print("under n0 = 1.6", error);
  EXPECT_LT(error.p99, 0.003);
}

// The recommendation of ACEScg rests on this: thin films leave Rec.709 but not ACEScg.
TEST(WavelengthQuadratures, FilmsStayInsideAcescg) {
  const std::vector<FilmSample> films = random_films(1, 8000);
  for (const ColorSpace space : kSpaces) {
    const WavelengthQuadrature q = fitted(Illuminant::d65, space);
    ClipAccount account;
    double highest = 0;
    for (const FilmSample& s : films) {
      const FilmPower power = q.fold_film(s.film, s.cosine);
      account.clip(power.reflectance, space);
      account.clip(power.transmittance, space);
      highest = std::max({highest, max_component(power.transmittance), max_component(power.reflectance)});
    }
    std::printf("%s: lowest %.4f, highest %.4f, %.2f %% of colours clipped, luminance added %.4f %%\n",
                name(space), account.lowest, highest,
                100.0 * static_cast<double>(account.clipped) / static_cast<double>(account.colors),
                100 * account.luminance_added / account.luminance);
    EXPECT_EQ(account.clipped > 0, space == ColorSpace::rec709);
  }
}

TEST(WavelengthQuadratures, BadRequestsAreErrors) {
  EXPECT_THROW(fitted(Illuminant::e, ColorSpace::acescg, 1), Error);
  EXPECT_THROW(fitted(Illuminant::e, ColorSpace::acescg, 16, 0), Error);
  EXPECT_THROW(fitted(Illuminant::e, ColorSpace::acescg, 16, std::nan("")), Error);
}

TEST(WavelengthQuadratures, LinearSolver) {
  std::vector<double> x = {7, 4, 3};
  EXPECT_TRUE(solve_linear({0, 2, 1, 1, 0, 1, 1, 1, 0}, x));
  EXPECT_NEAR(x[0], 1, 1e-15);
  EXPECT_NEAR(x[1], 2, 1e-15);
  EXPECT_NEAR(x[2], 3, 1e-15);
  std::vector<double> none = {1, 1};
  EXPECT_FALSE(solve_linear({1, 1, 1, 1}, none));
}

// ---- Uplifting ----

// Rec.709 lies inside the solid of reflectances, corners included.
TEST(Uplift, AllOfRec709) {
  const double levels[] = {0, 0.01, 0.1, 0.4, 0.7, 0.95, 1};
  for (const Illuminant illuminant : kIlluminants) {
    const WavelengthQuadrature q = fitted(illuminant, ColorSpace::rec709);
    for (const double r : levels)
      for (const double g : levels)
        for (const double b : levels) {
          const std::vector<double> spectrum = uplift_albedo(q, {r, g, b});
          for (const double s : spectrum) EXPECT_TRUE(s >= 0 && s <= 1) << s;
          EXPECT_LT(largest_difference(q.fold(spectrum), {r, g, b}), 1e-9) << r << ' ' << g << ' ' << b;
        }
  }
}

// So every Rec.709 colour taken over into ACEScg has a spectrum too.
TEST(Uplift, Rec709InAcescg) {
  const ColorMatrix to_acescg = rgb_to_rgb(ColorSpace::rec709, ColorSpace::acescg);
  for (const Illuminant illuminant : kIlluminants) {
    const WavelengthQuadrature q = fitted(illuminant, ColorSpace::acescg);
    for (const Rgb& color :
         {Rgb(0.9, 0.1, 0.1), Rgb(0.1, 0.9, 0.1), Rgb(0.1, 0.1, 0.9), Rgb(1, 1, 0), Rgb(1, 0, 1)}) {
      const Rgb albedo = to_acescg * color;
      EXPECT_LT(largest_difference(q.fold(uplift_albedo(q, albedo)), albedo), 1e-9) << color.r << color.g;
    }
  }
}

TEST(Uplift, GreyIsConstant) {
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::acescg);
  for (const double grey : {0.0, 0.18, 0.5, 1.0})
    for (const double s : uplift_albedo(q, Rgb(grey))) EXPECT_EQ(s, grey);
  for (const double s : uplift_albedo(q, {0.5, 0.5, 0.5000001})) EXPECT_NEAR(s, 0.5, 1e-6);
}

// A skin tone's spectrum, read between the nodes, has the same colour under the full observer.
TEST(Uplift, SpectrumIsSmooth) {
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::rec709);
  const WavelengthQuadrature reference = brute_force(Illuminant::d65, ColorSpace::rec709);
  double worst = 0;
  for (const Rgb& color :
       {Rgb(0.6, 0.35, 0.25), Rgb(0.2, 0.3, 0.1), Rgb(0.9, 0.1, 0.1), Rgb(0.05, 0.1, 0.5)}) {
    const std::vector<double> s = uplift_albedo(q, color);
    std::vector<std::pair<double, double>> points;
    for (std::size_t k = q.size(); k-- > 0;) points.emplace_back(q.wavelength_nm[k], s[k]);
    const AbsorptionShape line = AbsorptionShape::table(points);
    const double scale = color.g / q.fold_function(line).g;  // the line is relative to 510 nm
    worst = std::max(worst, largest_difference(scale * reference.fold_function(line), color));
  }
  std::printf("between the nodes: %.4f\n", worst);
  EXPECT_LT(worst, 0.01);
}

TEST(Uplift, UnreachableColoursNameTheNearest) {
  const WavelengthQuadrature q = fitted(Illuminant::d65, ColorSpace::acescg);
  try {
    uplift_albedo(q, {0, 1, 0});
    FAIL() << "no reflectance is that green";
  } catch (const Error& error) {
    const std::string text = error.what();
    const std::size_t at = text.rfind('(');
    Rgb nearest;
    ASSERT_EQ(std::sscanf(text.c_str() + at, "(%lf, %lf, %lf)", &nearest.r, &nearest.g, &nearest.b), 3)
        << text;
    EXPECT_GT(nearest.g, 0.5) << text;
    EXPECT_LT(largest_difference(q.fold(uplift_albedo(q, nearest)), nearest), 1e-9) << text;
  }
  EXPECT_THROW(uplift_albedo(q, {1.2, 0.5, 0.5}), Error);
  EXPECT_THROW(uplift_albedo(q, {0.5, -0.1, 0.5}), Error);
  EXPECT_THROW(uplift_albedo(q, {0.5, std::nan(""), 0.5}), Error);
}

// ---- Absorption ----

TEST(Absorption, FlatAndTables) {
  EXPECT_EQ(AbsorptionShape::flat()(400), 1);
  const AbsorptionShape shape = AbsorptionShape::table({{450, 6}, {500, 4}, {520, 2}, {600, 1}});
  EXPECT_EQ(shape(510), 1);
  EXPECT_NEAR(shape(475), 5.0 / 3, 1e-15);
  EXPECT_NEAR(shape(380), 2, 1e-15);
  EXPECT_NEAR(shape(780), 1.0 / 3, 1e-15);
  EXPECT_EQ(AbsorptionShape::table({{600, 7}})(400), 1);
}

TEST(Absorption, Pigments) {
  const AbsorptionShape eumelanin = AbsorptionShape::pigment("eumelanin");
  EXPECT_EQ(eumelanin(510), 1);
  // 1.70e12 lambda^-3.48 per cm, by hand: 3.48 ln(700 / 400) = 1.9475.
  EXPECT_NEAR(eumelanin(400) / eumelanin(700), std::exp(1.9475), 1e-3);
  EXPECT_NEAR(eumelanin(1020), 0.08962, 1e-4);  // 2^-3.48
  EXPECT_GT(AbsorptionShape::pigment("pheomelanin")(400), eumelanin(400));
  EXPECT_EQ(AbsorptionShape::pigment("pheomelanin")(510), 1);
  EXPECT_NEAR(AbsorptionShape::pigment("pheomelanin")(1020), 0.037163, 1e-5);  // 2^-4.75
}

TEST(Absorption, BadTablesAreErrors) {
  EXPECT_THROW(AbsorptionShape::table({}), Error);
  EXPECT_THROW(AbsorptionShape::table({{500, 1}, {500, 2}}), Error);
  EXPECT_THROW(AbsorptionShape::table({{500, 1}, {400, 2}}), Error);
  EXPECT_THROW(AbsorptionShape::table({{-500, 1}}), Error);
  EXPECT_THROW(AbsorptionShape::table({{500, -1}}), Error);
  EXPECT_THROW(AbsorptionShape::table({{500, 0}, {520, 0}}), Error);
  EXPECT_THROW(AbsorptionShape::pigment("chlorophyll"), Error);
}

}  // namespace
}  // namespace sunbeam
