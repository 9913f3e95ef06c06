#include "bake/factor_walks.h"

#include <fmt/format.h>

#include "bake/cell.h"
#include "bake/live/dense.h"
#include "bake/live/film_interface.h"
#include "bake/optics/fringes.h"
#include "bake/packed.h"
#include "sunbeam/core/error.h"
#include "sunbeam/core/text.h"

namespace sunbeam {
namespace {

constexpr double kNodesPerFringe = 10;              // of arrival and returned: cubic to 4e-4 of a fringe
constexpr double kExchangeNodesPerFringe = 3;       // most of exchange has no fringes
constexpr double kMoreNodesPerFringeOverWhite = 8;  // 3 alone would be off by 1 % of the albedo there
constexpr std::size_t kLeastFringeNodes = 6;
constexpr std::size_t kAlbedoNodes = 3;           // where wavelengths differ; the series in kd converges fast
constexpr std::size_t kDepthNodesOfOneValue = 5;  // where only wavelengths make depths differ
constexpr double kLowestCosine = 1e-3;
constexpr std::size_t kReplicates = 4;  // independent estimates, whose spread is the noise
// Strata of a replicate, doubled until the noise is low enough.
struct Strata {
  std::size_t least, most;
};
constexpr Strata kFacetStrata{16, 256};  // each way
constexpr Strata kUpStrata{16, 256};     // over the base's cosine^2, with a quarter of it of facets each way
constexpr std::size_t kFacetsOfUp = 4;
constexpr Strata kSmoothUpStrata{256, 1 << 16};
constexpr std::size_t kOrdersPerTask = 32;  // of exchange
constexpr int kCosineNodes = 64;            // m_a of "product"
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
  void visit_arrivals(const Vec3& w, std::size_t strata, Rng rng, Visit visit) const {
    if (material_.is_smooth()) strata = 1;
    const double share = 1 / static_cast<double>(strata * strata);
    for (std::size_t k = 0; k < strata * strata; ++k) {
      const Vec3 h = normal(w, stratum(k, strata, rng));
      const auto crossing = film_.cross(w, {h, {Rgb(0), Rgb(1)}, 0});
      if (crossing) visit(Leg{std::min(dot(w, h), 1.0), 0, crossing->inside.z, share * crossing->weight.r});
    }
  }

  // From the base, along its cosine law, to the film and back.
  template <class Visit>
  void visit_returns(std::size_t up, Rng rng, Visit visit) const {
    const std::size_t strata = material_.is_smooth() ? 1 : up / kFacetsOfUp;
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

NdArray outlined_array(const Recipe& recipe, const char* name, const std::vector<Axis>& axes,
                       Precision precision) {
  double cells = 1;
  for (const Axis& axis : axes) cells *= static_cast<double>(axis.size());
  if (cells > kMostCells)
    throw Error(fmt::format("{}: [grid] and [table] ask for {:.3g} cells of '{}'; allowed: up to {:.3g}",
                            recipe.name, cells, name, kMostCells));
  return NdArray::outline(name, axes, precision, 1);
}

// Mean of replicates, and the variance of that mean.
class Replicates {
 public:
  explicit Replicates(std::size_t size) : sum_(size), squares_(size) {}

  void add(const std::vector<double>& one) {
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      sum_[k] += one[k] / kReplicates;
      squares_[k] += square(one[k]) / kReplicates;
    }
  }
  const std::vector<double>& mean() const { return sum_; }
  double variance(std::size_t k) const {
    return std::max(0.0, squares_[k] - square(sum_[k])) / (kReplicates - 1);
  }

 private:
  std::vector<double> sum_, squares_;
};

// Tasks: of a rough film, each base IOR x direction of `arrival`, then those of the other array: `returned`
// a base IOR, `exchange` a base IOR and some fringe orders.
class FactoredJob : public BakeJob {
 public:
  FactoredJob(const Recipe& recipe, std::uint64_t seed)
      : recipe_(recipe), seed_(seed), outline_(factor_axes(recipe)), iors_(recipe.grid[1].size()) {
    const auto axes = direction_axes(recipe, "");
    for (const double c : axes[0].nodes)
      for (const double phi : axes[1].nodes) directions_.push_back(direction_from_cosine(c, phi));
    arrival_tasks_ = recipe.material.is_smooth() ? 0 : iors_ * directions_.size();
    depths_ = (has_exchange() ? outline_.exchange : outline_.returned).axes()[1];
    for (const double depth : depths_.nodes) {
      Matrix f(kCosineNodes);
      for (int a = 0; a < kCosineNodes; ++a)
        for (int b = 0; b < kCosineNodes; ++b)
          f.row(a)[b] = std::exp(-depth / (cosine_nodes_.nodes[a] * cosine_nodes_.nodes[b]));
      attenuation_.push_back(f);
    }
  }

