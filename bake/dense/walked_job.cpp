#include "bake/dense/walked_job.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mutex>

#include "bake/base/running_mean.h"
#include "bake/blocks/block_bytes.h"
#include "bake/dense/nodes.h"
#include "bake/live/pfmc.h"
#include "bake/recipe/attributes.h"

namespace sunbeam {
namespace {

constexpr int kFirstBatch = 64;  // estimates before the stop rule is asked; doubled until it holds
constexpr int kMostEstimates = 1 << 14;

// Rest by walks from one wi.
class RowWalks {
 public:
  RowWalks(const Pfmc& model, Technique technique, const Vec3& wi, double noise, Rng rng)
      : model_(model), technique_(technique), wi_(wi), noise_(noise), rng_(rng) {}

  // Appends the values of the directions that share walks: they go on until all of them are known.
  void add(std::span<const Vec3> wo) {
    std::vector<RunningMean> cells(wo.size());
    std::vector<Rgb> estimate(wo.size());
    int estimates = 0;
    const auto is_known = [&](const RunningMean& c) { return c.is_known(noise_, estimates); };
    for (int target = kFirstBatch; target <= kMostEstimates; target *= 2) {
      for (; estimates < target; ++estimates) {
        std::fill(estimate.begin(), estimate.end(), Rgb());
        model_.add_rest(wi_, wo, rng_, estimate, technique_);
        for (std::size_t k = 0; k < wo.size(); ++k) cells[k].add(estimate[k]);
      }
      if (std::all_of(cells.begin(), cells.end(), is_known)) break;
    }
    for (const RunningMean& cell : cells) {
      values_.push_back(cell.mean_of(estimates));
      errors_.push_back(cell.standard_error(estimates));
      worst_ = std::max(worst_, cell.relative_error(estimates));
    }
    walks_ += static_cast<std::uint64_t>(estimates) * model_.walks_per_estimate();
  }

  Block block() const {
    Block block{{walks_, worst_}, {}};
    append(block.values, std::span(values_));
    append(block.values, std::span(errors_));
    return block;
  }

 private:
  const Pfmc& model_;
  Technique technique_;
  Vec3 wi_;
  double noise_;
  Rng rng_;
  std::vector<Rgb> values_, errors_;
  double worst_ = 0;
  std::uint64_t walks_ = 0;
};

class WalkedValues {
 public:
  WalkedValues(const DenseNodes& nodes, const Blocks& blocks) : nodes_(nodes), blocks_(blocks) {}

  std::vector<float> remainder(std::size_t first, std::size_t count) const {
    std::vector<float> result;
    for (std::size_t node = first; node < first + count; ++node)
      std::ranges::copy(nodes_.remainder(node, rows(node, kRest)), std::back_inserter(result));
    return result;
  }
  std::vector<float> rest_stderr(std::size_t first, std::size_t count) const {
    std::vector<float> result;
    for (std::size_t node = first; node < first + count; ++node)
      std::ranges::copy(nodes_.rest_stderr(rows(node, kError)), std::back_inserter(result));
    return result;
  }

 private:
  // The halves of a block.
  enum Half : std::size_t { kRest, kError };

  // Of all blocks of a node.
  Rows rows(std::size_t node, Half half) const {
    const std::size_t places = nodes_.wo().size();
    Rows result;
    for (std::size_t i = 0; i < nodes_.wi().size(); ++i) {
      const auto both = unpacked<Rgb>(blocks_.values(node * nodes_.wi().size() + i), 2 * places);
      const auto from = both.begin() + static_cast<std::ptrdiff_t>(half * places);
      result.emplace_back(from, from + static_cast<std::ptrdiff_t>(places));
    }
    return result;
  }

  const DenseNodes& nodes_;
  const Blocks& blocks_;
};

// Keeps the model of the node that was asked for last. The rows of a node follow one another, and that of a
// film of many layers takes longer to make than some rows take to walk.
class LatestModel {
 public:
  template <class Make>
  std::shared_ptr<const Pfmc> of(std::size_t node, Make make) {
    const std::lock_guard lock(mutex_);
    if (!model_ || node_ != node) model_ = make();
    node_ = node;
    return model_;
  }

 private:
  std::mutex mutex_;
  std::size_t node_ = 0;
  std::shared_ptr<const Pfmc> model_;
};

class WalkedJob : public BakeJob {
 public:
  WalkedJob(const Recipe& recipe, std::uint64_t seed) : recipe_(recipe), seed_(seed), nodes_(recipe) {}

  std::size_t tasks() const override { return nodes_.size() * nodes_.wi().size(); }
  double cost(std::size_t) const override {
    constexpr double kSecondsPerEstimate = 5e-5, kNoiseOfOne = 0.3;  // of a typical skin
    const double estimates =
        std::clamp(square(kNoiseOfOne / recipe_.accuracy.noise), 64.0, double{kMostEstimates});
    return kSecondsPerEstimate * estimates;
  }

  Block run(std::size_t task) const override {
    const std::size_t node = task / nodes_.wi().size(), i = task % nodes_.wi().size();
    const std::shared_ptr<const Pfmc> model = model_.of(node, [&] {
      const Material material = nodes_.material(node);
      return std::make_shared<const Pfmc>(material, recipe_.spectrum.wavelengths(material));
    });
    RowWalks walks(*model, technique_of(recipe_.accuracy.estimator), nodes_.wi()[i], recipe_.accuracy.noise,
                   Rng(seed_, i));
    const std::span<const Vec3> wo = nodes_.wo();
    const std::size_t together = std::min(model->exits_per_walk(), wo.size());
    for (std::size_t first = 0; first < wo.size(); first += together)
      walks.add(wo.subspan(first, std::min(together, wo.size() - first)));
    return walks.block();
  }

  TableView table(const Blocks& blocks) const override {
    Table head = nodes_.head();
    head.info = info_of(recipe_, Encoding::dense, seed_, total_walks(*this, blocks),
                        name_of(recipe_.accuracy.estimator));
    const auto values = std::make_shared<WalkedValues>(nodes_, blocks);
    return {std::move(head),
            {nodes_.remainder_shape(), [=](auto... nodes) { return values->remainder(nodes...); }},
            {nodes_.rest_stderr_shape(), [=](auto... nodes) { return values->rest_stderr(nodes...); }}};
  }

 private:
  const Recipe& recipe_;
  std::uint64_t seed_;
  DenseNodes nodes_;
  mutable LatestModel model_;
};

}  // namespace

std::unique_ptr<BakeJob> walked_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<WalkedJob>(recipe, seed);
}

}  // namespace sunbeam
