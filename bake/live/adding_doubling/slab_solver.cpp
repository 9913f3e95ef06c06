#include "bake/live/adding_doubling/slab_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bake/live/exact/resolvent.h"
#include "runtime/src/base/vector_clones.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/quadrature.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

constexpr double kThinLayer = 1e-7;  // optical thickness, so thin that even grazing light scatters once

// Terms until a share g^l is below `least`.
int terms_until(double least, double g) {
  return g == 0 ? 1 : 1 + static_cast<int>(std::ceil(std::log(least) / std::log(std::abs(g))));
}

// sqrt((l - mode)! / (l + mode)!) P_l^mode(x) for l from `mode` to `terms` - 1: of the addition theorem.
Vector legendre(int mode, int terms, double x) {
  Vector p;
  double first = 1;
  for (int k = 1; k <= mode; ++k) first *= std::sqrt((2 * k - 1) / (2.0 * k) * (1 - x * x));
  for (int l = mode; l < terms; ++l) {
    if (l == mode) {
      p.push_back(first);
      continue;
    }
    const double before = l == mode + 1 ? 0 : p[p.size() - 2] * std::sqrt(square(l - 1.0) - square(mode));
    p.push_back(((2 * l - 1) * x * p.back() - before) / std::sqrt(square(l) - square(mode)));
  }
  return p;
}

double sine_of(double cosine) { return std::sqrt(1 - square(cosine)); }

// (1 - exp(-x)) / x.
double mean_decay(double x) { return x > 0 ? -std::expm1(-x) / x : 1; }

// FacetList that a direction at `cosine` and azimuth 0 sees, on one side of its plane: calls visit(h, share).
template <class Visit>
void each_facet(const FilmGeometry& film, double cosine, const SlabSolver::Resolution& resolution,
                Visit visit) {
  if (film.is_smooth()) return visit(Vec3{0, 0, 1}, 1.0);
  const GaussRule cap =
      gauss_legendre(resolution.across);  // over t, 1 - t^2 the share of the cap: long tails
  const Vec3 w = direction_from_cosine(cosine, 0);
  for (int a = 0; a < resolution.around; ++a)
    for (int c = 0; c < cap.size(); ++c) {
      const double t = cap.node[c];
      visit(film.visible_normal(w, {(a + 0.5) / (2 * resolution.around), 1 - t * t}),
            2 * t * cap.weight[c] / resolution.around);
    }
}

// Panels crowd their nodes at the lower end, where what leaves at grazing bends.
void add_panel(double low, double high, int count, Vector& cosine, Vector& root) {
  const GaussRule rule = gauss_legendre(count);
  for (int k = 0; k < count; ++k) {
    const double x = rule.node[k], m = low + (high - low) * x * x;
    cosine.push_back(m);
    root.push_back(std::sqrt(2 * kPi * m * 2 * x * rule.weight[k] * (high - low)));
  }
}

walk::FilmPhases phases_at(std::span<const double> orders) {
  walk::FilmPhases phases;
  for (const double order : orders) phases.k[phases.count++] = kPi * order;
  return phases;
}

// One facet's part in the moments of every mode: sums by (mode, node, order), `power` by order.
SUNBEAM_VECTOR_CLONES
void add_facet(const double* even, const double* odd, int nodes, double azimuth, int modes,
               const double* power, int count, double* sums, std::size_t mode_stride) {
  double before = azimuth, moment = 1;  // cos((k - 1) phi), cos(k phi)
  for (int mode = 0; mode < modes; ++mode, sums += mode_stride) {
    const double* weight = mode % 2 == 0 ? even : odd;
    for (int i = 0; i < nodes; ++i) add_scaled(moment * weight[i], power, count, sums + i * count);
    const double next = 2 * azimuth * moment - before;
    before = moment;
    moment = next;
  }
}

