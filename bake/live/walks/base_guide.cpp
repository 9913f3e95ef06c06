#include "bake/live/walks/base_guide.h"

#include "bake/live/walks/film_events.h"

namespace sunbeam::walk {
namespace {

std::array<std::array<double, kLanes>, kStrata> make_strata() {
  std::array<std::array<double, kLanes>, kStrata> rows{};
  Rng rng(0x5eed, 0);
  for (auto& row : rows) {
    for (int lane = 0; lane < kLanes; ++lane) row[lane] = (lane + rng.uniform()) / kLanes;
    for (int lane = kLanes - 1; lane > 0; --lane)
      std::swap(row[lane], row[static_cast<int>(rng.uniform() * (lane + 1))]);
  }
  return rows;
}

double cosine_of_bin(int bin) { return std::sqrt((bin + 0.5) / BaseGuide::kBins); }

// What directions below the film are worth, per bin of the guides. Importance only: noise here is harmless.
class BelowFilm {
 public:
  explicit BelowFilm(const Layers& layers) : layers_(layers) {
    if (layers.is_layered())
      meet_film<true>();
    else
      meet_film<false>();
  }

  // To walks that go on: what comes back down, through the pigment both times.
  BaseGuide going_on() const {
    return guide([&](int bin, int j) { return reflected_[bin][j] * square(attenuation(bin, j)); });
  }

  // To walks that may leave: what gets out, now or after later visits of the base.
  BaseGuide leaving() const {
    std::array<double, kMostWavelengths> later;
    for (int j = 0; j < layers_.count; ++j) later[j] = leaves_later(j);
    return guide([&](int bin, int j) {
      const double reflected = reflected_[bin][j], attenuated = attenuation(bin, j);
      return attenuated * (1 - reflected - absorbed_[bin][j] + reflected * attenuated * later[j]);
    });
  }

  // Of light that enters steeply, mean over wavelengths.
  double worth() const {
    double sum = 0;
    for (int j = 0; j < layers_.count; ++j) sum += std::exp(-layers_.tau[j]) * leaves_later(j);
    return sum / layers_.count;
  }

 private:
  using Lanes = Packet<Baseline>;
  static constexpr int kDraws = 4;  // packets

  double attenuation(int bin, int j) const { return std::exp(-layers_.tau[j] / cosine_of_bin(bin)); }

  // kd times the share of what the base sends up that gets out at last: v = out + back kd v.
  double leaves_later(int j) const {
    double out = 0, back = 0;
    for (int bin = 0; bin < BaseGuide::kBins; ++bin) {
      out += attenuation(bin, j) * (1 - reflected_[bin][j] - absorbed_[bin][j]) / BaseGuide::kBins;
      back += square(attenuation(bin, j)) * reflected_[bin][j] / BaseGuide::kBins;
    }
    return layers_.albedo[j] * out / std::max(1 - layers_.albedo[j] * back, 1e-3);
  }

  template <class Importance>
  BaseGuide guide(Importance importance) const {
    std::array<double, BaseGuide::kBins> sums{};
    for (int bin = 0; bin < BaseGuide::kBins; ++bin)
      for (int j = 0; j < layers_.count; ++j) sums[bin] += importance(bin, j);
    return BaseGuide(sums);
  }

  template <bool kLayered>
  void meet_film() {
    const Events<Lanes, kLayered> events(layers_);
    const int draws = layers_.is_smooth() ? 1 : kDraws;
    Rng rng(1, 0);
    for (int bin = 0; bin < BaseGuide::kBins; ++bin) {
      reflected_[bin].fill(0);
      for (int draw = 0; draw < draws; ++draw) {
        const auto down = events.reflect_below(Lanes(cosine_of_bin(bin)), rng);
        events.reflectances_below(down.film, [&](int j, const Lanes& r) {
          reflected_[bin][j] += mean_of_lanes(r * down.weight) / draws;
        });
        if constexpr (kLayered) add_absorbed(down.film, draws, absorbed_[bin]);
      }
    }
  }

  void add_absorbed(const Lanes& cosine, int draws, std::array<double, kMostWavelengths>& sums) const {
    Spectrum<Lanes> r, t;
    look_up_film(layers_.phases, Lanes(1), cosine, r, t);
    for (int j = 0; j < layers_.count; ++j) sums[j] += mean_of_lanes(Lanes(1) - r[j] - t[j]) / draws;
  }

  const Layers& layers_;
  std::array<std::array<double, kMostWavelengths>, BaseGuide::kBins> reflected_, absorbed_{};
};

}  // namespace

const std::array<std::array<double, kLanes>, kStrata> kStratum = make_strata();

BaseGuide::BaseGuide(const std::array<double, kBins>& importance) {
  double sum = 0;
  for (const double value : importance) sum += value;
  const auto probability = [&](int bin) {
    return kCosineShare / kBins + (1 - kCosineShare) * (sum > 0 ? importance[bin] / sum : 1.0 / kBins);
  };
  // Inverts the cumulative distribution, linear inside a bin of t, at equal steps.
  edge_.front() = 0;
  int bin = 0;
  double below = 0;
  for (int k = 1; k < kBins; ++k) {
    const double wanted = static_cast<double>(k) / kBins;
    while (below + probability(bin) < wanted) below += probability(bin++);
    edge_[k] = (bin + (wanted - below) / probability(bin)) / kBins;
  }
  edge_.back() = 1;
}

double BaseGuide::density(double square) const {
  const auto above = std::upper_bound(edge_.begin() + 1, edge_.end() - 1, square);
  return 1 / (kBins * (*above - *(above - 1)));
}

BaseForecast forecast_base(const Layers& layers) {
  const BelowFilm below(layers);
  return {below.going_on(), below.leaving(), below.worth()};
}

}  // namespace sunbeam::walk
