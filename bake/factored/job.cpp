#include "bake/factored/job.h"

#include <optional>

#include "bake/factored/arrival.h"
#include "bake/factored/exchange.h"
#include "bake/factored/returned.h"
#include "bake/recipe/attributes.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

// Tasks: of a rough film, each base IOR x direction of `arrival`, then those of the other array: `returned`
// a base IOR, `exchange` a base IOR and some fringe orders.
class FactoredJob : public BakeJob {
 public:
  FactoredJob(const Recipe& recipe, std::uint64_t seed)
      : bake_(recipe, seed),
        arrival_tasks_(recipe.material.is_smooth() ? 0 : bake_.iors() * bake_.direction_count()) {
    if (bake_.has_exchange()) exchange_.emplace(bake_);
  }

  std::size_t tasks() const override { return arrival_tasks_ + bake_.iors() * parts(); }

  double cost(std::size_t task) const override {
    constexpr double kSecondsPerOperation = 5e-10, kLegs = kReplicates * 64 * 64,
                     kNodes = ExchangeSolver::kNodes;
    const FactorShapes& shapes = bake_.shapes;
    const auto ends = static_cast<double>(bake_.direction_count());
    if (task < arrival_tasks_)
      return kSecondsPerOperation * kLegs * static_cast<double>(shapes.arrival.stride(0)) / ends;
    if (!exchange_) return kSecondsPerOperation * 16 * kLegs * static_cast<double>(shapes.returned.stride(0));
    const auto depths = static_cast<double>(shapes.exchange.axes()[1].size());
    const auto albedos = static_cast<double>(shapes.exchange.axes()[2].size());
    const double solve = square(kNodes) * (kNodes + ends) + square(ends) * kNodes;
    return kSecondsPerOperation * static_cast<double>(exchange_->orders_of(later(task).part).size()) *
           ((32 + ends) * kLegs + depths * albedos * solve);
  }

  Block run(std::size_t task) const override {
    const std::size_t directions = bake_.direction_count();
    if (task < arrival_tasks_) return walk_arrival(bake_, task / directions, task % directions);
    const auto [ior, part] = later(task);
    return exchange_ ? exchange_->run(ior, part) : walk_returned(bake_, ior);
  }

  TableView table(const Blocks& blocks) const override {
    Table table;
    table.material = bake_.recipe.material;
    table.symmetry = symmetry_of(bake_.recipe);
    const FactorShapes& shapes = bake_.shapes;
    Factors& factors = table.factors;
    factors = {shapes.grid, shapes.wavelengths, NdArray(shapes.arrival), NdArray(shapes.returned),
               NdArray(shapes.exchange)};
    const double variance = fill(blocks, factors);
    table.info =
        info_of(bake_.recipe, Encoding::factored, bake_.seed, total_walks(*this, blocks), "pfmc-shared-legs");
    const double relative = arrival_tasks_ > 0 ? 2 * variance / static_cast<double>(arrival_tasks_) : 0;
    table.info["noise"] = to_text(std::sqrt(relative));
    return table;
  }

 private:
  // Tasks of a base IOR other than arrivals.
  std::size_t parts() const { return exchange_ ? exchange_->parts() : 1; }
  struct Later {
    std::size_t ior, part;
  };
  Later later(std::size_t task) const {
    const std::size_t k = task - arrival_tasks_;
    return {k / parts(), k % parts()};
  }

  // Returns the sum of the relative variances of arrivals.
  double fill(const Blocks& blocks, Factors& factors) const {
    const std::size_t directions = bake_.direction_count();
    double variance = 0;
    for (std::size_t task = 0; task < arrival_tasks_; ++task)
      variance += add_arrival(task / directions, task % directions, blocks.values(task), factors.arrival);
    for (std::size_t task = arrival_tasks_; task < tasks(); ++task) {
      const auto [ior, part] = later(task);
      if (exchange_)
        exchange_->add(ior, part, blocks.values(task), factors.exchange);
      else
        add_returned(ior, blocks.values(task), factors.returned);
    }
    return variance;
  }

  SharedInputs bake_;
  std::size_t arrival_tasks_;
  std::optional<ExchangeWalks> exchange_;  // path "product"
};

}  // namespace

std::unique_ptr<BakeJob> factored_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<FactoredJob>(recipe, seed);
}

}  // namespace sunbeam
