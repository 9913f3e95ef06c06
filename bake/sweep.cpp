#include "bake/sweep.h"

#include <fmt/format.h>

#include <atomic>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "bake/cell.h"
#include "bake/factor_walks.h"
#include "bake/film_tables.h"
#include "bake/live/pfmc.h"
#include "bake/live/slab_films.h"
#include "bake/parallel_tasks.h"
#include "bake/version.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"

namespace sunbeam {
namespace {

constexpr int kFirstBatch = 64;  // estimates before the stop rule is asked; doubled until it holds
constexpr int kMostEstimates = 1 << 14;
constexpr double kLowestCosine = 0.01;

Symmetry symmetry_of(const Recipe& recipe) {
  return recipe.material.roughness.is_isotropic() ? Symmetry::isotropic : Symmetry::anisotropic;
}

// `count` azimuths from 0, without the end that is the beginning again.
std::vector<double> nodes_round(std::size_t count) {
  auto nodes = spaced_nodes(0, 2 * kPi, count + 1);
  nodes.pop_back();
  return nodes;
}

// Cubic in all but the azimuths of an anisotropic film, of which one is periodic and the other must not
// differ from it. Cosines are denser towards grazing, where the rest bends.
std::vector<Axis> rest_axes(const Recipe& recipe) {
  std::vector<Axis> axes = recipe.grid;
  for (Axis& axis : axes) axis.is_cubic = true;
  Axis cosine{"", "1", {}, 2, 0, 0, true};
  cosine.nodes = spaced_nodes(kLowestCosine, 1, static_cast<std::size_t>(recipe.table.angles), cosine.power);
  const auto azimuths = static_cast<std::size_t>(recipe.table.azimuths);
  Axis phi_i{"phi_i", "rad", {0}}, phi_o{"phi_o", "rad", spaced_nodes(0, kPi, azimuths), 1, 0, 0, true};
  if (symmetry_of(recipe) == Symmetry::anisotropic) {
    phi_i.nodes = spaced_nodes(0, kPi / 2, azimuths / 4 + 1);
    phi_o = {"phi_o", "rad", nodes_round(azimuths), 1, 2 * kPi};
  }
  cosine.name = "cos_theta_i";
  axes.push_back(cosine);
  axes.push_back(phi_i);
  cosine.name = "cos_theta_o";
  axes.push_back(cosine);
  axes.push_back(phi_o);
  return axes;
}

// To three binary digits, so that it takes next to no room in a file. Nobody needs a noise more exactly.
double coarse(double standard_error) {
  if (standard_error == 0) return 0;
  int exponent = 0;
  const double fraction = std::frexp(standard_error, &exponent);
  return std::ldexp(std::round(8 * fraction) / 8, exponent);
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

// Appends the values of the directions that share walks: they go on until all of them are known.
void bake_together(const Pfmc& model, Technique technique, const Vec3& wi, std::span<const Vec3> wo,
                   double noise, Rng& rng, Row& row) {
  std::vector<Cell> cells(wo.size());
  std::vector<Rgb> estimate(wo.size());
  std::uint64_t estimates = 0;
  const auto is_known = [&](const Cell& c) { return c.is_known(noise, static_cast<double>(estimates)); };
  for (std::uint64_t target = kFirstBatch; target <= kMostEstimates; target *= 2) {
    for (; estimates < target; ++estimates) {
      std::fill(estimate.begin(), estimate.end(), Rgb());
      model.add_rest(wi, wo, rng, estimate, technique);
      for (std::size_t k = 0; k < wo.size(); ++k) cells[k].add(estimate[k]);
    }
    if (std::all_of(cells.begin(), cells.end(), is_known)) break;
  }
  for (const Cell& cell : cells) {
    row.value.push_back(cell.mean_of(static_cast<double>(estimates)));
    row.standard_error.push_back(cell.standard_error(static_cast<double>(estimates)));
  }
  row.estimates += estimates;
}

Row bake_row(const Pfmc& model, Technique technique, const Vec3& wi, const std::vector<Vec3>& wo,
             double noise, Rng rng) {
  Row row;
  const std::size_t together = std::min(model.exits_per_walk(), wo.size());
  for (std::size_t first = 0; first < wo.size(); first += together)
    bake_together(model, technique, wi, std::span(wo).subspan(first, std::min(together, wo.size() - first)),
                  noise, rng, row);
  return row;
}

// Cells of one parameter node whose values are equal because the surface is its own mirror image, because
// light may be reversed, or because a direction along z has no azimuth.
class Orbits {
 public:
  explicit Orbits(const Recipe& recipe)
      : symmetry_(symmetry_of(recipe)),
        cosines_(static_cast<std::size_t>(recipe.table.angles)),
        azimuths_(static_cast<std::size_t>(recipe.table.azimuths)) {
    const std::size_t azimuths_i = symmetry_ == Symmetry::isotropic ? 1 : azimuths_ / 4 + 1;
    std::map<std::size_t, Cells> by_key;
    for (std::size_t i = 0; i < cosines_ * azimuths_i; ++i)
      for (std::size_t o = 0; o < cosines_ * azimuths_; ++o)
        by_key[key({i / azimuths_i, i % azimuths_i}, {o / azimuths_, o % azimuths_})].emplace_back(i, o);
    for (auto& [key, cells] : by_key) orbits_.push_back(std::move(cells));
  }

  // Replaces the values of each orbit by their mean: less noise, and symmetries hold to the last bit.
  void average(std::vector<Row>& rows) const {
    for (const Cells& cells : orbits_) average(rows, cells);
  }

 private:
  using Cells = std::vector<std::pair<std::size_t, std::size_t>>;  // (row, place in it), by row

  struct End {
    std::size_t cosine, azimuth;  // nodes; azimuths of an anisotropic table in steps from the x axis
  };

  std::size_t number(const End& i, const End& o) const {
    return ((i.cosine * azimuths_ + i.azimuth) * cosines_ + o.cosine) * azimuths_ + o.azimuth;
  }

  // The least number of all cells in the orbit.
  std::size_t key(End i, End o) const {
    const std::size_t pole = cosines_ - 1;
    if (symmetry_ == Symmetry::isotropic) {
      if (i.cosine == pole || o.cosine == pole) o.azimuth = 0;
      return std::min(number(i, o), number({o.cosine, 0}, {i.cosine, o.azimuth}));
    }
    const auto mirrored = [&](const End& end, bool x, bool y) {
      if (end.cosine == pole) return End{pole, 0};
      std::size_t azimuth = end.azimuth;
      if (x) azimuth = azimuths_ + azimuths_ / 2 - azimuth;
      if (y) azimuth = 2 * azimuths_ - azimuth;
      return End{end.cosine, azimuth % azimuths_};
    };
    auto least = std::numeric_limits<std::size_t>::max();
    for (const bool x : {false, true})
      for (const bool y : {false, true}) {
        const End a = mirrored(i, x, y), b = mirrored(o, x, y);
        least = std::min({least, number(a, b), number(b, a)});
      }
    return least;
  }

  // Cells of a row share their walks, so their errors add up; those of different rows do not.
  static void average(std::vector<Row>& rows, const Cells& cells) {
    Rgb value, variance, row_error;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto [row, place] = cells[k];
      value += rows[row].value[place];
      row_error += rows[row].standard_error[place];
      if (k + 1 < cells.size() && cells[k + 1].first == row) continue;
      variance += row_error * row_error;
      row_error = {};
    }
    const auto count = static_cast<double>(cells.size());
    const Rgb error = transform(variance, [](double x) { return std::sqrt(x); });
    for (const auto& [row, place] : cells) {
      rows[row].value[place] = value / count;
      rows[row].standard_error[place] = error / count;
    }
  }

  Symmetry symmetry_;
  std::size_t cosines_, azimuths_;
  std::vector<Cells> orbits_;
};

bool is_solved(const Recipe& recipe) {
  return recipe.table.values == TableValues::automatic && SlabSolver::solves(recipe.material);
}

std::map<std::string, std::string> info_of(const Recipe& recipe, Encoding encoding, std::uint64_t seed,
                                           std::uint64_t walks, const char* estimator) {
  std::map<std::string, std::string> info{{"recipe", recipe.text},        {"recipe_hash", recipe.hash},
                                          {"seed", std::to_string(seed)}, {"samples", std::to_string(walks)},
                                          {"estimator", estimator},       {"tool_version", kToolVersion},
                                          {"encoding", name_of(encoding)}};
  info.merge(recipe.spectrum.attributes());
  return info;
}

class Sweep {
 public:
  Sweep(const Recipe& recipe, const SweepSettings& settings)
      : recipe_(recipe), settings_(settings), orbits_(recipe) {
    table_.material = recipe.material;
    table_.symmetry = symmetry_of(recipe);
    table_.frame = recipe.table.frame;
    bake_film(recipe, table_);
    frame_.emplace(recipe.material, table_.first_visit);
    const auto axes = rest_axes(recipe);
    table_.remainder = NdArray("remainder", axes, recipe.table.precision);
    table_.rest_stderr = NdArray("rest_stderr", axes, Precision::single_float, 1);
    for (const double c : axes[3].nodes)
      for (const double phi : axes[4].nodes) wi_.push_back(direction_from_cosine(c, phi));
    for (const double c : axes[5].nodes)
      for (const double phi : axes[6].nodes) wo_.push_back(direction_from_cosine(c, phi));
    nodes_ = recipe.grid[0].size() * recipe.grid[1].size() * recipe.grid[2].size();
  }

