// No interpolated material returns more light than it receives: white base, absorption from 0, every
// thickness and base IOR between the nodes.
//
// The arrays hold no colours, so a wavelength is enough: with its spectral lists replaced by one wavelength
// anywhere in the table's range, the table is that of a monochromatic material, and
//     albedo(w) = first(w) + 2 pi Int rest(w, c) c dc.
// A folded albedo is sum_k weight_k albedo_k. The weights' means over channels are not negative and add up to
// 1 (asserted), so that no mean over channels exceeds the largest albedo of a wavelength; and the channels of
// rgb3 are wavelengths. BoundWaves at one wavelength takes microseconds where a table takes milliseconds to
// bind: it stands for the many, and some tables are bound whole.

#include "bake/base/parallel_tasks.h"
#include "bake/optics/thin_film.h"
#include "runtime/src/fit/bound_waves.h"
#include "sunbeam/detail/ggx.h"
#include "tests/accuracy/factored/support.h"
#include "tests/support/quadrature.h"

namespace sunbeam {
namespace {

constexpr double kMostAlbedo = 1 + 1e-3;
constexpr double kLeastCosine = 0.0175;  // 89 degrees, as far as sunbeam verify goes
constexpr int kPanels = 3;               // of eight points: two fringes over all cosines

// Twice the recipe's noise takes a quarter of its walks, and makes the bound no easier to meet.
const std::vector<std::string> kBright = {"material.albedo=1", "accuracy.noise=0.0006"};

std::vector<test::FilmRow> bright_rows() {
  return {{"0", "refract", "sum"},
          {"0", "refract", "product"},
          {"0", "straight", "product"},
          {"0.1", "refract", "sum"},
          {"0.1", "refract", "product"}};
}

// A quarter of all points is clear; the others follow the nodes, dense where little is absorbed.
Parameters draw(const Table& table, Rng& rng) {
  const auto at = [&](std::size_t k, double u) {
    const Axis& axis = table.parameter_axis(k);
    return axis.origin +
           std::pow(lerp(u, axis.coordinate(axis.low()), axis.coordinate(axis.high())), axis.power);
  };
  const double thickness = at(0, rng.uniform()), ior = at(1, rng.uniform());
  return {thickness, ior, rng.uniform() < 0.25 ? 0 : at(2, rng.uniform())};
}

// Share that the first surface sends back, by midpoints over visible normals.
double first_albedo(const Material& material, const Vec3& w, double nm) {
  const auto reflectance = [&](double c) { return airy(ThinFilm::of(material), c, Rgb(nm)).reflectance.r; };
  if (material.is_smooth()) return reflectance(w.z);
  constexpr int kNormals = 12;
  const Ggx ggx(material.roughness);
  double sum = 0;
  for (int i = 0; i < kNormals; ++i)
    for (int j = 0; j < kNormals; ++j) {
      const Vec3 h = ggx.sample_visible(w, {(i + 0.5) / kNormals, (j + 0.5) / kNormals});
      const Vec3 wi = reflect(w, h);
      if (wi.z > 0) sum += reflectance(std::min(dot(w, h), 1.0)) * ggx.g2_over_g1(w, wi);
    }
  return sum / (kNormals * kNormals);
}

// The table's arrays at one wavelength.
class Monochromatic {
 public:
  explicit Monochromatic(const Table& table) : table_(table) {
    const auto [shortest, longest] = std::minmax_element(wavelengths().nm.begin(), wavelengths().nm.end());
    shortest_ = *shortest, longest_ = *longest;
  }

  double albedo(Rng& rng) {
    const Parameters parameters = draw(table_, rng);
    const double nm = lerp(rng.uniform(), shortest_, longest_);
    table_.factors.wavelengths = {{nm}, {1}, {1}, {Rgb(1)}};
    const Material material = parameters.applied_to(table_.material);
    const BoundWaves rest(table_, material, film_kernels(Arithmetic::fastest),
                          rgb_to_rgb(ColorSpace::rec709, ColorSpace::rec709));
    const double cosine = lerp(rng.uniform(), kLeastCosine, 1);
    const auto row = rest.row(rest.direction(cosine, 0));
    const double returned = test::integrate(
        0, 1, kPanels, [&](double c) { return 2 * kPi * c * rest.rest(row, rest.direction(c, 0)).r; });
    return first_albedo(material, direction_from_cosine(cosine, 0), nm) + returned;
  }

 private:
  const Wavelengths& wavelengths() const { return table_.factors.wavelengths; }

  Table table_;
  double shortest_, longest_;
};

// Largest of what `measure(task, rng)` finds in `tasks` tasks with a random stream each.
template <class Measure>
double largest(std::size_t tasks, Measure measure) {
  std::vector<double> found(tasks);
  run_parallel_tasks(tasks, 0, {}, [&](std::size_t task) {
    Rng rng(11, task);
    found[task] = measure(rng);
  });
  return *std::max_element(found.begin(), found.end());
}

// Rows whose tables are bright, one a test.
class FactoredEnergy : public ::testing::TestWithParam<test::FilmRow> {
 protected:
  static const Table& table() { return test::factored(GetParam(), "full", kBright); }
};

// 20000 materials, each in a direction. Deterministic: no false alarm.
TEST_P(FactoredEnergy, OfEachWavelength) {
  constexpr int kTasks = 100, kMaterials = 200;
  const Table& table = this->table();
  const double found = largest(kTasks, [&](Rng& rng) {
    Monochromatic material(table);
    double most = 0;
    for (int k = 0; k < kMaterials; ++k) most = std::max(most, material.albedo(rng));
    return most;
  });
  EXPECT_LE(found, kMostAlbedo);
  EXPECT_GT(found, 0.9);  // it is bright
}

TEST_P(FactoredEnergy, MeansOverChannelsAreMeansOverWavelengths) {
  double sum = 0;
  for (const Rgb& weight : table().factors.wavelengths.weight) {
    EXPECT_GE(mean(weight), 0);
    sum += mean(weight);
  }
  EXPECT_NEAR(sum, 1, 1e-6);
}

// Largest albedo, as `measure` takes it, of 120 tables bound whole, in 3 directions each.
template <class Measure>
double largest_of_bound(const Table& table, Measure measure) {
  return largest(120, [&](Rng& rng) {
    const TableBsdf bsdf(table, draw(table, rng));
    double most = 0;
    for (int k = 0; k < 3; ++k)
      most = std::max(most,
                      measure(bsdf.albedo(direction_from_cosine(lerp(rng.uniform(), kLeastCosine, 1), 0))));
    return most;
  });
}

// The mean of ACEScg's channels.
TEST_P(FactoredEnergy, OfBoundTables) {
  EXPECT_LE(largest_of_bound(table(), [](const Rgb& albedo) { return mean(albedo); }), kMostAlbedo);
}

INSTANTIATE_TEST_SUITE_P(Each, FactoredEnergy, ::testing::ValuesIn(bright_rows()), test::name_of_row);

class FactoredEnergyOfChannels : public ::testing::TestWithParam<test::FilmRow> {};

// Each channel of rgb3 is a wavelength.
TEST_P(FactoredEnergyOfChannels, OfBoundTables) {
  const Table& table = test::factored(GetParam(), "rgb3", kBright);
  EXPECT_LE(largest_of_bound(table, [](const Rgb& albedo) { return max_component(albedo); }), kMostAlbedo);
}

INSTANTIATE_TEST_SUITE_P(Each, FactoredEnergyOfChannels,
                         ::testing::Values(bright_rows()[0], bright_rows()[1], bright_rows()[3]),
                         test::name_of_row);

}  // namespace
}  // namespace sunbeam
