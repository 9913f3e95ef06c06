#include "bake/factored/arrival.h"

#include "bake/base/error_floor.h"
#include "bake/blocks/block_bytes.h"
#include "bake/factored/legs.h"
#include "bake/live/exact/dense.h"

namespace sunbeam {
namespace {

constexpr Strata kFacetStrata{16, 256};  // each way
constexpr double kLeastArrival = 1e-15;  // where it is divided by

// A at (depth, order), row-major, of one replicate.
std::vector<double> arrivals(const SharedInputs& bake, const FilmLegs& legs, FringePowers& powers,
                             std::size_t ior, std::size_t direction, std::size_t strata,
                             std::size_t replicate, std::uint64_t& count) {
  const Axis& depths = bake.shapes.arrival.axes()[1];
  const std::size_t orders = powers.transmittance.size();
  std::vector<double> sums(depths.size() * orders);
  legs.visit_arrivals(bake.directions[ior][direction], strata, bake.rng_of_arrivals(direction, replicate),
                      [&](const Leg& leg) {
                        powers.at(leg.facet_cosine);
                        for (std::size_t t = 0; t < depths.size(); ++t)
                          add_scaled(leg.weight * std::exp(-depths.nodes[t] / leg.to),
                                     powers.transmittance.data(), static_cast<int>(orders),
                                     sums.data() + t * orders);
                        ++count;
                      });
  return sums;
}

// Of a product of two, relative to it or to what verify counts as dark.
double worst_error(const Replicates& a) {
  const double darkest = std::sqrt(kDarkestAlbedo);
  double worst = 0;
  for (std::size_t k = 0; k < a.mean().size(); ++k)
    worst = std::max(worst, std::sqrt(2 * a.variance(k)) / std::max(a.mean()[k], darkest));
  return worst;
}

// A with as many strata as its noise asks for.
Replicates known_arrivals(const SharedInputs& bake, std::size_t ior, std::size_t direction,
                          BlockSummary& summary) {
  const ArrayShape& array = bake.shapes.arrival;
  const Material material = bake.material_at(ior);
  const FilmLegs legs(material);
  FringePowers powers(ThinFilm::of(material), array.axes()[2],
                      fringe_order(material, bake.directions[ior][direction].z));
  for (std::size_t strata = kFacetStrata.least;; strata *= 2) {
    Replicates a(array.axes()[1].size() * array.axes()[2].size());
    for (std::size_t r = 0; r < kReplicates; ++r)
      a.add(arrivals(bake, legs, powers, ior, direction, strata, r, summary.walks));
    summary.worst_error = worst_error(a);
    if (summary.worst_error <= bake.recipe.accuracy.noise || strata == kFacetStrata.most) return a;
  }
}

}  // namespace

Block walk_arrival(const SharedInputs& bake, std::size_t ior, std::size_t direction) {
  const std::vector<Axis>& axes = bake.shapes.arrival.axes();
  Block block;
  const Replicates a = known_arrivals(bake, ior, direction, block.summary);
  const FactorFrame frame = bake.frame_at(ior);
  const double m = frame.pigment_cosine(bake.directions[ior][direction].z);
  const double least = std::max(frame.floor(), kLeastArrival);
  std::vector<double> values{0};
  for (std::size_t k = 0; k < a.mean().size(); ++k) {
    const double path = axes[1].nodes[k / axes[2].size()] / m;
    values.push_back(frame.arrival(a.mean()[k], path));
    values[0] +=
        a.variance(k) / std::max(square(a.mean()[k]), square(least)) / static_cast<double>(a.mean().size());
  }
  append(block.values, std::span<const double>(values));
  return block;
}

double add_arrival(std::size_t ior, std::size_t direction, const std::string& bytes, NdArray& array) {
  const auto values = unpacked<double>(bytes, 1 + array.axes()[1].size() * array.axes()[2].size());
  for (std::size_t k = 0; k + 1 < values.size(); ++k)
    array.set(ior * array.stride(0) + k * array.stride(2) + direction, Rgb(values[1 + k]));
  return values[0];
}

}  // namespace sunbeam
