#include "bake/factored/exchange.h"

#include "bake/blocks/block_bytes.h"
#include "bake/factored/returned.h"

namespace sunbeam {
namespace {

constexpr std::size_t kOrdersPerPart = 32, kOrdersPerLayeredPart = 128;
constexpr std::size_t kWavelengthAxis = 3;  // of a layered film
constexpr std::size_t kArrivalStrata = 64;  // each way
constexpr std::size_t kNodes = ExchangeSolver::kNodes;

bool passes_straight_on(const Material& m) { return m.is_smooth() || bending_index_ratio(m) == 1; }

// Between the two nodes about a leg's cosine, one value an order: row a of `sums` += share * powers.
void collect(const Bracket& at, double share, const std::vector<double>& powers, double* sums) {
  const int count = static_cast<int>(powers.size());
  add_scaled(share * (1 - at.upper_weight), powers.data(), count, sums + at.lower * powers.size());
  add_scaled(share * at.upper_weight, powers.data(), count, sums + at.upper * powers.size());
}

// Of one order out of rows over all of them.
Vector at_order(const std::vector<double>& rows, std::size_t order, std::size_t orders) {
  Vector result(rows.size() / orders);
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = rows[k * orders + order];
  return result;
}

}  // namespace

ExchangeWalks::ExchangeWalks(const SharedInputs& bake) : bake_(bake) {
  for (const double depth : axes()[1].nodes) solvers_.emplace_back(depth);
}

// A part of a layered film is dear to begin: its powers are tabulated, and the strata chosen.
std::size_t ExchangeWalks::orders_per_part() const {
  return is_layered(bake_.recipe) ? kOrdersPerLayeredPart : kOrdersPerPart;
}

std::size_t ExchangeWalks::parts_of_orders() const {
  return (orders().size() + orders_per_part() - 1) / orders_per_part();
}

std::size_t ExchangeWalks::parts() const {
  const std::size_t wavelengths = is_layered(bake_.recipe) ? axes()[kWavelengthAxis].size() : 1;
  return wavelengths * parts_of_orders();
}

ExchangeWalks::Orders ExchangeWalks::orders_of(std::size_t part) const {
  const std::size_t first = part % parts_of_orders() * orders_per_part();
  return {first, std::min(first + orders_per_part(), orders().size())};
}

LegFilm ExchangeWalks::film_at(std::size_t ior, std::size_t part) const {
  const Material material = bake_.material_at(ior);
  if (!is_layered(bake_.recipe)) return {material};
  const double nm = axes()[kWavelengthAxis].nodes[wavelength_of(part)];
  return {material, bake_.recipe.spectrum.monochromatic(bake_.recipe.material, nm)};
}

// B at (a, b, order).
std::vector<double> ExchangeWalks::collected_returns(const LegFilm& film, const Axis& orders,
                                                     BlockSummary& summary) const {
  const Axis& cosines = ExchangeSolver::cosines();
  const std::size_t row = kNodes * orders.size();
  std::vector<double> sums(kNodes * row);
  visit_returns(bake_, film, orders, summary, [&](const Leg& leg, const std::vector<double>& reflectance) {
    const Bracket from = cosines.locate(leg.from), to = cosines.locate(leg.to);
    double* lower = sums.data() + from.lower * row;
    double* upper = sums.data() + from.upper * row;
    collect(to, leg.weight * (1 - from.upper_weight), reflectance, lower);
    collect(to, leg.weight * from.upper_weight, reflectance, upper);
  });
  return sums;
}

// p of every direction at (a, order), not divided by A.
std::vector<std::vector<double>> ExchangeWalks::collected_arrivals(std::size_t ior, const LegFilm& film,
                                                                   const Axis& orders,
                                                                   std::uint64_t& count) const {
  std::vector<std::vector<double>> result;
  const FilmLegs legs(film.material);
  FringePowers powers = film.powers(Side::outside, orders);
  for (std::size_t d = 0; d < bake_.direction_count(); ++d) {
    auto& p = result.emplace_back(kNodes * orders.size());
    for (std::size_t r = 0; r < kReplicates; ++r)
      legs.visit_arrivals(bake_.directions[ior][d], kArrivalStrata, bake_.rng_of_arrivals(d, r),
                          [&](const Leg& leg) {
                            powers.at(leg.facet_cosine);
                            collect(ExchangeSolver::cosines().locate(leg.to), leg.weight / kReplicates,
                                    powers.transmittance, p.data());
                            ++count;
                          });
  }
  return result;
}

// All directions' light as it arrives; `arrivals` is empty where it passes straight on.
std::vector<ExchangeSolver::Arrived> ExchangeWalks::arrived(std::size_t ior, const ExchangeSolver& solver,
                                                            const std::vector<std::vector<double>>& arrivals,
                                                            std::size_t order, std::size_t orders) const {
  const FactorFrame frame = bake_.frame_at(ior);
  const Material material = bake_.material_at(ior);
  std::vector<ExchangeSolver::Arrived> result;
  for (std::size_t d = 0; d < bake_.direction_count(); ++d) {
    const double cosine = bake_.directions[ior][d].z, visit = frame.one_visit_cosine(cosine);
    result.push_back(arrivals.empty() ? solver.straight_on(material.cosine_below(cosine), visit)
                                      : solver.bent(at_order(arrivals[d], order, orders), visit));
  }
  return result;
}

Block ExchangeWalks::run(std::size_t ior, std::size_t part) const {
  const LegFilm film = film_at(ior, part);
  Axis orders = this->orders();
  const auto at = [&](std::size_t k) {
    return this->orders().nodes.begin() + static_cast<std::ptrdiff_t>(k);
  };
  orders.nodes = {at(orders_of(part).first), at(orders_of(part).end)};
  Block block;
  const auto returns = collected_returns(film, orders, block.summary);
  std::vector<std::vector<double>> arrivals;
  if (!passes_straight_on(film.material))
    arrivals = collected_arrivals(ior, film, orders, block.summary.walks);
  const std::vector<double>& albedos = axes()[2].nodes;
  const std::size_t pairs = bake_.direction_count() * bake_.direction_count();
  std::vector<float> values(solvers_.size() * albedos.size() * orders.size() * pairs);
  Matrix b(static_cast<int>(kNodes));
  for (std::size_t j = 0; j < orders.size(); ++j) {
    std::ranges::copy(at_order(returns, j, orders.size()), b.row(0));
    for (std::size_t t = 0; t < solvers_.size(); ++t) {
      const auto under = solvers_[t].under(arrived(ior, solvers_[t], arrivals, j, orders.size()), b);
      for (std::size_t k = 0; k < albedos.size(); ++k)
        solvers_[t].exchange(under, albedos[k],
                             &values[((t * albedos.size() + k) * orders.size() + j) * pairs]);
    }
  }
  append(block.values, std::span<const float>(values));
  return block;
}

void ExchangeWalks::add(std::size_t ior, std::size_t part, const std::string& bytes, NdArray& array) const {
  const Orders made = orders_of(part);
  const std::size_t of_order = array.stride(order_axis(array)), run = made.size() * of_order;
  const std::size_t first = (wavelength_of(part) * orders().size() + made.first) * of_order;
  const std::size_t outer = array.stride(0) / array.stride(2);  // depths x albedos
  const auto values = unpacked<float>(bytes, outer * run);
  for (std::size_t k = 0; k < outer; ++k)
    for (std::size_t c = 0; c < run; ++c)
      array.set(ior * array.stride(0) + k * array.stride(2) + first + c, Rgb(double{values[k * run + c]}));
}

}  // namespace sunbeam
