#include "bake/dense/nodes.h"

#include "bake/dense/film_arrays.h"
#include "sunbeam/detail/factor_frame.h"

namespace sunbeam {
namespace {

constexpr double kLowestCosine = 0.01;

// `count` azimuths from 0, without the end that is the beginning again.
std::vector<double> nodes_round(std::size_t count) {
  auto nodes = spaced_nodes(0, 2 * kPi, count + 1);
  nodes.pop_back();
  return nodes;
}

// To three binary digits, so that it takes next to no room in a file. Nobody needs a noise more exactly.
double coarse(double standard_error) {
  if (standard_error == 0) return 0;
  int exponent = 0;
  const double fraction = std::frexp(standard_error, &exponent);
  return std::ldexp(std::round(8 * fraction) / 8, exponent);
}

std::vector<Vec3> directions(const Axis& cosines, const Axis& azimuths) {
  std::vector<Vec3> result;
  for (const double c : cosines.nodes)
    for (const double phi : azimuths.nodes) result.push_back(direction_from_cosine(c, phi));
  return result;
}

// Denser towards grazing, where the rest bends, or about the critical angle of a base below the exterior. A
// smooth film lets nothing in beyond that.
Axis cosine_axis(const Recipe& recipe) {
  const auto count = static_cast<std::size_t>(recipe.table.angles);
  if (!reaches_below(recipe)) return {"", "1", spaced_nodes(kLowestCosine, 1, count, 2), 2, 0, 0, true};
  Material material = at_lowest_base_ior(recipe);
  material.absorption_per_nm = 0;
  Axis axis = critical_axis(material);
  axis.is_cubic = true;
  axis.nodes = spaced_nodes(axis, entering_cosine(material, kLowestCosine), 1, count);
  return axis;
}

}  // namespace

// Cubic in all but the azimuths of an anisotropic film, of which one is periodic and the other must not
// differ from it.
std::vector<Axis> rest_axes(const Recipe& recipe) {
  std::vector<Axis> axes = recipe.grid;
  for (Axis& axis : axes) axis.is_cubic = true;
  Axis cosine = cosine_axis(recipe);
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

DenseNodes::DenseNodes(const Recipe& recipe)
    : recipe_(recipe),
      size_(recipe.grid[0].size() * recipe.grid[1].size() * recipe.grid[2].size()),
      equal_cells_(symmetry_of(recipe) == Symmetry::isotropic, static_cast<std::size_t>(recipe.table.angles),
                   static_cast<std::size_t>(recipe.table.azimuths)) {
  head_.material = recipe.material;
  head_.symmetry = symmetry_of(recipe);
  if (is_layered(recipe)) head_.schema_version = kTableSchemaVersion;
  bake_film(recipe, head_);
  frame_.emplace(recipe.material, head_.first_visit, head_.has_layered_film());
  const auto axes = rest_axes(recipe);
  remainder_ = ArrayShape("remainder", axes, recipe.table.precision);
  rest_stderr_ = ArrayShape("rest_stderr", axes, Precision::single_float, 1);
  wi_ = directions(axes[3], axes[4]);
  wo_ = directions(axes[5], axes[6]);
}

Parameters DenseNodes::parameters(std::size_t node) const {
  const std::vector<Axis>& grid = recipe_.grid;
  const std::size_t c = node % grid[2].size(), b = node / grid[2].size() % grid[1].size();
  return {grid[0].nodes[node / (grid[1].size() * grid[2].size())], grid[1].nodes[b], grid[2].nodes[c]};
}

std::vector<float> DenseNodes::remainder(std::size_t node, Rows rest) const {
  equal_cells_.average(rest);
  frame(node, rest);
  std::vector<float> result;
  for (const std::vector<Rgb>& row : rest)
    for (const Rgb& value : row)
      for (int c = 0; c < 3; ++c) result.push_back(round_to(recipe_.table.precision, value[c]));
  return result;
}

std::vector<float> DenseNodes::rest_stderr(Rows errors) const {
  equal_cells_.average_errors(errors);
  std::vector<float> result;
  for (const std::vector<Rgb>& row : errors)
    for (const Rgb& error : row) result.push_back(round_to(Precision::single_float, coarse(mean(error))));
  return result;
}

void DenseNodes::frame(std::size_t node, Rows& rest) const {
  const Parameters p = parameters(node);
  const RestFrame frame = frame_->over(p.applied_to(recipe_.material));
  const auto transmittance = [&](double cosine) {
    return head_.transmittance({p.film_thickness_nm, p.base_ior, cosine});
  };
  std::vector<Rgb> t_o;
  for (std::size_t o = 0; o < wo_.size(); ++o)  // the azimuths of a cosine share it
    t_o.push_back(o > 0 && wo_[o].z == wo_[o - 1].z ? t_o.back() : transmittance(wo_[o].z));
  for (std::size_t i = 0; i < wi_.size(); ++i) {
    const Rgb t_i = transmittance(wi_[i].z);
    for (std::size_t o = 0; o < wo_.size(); ++o)
      rest[i][o] = frame.encode(rest[i][o], wi_[i].z, wo_[o].z, t_i, t_o[o]);
  }
}

}  // namespace sunbeam