// One mode of a film over a pigment: D for each column of `enters`, and sees . R D.
struct ModeResponse {
  Matrix down, slab;
};
SUNBEAM_FLAT_VECTOR_CLONES ModeResponse respond(const Matrix& back, const Matrix& r, Matrix enters,
                                                const Matrix& sees) {
  ModeResponse response{resolvent(multiply(back, r), std::move(enters)), {}};
  response.slab = multiply(multiply(sees, r), response.down);
  return response;
}

// Two of a layer of reflection r and transmission t.
SUNBEAM_FLAT_VECTOR_CLONES void double_layer(Matrix& r, Matrix& t) {
  const Matrix x = resolvent(multiply(r, r), t), tx = multiply(t, multiply(r, x));
  t = multiply(t, x);
  for (int i = 0; i < r.size(); ++i) add_scaled(1, tx.row(i), r.size(), r.row(i));
  symmetrise(r);
  symmetrise(t);
}

}  // namespace

std::vector<double> fringe_orders(double film_ior, double thickness_nm, const Wavelengths& wavelengths) {
  std::vector<double> orders;
  for (const double nm : wavelengths.nm) orders.push_back(2 * film_ior * thickness_nm / nm);
  return orders;
}

bool SlabSolver::solves(const Material& material) {
  return material.scatters() && material.roughness.is_isotropic() && !material.has_multiple_facets() &&
         material.absorption_path == AbsorptionPath::sum && std::abs(material.anisotropy) <= kMostForward;
}

SlabSolver::Nodes SlabSolver::make_nodes(const Material& material, const Resolution& resolution) {
  Nodes nodes;
  const double ratio = bending_index_ratio(material);
  const double critical = ratio < 1 ? std::sqrt(1 - square(ratio)) : 0;
  if (critical > 0) add_panel(0, critical, resolution.below, nodes.cosine, nodes.root);
  const int rest = critical > 0 ? resolution.above : resolution.below + resolution.above;
  add_panel(critical, 1, rest, nodes.cosine, nodes.root);
  for (const double m : nodes.cosine) nodes.sine.push_back(sine_of(m));
  return nodes;
}

// Of a function u: polynomials through x u over x = sqrt(m), for where both directions graze u is about
// 1 / (m + m').
SlabSolver::Nodes::Stencil SlabSolver::Nodes::at(double m) const {
  const auto above = std::upper_bound(cosine.begin(), cosine.end(), m) - cosine.begin();
  Stencil s{std::clamp(static_cast<int>(above) - kStencil / 2, 0, size() - kStencil), {}};
  const double x = std::sqrt(m);
  std::array<double, kStencil> node;
  for (int i = 0; i < kStencil; ++i) node[i] = std::sqrt(cosine[s.first + i]);
  for (int i = 0; i < kStencil; ++i) {
    s.weight[i] = node[i] / x;
    for (int j = 0; j < kStencil; ++j)
      if (j != i) s.weight[i] *= (x - node[j]) / (node[i] - node[j]);
  }
  return s;
}

SlabSolver::SlabSolver(const Material& material, std::vector<double> cosines, Resolution resolution)
    : material_(material),
      geometry_(material),
      film_(ThinFilm::of(material)),
      film_below_(ThinFilm::below(material)),
      cosines_(std::move(cosines)),
      resolution_(resolution),
      nodes_(make_nodes(material, resolution)),
      terms_(terms_until(square(resolution.least), material.anisotropy)),
      modes_(terms_until(resolution.least, material.anisotropy)) {
  for (const double c : cosines_) entry_.push_back(facets_of_entry(direction_from_cosine(c, 0)));
  for (int j = 0; j < nodes_.size(); ++j) thrown_back_.push_back(facets_thrown_back(j));
  modes_ = modes_above(resolution.faintest);
}