  std::size_t tasks() const override { return arrival_tasks_ + iors_ * parts(); }

  double cost(std::size_t task) const override {
    constexpr double kSecondsPerOperation = 5e-10, kLegs = kReplicates * 64 * 64;
    const auto depths = static_cast<double>(depths_.size()), ends = static_cast<double>(directions_.size());
    if (task < arrival_tasks_)
      return kSecondsPerOperation * kLegs * static_cast<double>(outline_.arrival.stride(0)) / ends;
    if (!has_exchange())
      return kSecondsPerOperation * 16 * kLegs * static_cast<double>(outline_.returned.stride(0));
    const auto albedos = static_cast<double>(outline_.exchange.axes()[2].size());
    const double solve = square(double{kCosineNodes}) * (kCosineNodes + ends) + square(ends) * kCosineNodes;
    return kSecondsPerOperation * static_cast<double>(orders_of(task).size()) *
           ((32 + ends) * kLegs + depths * albedos * solve);
  }

  Block run(std::size_t task) const override {
    if (task < arrival_tasks_) return walk_arrival(task / directions_.size(), task % directions_.size());
    const std::size_t ior = (task - arrival_tasks_) / parts();
    return has_exchange() ? walk_exchange(ior, orders_of(task)) : walk_returned(ior);
  }

  Table table(const Blocks& blocks) const override {
    Table table;
    table.material = recipe_.material;
    table.symmetry = symmetry_of(recipe_);
    table.factors = outline_;
    for (NdArray* array : {&table.factors.arrival, &table.factors.returned, &table.factors.exchange})
      if (array->is_outline())
        *array = NdArray(array->name(), array->axes(), array->precision(), array->channels());
    double variance = 0;
    for (std::size_t task = 0; task < tasks(); ++task) {
      if (task < arrival_tasks_)
        variance += add_arrival(task, blocks.values(task), table.factors.arrival);
      else if (has_exchange())
        add_exchange(task, blocks.values(task), table.factors.exchange);
      else
        add_returned(task, blocks.values(task), table.factors.returned);
    }
    table.info = info_of(recipe_, Encoding::factored, seed_, total_walks(*this, blocks), "pfmc-shared-legs");
    const double relative = arrival_tasks_ > 0 ? 2 * variance / static_cast<double>(arrival_tasks_) : 0;
    table.info["noise"] = to_text(std::sqrt(relative));
    return table;
  }

 private:
  bool has_exchange() const { return !outline_.exchange.empty(); }

  // Tasks of a base IOR other than arrivals.
  std::size_t parts() const {
    if (!has_exchange()) return 1;
    return (outline_.exchange.axes()[3].size() + kOrdersPerTask - 1) / kOrdersPerTask;
  }

