#include "bake/dense/solved_job.h"

#include <half.h>

#include <map>

#include "bake/base/parallel_tasks.h"
#include "bake/blocks/block_bytes.h"
#include "bake/dense/nodes.h"
#include "bake/live/adding_doubling/slab_films.h"
#include "bake/recipe/attributes.h"

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
class SolvedValues {
 public:
  SolvedValues(const DenseNodes& nodes, const Order& order, Precision precision, const Blocks& blocks)
      : nodes_(nodes), order_(order), precision_(precision), blocks_(blocks) {}

  std::vector<float> remainder(std::size_t first, std::size_t count) const {
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
  std::vector<float> rest_stderr(std::size_t, std::size_t count) const {
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

  void prepare(const TaskRange& tasks, int threads) override {
    const std::size_t ior = tasks.first / order_.thicknesses;
    if (!begun_.contains(ior)) begin_from(ior, threads);
    films_ = std::move(begun_.at(ior));
    begun_.erase(ior);
    films_->prepare(
        tasks.first % order_.thicknesses, (tasks.end - 1) % order_.thicknesses + 1,
        [&](std::size_t count, const auto& task) { run_parallel_tasks(count, threads, {}, task); });
  }

  Block run(std::size_t task) const override {
    const std::size_t first = order_.first_node(task), places = nodes_.wo().size();
    Block block;
    std::vector<Rgb> values(films_->cells());
    for (std::size_t absorption = 0; absorption < order_.absorptions; ++absorption) {
      films_->rest(task % order_.thicknesses, absorption, values);
      Rows rest;
      for (std::size_t i = 0; i < nodes_.wi().size(); ++i) {
        const auto from = values.begin() + static_cast<std::ptrdiff_t>(i * places);
        rest.emplace_back(from, from + static_cast<std::ptrdiff_t>(places));
      }
      add(nodes_.remainder(first + absorption, std::move(rest)), block.values);
    }
    return block;
  }

  TableView table(const Blocks& blocks) const override {
    Table head = nodes_.head();
    head.info = info_of(recipe_, Encoding::dense, seed_, total_walks(*this, blocks), "adding-doubling");
    const auto values = std::make_shared<SolvedValues>(nodes_, order_, recipe_.table.precision, blocks);
    return {std::move(head),
            {nodes_.remainder_shape(), [=](auto... nodes) { return values->remainder(nodes...); }},
            {nodes_.rest_stderr_shape(), [=](auto... nodes) { return values->rest_stderr(nodes...); }}};
  }

 private:
  void add(const std::vector<float>& values, std::string& bytes) const {
    if (recipe_.table.precision == Precision::single_float) return append(bytes, std::span(values));
    const std::vector<Imath::half> halves(values.begin(), values.end());
    append(bytes, std::span(halves));
  }

  // What comes before prepare() runs on one thread, hence some base IORs at once.
  void begin_from(std::size_t ior, int threads) {
    constexpr std::size_t kAtOnce = 4;
    begun_.clear();
    const std::size_t count = std::min(kAtOnce, order_.iors - ior);
    for (std::size_t k = 0; k < count; ++k) begun_[ior + k];
    run_parallel_tasks(count, threads, {}, [&](std::size_t k) {
      const std::vector<Axis>& grid = recipe_.grid;
      const Material material =
          Parameters{grid[0].high(), grid[1].nodes[ior + k], 0}.applied_to(recipe_.material);
      begun_.at(ior + k) = std::make_unique<SlabFilms>(
          material, recipe_.spectrum.wavelengths(material),
          SlabFilms::Grid{grid[0].nodes, grid[2].nodes, nodes_.cosines(), nodes_.azimuths()});
    });
  }

  const Recipe& recipe_;
  std::uint64_t seed_;
  DenseNodes nodes_;
  Order order_;
  std::map<std::size_t, std::unique_ptr<SlabFilms>> begun_;  // by base IOR, not prepared yet
  std::unique_ptr<SlabFilms> films_;                         // of the group that is prepared
};

}  // namespace

std::unique_ptr<BakeJob> solved_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<SolvedJob>(recipe, seed);
}

}  // namespace sunbeam