// Odd modes of whatever light meets hold the sine of m as a factor, which no polynomial in the cosine has.
SlabSolver::Facet SlabSolver::facet(double cosine, double share, const Vec3& on) const {
  const Nodes::Stencil at = nodes_.at(on.z);
  const double sine = std::hypot(on.x, on.y);
  Facet facet{std::min(cosine, 1.0), share, sine > 0 ? on.x / sine : 1, at.first, {}, {}};
  for (int i = 0; i < Nodes::kStencil; ++i) {
    const int to = at.first + i;
    facet.even[i] = at.weight[i] / nodes_.root[to];
    facet.odd[i] = facet.even[i] * sine / nodes_.sine[to];
  }
  return facet;
}

SlabSolver::FacetList SlabSolver::facets_of_entry(const Vec3& w) const {
  FacetList facets;
  each_facet(geometry_, w.z, resolution_, [&](const Vec3& h, double share) {
    if (const auto inside = geometry_.cross(w, h))
      facets.push_back(facet(dot(w, h), share * inside->share, inside->direction));
  });
  return facets;
}

SlabSolver::FacetList SlabSolver::facets_thrown_back(int from) const {
  const Vec3 u = direction_from_cosine(nodes_.cosine[from], 0);
  FacetList facets;
  each_facet(geometry_, u.z, resolution_, [&](const Vec3& h, double share) {
    if (const auto down = geometry_.mirror(u, h))
      facets.push_back(facet(dot(u, h), nodes_.root[from] * (share * down->share), down->direction));
  });
  return facets;
}

// Light scattered once leaves a pigment without a base as p(m, m') / (m + m').
int SlabSolver::modes_above(double faintest) const {
  if (faintest <= 0) return modes_;
  const std::array<double, 1> bare{0};
  const Fringes film(*this, bare);
  Matrix mean;
  for (int mode = 0; mode < modes_; ++mode) {
    Matrix once = phase(mode).backward;
    for (int i = 0; i < once.size(); ++i)
      for (int j = 0; j < once.size(); ++j)
        once.row(i)[j] *= nodes_.root[i] * nodes_.root[j] / (nodes_.cosine[i] + nodes_.cosine[j]);
    const Matrix &sees = film.modes_[0][mode].entry, left = multiply(multiply(sees, once), transposed(sees));
    if (mode == 0) mean = left;
    bool is_faint = true;
    for (int a = 0; a < left.size(); ++a)
      for (int b = 0; b < left.size(); ++b)
        is_faint = is_faint && std::abs(left.row(a)[b]) < faintest * mean.row(a)[b];
    if (is_faint) return mode;
  }
  return modes_;
}

void SlabSolver::add_depth(double depth) {
  {
    const std::lock_guard lock(mutex_);
    if (layers_.contains(depth)) return;
  }
  Layer layer = make_layer(depth);
  const std::lock_guard lock(mutex_);
  layers_.emplace(depth, std::move(layer));
}

SlabSolver::Layer SlabSolver::make_layer(double depth) const {
  Layer layer;
  for (int mode = 0; mode < modes_; ++mode) {
    Matrix r, t;
    double_up(mode, depth, r, t);
    layer.reflection.push_back(std::move(r));
    if (mode == 0) layer.transmission = std::move(t);
  }
  return layer;
}

SlabSolver::Phase SlabSolver::phase(int mode) const {
  const int n = nodes_.size();
  const double g = material_.anisotropy;
  std::vector<Vector> p;
  for (const double m : nodes_.cosine) p.push_back(legendre(mode, terms_, m));
  Phase phase{Matrix(n), Matrix(n)};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double power = std::pow(g, mode);
      for (std::size_t l = 0; l < p[i].size(); ++l, power *= g) {
        const int order = mode + static_cast<int>(l);
        const double term = (2 * order + 1) * kInvPi / 4 * power * p[i][l] * p[j][l];
        phase.forward.row(i)[j] += term;
        phase.backward.row(i)[j] += order % 2 == 0 ? term : -term;
      }
    }
  return phase;
}

