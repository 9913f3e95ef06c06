// How many wavelengths random layered films take, and how wrong their colours are. docs/theory/color.md
// quotes the numbers printed and enforced here.
#include "bake/optics/layered/film_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "sunbeam/core/rng.h"
#include "sunbeam/detail/layered_film.h"

namespace sunbeam {
namespace {

constexpr auto kSpace = ColorSpace::acescg;
constexpr int kStacks = 24;  // of each kind

struct Case {
  Material material;
  FilmDesign film;
};

DesignLayer layer(double thickness_nm, const OpticalIndex& index) { return {thickness_nm, index}; }
double uniform(Rng& rng, double low, double high) { return lerp(rng.uniform(), low, high); }

// Pairs of two media, up to twenty layers.
Case pairs(Rng& rng, const OpticalIndex& a, const OpticalIndex& b, double thickest_nm) {
  Case c;
  c.film.layers = {layer(uniform(rng, 20, thickest_nm), a), layer(uniform(rng, 20, thickest_nm), b)};
  c.film.periods = 1 + static_cast<int>(10 * rng.uniform());
  return c;
}

Case chitin_and_air(Rng& rng) {
  return pairs(rng, OpticalIndex::named("chitin"), OpticalIndex::constant(1), 150);
}
Case titania_and_silica(Rng& rng) {
  return pairs(rng, OpticalIndex::named("titania"), OpticalIndex::named("silica"), 120);
}
Case chitin_and_melanin(Rng& rng) {
  return pairs(rng, OpticalIndex::named("chitin"), OpticalIndex::named("melanin"), 150);
}
// Layers without order, clear or absorbing.
Case random_layers(Rng& rng) {
  Case c;
  const int count = 1 + static_cast<int>(20 * rng.uniform());
  for (int j = 0; j < count; ++j)
    c.film.layers.push_back(
        layer(uniform(rng, 0, 250),
              OpticalIndex::constant(uniform(rng, 1.3, 2.4), std::max(0.0, uniform(rng, -0.1, 0.1)))));
  return c;
}
Case oxide_on_metal(Rng& rng) {
  const char* metals[] = {"Ti", "Nb", "Fe", "Al", "Au"};
  Case c;
  c.film.layers = {layer(uniform(rng, 20, 500), OpticalIndex::constant(uniform(rng, 1.4, 2.6)))};
  c.film.base = OpticalIndex::named(metals[static_cast<int>(5 * rng.uniform())]);
  c.material.base_extinction = 3;
  return c;
}
Case plain_film(Rng& rng) {
  Case c;
  c.film.layers = {layer(uniform(rng, 20, 1500), OpticalIndex::constant(uniform(rng, 1.3, 1.8)))};
  return c;
}

Rgb folded(const Case& c, const Spectrum& spectrum, double cosine) {
  const Wavelengths w = spectrum.wavelengths(c.material);
  const StackSpectrum film = stack_spectrum(c.material, w);
  std::vector<double> above(film.lanes()), through(film.lanes()), below(film.lanes());
  film.powers(c.material.exterior_ior, cosine, above.data(), through.data(), below.data());
  return w.fold(above);
}

// At one wavelength every nm.
Rgb exact(const Case& c, double cosine) {
  const WavelengthQuadrature reference = brute_force(Illuminant::d65, kSpace);
  Wavelengths w;
  w.nm = reference.wavelength_nm;
  w.weight = reference.weight;
  c.film.fill(w);
  const StackSpectrum film = stack_spectrum(c.material, w);
  std::vector<double> above(film.lanes()), through(film.lanes()), below(film.lanes());
  film.powers(c.material.exterior_ior, cosine, above.data(), through.data(), below.data());
  return w.fold(above);
}

double quantile(std::vector<double> values, double q) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

struct Figures {
  std::vector<double> nodes, by_rule, errors;
  int refused = 0;
};

// Errors at angles and thicknesses other than those that chose the nodes.
void add_errors(Case c, const FilmNodes& nodes, double thickest_nm, Rng& rng, std::vector<double>& errors) {
  Spectrum spectrum(Illuminant::d65, kSpace, nodes.quadrature);
  spectrum.set_film(c.film, nodes.path_nm);
  for (int k = 0; k < 8; ++k) {
    c.material.film_thickness_nm = thickest_nm * rng.uniform();
    const double cosine = std::cos(0.5 * kPi * rng.uniform());
    const Rgb found = folded(c, spectrum, cosine), right = exact(c, cosine);
    for (int channel = 0; channel < 3; ++channel)
      errors.push_back(std::abs(found[channel] - right[channel]) / std::max(right[channel], 0.01));
  }
}

Figures measure(Case (*draw)(Rng&), double spread) {
  Figures figures;
  Rng rng(20, 7);
  for (int k = 0; k < kStacks; ++k) {
    Case c = draw(rng);
    c.material.thickness_spread = spread;
    const double thickest_nm = c.film.thickness_nm(), path = c.film.path_nm(c.material, thickest_nm);
    if (path > resolved_path_nm(kMostWavelengths)) continue;
    const FilmNodes nodes = nodes_for_film(c.material, c.film, Illuminant::d65, kSpace, thickest_nm);
    if (nodes.error > kMostFoldingError) {
      ++figures.refused;
      continue;
    }
    figures.nodes.push_back(static_cast<double>(nodes.quadrature.size()));
    figures.by_rule.push_back(nodes_for_path(path));
    add_errors(c, nodes, thickest_nm, rng, figures.errors);
  }
  return figures;
}

TEST(FilmNodeTables, OfRandomStacks) {
  const struct {
    const char* name;
    Case (*draw)(Rng&);
    double spread;
  } kinds[] = {{"one clear layer", plain_film, 0},
               {"chitin and air", chitin_and_air, 0},
               {"chitin and air, spread 0.1", chitin_and_air, 0.1},
               {"titania and silica", titania_and_silica, 0},
               {"chitin and melanin", chitin_and_melanin, 0},
               {"layers without order", random_layers, 0},
               {"oxide on metal", oxide_on_metal, 0},
               {"oxide on metal, spread 0.1", oxide_on_metal, 0.1}};
  std::printf(
      "nodes: median, largest; by rule: median, largest; refused; error in percent: median, p99, max\n");
  for (const auto& kind : kinds) {
    const Figures f = measure(kind.draw, kind.spread);
    std::printf("%-28s %g %g | %g %g | %d | %.4f %.3f %.2f\n", kind.name, quantile(f.nodes, 0.5),
                quantile(f.nodes, 1), quantile(f.by_rule, 0.5), quantile(f.by_rule, 1), f.refused,
                100 * quantile(f.errors, 0.5), 100 * quantile(f.errors, 0.99), 100 * quantile(f.errors, 1));
    EXPECT_LE(quantile(f.errors, 0.99), kMostFoldingError) << kind.name;
    EXPECT_LE(f.refused, kStacks / 4) << kind.name;
  }
}

}  // namespace
}  // namespace sunbeam