  struct Orders {
    std::size_t first, end;
    std::size_t size() const { return end - first; }
  };
  Orders orders_of(std::size_t task) const {
    const std::size_t first = (task - arrival_tasks_) % parts() * kOrdersPerTask;
    return {first, std::min(first + kOrdersPerTask, outline_.exchange.axes()[3].size())};
  }

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
  std::vector<double> arrivals(const Legs& legs, FringePowers& powers, std::size_t direction,
                               std::size_t strata, std::size_t replicate, std::uint64_t& count) const {
    const Axis& depths = outline_.arrival.axes()[1];
    const std::size_t orders = powers.transmittance.size();
    std::vector<double> sums(depths.size() * orders);
    legs.visit_arrivals(directions_[direction], strata, rng_of(direction, replicate), [&](const Leg& leg) {
      powers.at(leg.facet_cosine);
      for (std::size_t t = 0; t < depths.size(); ++t)
        add_scaled(leg.weight * std::exp(-depths.nodes[t] / leg.to), powers.transmittance.data(),
                   static_cast<int>(orders), sums.data() + t * orders);
      ++count;
    });
    return sums;
  }

  // The mean relative variance of A, then log A less its decay, at (depth, order).
  Block walk_arrival(std::size_t ior, std::size_t direction) const {
    const Material material = material_at(ior);
    const Axis &depths = outline_.arrival.axes()[1], &orders = outline_.arrival.axes()[2];
    const Vec3& w = directions_[direction];
    const Legs legs(material);
    FringePowers powers(ThinFilm::of(material), orders, fringe_order(material, w.z));
    Block block;
    Replicates a(depths.size() * orders.size());
    for (std::size_t strata = kFacetStrata.least;; strata *= 2) {
      a = Replicates(a.mean().size());
      for (std::size_t r = 0; r < kReplicates; ++r)
        a.add(arrivals(legs, powers, direction, strata, r, block.summary.walks));
      block.summary.worst_error = worst_arrival_error(a);
      if (block.summary.worst_error <= recipe_.accuracy.noise || strata == kFacetStrata.most) break;
    }
    std::vector<double> values{0};
    for (std::size_t k = 0; k < a.mean().size(); ++k) {
      const double path = depths.nodes[k / orders.size()] / arrival_cosine(material, w.z);
      values.push_back(std::log(std::max(a.mean()[k], kLeastArrival)) + path);
      values[0] +=
          a.variance(k) / std::max(square(a.mean()[k]), kLeastArrival) / static_cast<double>(a.mean().size());
    }
    append(block.values, std::span<const double>(values));
    return block;
  }

  // Of a product of two, relative to it or to what verify counts as dark.
  static double worst_arrival_error(const Replicates& a) {
    const double darkest = std::sqrt(kDarkestAlbedo);
    double worst = 0;
    for (std::size_t k = 0; k < a.mean().size(); ++k)
      worst = std::max(worst, std::sqrt(2 * a.variance(k)) / std::max(a.mean()[k], darkest));
    return worst;
  }

  double add_arrival(std::size_t task, const std::string& bytes, NdArray& array) const {
    const std::size_t ior = task / directions_.size(), direction = task % directions_.size();
    const std::size_t orders = array.axes()[2].size();
    const auto values = unpacked<double>(bytes, 1 + array.axes()[1].size() * orders);
    for (std::size_t k = 0; k + 1 < values.size(); ++k)
      array.set(ior * array.stride(0) + k * array.stride(2) + direction, Rgb(values[1 + k]));
    return values[0];
  }

  // Strata over the base's cosine for the noise that is asked for, and that noise: of what the film throws
  // back, all told, at each order, as it tells in 1 / (1 - kd returned).
  std::size_t strata_of_returns(const Material& material, const Legs& legs, const Axis& orders,
                                BlockSummary& summary) const {
    FringePowers powers(below(material), thinned(orders), fringe_order(material, 1));
    const Strata range = material.is_smooth() ? kSmoothUpStrata : kUpStrata;
    const std::vector<double>& albedos = outline_.wavelengths.albedo;
    const double kd = *std::max_element(albedos.begin(), albedos.end());
    for (std::size_t up = range.least;; up *= 2) {
      Replicates returned(powers.reflectance.size());
      for (std::size_t r = 0; r < kReplicates; ++r) {
        std::vector<double> one(powers.reflectance.size());
        legs.visit_returns(up, rng_of(directions_.size(), r), [&](const Leg& leg) {
          powers.at(leg.facet_cosine);
          add_scaled(leg.weight, powers.reflectance.data(), static_cast<int>(one.size()), one.data());
          ++summary.walks;
        });
        returned.add(one);
      }
      summary.worst_error = 0;
      for (std::size_t k = 0; k < returned.mean().size(); ++k) {
        const double kept = std::max(1 - kd * returned.mean()[k], kDarkestAlbedo);
        summary.worst_error = std::max(summary.worst_error, kd * std::sqrt(returned.variance(k)) / kept);
      }
      if (summary.worst_error <= recipe_.accuracy.noise || up == range.most) return up;
    }
  }

