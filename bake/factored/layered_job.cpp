#include <optional>

#include "bake/blocks/block_bytes.h"
#include "bake/factored/exchange.h"
#include "bake/factored/facets/crossing.h"
#include "bake/factored/facets/returning.h"
#include "bake/factored/job.h"
#include "bake/recipe/attributes.h"

namespace sunbeam {
namespace {

// Tasks: of a rough film over a clear base, each direction of `crossing`; then `returning`, or of path
// "product" each base IOR and part of `exchange`.
class LayeredJob : public BakeJob {
 public:
  LayeredJob(const Recipe& recipe, std::uint64_t seed) : bake_(recipe, seed), directions_(directions()) {
    if (bake_.has_exchange()) exchange_.emplace(bake_);
  }

  std::size_t tasks() const override { return directions_.size() + later_tasks(); }

  double cost(std::size_t task) const override {
    constexpr double kSecondsOfADirection = 0.002, kSecondsPerValue = 5e-6, kSecondsOfReturns = 0.2,
                     kSecondsOfExchange = 2;
    if (task < directions_.size())
      return kSecondsOfADirection +
             kSecondsPerValue * static_cast<double>(bake_.shapes.crossing.cells() / directions_.size());
    return exchange_ ? kSecondsOfExchange : kSecondsOfReturns;
  }

  Block run(std::size_t task) const override {
    if (task < directions_.size()) return crossing(directions_[task]);
    const std::size_t later = task - directions_.size();
    return exchange_ ? exchange_->run(later / exchange_->parts(), later % exchange_->parts()) : returning();
  }

  TableView table(const Blocks& blocks) const override {
    Table table;
    table.schema_version = kTableSchemaVersion;
    table.material = bake_.recipe.material;
    table.symmetry = symmetry_of(bake_.recipe);
    const FactorShapes& shapes = bake_.shapes;
    table.factors = {shapes.grid,
                     shapes.wavelengths,
                     {},
                     {},
                     NdArray(shapes.exchange),
                     NdArray(shapes.facet_cosine),
                     NdArray(shapes.crossing),
                     NdArray(shapes.return_cosine),
                     NdArray(shapes.returning)};
    fill(blocks, table.factors);
    table.info =
        info_of(bake_.recipe, Encoding::factored, bake_.seed, total_walks(*this, blocks), "facet-rings");
    table.info["noise"] = "0";
    return table;
  }

 private:
  // Those of the arrays, phi fastest.
  std::vector<Vec3> directions() const {
    std::vector<Vec3> result;
    if (bake_.shapes.crossing.empty()) return result;
    const std::vector<Axis>& axes = bake_.shapes.facet_cosine.axes();
    for (const double theta : axes[0].nodes)
      for (const double phi : axes[1].nodes) result.push_back(direction_from_cosine(std::cos(theta), phi));
    return result;
  }

  std::size_t later_tasks() const { return exchange_ ? bake_.iors() * exchange_->parts() : 1; }

  // c' at all ranks, then the values of `crossing` at (base_ior, optical_depth, facet_rank).
  Block crossing(const Vec3& w) const {
    const std::vector<Axis>& axes = bake_.shapes.crossing.axes();
    const Roughness& roughness = bake_.recipe.material.roughness;
    const std::vector<double> cosines = VisibleFacets(w, roughness, 1).cosines(axes[4].nodes);
    Block block;
    append(block.values, std::span<const double>(cosines));
    for (std::size_t ior = 0; ior < bake_.iors(); ++ior) {
      const Material material = bake_.material_at(ior);
      const VisibleFacets facets(w, roughness, bending_index_ratio(material));
      const auto values = crossing_values(material, facets, cosines, axes[1].nodes);
      append(block.values, std::span<const double>(values));
    }
    return block;
  }

  Block returning() const {
    Block block;
    Returning values{{1}, {0}};
    const std::vector<Axis>& axes = bake_.shapes.returning.axes();
    if (!bake_.recipe.material.is_opaque())
      values = returning_of(bake_.recipe.material, axes[1].nodes, axes[0].nodes);
    append(block.values, std::span<const double>(values.cosines));
    append(block.values, std::span<const double>(values.values));
    return block;
  }

  void fill(const Blocks& blocks, Factors& factors) const {
    for (std::size_t k = 0; k < directions_.size(); ++k) add_crossing(k, blocks.values(k), factors);
    for (std::size_t task = directions_.size(); task < tasks(); ++task) {
      const std::size_t later = task - directions_.size();
      if (exchange_)
        exchange_->add(later / exchange_->parts(), later % exchange_->parts(), blocks.values(task),
                       factors.exchange);
      else
        add_returning(blocks.values(task), factors);
    }
  }

  static void add_crossing(std::size_t direction, const std::string& bytes, Factors& factors) {
    NdArray& cosine = factors.facet_cosine;
    NdArray& crossing = factors.crossing;
    const std::size_t ranks = crossing.axes()[4].size(), media = crossing.cells() / crossing.stride(1);
    const auto values = unpacked<double>(bytes, (1 + media) * ranks);
    for (std::size_t j = 0; j < ranks; ++j) {
      cosine.set(direction * ranks + j, Rgb(values[j]));
      for (std::size_t m = 0; m < media; ++m)
        crossing.set(m * crossing.stride(1) + direction * ranks + j, Rgb(values[(1 + m) * ranks + j]));
    }
  }

  static void add_returning(const std::string& bytes, Factors& factors) {
    const std::size_t ranks = factors.return_cosine.cells(), cells = factors.returning.cells();
    const auto values = unpacked<double>(bytes, ranks + cells);
    for (std::size_t j = 0; j < ranks; ++j) factors.return_cosine.set(j, Rgb(values[j]));
    for (std::size_t k = 0; k < cells; ++k) factors.returning.set(k, Rgb(values[ranks + k]));
  }

  SharedInputs bake_;
  std::vector<Vec3> directions_;
  std::optional<ExchangeWalks> exchange_;  // path "product"
};

}  // namespace

std::unique_ptr<BakeJob> layered_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<LayeredJob>(recipe, seed);
}

}  // namespace sunbeam
