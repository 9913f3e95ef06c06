// Look-ups of factored tables whose arrays are constants, against the equations of sunbeam/detail/factors.h.
#include "sunbeam/table_bsdf.h"
#include "sunbeam/textured_table.h"
#include "tests/support/bsdf_checks.h"
#include "tests/support/quadrature.h"
#include "tests/table/factored_tables.h"

namespace sunbeam {
namespace {

constexpr double kArriving = 0.5;  // A without the pigment
constexpr double kReturned = 0.4, kExchange = 0.2;
constexpr std::array kAlbedos{0.8, 0.4, 0.1}, kAbsorption{0.5, 1.0, 2.0};
const Parameters kNode{300, 1.5, 0.1};  // a node of each axis
constexpr double kExterior = 1.33;

void fill(NdArray& array, double value) {
  for (std::size_t cell = 0; cell < array.cells(); ++cell) array.set(cell, Rgb(value));
}

// In water, over a coloured base; a wavelength a channel.
Table constant_table(Transmission transmission, AbsorptionPath path, const Roughness& roughness) {
  Table table = test::small_factored_table(roughness, path, Precision::single_float);
  table.material.transmission = transmission;
  table.material.exterior_ior = kExterior;
  table.material.film_thickness_nm = kNode.film_thickness_nm;
  table.material.base_ior = kNode.base_ior;
  table.material.absorption_per_nm = kNode.absorption_per_nm;
  table.factors.wavelengths = {{650, 510, 475},
                               {kAlbedos.begin(), kAlbedos.end()},
                               {kAbsorption.begin(), kAbsorption.end()},
                               {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  fill(table.factors.arrival, std::log(kArriving));
  fill(path == AbsorptionPath::sum ? table.factors.returned : table.factors.exchange,
       path == AbsorptionPath::sum ? kReturned : kExchange);
  return table;
}

double below(const Material& m, double cosine) {
  if (m.transmission == Transmission::straight) return cosine;
  return std::sqrt(1 - square(kExterior / kNode.base_ior) * (1 - square(cosine)));
}

double arriving(const Material& m, double depth, double cosine) {
  const double blur =
      m.transmission == Transmission::straight ? 0 : 0.3 * 0.3;  // the larger roughness is 0.3
  return kArriving * std::exp(-depth / std::hypot(below(m, cosine), blur));
}

double expected_rest(const Material& m, std::size_t channel, double cos_o, double cos_i) {
  const double depth = kNode.absorption_per_nm * m.pigment_thickness_nm * kAbsorption[channel];
  const double scale =
      m.transmission == Transmission::straight ? 1 : square(kExterior) / square(kNode.base_ior);
  const double once =
      scale * kAlbedos[channel] * kInvPi * arriving(m, depth, cos_o) * arriving(m, depth, cos_i);
  if (m.absorption_path == AbsorptionPath::sum) return once / (1 - kAlbedos[channel] * kReturned);
  const double per_o = 1 / below(m, cos_o), per_i = 1 / below(m, cos_i);
  return once * (std::exp(depth * (per_o + per_i - per_o * per_i)) + kExchange);
}

std::vector<Table> constant_tables() {
  std::vector<Table> tables;
  for (const Transmission transmission : {Transmission::straight, Transmission::refract})
    for (const AbsorptionPath path : {AbsorptionPath::sum, AbsorptionPath::product})
      for (const Roughness& roughness : {Roughness(0.3), Roughness(0.3, 0.1)})
        tables.push_back(constant_table(transmission, path, roughness));
  return tables;
}

std::string name_of(const Table& table) {
  const Material& m = table.material;
  return std::string(to_string(m.transmission)) + ' ' + std::string(to_string(m.absorption_path)) + ' ' +
         to_string(m.roughness);
}

// Cosines at nodes of every grid that a look-up fits.
constexpr double kCosines[] = {0.25, 0.5625, 1};

TEST(FactoredMeaning, OfBoundTables) {
  for (const Table& table : constant_tables()) {
    const TableBsdf bsdf(table, kNode);
    for (const double o : kCosines)
      for (const double i : kCosines) {
        const Rgb found = bsdf.rest(direction_from_cosine(o, 0), direction_from_cosine(i, 0));
        for (int c = 0; c < 3; ++c) {
          const double expected = expected_rest(table.material, static_cast<std::size_t>(c), o, i);
          EXPECT_NEAR(found[c], expected, 1e-5 * expected)
              << name_of(table) << ' ' << o << ' ' << i << ' ' << c;
        }
      }
  }
}

TEST(FactoredMeaning, OfTexturedTables) {
  for (const Table& table : constant_tables()) {
    const TexturedTable textured(table);
    const TexturedTable::At bsdf = textured.at(kNode);
    const TableBsdf bound(table, kNode);
    Rng rng(1, 0);
    for (const double o : kCosines)
      for (const double i : kCosines) {
        const Vec3 wo = direction_from_cosine(o, 0), wi = direction_from_cosine(i, 0);
        const Rgb found = bsdf.eval(wo, wi, rng) - bound.first(wo, wi);
        for (int c = 0; c < 3; ++c) {
          const double expected = expected_rest(table.material, static_cast<std::size_t>(c), o, i);
          EXPECT_NEAR(found[c], expected, 1e-4 * expected)
              << name_of(table) << ' ' << o << ' ' << i << ' ' << c;
        }
      }
  }
}

}  // namespace
}  // namespace sunbeam