  Table run() {
    if (is_solved(recipe_)) {
      for (std::size_t ior = 0; ior < recipe_.grid[1].size(); ++ior) solve_nodes(ior);
    } else {
      run_parallel_tasks(nodes_, settings_.threads, settings_.on_progress,
                         [&](std::size_t node) { bake_node(node); });
    }
    table_.info = info_of(recipe_, Encoding::dense, settings_.seed, walks_, dense_method(recipe_));
    return std::move(table_);
  }

 private:
  // All nodes of one base IOR, without walks.
  void solve_nodes(std::size_t ior) {
    const std::vector<Axis>& grid = recipe_.grid;
    const std::vector<Axis>& axes = table_.remainder.axes();
    const Material material = Parameters{grid[0].high(), grid[1].nodes[ior], 0}.applied_to(recipe_.material);
    SlabFilms films(material, recipe_.spectrum.wavelengths(material),
                    {grid[0].nodes, grid[2].nodes, axes[3].nodes, axes[6].nodes});
    films.prepare(0, grid[0].size(), [&](std::size_t count, const auto& task) {
      run_parallel_tasks(count, settings_.threads, {}, task);
    });
    const auto progress = [&](double fraction) {
      if (settings_.on_progress)
        settings_.on_progress((static_cast<double>(ior) + fraction) / static_cast<double>(grid[1].size()));
    };
    run_parallel_tasks(grid[0].size(), settings_.threads, progress, [&](std::size_t thickness) {
      for (std::size_t absorption = 0; absorption < grid[2].size(); ++absorption)
        solve_node(films, thickness, ior, absorption);
    });
  }