void SlabSolver::double_up(int mode, double depth, Matrix& r, Matrix& t) const {
  const int n = nodes_.size();
  const double scattering = material_.scattering_depth(), whole = scattering + depth;
  const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(whole / kThinLayer))));
  const double thin = std::ldexp(whole, -doublings), albedo = scattering / whole;

  const Phase p = phase(mode);
  r = Matrix(n), t = Matrix(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      // One event: Int exp(-z/m) exp(-(z or thin - z)/m') dz / (m m').
      const double in = nodes_.cosine[i], out = nodes_.cosine[j];
      const double common = albedo * thin / (in * out) * nodes_.root[i] * nodes_.root[j];
      r.row(i)[j] = common * p.backward.row(i)[j] * mean_decay(thin * (1 / in + 1 / out));
      const double steep = std::max(in, out), flat = std::min(in, out);
      t.row(i)[j] =
          common * p.forward.row(i)[j] * std::exp(-thin / steep) * mean_decay(thin * (1 / flat - 1 / steep));
    }
  for (int i = 0; i < n; ++i) t.row(i)[i] += std::exp(-thin / nodes_.cosine[i]);
  for (int k = 0; k < doublings; ++k) double_layer(r, t);
}

std::vector<double> SlabSolver::transmittances(std::span<const double> orders, std::size_t cosine) const {
  const walk::FilmPhases phases = phases_at(orders);
  std::array<double, kMostWavelengths> reflectance;
  std::vector<double> sums(orders.size());
  for (const Facet& facet : entry_[cosine]) {
    walk::best_kernels().reflectances(film_, phases, facet.cosine, reflectance.data());
    for (std::size_t j = 0; j < sums.size(); ++j) sums[j] += facet.share * (1 - reflectance[j]);
  }
  return sums;
}

// By (mode, row, node, order).
std::vector<double> SlabSolver::moments(const std::vector<FacetList>& rows, sunbeam::Side side, Part part,
                                        const walk::FilmPhases& phases) const {
  const walk::Kernels& kernels = walk::best_kernels();
  const walk::FilmSide& film = side == sunbeam::Side::outside ? film_ : film_below_;
  const std::size_t row_size = nodes_.cosine.size() * phases.count, mode_size = rows.size() * row_size;
  std::vector<double> moments(modes_ * mode_size);
  FilmPowers powers;
  auto& power = part == Part::reflectance ? powers.reflectance : powers.transmittance;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (const Facet& facet : rows[row]) {
      walk::film_powers(kernels, film, phases, side, facet.cosine, powers);
      for (int j = 0; j < phases.count; ++j) power[j] *= facet.share;
      add_facet(facet.even.data(), facet.odd.data(), Nodes::kStencil, facet.azimuth, modes_, power.data(),
                phases.count, &moments[row * row_size + facet.first_node * phases.count], mode_size);
    }
  return moments;
}

SlabSolver::Fringes::Fringes(const SlabSolver& solver, std::span<const double> orders)
    : Fringes(solver, phases_at(orders)) {}

SlabSolver::Fringes::Fringes(const SlabSolver& solver, const walk::FilmPhases& phases) : solver_(solver) {
  const std::vector<double> entry =
      solver.moments(solver.entry_, sunbeam::Side::outside, Part::transmittance, phases);
  const std::vector<double> back =
      solver.moments(solver.thrown_back_, sunbeam::Side::inside, Part::reflectance, phases);
  const int n = solver.nodes_.size(), cosines = static_cast<int>(solver.cosines_.size());
  modes_.resize(phases.count, std::vector<Mode>(solver.modes_, {Matrix(cosines, n), Matrix(n)}));
  const double *e = entry.data(), *f = back.data();
  for (int mode = 0; mode < solver.modes_; ++mode) {
    for (int c = 0; c < cosines; ++c)
      for (int to = 0; to < n; ++to)
        for (auto& modes : modes_) modes[mode].entry.row(c)[to] = *e++;
    for (int from = 0; from < n; ++from)
      for (int to = 0; to < n; ++to)
        for (auto& modes : modes_) modes[mode].thrown_back.row(to)[from] = *f++;
  }
}

