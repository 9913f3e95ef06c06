#include "bake/solved_job.h"

#include <half.h>

#include <set>

#include "bake/dense_nodes.h"
#include "bake/live/slab_solver.h"
#include "bake/packed.h"
#include "bake/parallel_tasks.h"

namespace sunbeam {
namespace {

// Node = (thickness * base IORs + base IOR) * absorptions + absorption; task = base IOR * thicknesses +
// thickness, so that the tasks of a group follow one another.
class Order {
 public:
  explicit Order(const Recipe& recipe)
      : thicknesses(recipe.grid[0].size()), iors(recipe.grid[1].size()), absorptions(recipe.grid[2].size()) {}

  std::size_t first_node(std::size_t task) const {
    return (task % thicknesses * iors + task / thicknesses) * absorptions;
  }
  std::size_t task_of_node(std::size_t node) const {
    const std::size_t film = node / absorptions;
    return film % iors * thicknesses + film / iors;
  }

  std::size_t thicknesses, iors, absorptions;
};

// Blocks hold the remainder of their nodes; solutions have no noise.
class SolvedCells : public DenseCells {
 public:
  SolvedCells(const DenseNodes& nodes, const Order& order, Precision precision, const Blocks& blocks)
      : nodes_(nodes), order_(order), precision_(precision), blocks_(blocks) {}

  std::vector<float> remainder(std::size_t first, std::size_t count) const override {
    const std::size_t node_values = 3 * nodes_.cells();
    std::vector<float> result;
    for (std::size_t node = first; node < first + count;) {
      const std::size_t in_block = node % order_.absorptions;
      const std::size_t taken = std::min(order_.absorptions - in_block, first + count - node);
      const auto block = block_of(order_.task_of_node(node));
      const auto from = block.begin() + static_cast<std::ptrdiff_t>(in_block * node_values);
      result.insert(result.end(), from, from + static_cast<std::ptrdiff_t>(taken * node_values));
      node += taken;
    }
    return result;
  }
  std::vector<float> rest_stderr(std::size_t, std::size_t count) const override {
    return std::vector<float>(count * nodes_.cells());
  }

 private:
  std::vector<float> block_of(std::size_t task) const {
    const std::size_t count = 3 * nodes_.cells() * order_.absorptions;
    const std::string bytes = blocks_.values(task);
    if (precision_ == Precision::single_float) return unpacked<float>(bytes, count);
    const auto halves = unpacked<Imath::half>(bytes, count);
    return {halves.begin(), halves.end()};
  }

  const DenseNodes& nodes_;
  const Order& order_;
  Precision precision_;
  const Blocks& blocks_;
};

class SolvedJob : public BakeJob {
 public:
  SolvedJob(const Recipe& recipe, std::uint64_t seed)
      : recipe_(recipe), seed_(seed), nodes_(recipe), order_(recipe) {}

  std::size_t tasks() const override { return order_.thicknesses * order_.iors; }
  double cost(std::size_t) const override {
    constexpr double kSecondsPerFilm = 0.05, kSecondsPerValue = 5e-8;
    return kSecondsPerFilm + kSecondsPerValue * static_cast<double>(nodes_.cells() * order_.absorptions);
  }

  std::vector<std::size_t> groups() const override {
    std::vector<std::size_t> first;
    for (std::size_t ior = 0; ior < order_.iors; ++ior) first.push_back(ior * order_.thicknesses);
    return first;
  }

  void prepare(std::size_t ior, int threads) override {
    Material material = recipe_.material;
    material.base_ior = recipe_.grid[1].nodes[ior];
    solver_ = std::make_unique<SlabSolver>(material, nodes_.cosines());
    std::set<double> depths;
    for (const double absorption : recipe_.grid[2].nodes) {
      material.absorption_per_nm = absorption;
      for (const double relative : recipe_.spectrum.wavelengths(material).absorption)
        depths.insert(material.optical_depth() * relative);
    }
    const std::vector<double> each(depths.begin(), depths.end());
    run_parallel_tasks(each.size(), threads, {}, [&](std::size_t k) { solver_->add_depth(each[k]); });
  }

  Block run(std::size_t task) const override {
    const std::size_t first = order_.first_node(task);
    const Material at_first = nodes_.material(first);
    const SlabSolver::Film film(*solver_, at_first.film_thickness_nm, recipe_.spectrum.wavelengths(at_first));
    Block block;
    for (std::size_t node = first; node < first + order_.absorptions; ++node) {
      const auto rest = film.rest(nodes_.material(node).optical_depth());
      std::vector<Row> rows(nodes_.wi().size());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t o = 0; o < nodes_.cosines().size(); ++o)
          for (const double azimuth : nodes_.azimuths()) rows[i].value.push_back(rest.at(o, i, azimuth));
        rows[i].standard_error.resize(nodes_.wo().size());
      }
      add(nodes_.values(node, rows).remainder, block.values);
    }
    return block;
  }

  Table table(const Blocks& blocks) const override {
    Table table = nodes_.outline();
    table.info = info_of(recipe_, Encoding::dense, seed_, total_walks(*this, blocks), "adding-doubling");
    return table;
  }
  std::unique_ptr<DenseCells> cells(const Blocks& blocks) const override {
    return std::make_unique<SolvedCells>(nodes_, order_, recipe_.table.precision, blocks);
  }

 private:
  void add(const std::vector<float>& values, std::string& bytes) const {
    if (recipe_.table.precision == Precision::single_float) return append(bytes, std::span(values));
    const std::vector<Imath::half> halves(values.begin(), values.end());
    append(bytes, std::span(halves));
  }

  const Recipe& recipe_;
  std::uint64_t seed_;
  DenseNodes nodes_;
  Order order_;
  std::unique_ptr<SlabSolver> solver_;  // of the group that is prepared
};

}  // namespace

bool has_solution(const Recipe& recipe) {
  return recipe.table.values == TableValues::automatic && SlabSolver::solves(recipe.material);
}

std::unique_ptr<BakeJob> solved_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<SolvedJob>(recipe, seed);
}

}  // namespace sunbeam
