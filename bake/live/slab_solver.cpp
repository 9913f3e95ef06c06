#include "bake/live/slab_solver.h"

#include <algorithm>
#include <cmath>

#include "bake/live/microsurface.h"
#include "bake/optics/quadrature.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"

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

// Facets that a direction at `cosine` and azimuth 0 sees, on one side of its plane: calls visit(h, share).
template <class Visit>
void each_facet(const Ggx& ggx, bool is_smooth, double cosine, const SlabSolver::Resolution& resolution,
                Visit visit) {
  if (is_smooth) return visit(Vec3{0, 0, 1}, 1.0);
  const GaussRule cap =
      gauss_legendre(resolution.across);  // over t, 1 - t^2 the share of the cap: long tails
  const Vec3 w = direction_from_cosine(cosine, 0);
  for (int a = 0; a < resolution.around; ++a)
    for (int c = 0; c < cap.size(); ++c) {
      const double t = cap.node[c];
      visit(ggx.sample_visible(w, {(a + 0.5) / (2 * resolution.around), 1 - t * t}),
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

}  // namespace

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
      cosines_(std::move(cosines)),
      resolution_(resolution),
      nodes_(make_nodes(material, resolution)),
      modes_(terms_until(resolution.least, material.anisotropy)),
      terms_(terms_until(square(resolution.least), material.anisotropy)) {}

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

void SlabSolver::double_up(int mode, double depth, Matrix& r, Matrix& t) const {
  const int n = nodes_.size();
  const double scattering = material_.scattering_depth(), g = material_.anisotropy;
  const double whole = scattering + depth;
  const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(whole / kThinLayer))));
  const double thin = std::ldexp(whole, -doublings), albedo = scattering / whole;

  std::vector<Vector> p;
  for (const double m : nodes_.cosine) p.push_back(legendre(mode, terms_, m));
  r = Matrix(n), t = Matrix(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double forward = 0, backward = 0, power = std::pow(g, mode);
      for (std::size_t l = 0; l < p[i].size(); ++l, power *= g) {
        const int order = mode + static_cast<int>(l);
        const double term = (2 * order + 1) * kInvPi / 4 * power * p[i][l] * p[j][l];
        forward += term;
        backward += order % 2 == 0 ? term : -term;
      }
      // One event: Int exp(-z/m) exp(-(z or thin - z)/m') dz / (m m').
      const double in = nodes_.cosine[i], out = nodes_.cosine[j];
      const double common = albedo * thin / (in * out) * nodes_.root[i] * nodes_.root[j];
      r.row(i)[j] = common * backward * mean_decay(thin * (1 / in + 1 / out));
      const double steep = std::max(in, out), flat = std::min(in, out);
      t.row(i)[j] = common * forward * std::exp(-thin / steep) * mean_decay(thin * (1 / flat - 1 / steep));
    }
  for (int i = 0; i < n; ++i) t.row(i)[i] += std::exp(-thin / nodes_.cosine[i]);

  for (int k = 0; k < doublings; ++k) {
    const Matrix x = solve(one_minus(multiply(r, r)), t), tx = multiply(t, multiply(r, x));
    t = multiply(t, x);
    for (int i = 0; i < n; ++i) add_scaled(1, tx.row(i), n, r.row(i));
    symmetrise(r);
    symmetrise(t);
  }
}