  void solve_node(const SlabFilms& films, std::size_t thickness, std::size_t ior, std::size_t absorption) {
    const std::vector<Axis>& grid = recipe_.grid;
    const std::size_t node = (thickness * grid[1].size() + ior) * grid[2].size() + absorption;
    const Parameters parameters = parameters_at(grid, node);
    std::vector<Rgb> values(films.cells());
    films.rest(thickness, absorption, values);
    std::vector<Row> rows(wi_.size());
    for (std::size_t i = 0; i < wi_.size(); ++i) {
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(i * wo_.size());
      rows[i].value.assign(first, first + static_cast<std::ptrdiff_t>(wo_.size()));
      rows[i].standard_error.resize(wo_.size());
    }
    finish(node, parameters, parameters.applied_to(recipe_.material), rows);
  }

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
    finish(node, parameters, material, rows);
  }

  void finish(std::size_t node, const Parameters& parameters, const Material& material,
              std::vector<Row>& rows) {
    orbits_.average(rows);
    if (table_.frame == FrameKind::closed) frame(parameters, material, rows);
    store(node, rows);
  }

  void store(std::size_t node, const std::vector<Row>& rows) {
    std::size_t cell = node * table_.remainder.stride(2);
    for (std::size_t i = 0; i < wi_.size(); ++i)
      for (std::size_t o = 0; o < wo_.size(); ++o, ++cell) {
        table_.remainder.set(cell, rows[i].value[o]);
        table_.rest_stderr.set(cell, Rgb(coarse(mean(rows[i].standard_error[o]))));
      }
  }