  // The same range with fewer nodes.
  static Axis thinned(Axis orders) {
    constexpr std::size_t kMost = 32;
    if (orders.size() > kMost) orders.nodes = spaced_nodes(orders.low(), orders.high(), kMost);
    return orders;
  }

  Block walk_returned(std::size_t ior) const {
    const Material material = material_at(ior);
    const Axis& orders = outline_.returned.axes()[2];
    FringePowers powers(below(material), orders, fringe_order(material, 1));
    std::vector<double> sum(depths_.size() * orders.size());
    const Legs legs(material);
    Block block;
    const std::size_t up = strata_of_returns(material, legs, orders, block.summary);
    for (std::size_t r = 0; r < kReplicates; ++r)
      legs.visit_returns(up, rng_of(directions_.size(), r), [&](const Leg& leg) {
        powers.at(leg.facet_cosine);
        for (std::size_t t = 0; t < depths_.size(); ++t)
          add_scaled(leg.weight / kReplicates * std::exp(-depths_.nodes[t] * (1 / leg.from + 1 / leg.to)),
                     powers.reflectance.data(), static_cast<int>(orders.size()),
                     sum.data() + t * orders.size());
        ++block.summary.walks;
      });
    append(block.values, std::span<const double>(sum));
    return block;
  }

  void add_returned(std::size_t task, const std::string& bytes, NdArray& array) const {
    const auto values = unpacked<double>(bytes, array.stride(0));
    for (std::size_t k = 0; k < values.size(); ++k)
      array.set((task - arrival_tasks_) * array.stride(0) + k, Rgb(values[k]));
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
  std::vector<double> collected_returns(const Material& material, const Axis& orders,
                                        BlockSummary& summary) const {
    FringePowers powers(below(material), orders, fringe_order(material, 1));
    std::vector<double> sums(square_of_nodes() * orders.size());
    const Legs legs(material);
    const std::size_t up = strata_of_returns(material, legs, outline_.exchange.axes()[3], summary);
    for (std::size_t r = 0; r < kReplicates; ++r)
      legs.visit_returns(up, rng_of(directions_.size(), r), [&](const Leg& leg) {
        powers.at(leg.facet_cosine);
        const Bracket from = cosine_nodes_.locate(leg.from), to = cosine_nodes_.locate(leg.to);
        double* rows = sums.data();
        const std::size_t row = kCosineNodes * orders.size();
        const double share = leg.weight / kReplicates;
        collect(to, share * (1 - from.upper_weight), powers.reflectance, rows + from.lower * row);
        collect(to, share * from.upper_weight, powers.reflectance, rows + from.upper * row);
        ++summary.walks;
      });
    return sums;
  }

  // p of every direction at (a, order).
  std::vector<std::vector<double>> collected_arrivals(const Material& material, const Axis& orders,
                                                      std::uint64_t& count) const {
    std::vector<std::vector<double>> result;
    const Legs legs(material);
    FringePowers powers(ThinFilm::of(material), orders, fringe_order(material, 1));
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      auto& p = result.emplace_back(kCosineNodes * orders.size());
      for (std::size_t r = 0; r < kReplicates; ++r)
        legs.visit_arrivals(directions_[d], kArrivalStrata, rng_of(d, r), [&](const Leg& leg) {
          powers.at(leg.facet_cosine);
          collect(cosine_nodes_.locate(leg.to), leg.weight / kReplicates, powers.transmittance, p.data());
          ++count;
        });
    }
    return result;
  }

  static constexpr std::size_t square_of_nodes() { return std::size_t{kCosineNodes} * kCosineNodes; }

