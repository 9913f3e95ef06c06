#include "bake/live/adding_doubling/slab_films.h"

#include <limits>
#include <set>

#include "runtime/src/base/vector_clones.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr double kFaintest = 1e-5;   // SlabSolver::Resolution
constexpr double kDepthStep = 0.05;  // of the root of a depth
constexpr double kFringeError =
    2e-5;  // of the film's transmittance between nodes, relative, mean of a fringe
constexpr int kMostTerms = EvenSamples::kStencil * EvenSamples::kStencil;
constexpr std::size_t kOrdersTogether = 16;  // of a single film, solved as one task

// Time that a depth and an order take before anything is solved with them, in responses.
constexpr double kDepthCost = 70, kOrderCost = 5;

SlabSolver::Resolution resolution() {
  SlabSolver::Resolution r;
  r.faintest = kFaintest;
  return r;
}

// Nodes a fringe that the film asks for; 0 if no number is enough. Told by its transmittance from order 0,
// where all facets are in phase, to 1.
int nodes_per_fringe(const SlabSolver& solver, std::size_t cosines) {
  constexpr int kFine = 768;
  constexpr std::array kChoices{8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256};
  std::vector<double> orders;
  for (int k = 0; k <= kFine * 3 / 2; ++k) orders.push_back(static_cast<double>(k) / kFine);
  std::size_t choice = 0;
  for (std::size_t c = 0; c < cosines && choice < kChoices.size(); ++c) {
    std::vector<double> fine;
    for (std::size_t first = 0; first < orders.size(); first += kMostWavelengths)
      for (const double t : solver.transmittances(
               std::span(orders).subspan(first, std::min(kMostWavelengths, orders.size() - first)), c))
        fine.push_back(t);
    const auto error = [&](int nodes) {
      const EvenSamples samples(1.0 / nodes, 1);
      double sum = 0, difference = 0;
      for (int k = 0; k < kFine; ++k) {
        const EvenSamples::Stencil at = samples.at(orders[k]);
        double value = 0;
        for (int i = 0; i < at.count; ++i) value += at.weight[i] * fine[at.node[i] * (kFine / nodes)];
        sum += fine[k];
        difference += std::abs(value - fine[k]);
      }
      return difference / sum;
    };
    while (choice < kChoices.size() && error(kChoices[choice]) > kFringeError) ++choice;
  }
  return choice < kChoices.size() ? kChoices[choice] : 0;
}

std::vector<double> sorted(const std::set<double>& values) { return {values.begin(), values.end()}; }

// sum += weight[k] response[k] over `count` responses of `size` numbers.
SUNBEAM_VECTOR_CLONES
void add_responses(const double* weight, const double* const* response, int count, int size,
                   double* __restrict sum) {
  int k = 0;
  // Four terms for each time a sum is fetched and put back.
  for (; k + 4 <= count; k += 4) {
    const double w0 = weight[k], w1 = weight[k + 1], w2 = weight[k + 2], w3 = weight[k + 3];
    const double *x0 = response[k], *x1 = response[k + 1], *x2 = response[k + 2], *x3 = response[k + 3];
    for (int j = 0; j < size; ++j) sum[j] = sum[j] + w0 * x0[j] + w1 * x1[j] + w2 * x2[j] + w3 * x3[j];
  }
  for (; k < count; ++k) add_scaled(weight[k], response[k], size, sum);
}

// sum[c] += weight[c] values, per channel.
SUNBEAM_VECTOR_CLONES
void fold(const Rgb& weight, const double* values, int count, double* r, double* g, double* b) {
  for (int k = 0; k < count; ++k) {
    r[k] += weight.r * values[k];
    g[k] += weight.g * values[k];
    b[k] += weight.b * values[k];
  }
}

}  // namespace

SlabFilms::SlabFilms(const Material& material, const Wavelengths& wavelengths, Grid grid)
    : grid_(std::move(grid)),
      wavelengths_(wavelengths),
      is_layered_(is_layered(material, wavelengths)),
      film_ior_(material.film_ior),
      pigment_thickness_nm_(material.pigment_thickness_nm),
      solver_(material, grid_.cosine, resolution()),
      nodes_(choose_nodes()),
      response_(nodes_.order.size() * nodes_.root_depth.size()) {
  for (int mode = 0; mode < solver_.modes(); ++mode) {
    cos_.emplace_back();
    for (const double azimuth : grid_.azimuth) cos_.back().push_back(std::cos(mode * azimuth));
  }
}

