#include "bake/factor_walks.h"

#include <fmt/format.h>

#include "bake/live/dense.h"
#include "bake/live/film_interface.h"
#include "bake/optics/fringes.h"
#include "bake/parallel_tasks.h"
#include "sunbeam/core/error.h"
#include "sunbeam/table.h"

namespace sunbeam {
namespace {

constexpr double kNodesPerFringe = 10;              // of arrival and returned: cubic to 4e-4 of a fringe
constexpr double kExchangeNodesPerFringe = 3;       // most of exchange has no fringes
constexpr double kMoreNodesPerFringeOverWhite = 8;  // 3 alone would be off by 1 % of the albedo there
constexpr std::size_t kLeastFringeNodes = 6;
constexpr std::size_t kAlbedoNodes = 3;           // where wavelengths differ; the series in kd converges fast
constexpr std::size_t kDepthNodesOfOneValue = 5;  // where only wavelengths make depths differ
constexpr double kLowestCosine = 1e-3;
constexpr std::size_t kReplicates = 4;    // independent estimates, whose spread is the noise
constexpr std::size_t kFacetStrata = 64;  // each way, of a replicate
constexpr std::size_t kUpStrata = 64;     // over the base's cosine^2, with kReturnStrata facets each way
constexpr std::size_t kReturnStrata = 16;
constexpr std::size_t kSmoothUpStrata = 4096;
constexpr int kCosineNodes = 64;  // m_a of "product"
constexpr double kMostCells = 1 << 28;

// Where light is and how much of it, film and pigment aside.
struct Leg {
  double facet_cosine;  // with the film's facet, on the side it is met from
  double from, to;      // cosines: base side; `from` only of a return
  double weight;
};

bool passes_straight_on(const Material& m) { return m.is_smooth() || bending_index_ratio(m) == 1; }

class Legs {
 public:
  explicit Legs(const Material& material)
      : material_(material), film_(material, Rgb(550)), ggx_(material.roughness) {}

  // From outside along w to the base; the weights of a replicate add up to the share of w that facets let by.
  template <class Visit>
  void visit_arrivals(const Vec3& w, Rng rng, Visit visit) const {
    const std::size_t strata = material_.is_smooth() ? 1 : kFacetStrata;
    const double share = 1 / static_cast<double>(strata * strata);
    for (std::size_t k = 0; k < strata * strata; ++k) {
      const Vec3 h = normal(w, stratum(k, strata, rng));
      const auto crossing = film_.cross(w, {h, {Rgb(0), Rgb(1)}, 0});
      if (crossing) visit(Leg{std::min(dot(w, h), 1.0), 0, crossing->inside.z, share * crossing->weight.r});
    }
  }

  // From the base, along its cosine law, to the film and back.
  template <class Visit>
  void visit_returns(Rng rng, Visit visit) const {
    const std::size_t up = material_.is_smooth() ? kSmoothUpStrata : kUpStrata;
    const std::size_t strata = material_.is_smooth() ? 1 : kReturnStrata;
    const double share = 1 / static_cast<double>(up * strata * strata);
    for (std::size_t i = 0; i < up; ++i)
      for (std::size_t k = 0; k < strata * strata; ++k) {
        const double cosine =
            std::sqrt((static_cast<double>(i) + 1 - rng.uniform()) / static_cast<double>(up));
        const Vec3 m = direction_from_cosine(cosine, 2 * kPi * rng.uniform());
        const Vec3 h = normal(m, stratum(k, strata, rng));
        const auto mirrored = film_.reflect_down(m, {h, {Rgb(1), Rgb(0)}, 1});
        if (mirrored)
          visit(Leg{std::min(dot(m, h), 1.0), m.z, mirrored->direction.z, share * mirrored->weight.r});
      }
  }