SlabSolver::Response SlabSolver::Fringes::response(std::size_t order, double depth) const {
  const auto found = solver_.layers_.find(depth);
  if (found == solver_.layers_.end())
    throw Error("slab solver: found an optical depth of " + to_text(depth) + " that was not added");
  const Layer& layer = found->second;
  const int n = solver_.nodes_.size(), cosines = static_cast<int>(solver_.cosines_.size());
  const double scale = solver_.material_.radiance_scale();
  Response response;
  for (int mode = 0; mode < solver_.modes_; ++mode) {
    // F, and E with what the base sends up, if anything does, as one more column.
    const bool has_base = mode == 0;
    const auto& [sees, back] = modes_[order][mode];
    Matrix enters(n, cosines + has_base);
    for (int c = 0; c < cosines; ++c)
      for (int to = 0; to < n; ++to) enters.row(to)[c] = sees.row(c)[to];
    Vector up;
    if (has_base) {
      up = multiply(solver_.nodes_.root, layer.transmission);  // times pi
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) enters.row(i)[cosines] += back.row(i)[j] * up[j];
    }
    const Matrix& r = layer.reflection[mode];
    ModeResponse found_mode = respond(back, r, std::move(enters), sees);
    if (has_base) {
      response.arrived = multiply(up, found_mode.down);
      response.returned =
          kInvPi * (dot(multiply(solver_.nodes_.root, r), solver_.nodes_.root) + response.arrived[cosines]);
      response.arrived.resize(cosines);
      for (double& power : response.arrived) power *= std::sqrt(scale * kInvPi);
    }
    Matrix slab(cosines);
    for (int a = 0; a < cosines; ++a)
      for (int b = 0; b < cosines; ++b)
        slab.row(a)[b] = scale * (mode == 0 ? 1 : 2) * found_mode.slab.row(a)[b];
    response.slab.push_back(std::move(slab));
  }
  return response;
}

SlabSolver::Fringes SlabSolver::fringes(double film_thickness_nm, const Wavelengths& wavelengths) const {
  Material material = material_;
  material.film_thickness_nm = film_thickness_nm;
  if (!is_layered(material, wavelengths))
    return {*this, fringe_orders(material.film_ior, film_thickness_nm, wavelengths)};
  const FilmCurves curves(material, wavelengths);
  walk::FilmPhases phases;
  phases.count = static_cast<int>(wavelengths.size());
  phases.curves = &curves;
  std::iota(phases.number.begin(), phases.number.end(), 0);
  return {*this, phases};
}

SlabSolver::Film::Film(const SlabSolver& solver, double film_thickness_nm, const Wavelengths& wavelengths)
    : wavelengths_(wavelengths), fringes_(solver.fringes(film_thickness_nm, wavelengths)) {}

SlabSolver::Film::Modes SlabSolver::Film::rest(double optical_depth) const {
  Modes modes;
  for (std::size_t j = 0; j < wavelengths_.size(); ++j) {
    const Response response = fringes_.response(j, optical_depth * wavelengths_.absorption[j]);
    const std::size_t cosines = response.arrived.size();
    modes.cosines_ = cosines;
    modes.mode_.resize(response.slab.size(), std::vector<Rgb>(cosines * cosines));
    for (std::size_t mode = 0; mode < modes.mode_.size(); ++mode)
      for (std::size_t a = 0; a < cosines; ++a)
        for (std::size_t b = 0; b < cosines; ++b) {
          const double base = mode == 0 ? response.base(a, b, wavelengths_.albedo[j]) : 0;
          modes.mode_[mode][a * cosines + b] +=
              (response.slab[mode].row(static_cast<int>(a))[b] + base) * wavelengths_.weight[j];
        }
  }
  return modes;
}

Rgb SlabSolver::Film::Modes::at(std::size_t a, std::size_t b, double azimuth) const {
  Rgb sum;
  for (std::size_t mode = 0; mode < mode_.size(); ++mode)
    sum += std::cos(static_cast<double>(mode) * azimuth) * mode_[mode][a * cosines_ + b];
  return sum;
}

}  // namespace sunbeam