std::vector<double> SlabFilms::orders(std::size_t thickness) const {
  if (!is_layered_) return fringe_orders(film_ior_, grid_.film_thickness_nm[thickness], wavelengths_);
  std::vector<double> numbers;
  for (std::size_t j = 0; j < wavelengths_.size(); ++j)
    numbers.push_back(static_cast<double>(thickness * wavelengths_.size() + j));
  return numbers;
}

// Those of a layered film are all of one thickness.
SlabSolver::Fringes SlabFilms::fringes(std::span<const std::size_t> orders) const {
  if (is_layered_)
    return solver_.fringes(grid_.film_thickness_nm[orders.front() / wavelengths_.size()], wavelengths_);
  std::vector<double> order;
  for (const std::size_t o : orders) order.push_back(nodes_.order[o]);
  return {solver_, order};
}

double SlabFilms::root_depth(std::size_t absorption, std::size_t wavelength) const {
  return std::sqrt(grid_.absorption_per_nm[absorption] * pigment_thickness_nm_ *
                   wavelengths_.absorption[wavelength]);
}

SlabFilms::Nodes SlabFilms::choose_nodes() const {
  std::set<double> all_orders, roots;
  for (std::size_t t = 0; t < grid_.film_thickness_nm.size(); ++t)
    for (const double order : orders(t)) all_orders.insert(order);
  for (std::size_t a = 0; a < grid_.absorption_per_nm.size(); ++a)
    for (std::size_t j = 0; j < wavelengths_.size(); ++j) roots.insert(root_depth(a, j));
  std::vector<EvenSamples> order_choices{EvenSamples(sorted(all_orders))},
      root_choices{EvenSamples(sorted(roots)), {kDepthStep, *roots.rbegin()}};
  if (const int nodes = is_layered_ ? 0 : nodes_per_fringe(solver_, grid_.cosine.size()))
    order_choices.emplace_back(1.0 / nodes, *all_orders.rbegin());
  Nodes best{order_choices.front(), root_choices.front()};
  double least = std::numeric_limits<double>::infinity();
  for (const EvenSamples& order : order_choices)
    for (const EvenSamples& root : root_choices) {
      const Nodes nodes{order, root};
      const double taken = cost(nodes);
      if (taken < least) best = nodes, least = taken;
    }
  return best;
}

// Calls visit(o, d) for every pair of nodes that these thicknesses need, more than once.
template <class Visit>
void SlabFilms::each_pair(const Nodes& nodes, std::size_t first, std::size_t last, Visit visit) const {
  for (std::size_t j = 0; j < wavelengths_.size(); ++j) {
    std::set<std::size_t> depths;
    for (std::size_t a = 0; a < grid_.absorption_per_nm.size(); ++a) {
      const EvenSamples::Stencil at = nodes.root_depth.at(root_depth(a, j));
      depths.insert(at.node.begin(), at.node.begin() + at.count);
    }
    for (std::size_t t = first; t < last; ++t) {
      const EvenSamples::Stencil at = nodes.order.at(orders(t)[j]);
      for (int i = 0; i < at.count; ++i)
        for (const std::size_t d : depths) visit(at.node[i], d);
    }
  }
}

std::vector<bool> SlabFilms::needed(const Nodes& nodes, std::size_t first, std::size_t last) const {
  std::vector<bool> pairs(nodes.order.size() * nodes.root_depth.size());
  each_pair(nodes, first, last, [&](std::size_t o, std::size_t d) { pairs[nodes.pair(o, d)] = true; });
  return pairs;
}

double SlabFilms::cost(const Nodes& nodes) const {
  const std::vector<bool> pairs = needed(nodes, 0, grid_.film_thickness_nm.size());
  return static_cast<double>(std::count(pairs.begin(), pairs.end(), true)) +
         kDepthCost * static_cast<double>(nodes.root_depth.size()) +
         kOrderCost * static_cast<double>(nodes.order.size());
}