 private:
  static Point2 stratum(std::size_t k, std::size_t strata, Rng& rng) {
    const auto n = static_cast<double>(strata);
    const double u = rng.uniform(), v = rng.uniform();
    return {(static_cast<double>(k % strata) + u) / n, (static_cast<double>(k / strata) + v) / n};
  }
  Vec3 normal(const Vec3& w, const Point2& u) const {
    return material_.is_smooth() ? Vec3{0, 0, 1} : ggx_.sample_visible(w, u);
  }

  const Material& material_;
  FilmInterface film_;
  Ggx ggx_;
};

// Powers of one film at all nodes of a fringe axis.
class FringePowers {
 public:
  // `order` is the fringe order of a film of one wavelength's thickness.
  FringePowers(const ThinFilm& film, const Axis& orders, double order)
      : film_(film), first_(orders.low() / order), reflectance(orders.size()), transmittance(orders.size()) {
    if (orders.size() > 1) step_ = (orders.nodes[1] - orders.nodes[0]) / order;
  }
  void at(double cosine) { film_fringes(film_, cosine, first_, step_, reflectance, transmittance); }

 private:
  ThinFilm film_;
  double first_, step_ = 0;

 public:
  std::vector<double> reflectance, transmittance;
};

Axis cubic(Axis axis) {
  axis.is_cubic = axis.size() > 2;
  return axis;
}

Axis orders_axis(const Recipe& recipe, const Wavelengths& w, double least_cosine, double per_fringe) {
  const auto [shortest, longest] = std::minmax_element(w.nm.begin(), w.nm.end());
  const double low = fringe_order(recipe.material, least_cosine) * recipe.grid[0].low() / *longest;
  const double high = fringe_order(recipe.material, 1) * recipe.grid[0].high() / *shortest;
  Axis axis{"fringe_order", "1", {low}};
  if (high > low) {
    const auto count =
        std::max(kLeastFringeNodes, static_cast<std::size_t>(std::ceil((high - low) * per_fringe)) + 1);
    const double step = (high - low) / static_cast<double>(count - 1);
    axis.nodes = spaced_nodes(low, high + step, count + 1);  // one beyond: a cubic is best inside its nodes
  }
  return cubic(axis);
}

// Later visits carry the fringes, and their series ends the later the brighter the base.
double exchange_nodes_per_fringe(const Wavelengths& w) {
  return kExchangeNodesPerFringe +
         kMoreNodesPerFringeOverWhite * square(*std::max_element(w.albedo.begin(), w.albedo.end()));
}

Axis depths_axis(const Recipe& recipe, const Wavelengths& w) {
  const Axis& absorption = recipe.grid[2];
  const auto [least, most] = std::minmax_element(w.absorption.begin(), w.absorption.end());
  const double thickness = recipe.material.pigment_thickness_nm;
  const double low = absorption.low() * thickness * *least, high = absorption.high() * thickness * *most;
  Axis axis{"optical_depth", "1", {low}, 3};
  const std::size_t count = absorption.size() > 1 ? absorption.size() : kDepthNodesOfOneValue;
  if (high > low) axis.nodes = spaced_nodes(low, high, count, axis.power);
  return cubic(axis);
}

Axis albedos_axis(const Wavelengths& w) {
  const auto [least, most] = std::minmax_element(w.albedo.begin(), w.albedo.end());
  Axis axis{"albedo", "1", {*least}};
  constexpr double kSameAlbedo = 1e-6;  // as good as grey
  if (*most - *least > kSameAlbedo) axis.nodes = spaced_nodes(*least, *most, kAlbedoNodes);
  return cubic(axis);
}

std::vector<Axis> direction_axes(const Recipe& recipe, const std::string& suffix) {
  const auto cosines = spaced_nodes(kLowestCosine, 1, static_cast<std::size_t>(recipe.table.angles), 2);
  Axis phi{"phi" + suffix, "rad", {0}};
  if (!recipe.material.roughness.is_isotropic())
    phi.nodes = spaced_nodes(0, kPi / 2, static_cast<std::size_t>(recipe.table.azimuths) / 4 + 1);
  return {cubic({"cos_theta" + suffix, "1", cosines, 2}), cubic(phi)};
}

NdArray checked_array(const Recipe& recipe, const char* name, const std::vector<Axis>& axes,
                      Precision precision) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  if (cells > kMostCells)
    throw Error(fmt::format("{}: [grid] and [table] ask for {:.3g} cells of '{}'; allowed: up to {:.3g}",
                            recipe.name, cells, name, kMostCells));
  return NdArray(name, axes, precision, 1);
}

class FactorWalks {
 public:
  FactorWalks(const Recipe& recipe, std::uint64_t seed) : recipe_(recipe), seed_(seed) {
    result_.factors = factor_axes(recipe);
    const auto axes = direction_axes(recipe, "");
    for (const double c : axes[0].nodes)
      for (const double phi : axes[1].nodes) directions_.push_back(direction_from_cosine(c, phi));
    const Axis& cosines = cosine_nodes_;
    depths_ = (factors().returned.empty() ? factors().exchange : factors().returned).axes()[1];
    for (const double depth : depths_.nodes) {
      Matrix f(kCosineNodes);
      for (int a = 0; a < kCosineNodes; ++a)
        for (int b = 0; b < kCosineNodes; ++b)
          f.row(a)[b] = std::exp(-depth / (cosines.nodes[a] * cosines.nodes[b]));
      attenuation_.push_back(f);
    }
  }

