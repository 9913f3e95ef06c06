// Scattering slabs of a whole grid against direct solutions of one film each, which share neither the nodes
// of the fringe order and the depth nor the modes left out.
#include "bake/live/adding_doubling/slab_films.h"

#include <gmock/gmock.h>

#include "bake/optics/spectrum.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/axis.h"
#include "sunbeam/detail/quadrature.h"
#include "tests/support/layered_films.h"

namespace sunbeam {
namespace {

constexpr double kThickest = 1500;
const GaussRule kRule = gauss_legendre(6);

Material slab(double base_ior, double roughness) {
  Material m;
  m.film_ior = 1.56;
  m.film_thickness_nm = kThickest;
  m.base_ior = base_ior;
  m.roughness = roughness;
  m.albedo = Rgb(0.3);
  m.pigment_thickness_nm = 1000;
  m.scattering_per_nm = 0.0015;
  m.anisotropy = 0.5;
  return m;
}

struct Case {
  Material material;
  AbsorptionShape absorption = AbsorptionShape::flat();

  Wavelengths wavelengths() const {
    return Spectrum(Illuminant::d65, ColorSpace::rec709, 2 * material.film_ior * kThickest, absorption)
        .wavelengths(material);
  }
};

// To 89.4 degrees.
SlabFilms::Grid grid(std::size_t thicknesses, std::size_t absorptions) {
  SlabFilms::Grid g{spaced_nodes(0, kThickest, thicknesses), spaced_nodes(0, 0.002, absorptions), {}, {}};
  for (const double x : kRule.node) g.cosine.push_back(0.01 + 0.99 * x * x);
  g.azimuth = spaced_nodes(0, kPi, 5);
  return g;
}

void one_by_one(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t k = 0; k < count; ++k) task(k);
}

// Int |difference| cos dwo / Int |rest| cos dwo, the largest of all wi.
double largest_error(const SlabFilms::Grid& grid, std::span<const Rgb> values,
                     const SlabSolver::Film::Modes& direct) {
  const std::size_t cosines = grid.cosine.size(), azimuths = grid.azimuth.size();
  double largest = 0;
  for (std::size_t i = 0; i < cosines; ++i) {
    double difference = 0, whole = 0;
    for (std::size_t o = 0; o < cosines; ++o)
      for (std::size_t k = 0; k < azimuths; ++k) {
        const double phi = grid.azimuth[k];
        const Rgb expected = (direct.at(o, i, phi) + direct.at(i, o, phi)) / 2;
        const double weight = kRule.weight[o] * kRule.node[o] * grid.cosine[o];
        for (int c = 0; c < 3; ++c) {
          difference += weight * std::abs(values[(i * cosines + o) * azimuths + k][c] - expected[c]);
          whole += weight * std::abs(expected[c]);
        }
      }
    largest = std::max(largest, difference / whole);
  }
  return largest;
}

TEST(SlabFilms, AgreeWithDirectSolutions) {
  Case coloured{slab(1.5, 0.05), AbsorptionShape::pigment("eumelanin")};
  coloured.material.albedo = {0.7, 0.4, 0.2};
  Case thin = coloured, back = coloured, wet{slab(1.5, 0.2)};
  thin.material.scattering_per_nm = 0.0001;
  back.material.anisotropy = -0.6;
  back.material.transmission = Transmission::straight;
  wet.material.exterior_ior = 1.33;
  const std::vector<Case> cases{
      {slab(2, 0)}, {slab(1.1, 0.05)}, {slab(1, 0.05)}, {slab(1, 0.2)}, coloured, thin, back, wet};

  for (const Case& c : cases) {
    const Wavelengths wavelengths = c.wavelengths();
    const SlabFilms::Grid nodes = grid(500, 30);
    SlabFilms films(c.material, wavelengths, nodes);
    EXPECT_LT(films.responses(), nodes.film_thickness_nm.size() * wavelengths.size() * 30 / 2);
    for (const auto& [thickness, absorption] : {std::pair{0, 29}, {7, 3}, {499, 11}}) {
      films.prepare(thickness, thickness + 1, one_by_one);
      std::vector<Rgb> values(films.cells());
      films.rest(thickness, absorption, values);

      SlabSolver solver(c.material, nodes.cosine);
      const double depth = nodes.absorption_per_nm[absorption] * c.material.pigment_thickness_nm;
      for (const double relative : wavelengths.absorption) solver.add_depth(depth * relative);
      const SlabSolver::Film film(solver, nodes.film_thickness_nm[thickness], wavelengths);
      EXPECT_LT(largest_error(nodes, values, film.rest(depth)), 1e-4)
          << "base IOR " << c.material.base_ior << ", roughness " << c.material.roughness.u << ", thickness "
          << nodes.film_thickness_nm[thickness] << ", absorption " << nodes.absorption_per_nm[absorption];
    }
  }
}

// At every thickness and wavelength for itself, whatever the layers do.
TEST(SlabFilms, OfLayersAgreeWithDirectSolutions) {
  Material material = slab(1.5, 0.1);
  material.albedo = {0.7, 0.4, 0.2};
  SlabFilms::Grid nodes = grid(3, 3);
  for (const test::LayeredFilm& film : test::layered_films(material)) {
    nodes.film_thickness_nm = {0.5 * film.material.film_thickness_nm, film.material.film_thickness_nm};
    SlabFilms films(film.material, film.wavelengths, nodes);
    EXPECT_EQ(films.responses(), 2 * 3 * 3);
    films.prepare(1, 2, one_by_one);
    for (const std::size_t absorption : {0, 2}) {
      std::vector<Rgb> values(films.cells());
      films.rest(1, absorption, values);
      SlabSolver solver(film.material, nodes.cosine);
      const double depth = nodes.absorption_per_nm[absorption] * material.pigment_thickness_nm;
      solver.add_depth(depth);
      const SlabSolver::Film direct(solver, nodes.film_thickness_nm[1], film.wavelengths);
      EXPECT_LT(largest_error(nodes, values, direct.rest(depth)), 1e-4)
          << film.name << ", absorption " << nodes.absorption_per_nm[absorption];
    }
  }
}

// A small grid has nothing to interpolate.
TEST(SlabFilms, SolveSmallGridsDirectly) {
  const Case c{slab(1.5, 0.2)};
  const Wavelengths wavelengths = c.wavelengths();
  SlabFilms films(c.material, wavelengths, grid(3, 2));
  EXPECT_EQ(films.responses(), (2 * wavelengths.size() + 1) * 2);  // no film: one order
}

TEST(SlabFilms, AreTheSameWhateverIsAskedFirst) {
  Case c{slab(1.5, 0.2), AbsorptionShape::pigment("eumelanin")};
  const SlabFilms::Grid nodes = grid(60, 4);
  SlabFilms all(c.material, c.wavelengths(), nodes), some(c.material, c.wavelengths(), nodes);
  all.prepare(0, 60, one_by_one);
  for (const std::size_t thickness : {40, 11, 12}) {
    some.prepare(thickness, thickness + 1, [](std::size_t count, const auto& task) {
      for (std::size_t k = count; k-- > 0;) task(k);
    });
    for (std::size_t absorption = 0; absorption < 4; ++absorption) {
      std::vector<Rgb> a(all.cells()), b(all.cells());
      all.rest(thickness, absorption, a);
      some.rest(thickness, absorption, b);
      EXPECT_EQ(a, b) << thickness << ' ' << absorption;
    }
  }
  std::vector<Rgb> values(some.cells());
  EXPECT_THAT([&] { some.rest(59, 0, values); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("59 that was not prepared")));
}

TEST(EvenSamples, ReproduceEvenPolynomials) {
  const auto f = [](double u) { return 1 - 3 * u * u + 0.5 * std::pow(u, 4) + 0.1 * std::pow(u, 6); };
  const EvenSamples even(0.25, 2), exact(std::vector{0.5, 1.5});
  for (const double u : {0.0, 0.1, 0.25, 0.9, 1.99, 2.0}) {
    const EvenSamples::Stencil at = even.at(u);
    double value = 0;
    for (int i = 0; i < at.count; ++i) value += at.weight[i] * f(even[at.node[i]]);
    EXPECT_NEAR(value, f(u), 1e-12) << u;
  }
  EXPECT_EQ(exact.at(1.5).count, 1);
  EXPECT_EQ(exact.at(1.5).node[0], 1u);
}

}  // namespace
}  // namespace sunbeam
