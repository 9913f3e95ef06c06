#include "bake/sweep.h"

#include <fmt/format.h>

#include <atomic>

#include "bake/cell.h"
#include "bake/film_tables.h"
#include "bake/live/pfmc.h"
#include "bake/parallel_tasks.h"
#include "bake/version.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"

namespace sunbeam {
namespace {

constexpr int kFirstBatch = 64;  // estimates before the stop rule is asked; doubled until it holds
constexpr int kMostEstimates = 1 << 14;
constexpr double kLowestCosine = 0.01;

std::vector<Axis> rest_axes(const Recipe& recipe) {
  std::vector<Axis> axes = recipe.grid;
  const auto cosines = spaced_nodes(kLowestCosine, 1, static_cast<std::size_t>(recipe.table.angles));
  const auto azimuths = spaced_nodes(0, kPi, static_cast<std::size_t>(recipe.table.azimuths));
  axes.push_back({"cos_theta_i", "1", cosines});
  axes.push_back({"phi_i", "rad", {0}});
  axes.push_back({"cos_theta_o", "1", cosines});
  axes.push_back({"phi_o", "rad", azimuths});
  return axes;
}

// Parameters of node `index` of the flattened grid.
Parameters parameters_at(const std::vector<Axis>& grid, std::size_t index) {
  const std::size_t c = index % grid[2].size(), b = index / grid[2].size() % grid[1].size();
  return {grid[0].nodes[index / (grid[1].size() * grid[2].size())], grid[1].nodes[b], grid[2].nodes[c]};
}

// Rest and its standard error for one wi and every wo of the table.
struct Row {
  std::vector<Rgb> value, standard_error;
  std::uint64_t estimates = 0;
};

Row bake_row(const Pfmc& model, Technique technique, const Vec3& wi, const std::vector<Vec3>& wo,
             double noise, Rng rng) {
  std::vector<Cell> cells(wo.size());
  std::vector<Rgb> estimate(wo.size());
  Row row;
  for (std::uint64_t target = kFirstBatch;; target *= 2) {
    for (; row.estimates < target; ++row.estimates) {
      std::fill(estimate.begin(), estimate.end(), Rgb());
      model.add_rest(wi, wo, rng, estimate, technique);
      for (std::size_t k = 0; k < wo.size(); ++k) cells[k].add(estimate[k]);
    }
    const auto count = static_cast<double>(row.estimates);
    if (row.estimates < kMostEstimates &&
        !std::all_of(cells.begin(), cells.end(), [&](const Cell& c) { return c.is_known(noise, count); }))
      continue;
    for (const Cell& cell : cells) {
      row.value.push_back(cell.mean_of(count));
      row.standard_error.push_back(cell.standard_error(count));
    }
    return row;
  }
}

// Averages (i, o) with (o, i): half the noise in variance, and reciprocity to the last bit.
void average_reciprocal(std::vector<Row>& rows, std::size_t azimuths) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t o = 0; o < i; ++o)
      for (std::size_t a = 0; a < azimuths; ++a) {
        const std::size_t io = o * azimuths + a, oi = i * azimuths + a;
        const Rgb value = 0.5 * (rows[i].value[io] + rows[o].value[oi]);
        const Rgb e1 = rows[i].standard_error[io], e2 = rows[o].standard_error[oi];
        const Rgb error = 0.5 * transform(e1 * e1 + e2 * e2, [](double x) { return std::sqrt(x); });
        rows[i].value[io] = rows[o].value[oi] = value;
        rows[i].standard_error[io] = rows[o].standard_error[oi] = error;
      }
}