  FactorResult run(int threads, const std::function<void(double)>& on_progress) {
    const std::size_t iors = recipe_.grid[1].size(), directions = directions_.size();
    std::vector<double> variances(iors * directions), legs(iors * (directions + 1));
    const bool rough = !recipe_.material.is_smooth();
    const auto part = [&](double from, double to) {
      return [=](double fraction) {
        if (on_progress) on_progress(from + (to - from) * fraction);
      };
    };
    if (rough)
      run_parallel_tasks(iors * directions, threads, part(0, 0.5), [&](std::size_t task) {
        variances[task] = walk_arrival(task / directions, task % directions, legs[task]);
      });
    run_parallel_tasks(iors, threads, part(0.5, 1), [&](std::size_t ior) {
      double& count = legs[iors * directions + ior];
      factors().returned.empty() ? walk_exchange(ior, count) : walk_returned(ior, count);
    });
    double variance = 0, walks = 0;
    for (const double v : variances) variance += v / static_cast<double>(variances.size());
    for (const double n : legs) walks += n;
    result_.relative_stderr = std::sqrt(2 * variance);
    result_.walks = static_cast<std::uint64_t>(walks);
    return std::move(result_);
  }

 private:
  Factors& factors() { return result_.factors; }

  Material material_at(std::size_t ior) const {
    Material material = recipe_.material;
    material.base_ior = recipe_.grid[1].nodes[ior];
    return material;
  }

  // One random stream a direction and replicate, and others for returns: the same at every base IOR.
  Rng rng_of(std::size_t stream, std::size_t replicate) const {
    return Rng(seed_, stream * kReplicates + replicate);
  }

  // A at (depth, order), row-major, of one replicate.
  std::vector<double> arrivals(const Legs& legs, const Axis& depths, FringePowers& powers,
                               std::size_t direction, std::size_t replicate, double& count) const {
    const std::size_t orders = powers.transmittance.size();
    std::vector<double> sums(depths.size() * orders);
    legs.visit_arrivals(directions_[direction], rng_of(direction, replicate), [&](const Leg& leg) {
      powers.at(leg.facet_cosine);
      for (std::size_t t = 0; t < depths.size(); ++t)
        add_scaled(leg.weight * std::exp(-depths.nodes[t] / leg.to), powers.transmittance.data(),
                   static_cast<int>(orders), sums.data() + t * orders);
      ++count;
    });
    return sums;
  }

