// Makes the array `exchange` of a factored table, which sunbeam/detail/factors.h stores and
// runtime/src/fit/wave_field.h looks up. Legs are walked and collected at the nodes of exchange_solver.h,
// each between its two neighbours, and all their chains are summed at once.
#pragma once

#include "bake/blocks/job.h"
#include "bake/factored/exchange_solver.h"
#include "bake/factored/legs.h"
#include "bake/factored/shared_inputs.h"

namespace sunbeam {

// Walks the legs and sums their chains. `bake` must outlive it.
class ExchangeWalks {
 public:
  explicit ExchangeWalks(const SharedInputs& bake);

  // The fringe orders, of a layered film those at each wavelength, are made in this many parts.
  std::size_t parts() const;
  struct Orders {
    std::size_t first, end;
    std::size_t size() const { return end - first; }
  };
  Orders orders_of(std::size_t part) const;

  // Makes the values of one part, at (depth, albedo, order, wi, wo).
  Block run(std::size_t ior, std::size_t part) const;

  // Puts the values of such a block into `array`.
  void add(std::size_t ior, std::size_t part, const std::string& bytes, NdArray& array) const;

 private:
  std::size_t orders_per_part() const;
  std::size_t parts_of_orders() const;
  std::size_t wavelength_of(std::size_t part) const { return part / parts_of_orders(); }
  LegFilm film_at(std::size_t ior, std::size_t part) const;
  std::vector<double> collected_returns(const LegFilm& film, const Axis& orders, BlockSummary& summary) const;
  std::vector<std::vector<double>> collected_arrivals(std::size_t ior, const LegFilm& film,
                                                      const Axis& orders, std::uint64_t& count) const;
  std::vector<ExchangeSolver::Arrived> arrived(std::size_t ior, const ExchangeSolver& solver,
                                               const std::vector<std::vector<double>>& arrivals,
                                               std::size_t order, std::size_t orders) const;
  const std::vector<Axis>& axes() const { return bake_.shapes.exchange.axes(); }
  const Axis& orders() const { return axes()[order_axis(bake_.shapes.exchange)]; }

  const SharedInputs& bake_;
  std::vector<ExchangeSolver> solvers_;  // one an optical depth
};

}  // namespace sunbeam