SlabSolver::Film::Film(const SlabSolver& solver, double film_thickness_nm, const Wavelengths& wavelengths)
    : solver_(solver), wavelengths_(wavelengths), count_(static_cast<int>(wavelengths.size())) {
  Material material = solver.material_;
  material.film_thickness_nm = film_thickness_nm;
  const walk::Layers layers(material, wavelengths);
  const walk::Kernels& kernels = walk::best_kernels();
  const Nodes& nodes = solver.nodes_;
  const int n = nodes.size(), modes = solver.modes_, cosines = static_cast<int>(solver.cosines_.size());
  const Ggx ggx(material.roughness);
  std::array<double, kMostWavelengths> power;

  // Adds `power` of light that goes on along m to the moments of row `from` out of `rows`. Odd modes of
  // whatever it meets hold the sine of m as a factor, which no polynomial in the cosine has.
  const auto add = [&](const Vec3& m, int from, int rows, std::vector<double>& moments) {
    const Nodes::Stencil at = nodes.at(m.z);
    const double sine = std::hypot(m.x, m.y), turn = sine > 0 ? m.x / sine : 1;
    double before = turn, moment = 1;  // cos((k - 1) phi), cos(k phi)
    for (int mode = 0; mode < modes; ++mode) {
      for (int i = 0; i < Nodes::kStencil; ++i) {
        const int to = at.first + i;
        const double sines = mode % 2 == 1 ? sine / sine_of(nodes.cosine[to]) : 1;
        double* sum = &moments[static_cast<std::size_t>((mode * rows + from) * n + to) * count_];
        add_scaled(moment * sines * at.weight[i] / nodes.root[to], power.data(), count_, sum);
      }
      const double next = 2 * turn * moment - before;
      before = moment;
      moment = next;
    }
  };

  entry_.resize(static_cast<std::size_t>(modes * cosines * n) * count_);
  for (int c = 0; c < cosines; ++c) {
    const Vec3 w = direction_from_cosine(solver.cosines_[c], 0);
    each_facet(ggx, layers.is_smooth(), w.z, solver.resolution_, [&](const Vec3& h, double share) {
      Vec3 m = w;
      if (layers.bends && (!walk::refract(w, h, layers.index_ratio, m) || m.z <= 0)) return;
      const double passes = layers.straight || layers.is_smooth() ? 1 : ggx.g2_over_g1(w, m);
      kernels.reflectances(layers.film, layers.phases, std::min(dot(w, h), 1.0), power.data());
      for (int j = 0; j < count_; ++j) power[j] = (1 - power[j]) * share * passes;
      add(m, c, cosines, entry_);
    });
  }
  thrown_back_.resize(static_cast<std::size_t>(modes * n * n) * count_);
  for (int from = 0; from < n; ++from) {
    const Vec3 u = direction_from_cosine(nodes.cosine[from], 0);
    each_facet(ggx, layers.is_smooth(), u.z, solver.resolution_, [&](const Vec3& h, double share) {
      const Vec3 m = reflect(u, h);
      if (m.z <= 0) return;
      const double kept = nodes.root[from] * share * (layers.is_smooth() ? 1 : ggx.g2_over_g1(u, m));
      kernels.reflectances(layers.film_below, layers.phases, std::min(dot(u, h), 1.0), power.data());
      for (int j = 0; j < count_; ++j) power[j] *= kept;
      add(m, from, n, thrown_back_);
    });
  }
}

SlabSolver::Film::Modes SlabSolver::Film::rest(double optical_depth) const {
  Modes modes;
  modes.cosines_ = solver_.cosines_.size();
  modes.mode_.assign(solver_.modes_, std::vector<Rgb>(modes.cosines_ * modes.cosines_));
  for (int j = 0; j < count_; ++j) add_wavelength(j, optical_depth * wavelengths_.absorption[j], modes);
  return modes;
}

void SlabSolver::Film::add_wavelength(std::size_t wavelength, double depth, Modes& modes) const {
  const auto found = solver_.layers_.find(depth);
  if (found == solver_.layers_.end())
    throw Error("slab solver: found an optical depth of " + to_text(depth) + " that was not added");
  const Layer& layer = found->second;
  const int n = solver_.nodes_.size(), cosines = static_cast<int>(modes.cosines_);
  const double scale = solver_.material_.radiance_scale(), kd = wavelengths_.albedo[wavelength];
  for (int mode = 0; mode < solver_.modes_; ++mode) {
    // F, and E with what the base sends up, if anything does, as one more column.
    const bool has_base = mode == 0;
    Matrix back(n), enters(n, cosines + has_base), sees(cosines, n);
    for (int from = 0; from < n; ++from)
      for (int to = 0; to < n; ++to)
        back.row(to)[from] =
            thrown_back_[static_cast<std::size_t>((mode * n + from) * n + to) * count_ + wavelength];
    for (int c = 0; c < cosines; ++c)
      for (int to = 0; to < n; ++to)
        sees.row(c)[to] = enters.row(to)[c] =
            entry_[static_cast<std::size_t>((mode * cosines + c) * n + to) * count_ + wavelength];
    Vector up;
    if (has_base) {
      up = multiply(solver_.nodes_.root, layer.transmission);  // times pi
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) enters.row(i)[cosines] += back.row(i)[j] * up[j];
    }
    const Matrix& r = layer.reflection[mode];
    const Matrix down = solve(one_minus(multiply(back, r)), std::move(enters));
    const Matrix value = multiply(multiply(sees, r), down);
    Vector arrived;
    double visits = 0;
    if (has_base) {
      arrived = multiply(up, down);
      const double returned =
          kInvPi * (dot(multiply(solver_.nodes_.root, r), solver_.nodes_.root) + arrived[cosines]);
      visits = kd * kInvPi / (1 - kd * returned);
    }
    const double factor = scale * (mode == 0 ? 1 : 2);
    for (int a = 0; a < cosines; ++a)
      for (int b = 0; b < cosines; ++b) {
        const double base = has_base ? visits * arrived[a] * arrived[b] : 0;
        modes.mode_[mode][a * cosines + b] +=
            factor * (value.row(a)[b] + base) * wavelengths_.weight[wavelength];
      }
  }
}

Rgb SlabSolver::Film::Modes::at(std::size_t a, std::size_t b, double azimuth) const {
  Rgb sum;
  for (std::size_t mode = 0; mode < mode_.size(); ++mode)
    sum += std::cos(static_cast<double>(mode) * azimuth) * mode_[mode][a * cosines_ + b];
  return sum;
}

}  // namespace sunbeam