  // At (depth, albedo, order, wi, wo), of some orders.
  Block walk_exchange(std::size_t ior, const Orders& part) const {
    const Material material = material_at(ior);
    const Axis &albedos = outline_.exchange.axes()[2], &all = outline_.exchange.axes()[3];
    Axis orders = all;
    const auto at = [&](std::size_t k) { return all.nodes.begin() + static_cast<std::ptrdiff_t>(k); };
    orders.nodes = {at(part.first), at(part.end)};
    Block block;
    const auto returns = collected_returns(material, orders, block.summary);
    const bool straight_on = passes_straight_on(material);
    const auto arrivals = straight_on ? std::vector<std::vector<double>>()
                                      : collected_arrivals(material, orders, block.summary.walks);
    Matrix b(kCosineNodes);
    const std::size_t ends = square_of_directions();
    std::vector<float> values(depths_.size() * albedos.size() * orders.size() * ends);
    for (std::size_t j = 0; j < orders.size(); ++j) {
      for (std::size_t k = 0; k < square_of_nodes(); ++k) b.row(0)[k] = returns[k * orders.size() + j];
      for (std::size_t t = 0; t < depths_.size(); ++t) {
        const auto visits =
            straight_on ? straight_visits(material, t) : bent_visits(arrivals, t, j, orders.size());
        for (std::size_t k = 0; k < albedos.size(); ++k)
          solve_exchange(material, visits, b, t, albedos.nodes[k],
                         &values[((t * albedos.size() + k) * orders.size() + j) * ends]);
      }
    }
    append(block.values, std::span<const float>(values));
    return block;
  }

  std::size_t square_of_directions() const { return directions_.size() * directions_.size(); }

  void add_exchange(std::size_t task, const std::string& bytes, NdArray& array) const {
    const Orders part = orders_of(task);
    const std::size_t ior = (task - arrival_tasks_) / parts(), run = part.size() * array.stride(3);
    const std::size_t outer = array.stride(0) / array.stride(2);  // depths x albedos
    const auto values = unpacked<float>(bytes, outer * run);
    for (std::size_t k = 0; k < outer; ++k)
      for (std::size_t c = 0; c < run; ++c)
        array.set(ior * array.stride(0) + k * array.stride(2) + part.first * array.stride(3) + c,
                  Rgb(double{values[k * run + c]}));
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
  void solve_exchange(const Material& material, const std::vector<Visit>& visits, const Matrix& b,
                      std::size_t depth, double albedo, float* values) const {
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
        const auto mean_value = static_cast<float>((value(i, o) + value(o, i)) / 2);
        values[i * count + o] = values[o * count + i] = mean_value;
      }
  }

  static constexpr double kLeastArrival = 1e-30;
  static constexpr std::size_t kArrivalStrata = 64;  // where arrivals are collected at nodes

  const Recipe& recipe_;
  std::uint64_t seed_;
  Factors outline_;  // arrays without values
  std::size_t iors_, arrival_tasks_;
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
    factors.arrival = outlined_array(
        recipe, "arrival",
        joined({ior, straight ? one_depth : depths, orders_axis(recipe, w, 0, kNodesPerFringe)},
               direction_axes(recipe, "")),
        recipe.table.precision);
  }
  if (recipe.material.absorption_path == AbsorptionPath::sum) {
    factors.returned =
        outlined_array(recipe, "returned", {ior, depths, orders_axis(recipe, w, 1, kNodesPerFringe)},
                       Precision::single_float);
  } else {
    auto axes =
        joined({ior, depths, albedos_axis(w), orders_axis(recipe, w, 1, exchange_nodes_per_fringe(w))},
               direction_axes(recipe, "_i"));
    factors.exchange = outlined_array(recipe, "exchange", joined(axes, direction_axes(recipe, "_o")),
                                      recipe.table.precision);
  }
  return factors;
}

std::unique_ptr<BakeJob> factored_job(const Recipe& recipe, std::uint64_t seed) {
  return std::make_unique<FactoredJob>(recipe, seed);
}

}  // namespace sunbeam