void SlabFilms::prepare(std::size_t first, std::size_t last, const ForEach& for_each) {
  const std::vector<bool> pairs = needed(nodes_, first, last);
  std::vector<std::vector<std::size_t>> missing(nodes_.order.size());  // depths by order
  std::set<double> depths;
  for (std::size_t o = 0; o < nodes_.order.size(); ++o)
    for (std::size_t d = 0; d < nodes_.root_depth.size(); ++d)
      if (pairs[nodes_.pair(o, d)] && response_[nodes_.pair(o, d)].empty()) {
        missing[o].push_back(d);
        depths.insert(square(nodes_.root_depth[d]));
      }
  const std::vector<double> each_depth = sorted(depths);
  for_each(each_depth.size(), [&](std::size_t k) { solver_.add_depth(each_depth[k]); });

  std::vector<std::size_t> unsolved;
  for (std::size_t o = 0; o < missing.size(); ++o)
    if (!missing[o].empty()) unsolved.push_back(o);
  const std::size_t at_once = is_layered_ ? wavelengths_.size() : kOrdersTogether;
  for_each((unsolved.size() + at_once - 1) / at_once, [&](std::size_t task) {
    const std::size_t start = task * at_once;
    const auto together = std::span(unsolved).subspan(start, std::min(at_once, unsolved.size() - start));
    const SlabSolver::Fringes films = fringes(together);
    for (std::size_t k = 0; k < together.size(); ++k)
      for (const std::size_t d : missing[together[k]])
        response_[nodes_.pair(together[k], d)] = flatten(films.response(k, square(nodes_.root_depth[d])));
  });
}

// Light may be reversed: one value for a pair of cosines, the mean of both ways.
std::vector<double> SlabFilms::flatten(const SlabSolver::Response& response) const {
  const int cosines = static_cast<int>(grid_.cosine.size());
  std::vector<double> values;
  for (int a = 0; a < cosines; ++a)
    for (int b = 0; b <= a; ++b)
      for (std::size_t phi = 0; phi < grid_.azimuth.size(); ++phi) {
        double sum = 0;
        for (std::size_t mode = 0; mode < response.slab.size(); ++mode)
          sum += cos_[mode][phi] * (response.slab[mode].row(a)[b] + response.slab[mode].row(b)[a]) / 2;
        values.push_back(sum);
      }
  values.insert(values.end(), response.arrived.begin(), response.arrived.end());
  values.push_back(response.returned);
  return values;
}

void SlabFilms::rest(std::size_t thickness, std::size_t absorption, std::span<Rgb> values) const {
  const std::size_t cosines = grid_.cosine.size(), azimuths = grid_.azimuth.size();
  const std::size_t slab_cells = cosines * (cosines + 1) / 2 * azimuths;
  const auto size = static_cast<int>(slab_cells + cosines + 1);
  std::vector<double> spectral(size), r(slab_cells), g(slab_cells), b(slab_cells);
  const std::vector<double> order_of = orders(thickness);
  for (std::size_t j = 0; j < wavelengths_.size(); ++j) {
    const EvenSamples::Stencil order = nodes_.order.at(order_of[j]),
                               depth = nodes_.root_depth.at(root_depth(absorption, j));
    std::array<double, kMostTerms> weight;
    std::array<const double*, kMostTerms> response;
    int terms = 0;
    for (int o = 0; o < order.count; ++o)
      for (int d = 0; d < depth.count; ++d, ++terms) {
        const std::vector<double>& solved = response_[nodes_.pair(order.node[o], depth.node[d])];
        if (solved.empty())
          throw Error("slab films: found thickness node " + std::to_string(thickness) +
                      " that was not prepared");
        weight[terms] = order.weight[o] * depth.weight[d];
        response[terms] = solved.data();
      }
    std::fill(spectral.begin(), spectral.end(), 0.0);
    add_responses(weight.data(), response.data(), terms, size, spectral.data());
    SlabSolver::Response base;
    base.arrived.assign(spectral.begin() + static_cast<std::ptrdiff_t>(slab_cells), spectral.end() - 1);
    base.returned = spectral.back();
    double* cell = spectral.data();
    for (std::size_t a = 0; a < cosines; ++a)
      for (std::size_t c = 0; c <= a; ++c) {
        const double diffuse = base.base(a, c, wavelengths_.albedo[j]);
        for (std::size_t phi = 0; phi < azimuths; ++phi) *cell++ += diffuse;
      }
    fold(wavelengths_.weight[j], spectral.data(), static_cast<int>(slab_cells), r.data(), g.data(), b.data());
  }
  for (std::size_t i = 0; i < cosines; ++i)
    for (std::size_t o = 0; o < cosines; ++o) {
      const std::size_t high = std::max(i, o), pair = high * (high + 1) / 2 + std::min(i, o);
      for (std::size_t phi = 0; phi < azimuths; ++phi) {
        const std::size_t cell = pair * azimuths + phi;
        values[(i * cosines + o) * azimuths + phi] = {r[cell], g[cell], b[cell]};
      }
    }
}

std::size_t SlabFilms::responses() const {
  const std::vector<bool> pairs = needed(nodes_, 0, grid_.film_thickness_nm.size());
  return static_cast<std::size_t>(std::count(pairs.begin(), pairs.end(), true));
}

}  // namespace sunbeam