  // Returns the mean relative variance of A.
  double walk_arrival(std::size_t ior, std::size_t direction, double& count) {
    const Material material = material_at(ior);
    NdArray& array = factors().arrival;
    const Axis &depths = array.axes()[1], &orders = array.axes()[2];
    const Vec3& w = directions_[direction];
    const Legs legs(material);
    FringePowers powers(ThinFilm::of(material), orders, fringe_order(material, w.z));
    std::vector<double> sum(depths.size() * orders.size()), squares(sum.size());
    for (std::size_t r = 0; r < kReplicates; ++r) {
      const auto one = arrivals(legs, depths, powers, direction, r, count);
      for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k] += one[k] / kReplicates;
        squares[k] += square(one[k]) / kReplicates;
      }
    }
    double variance = 0;
    for (std::size_t t = 0; t < depths.size(); ++t)
      for (std::size_t j = 0; j < orders.size(); ++j) {
        const std::size_t k = t * orders.size() + j;
        const std::size_t cell =
            ior * array.stride(0) + t * array.stride(1) + j * array.stride(2) + direction;
        const double path = depths.nodes[t] / arrival_cosine(material, w.z);
        array.set(cell, Rgb(std::log(std::max(sum[k], kLeastArrival)) + path));
        variance += std::max(0.0, squares[k] / square(sum[k]) - 1) / (kReplicates - 1);
      }
    return variance / static_cast<double>(sum.size());
  }

  void walk_returned(std::size_t ior, double& count) {
    const Material material = material_at(ior);
    NdArray& array = factors().returned;
    const Axis& orders = array.axes()[2];
    FringePowers powers(below(material), orders, fringe_order(material, 1));
    std::vector<double> sum(depths_.size() * orders.size());
    const Legs legs(material);
    for (std::size_t r = 0; r < kReplicates; ++r)
      legs.visit_returns(rng_of(directions_.size(), r), [&](const Leg& leg) {
        powers.at(leg.facet_cosine);
        for (std::size_t t = 0; t < depths_.size(); ++t)
          add_scaled(leg.weight / kReplicates * std::exp(-depths_.nodes[t] * (1 / leg.from + 1 / leg.to)),
                     powers.reflectance.data(), static_cast<int>(orders.size()),
                     sum.data() + t * orders.size());
        ++count;
      });
    for (std::size_t k = 0; k < sum.size(); ++k) array.set(ior * array.stride(0) + k, Rgb(sum[k]));
  }

  static ThinFilm below(const Material& material) {
    const ThinFilm film = ThinFilm::of(material);
    return material.transmission == Transmission::straight ? film : film.reversed();
  }

  // Where a leg's cosine lies between m_a, one value an order: row a of `sums` += share * powers.
  static void collect(const Bracket& at, double share, const std::vector<double>& powers, double* sums) {
    const int count = static_cast<int>(powers.size());
    add_scaled(share * (1 - at.upper_weight), powers.data(), count, sums + at.lower * powers.size());
    add_scaled(share * at.upper_weight, powers.data(), count, sums + at.upper * powers.size());
  }

  // B at (a, b, order).
  std::vector<double> collected_returns(const Material& material, const Axis& orders, double& count) const {
    FringePowers powers(below(material), orders, fringe_order(material, 1));
    std::vector<double> sums(square_of_nodes() * orders.size());
    const Legs legs(material);
    for (std::size_t r = 0; r < kReplicates; ++r)
      legs.visit_returns(rng_of(directions_.size(), r), [&](const Leg& leg) {
        powers.at(leg.facet_cosine);
        const Bracket from = cosine_nodes_.locate(leg.from), to = cosine_nodes_.locate(leg.to);
        double* rows = sums.data();
        const std::size_t row = kCosineNodes * orders.size();
        const double share = leg.weight / kReplicates;
        collect(to, share * (1 - from.upper_weight), powers.reflectance, rows + from.lower * row);
        collect(to, share * from.upper_weight, powers.reflectance, rows + from.upper * row);
        ++count;
      });
    return sums;
  }

  // p of every direction at (a, order).
  std::vector<std::vector<double>> collected_arrivals(const Material& material, const Axis& orders,
                                                      double& count) const {
    std::vector<std::vector<double>> result;
    const Legs legs(material);
    FringePowers powers(ThinFilm::of(material), orders, fringe_order(material, 1));
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      auto& p = result.emplace_back(kCosineNodes * orders.size());
      for (std::size_t r = 0; r < kReplicates; ++r)
        legs.visit_arrivals(directions_[d], rng_of(d, r), [&](const Leg& leg) {
          powers.at(leg.facet_cosine);
          collect(cosine_nodes_.locate(leg.to), leg.weight / kReplicates, powers.transmittance, p.data());
          ++count;
        });
    }
    return result;
  }

  static constexpr std::size_t square_of_nodes() { return std::size_t{kCosineNodes} * kCosineNodes; }

  void walk_exchange(std::size_t ior, double& count) {
    const Material material = material_at(ior);
    NdArray& array = factors().exchange;
    const Axis &albedos = array.axes()[2], &orders = array.axes()[3];
    const auto returns = collected_returns(material, orders, count);
    const bool straight_on = passes_straight_on(material);
    const auto arrivals =
        straight_on ? std::vector<std::vector<double>>() : collected_arrivals(material, orders, count);
    Matrix b(kCosineNodes);
    for (std::size_t j = 0; j < orders.size(); ++j) {
      for (std::size_t k = 0; k < square_of_nodes(); ++k) b.row(0)[k] = returns[k * orders.size() + j];
      for (std::size_t t = 0; t < depths_.size(); ++t) {
        const auto visits =
            straight_on ? straight_visits(material, t) : bent_visits(arrivals, t, j, orders.size());
        for (std::size_t k = 0; k < albedos.size(); ++k) {
          const std::size_t cell =
              ior * array.stride(0) + t * array.stride(1) + k * array.stride(2) + j * array.stride(3);
          store(material, visits, b, t, albedos.nodes[k], cell, array);
        }
      }
    }
  }

  // What of a direction's light arrives where, over A(w): at the nodes (p), and through exp(-tau / (m m_b))
  // at the nodes of the other side (f). Straight on, p is not needed.
  struct Visit {
    Vector p, f;
  };

  std::vector<Visit> straight_visits(const Material& material, std::size_t depth) const {
    std::vector<Visit> visits;
    for (const Vec3& w : directions_) {
      const double m = arrival_cosine(material, w.z);
      Vector f(kCosineNodes);
      for (int b = 0; b < kCosineNodes; ++b)
        f[b] = std::exp(-depths_.nodes[depth] / m * (1 / cosine_nodes_.nodes[b] - 1));
      visits.push_back({{}, f});
    }
    return visits;
  }

  std::vector<Visit> bent_visits(const std::vector<std::vector<double>>& arrivals, std::size_t depth,
                                 std::size_t order, std::size_t orders) const {
    std::vector<Visit> visits;
    for (const auto& collected : arrivals) {
      Vector p(kCosineNodes);
      double arriving = 0;
      for (int a = 0; a < kCosineNodes; ++a) {
        p[a] = collected[a * orders + order];
        arriving += p[a] * std::exp(-depths_.nodes[depth] / cosine_nodes_.nodes[a]);
      }
      for (double& share : p) share /= std::max(arriving, kLeastArrival);
      visits.push_back({p, multiply(p, attenuation_[depth])});
    }
    return visits;
  }

  // (V - E + kd f_i^T B y_o) with (1 - kd F B) y_o = f_o, V the single visit where it is not E.
  void store(const Material& material, const std::vector<Visit>& visits, const Matrix& b, std::size_t depth,
             double albedo, std::size_t cell, NdArray& array) const {
    Matrix system = multiply(attenuation_[depth], b), right(kCosineNodes);
    for (int a = 0; a < kCosineNodes; ++a)
      for (int c = 0; c < kCosineNodes; ++c) system.row(a)[c] = (a == c ? 1 : 0) - albedo * system.row(a)[c];
    const int count = static_cast<int>(visits.size());
    std::vector<Matrix> solved;
    for (int first = 0; first < count; first += kCosineNodes) {
      for (int a = 0; a < kCosineNodes; ++a)
        for (int o = 0; o < std::min(kCosineNodes, count - first); ++o)
          right.row(a)[o] = visits[static_cast<std::size_t>(first + o)].f[a];
      solved.push_back(solve(system, right));
    }
    std::vector<Vector> returned;  // kd f_i^T B
    for (const Visit& visit : visits) {
      returned.push_back(multiply(visit.f, b));
      for (double& x : returned.back()) x *= albedo;
    }
    const auto value = [&](int i, int o) {
      double sum = 0;
      const Matrix& y = solved[static_cast<std::size_t>(o / kCosineNodes)];
      for (int a = 0; a < kCosineNodes; ++a)
        sum += returned[static_cast<std::size_t>(i)][a] * y.row(a)[o % kCosineNodes];
      const Visit &vi = visits[static_cast<std::size_t>(i)], &vo = visits[static_cast<std::size_t>(o)];
      if (vi.p.empty()) return sum;
      const double m_i = material.cosine_below(directions_[static_cast<std::size_t>(i)].z);
      const double m_o = material.cosine_below(directions_[static_cast<std::size_t>(o)].z);
      return sum + dot(vi.f, vo.p) - one_visit_of_product(depths_.nodes[depth], m_i, m_o);
    };
    for (int i = 0; i < count; ++i)
      for (int o = 0; o <= i; ++o) {
        const Rgb mean_value((value(i, o) + value(o, i)) / 2);
        array.set(cell + static_cast<std::size_t>(i * count + o), mean_value);
        array.set(cell + static_cast<std::size_t>(o * count + i), mean_value);
      }
  }

  static constexpr double kLeastArrival = 1e-30;

  const Recipe& recipe_;
  std::uint64_t seed_;
  FactorResult result_;
  std::vector<Vec3> directions_;
  const Axis cosine_nodes_{"", "", spaced_nodes(1e-3, 1, kCosineNodes, 1.5), 1.5};
  Axis depths_;
  std::vector<Matrix> attenuation_;  // F at each depth
};

}  // namespace