class Sweep {
 public:
  Sweep(const Recipe& recipe, const SweepSettings& settings) : recipe_(recipe), settings_(settings) {
    table_.material = recipe.material;
    bake_film(recipe, table_);
    const auto axes = rest_axes(recipe);
    table_.remainder = NdArray("remainder", axes, recipe.table.precision);
    table_.rest_stderr = NdArray("rest_stderr", axes, recipe.table.precision);
    for (const double c : axes[3].nodes) wi_.push_back(direction_from_cosine(c, 0));
    for (const double c : axes[5].nodes)
      for (const double phi : axes[6].nodes) wo_.push_back(direction_from_cosine(c, phi));
    nodes_ = recipe.grid[0].size() * recipe.grid[1].size() * recipe.grid[2].size();
  }

  Table run() {
    run_parallel_tasks(nodes_, settings_.threads, settings_.on_progress,
                       [&](std::size_t node) { bake_node(node); });
    table_.info = {{"recipe", recipe_.text},
                   {"recipe_hash", recipe_.hash},
                   {"seed", std::to_string(settings_.seed)},
                   {"samples", std::to_string(walks_.load())},
                   {"estimator", name_of(recipe_.accuracy.estimator)},
                   {"tool_version", kToolVersion},
                   {"encoding", recipe_.table.encoding}};
    table_.info.merge(recipe_.spectrum.attributes());
    return std::move(table_);
  }

 private:
  void bake_node(std::size_t node) {
    const Parameters parameters = parameters_at(recipe_.grid, node);
    const Material material = parameters.applied_to(recipe_.material);
    const Pfmc model(material, recipe_.spectrum.wavelengths(material));
    std::vector<Row> rows;
    for (std::size_t i = 0; i < wi_.size(); ++i) {
      rows.push_back(bake_row(model, technique_of(recipe_.accuracy.estimator), wi_[i], wo_,
                              recipe_.accuracy.noise, Rng(settings_.seed, node * wi_.size() + i)));
      walks_ += rows.back().estimates * model.walks_per_estimate();
    }
    average_reciprocal(rows, table_.remainder.axes()[6].size());
    store(node, parameters, material, rows);
  }

  void store(std::size_t node, const Parameters& parameters, const Material& material,
             const std::vector<Row>& rows) {
    const RestFrame frame(material, table_.first_visit);
    const auto transmittance = [&](double cosine) {
      return table_.transmittance({parameters.film_thickness_nm, parameters.base_ior, cosine});
    };
    std::size_t cell = node * table_.remainder.stride(2);
    for (std::size_t i = 0; i < wi_.size(); ++i) {
      const Rgb t_i = transmittance(wi_[i].z);
      for (std::size_t o = 0; o < wo_.size(); ++o, ++cell) {
        table_.remainder.set(
            cell, frame.encode(rows[i].value[o], wi_[i].z, wo_[o].z, t_i, transmittance(wo_[o].z)));
        table_.rest_stderr.set(cell, rows[i].standard_error[o]);
      }
    }
  }

  const Recipe& recipe_;
  const SweepSettings& settings_;
  Table table_;
  std::vector<Vec3> wi_, wo_;
  std::size_t nodes_ = 0;
  std::atomic<std::uint64_t> walks_ = 0;
};

double cells_of(const std::vector<Axis>& axes) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  return cells;
}

}  // namespace

void require_reasonable_size(const Recipe& recipe) {
  constexpr double kMostCells = 1 << 28;  // two arrays of three floats: 6.4 GB
  const double rest = cells_of(rest_axes(recipe)), film = cells_of(film_axes(recipe));
  if (rest > kMostCells)
    throw Error(
        fmt::format("{}: [grid] and table.angles, table.azimuths ask for {:.3g} cells; allowed: up to {:.3g}",
                    recipe.name, rest, kMostCells));
  if (film > kMostCells)
    throw Error(fmt::format(
        "{}: grid.film_thickness_nm and grid.base_ior ask for {:.3g} film cells; allowed: up to {:.3g}",
        recipe.name, film, kMostCells));
}

Table bake_table(const Recipe& recipe, const SweepSettings& settings) {
  return Sweep(recipe, settings).run();
}

}  // namespace sunbeam
