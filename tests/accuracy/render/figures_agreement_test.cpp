// The paper's Figs. 5 and 6 (c), (d): table and live renderings are statistically equal, by Z-tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "bake/jobs/bake.h"
#include "sunbeam/detail/text.h"
#include "tests/accuracy/render/support.h"

namespace sunbeam::test {
namespace {

const std::string kTables = SUNBEAM_SOURCE_DIR "/tables/";
constexpr int kWidth = 96, kHeight = 54;
constexpr int kBlockWidth = 16, kBlockHeight = 9;
constexpr int kSpp = 128;

struct Figure {
  std::string scene;
  double film_thickness_nm, base_ior, absorption_per_nm;
  std::string name() const {
    return scene + "_" + to_text(film_thickness_nm) + "_" + to_text(base_ior) + "_" +
           to_text(absorption_per_nm);
  }
};

std::vector<Figure> figures() {
  std::vector<Figure> result;
  for (const double base_ior : {1.0, 2.0})
    for (const double film_thickness_nm : {300.0, 600.0, 1200.0})
      result.push_back({"fig5", film_thickness_nm, base_ior, 0.7});
  for (const std::string shape : {"sphere", "torus", "snake"})
    for (const double absorption_per_nm : {0.0, 0.7})
      result.push_back({"fig6_" + shape, 900, 1, absorption_per_nm});
  return result;
}

// The default recipe at the figures' own parameters.
const Table& figures_table() {
  static const Table table =
      bake_table(load_recipe(kTables + "recipes/sunbeam.toml",
                             {"grid.film_thickness_nm={from = 300, to = 1200, count = 19}",
                              "grid.base_ior=[1.0, 2.0]", "grid.absorption_per_nm=[0.0, 0.7]"}),
                 Encoding::factored, {});
  return table;
}

Scene scene_of(const Figure& figure) {
  return load_scene(kTables + "scenes/" + figure.scene + ".toml",
                    {"material[0].film_thickness_nm=" + to_text(figure.film_thickness_nm),
                     "material[0].base_ior=" + to_text(figure.base_ior),
                     "material[0].absorption_per_nm=" + to_text(figure.absorption_per_nm)});
}

RenderResult render_figure(const Scene& scene, const Skins& skins, std::uint64_t seed) {
  return render_scene(scene, skins, {.width = kWidth, .height = kHeight, .spp = kSpp, .seed = seed});
}

// Sums of normal values over all figures, channel by channel, divided by the root of their number: normal
// too.
class Combined {
 public:
  void add(const std::array<double, 3>& z) {
    for (int channel = 0; channel < 3; ++channel) sum_[channel] += z[channel];
    ++count_;
  }
  double largest() const { return *std::max_element(sum_.begin(), sum_.end()) / std::sqrt(count_); }
  double smallest() const { return *std::min_element(sum_.begin(), sum_.end()) / std::sqrt(count_); }

 private:
  std::array<double, 3> sum_{};
  double count_ = 0;
};

double largest_magnitude(const std::array<double, 3>& z) {
  return std::max({std::abs(z[0]), std::abs(z[1]), std::abs(z[2])});
}

// Means: of every block and of every whole picture; and of all pictures together. Live walks are noisier than
// tables, so the variances are held from one side: a table must not be noisier than what it replaces.
//
// Values and chance of a false alarm: 12 figures x 3 channels x 36 blocks beyond 5, 0.07 %; 36 whole pictures
// beyond 4.5, 0.02 %; 3 of all together beyond 4.5, 0.002 %; variances likewise, from one side, below 0.02 %.
// The seeds are fixed.
TEST(FiguresAgreement, TableAndLiveAreStatisticallyEqual) {
  const Table& table = figures_table();
  Combined means, variances, brighter_means, noisier_variances;
  std::uint64_t seed = 0;  // of its own for every picture: the same one would repeat the noise of the ground
  for (const Figure& figure : figures()) {
    SCOPED_TRACE(figure.name());
    const Scene scene = scene_of(figure);
    const RenderResult from_table = render_figure(scene, {.table = table}, ++seed);
    const RenderResult live = render_figure(scene, {.table = table, .live = true}, ++seed);
    EXPECT_LT(largest_z(from_table, live, kBlockWidth, kBlockHeight), 5);
    EXPECT_LT(largest_magnitude(mean_z(from_table, live)), 4.5);
    const auto excess = excess_variance_z(from_table, live);
    EXPECT_LT(*std::max_element(excess.begin(), excess.end()), 4.5);
    means.add(mean_z(from_table, live));
    variances.add(excess);

    brighter_means.add(mean_z(render_figure(scene, {.table = table, .brightness = 1.02}, ++seed), live));
    RenderResult noisier = from_table;
    for (float& variance : noisier.variance.rgb) variance *= 1.5f;
    noisier_variances.add(excess_variance_z(noisier, live));
  }
  EXPECT_LT(means.largest(), 4.5);
  EXPECT_GT(means.smallest(), -4.5);
  EXPECT_LT(variances.largest(), 4.5);

  // The test has teeth: skins brighter by 2 % show in all channels, and so does half as much variance again.
  EXPECT_GT(brighter_means.smallest(), 4.5);
  EXPECT_GT(noisier_variances.smallest(), 4.5);

  RecordProperty("z_of_means", to_text({means.smallest(), means.largest()}));
  RecordProperty("z_of_2_percent", to_text(brighter_means.smallest()));
  RecordProperty("z_of_noise",
                 to_text({variances.smallest(), variances.largest(), noisier_variances.smallest()}));
}

}  // namespace
}  // namespace sunbeam::test