bool has_factors(const Material& material) { return !material.scatters() && !material.has_multiple_facets(); }

Factors factor_axes(const Recipe& recipe) {
  Factors factors;
  factors.grid = recipe.grid;
  factors.wavelengths = recipe.spectrum.wavelengths(recipe.material);
  const Wavelengths& w = factors.wavelengths;
  const Axis ior = cubic(recipe.grid[1]), depths = depths_axis(recipe, w);
  const auto joined = [](std::vector<Axis> axes, const std::vector<Axis>& more) {
    axes.insert(axes.end(), more.begin(), more.end());
    return axes;
  };
  if (!recipe.material.is_smooth()) {
    const bool straight = recipe.material.transmission == Transmission::straight;
    const Axis one_depth{"optical_depth", "1", {0}, 3};
    factors.arrival =
        checked_array(recipe, "arrival",
                      joined({ior, straight ? one_depth : depths, orders_axis(recipe, w, 0, kNodesPerFringe)},
                             direction_axes(recipe, "")),
                      recipe.table.precision);
  }
  if (recipe.material.absorption_path == AbsorptionPath::sum) {
    factors.returned =
        checked_array(recipe, "returned", {ior, depths, orders_axis(recipe, w, 1, kNodesPerFringe)},
                      Precision::single_float);
  } else {
    auto axes =
        joined({ior, depths, albedos_axis(w), orders_axis(recipe, w, 1, exchange_nodes_per_fringe(w))},
               direction_axes(recipe, "_i"));
    factors.exchange =
        checked_array(recipe, "exchange", joined(axes, direction_axes(recipe, "_o")), recipe.table.precision);
  }
  return factors;
}

FactorResult walk_factors(const Recipe& recipe, std::uint64_t seed, int threads,
                          const std::function<void(double)>& on_progress) {
  return FactorWalks(recipe, seed).run(threads, on_progress);
}

}  // namespace sunbeam