  void frame(const Parameters& parameters, const Material& material, std::vector<Row>& rows) const {
    const RestFrame frame = frame_->over(material);
    const auto transmittance = [&](double cosine) {
      return table_.transmittance({parameters.film_thickness_nm, parameters.base_ior, cosine});
    };
    std::vector<Rgb> t_o;
    for (std::size_t o = 0; o < wo_.size(); ++o)  // the azimuths of a cosine share it
      t_o.push_back(o > 0 && wo_[o].z == wo_[o - 1].z ? t_o.back() : transmittance(wo_[o].z));
    for (std::size_t i = 0; i < wi_.size(); ++i) {
      const Rgb t_i = transmittance(wi_[i].z);
      for (std::size_t o = 0; o < wo_.size(); ++o)
        rows[i].value[o] = frame.encode(rows[i].value[o], wi_[i].z, wo_[o].z, t_i, t_o[o]);
    }
  }

  const Recipe& recipe_;
  const SweepSettings& settings_;
  const Orbits orbits_;
  Table table_;
  std::optional<RestFrame> frame_;
  std::vector<Vec3> wi_, wo_;
  std::size_t nodes_ = 0;
  std::atomic<std::uint64_t> walks_ = 0;
};

Table bake_factored(const Recipe& recipe, const SweepSettings& settings) {
  FactorResult result = walk_factors(recipe, settings.seed, settings.threads, settings.on_progress);
  Table table;
  table.material = recipe.material;
  table.symmetry = symmetry_of(recipe);
  table.factors = std::move(result.factors);
  table.info = info_of(recipe, Encoding::factored, settings.seed, result.walks, "pfmc-shared-legs");
  table.info["noise"] = to_text(result.relative_stderr);
  return table;
}

double cells_of(const std::vector<Axis>& axes) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  return cells;
}

double bytes_of(const NdArray& array) {
  return static_cast<double>(array.cells() * array.channels() *
                             (array.precision() == Precision::half_float ? 2 : 4));
}

// Without compression.
double bytes_of(const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    const Factors factors = factor_axes(recipe);
    return bytes_of(factors.arrival) + bytes_of(factors.returned) + bytes_of(factors.exchange);
  }
  const double value = recipe.table.precision == Precision::half_float ? 2 : 4;
  const double films = recipe.material.is_smooth() || recipe.table.frame == FrameKind::none ? 1 : 2;
  return (3 * value + 4) * cells_of(rest_axes(recipe)) + films * 3 * 4 * cells_of(film_axes(recipe));
}

}  // namespace

std::vector<Encoding> encodings_of(const Recipe& recipe) {
  if (recipe.table.encoding != Encoding::automatic) return {recipe.table.encoding};
  if (!has_factors(recipe.material)) return {Encoding::dense};
  if (bytes_of(recipe, Encoding::factored) < bytes_of(recipe, Encoding::dense))
    return {Encoding::factored, Encoding::dense};
  return {Encoding::dense, Encoding::factored};
}

const char* dense_method(const Recipe& recipe) {
  return is_solved(recipe) ? "adding-doubling" : name_of(recipe.accuracy.estimator);
}

void require_reasonable_size(const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    factor_axes(recipe);
    return;
  }
  constexpr double kMostCells = 1 << 28;  // four floats each: 4.3 GB
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

Table bake_table(const Recipe& recipe, Encoding encoding, const SweepSettings& settings) {
  if (encoding == Encoding::factored) return bake_factored(recipe, settings);
  return Sweep(recipe, settings).run();
}

Table bake_table(const Recipe& recipe, const SweepSettings& settings) {
  return bake_table(recipe, encodings_of(recipe).front(), settings);
}

}  // namespace sunbeam
