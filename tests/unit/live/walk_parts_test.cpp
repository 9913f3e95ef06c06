// The parts of the walks: packets of lanes, the film in lanes, the guide of directions that leave the base.
#include <gtest/gtest.h>

#include <functional>

#include "bake/live/walks/film_events.h"
#include "tests/support/stats.h"

namespace sunbeam::walk {
namespace {

using Lanes = Packet<Baseline>;

template <class F>
Lanes lanes_of(F f) {
  return Lanes::generate([&](int lane) { return f(lane); });
}
std::array<double, kLanes> values_of(const Lanes& lanes) {
  std::array<double, kLanes> values;
  lanes.store(values.data());
  return values;
}

TEST(Packet, FunctionsAgreeWithTheStandardLibrary) {
  Rng rng(1, 0);
  for (int k = 0; k < 2000; ++k) {
    const Lanes u = lanes_of([&](int) { return rng.uniform(); });
    const auto uniform = values_of(u);
    const auto exponentials = values_of(exp_negative(Lanes(-40) * u));
    const auto cosines = values_of(cos_half_turn(u)), phases = values_of(cos_of_phase(Lanes(3000) * u));
    for (int lane = 0; lane < kLanes; ++lane) {
      const double x = uniform[lane];
      EXPECT_NEAR(exponentials[lane] / std::exp(-40 * x), 1, 1e-13);
      EXPECT_NEAR(cosines[lane], std::cos(kPi * x), 1e-13);
      EXPECT_NEAR(phases[lane], std::cos(3000 * x), 1e-12);
    }
  }
}

TEST(Packet, LogarithmAgreesWithTheStandardLibrary) {
  Rng rng(4, 0);
  for (int k = 0; k < 2000; ++k) {
    const double scale = std::pow(0.5, k % 60);
    const auto x = values_of(lanes_of([&](int) { return scale * (1 - rng.uniform()); }));
    const auto logarithms = values_of(log_of_share(Lanes::load(x.data())));
    for (int lane = 0; lane < kLanes; ++lane)
      EXPECT_NEAR(logarithms[lane], std::log(x[lane]), 1e-15 + 2e-15 * std::abs(std::log(x[lane])));
  }
  EXPECT_EQ(values_of(log_of_share(Lanes(1)))[0], 0);
  EXPECT_LT(values_of(log_of_share(Lanes(0)))[0], -700);
}

TEST(Packet, ExponentialAtItsEnds) {
  const auto values = values_of(exp_negative(lanes_of([](int lane) { return lane == 0 ? 0 : -1e9 * lane; })));
  EXPECT_EQ(values[0], 1);
  for (int lane = 1; lane < kLanes; ++lane) EXPECT_LT(values[lane], 1e-303);
}

// Every lane is uniform by itself (32 chi-square tests in all, false alarm 1e-6), and the lanes are spread:
// one in each stratum up to the random shift.
TEST(Uniform, LanesAreUniformAndStratified) {
  constexpr int kCells = 40, kDraws = 40000;
  std::array<std::vector<test::Cell>, kLanes> cells;
  for (auto& lane : cells) lane.assign(kCells, {0, kDraws / static_cast<double>(kCells), 0});
  Rng rng(2, 0);
  for (int k = 0; k < kDraws; ++k) {
    auto u = values_of(Uniform<Lanes>::draw(rng));
    for (int lane = 0; lane < kLanes; ++lane) {
      ASSERT_GE(u[lane], 0);
      ASSERT_LT(u[lane], 1);
      ++cells[lane][static_cast<int>(u[lane] * kCells)].observed;
    }
    std::sort(u.begin(), u.end());
    for (int lane = 1; lane < kLanes; ++lane) ASSERT_LT(u[lane] - u[lane - 1], 2.0 / kLanes + 1e-9);
  }
  for (const auto& lane : cells) EXPECT_GT(test::chi_square(lane).p_value, test::sidak(1e-6, kLanes));
}

struct Film {
  const char* name;
  ThinFilm film;
};
const Film kFilms[] = {
    {"keratin", {1, 1.56, 1.4, 480}},         {"thick", {1, 1.56, 1.4, 9000}},
    {"from below", {1.5, 1.56, 1, 300}},      {"bare", {1, 1.5, 1.5, 0}},
    {"bare from below", {1.5, 1.5, 1, 0}},    {"frustrated total reflection", {1.5, 1.1, 1.4, 200}},
    {"index-matched sides", {1, 1.3, 1, 250}}};

template <class V>
void expect_film(const Film& f, const std::vector<double>& nm, double cosine, double tolerance) {
  FilmPhases phases;
  for (const double wavelength : nm)
    phases.k[phases.count++] = 2 * kPi * f.film.film_ior * f.film.thickness_nm / wavelength;
  phases.is_bare = f.film.thickness_nm == 0;
  phases.is_even = nm.size() > 3;
  const FilmSide side(f.film);
  const FilmPackets<V> lanes(side, phases, V(cosine));
  int visited = 0;
  lanes.reflectances([&](int j, const V& r) {
    EXPECT_NEAR(mean_of_lanes(r), airy(f.film, cosine, Rgb(nm[j])).reflectance.g, tolerance)
        << f.name << " R at " << cosine << ", " << nm[j] << " nm";
    ++visited;
  });
  lanes.transmittances([&](int j, const V& t) {
    EXPECT_NEAR(mean_of_lanes(t), airy(f.film, cosine, Rgb(nm[j])).transmittance.g, tolerance)
        << f.name << " T at " << cosine << ", " << nm[j] << " nm";
  });
  EXPECT_EQ(visited, static_cast<int>(nm.size()));
}

std::vector<double> evenly_spaced_in_frequency(int count) {
  std::vector<double> nm;
  for (int j = 0; j < count; ++j) nm.push_back(1 / lerp(j / (count - 1.0), 1.0 / 395, 1.0 / 720));
  return nm;
}

TEST(FilmPackets, AgreeWithAiry) {
  for (const Film& f : kFilms)
    for (const double cosine : {0.0, 1e-6, 0.05, 0.3, 0.62, 0.7453, 0.7454, 0.746, 0.9, 1.0}) {
      expect_film<Lanes>(f, {650, 510, 475}, cosine, 1e-11);
      expect_film<double>(f, {650, 510, 475}, cosine, 1e-11);
      expect_film<Lanes>(f, evenly_spaced_in_frequency(20), cosine, 1e-10);
    }
}

// n0 sin = n1 and about it, where the film's own cosine is 0 and sin^2 / c1^2 is 0 / 0: R keeps its digits
// although it is small, on the side of waves and on the evanescent one.
template <class V>
void expect_digits(const ThinFilm& film, double cosine, double nm) {
  FilmPhases phases;
  phases.count = 1;
  phases.k[0] = 2 * kPi * film.film_ior * film.thickness_nm / nm;
  const FilmSide side(film);
  const FilmPackets<V> lanes(side, phases, V(cosine));
  const FilmPower expected = airy(film, cosine, Rgb(nm));
  const auto expect = [&](const char* what, double found, double right) {
    EXPECT_NEAR(found / right, 1, 1e-13) << what << ' ' << film.thickness_nm << " nm at " << cosine;
  };
  lanes.reflectances([&](int, const V& r) { expect("R", mean_of_lanes(r), expected.reflectance.r); });
  lanes.transmittances([&](int, const V& t) { expect("T", mean_of_lanes(t), expected.transmittance.r); });
  expect("R at k", mean_of_lanes(lanes.reflectance_at(V(phases.k[0]))), expected.reflectance.r);
}

TEST(FilmPackets, KeepDigitsAboutTheFilmsCriticalAngle) {
  for (const double thickness : {1.0, 30.0, 300.0, 1500.0})
    for (const double step : {0.0, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2})
      for (const double cosine : {0.6 - step, 0.6 + step}) {  // 1.25 * 0.8 = 1
        expect_digits<double>({1.25, 1, 1.3, thickness}, cosine, 510);
        expect_digits<Lanes>({1.25, 1, 1.3, thickness}, cosine, 510);
      }
}

std::array<double, BaseGuide::kBins> importance_of(const std::function<double(double)>& f) {
  std::array<double, BaseGuide::kBins> importance;
  for (int bin = 0; bin < BaseGuide::kBins; ++bin) importance[bin] = f((bin + 0.5) / BaseGuide::kBins);
  return importance;
}

TEST(BaseGuide, NothingImportantIsCosineWeighted) {
  const BaseGuide guide(importance_of([](double) { return 0.0; }));
  for (const double u : {0.0, 0.2, 0.77, 0.999999}) {
    EXPECT_NEAR(guide.sample(u).square, u, 1e-14);
    EXPECT_NEAR(guide.sample(u).per_density, 1, 1e-13);
  }
}

// The inverse of the cumulative distribution: E[1 / density over samples] = 1 on every interval, and
// density() is what sample() says; bounded by the cosine-weighted share.
TEST(BaseGuide, SamplesFollowTheDensity) {
  const BaseGuide guide(importance_of([](double t) { return t < 0.55 ? 1.0 : 0.05; }));
  double covered = 0;
  constexpr int kSteps = 64000;
  for (int i = 0; i < kSteps; ++i) {
    const auto at = guide.sample((i + 0.5) / kSteps);
    covered += at.per_density / kSteps;
    EXPECT_LE(at.per_density, 1 / BaseGuide::kCosineShare + 1e-9);
    EXPECT_NEAR(guide.density(at.square) * at.per_density, 1, 1e-9);
    EXPECT_NEAR(at.square, covered, 2e-3);
  }
  EXPECT_NEAR(covered, 1, 1e-9);
}

TEST(BaseGuide, PacketsSampleAsOneLaneDoes) {
  const BaseGuide guide(importance_of([](double t) { return t * t; }));
  Rng rng(3, 0);
  const Lanes u = Uniform<Lanes>::draw(rng);
  const auto at = guide.sample(u);
  const auto uniform = values_of(u), square = values_of(at.square), per_density = values_of(at.per_density);
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_NEAR(square[lane], guide.sample(uniform[lane]).square, 1e-13);
    EXPECT_NEAR(per_density[lane], guide.sample(uniform[lane]).per_density, 1e-12);
  }
}

}  // namespace
}  // namespace sunbeam::walk
