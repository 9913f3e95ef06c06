#include "runtime/src/table/table_checks.h"

#include <algorithm>
#include <utility>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr double kDeepest = 1e21;  // optical depth

NdArray* find(TableParts& parts, const std::string& name) {
  const auto at =
      std::find_if(parts.arrays.begin(), parts.arrays.end(), [&](const auto& a) { return a.name() == name; });
  return at == parts.arrays.end() ? nullptr : &*at;
}

std::string inventory(const TableParts& parts) {
  constexpr std::size_t kMost = 10;
  const std::size_t count = parts.arrays.size();
  std::string list;
  for (std::size_t k = 0; k < std::min(count, kMost); ++k)
    list += (list.empty() ? "" : ", ") + parts.arrays[k].name();
  if (count > kMost) list += " and " + std::to_string(count - kMost) + " more";
  return list.empty() ? "no array" : list;
}

void check_axis_range(const Axis& axis, double low, double high) {
  if (axis.nodes.front() < low || axis.nodes.back() > high)
    throw Error("axis '" + axis.name + "' leaves " + to_text(low) + " to " + to_text(high));
}

void check_period(const Axis& axis, double period) {
  if (axis.period != period)
    throw Error("axis '" + axis.name + "' has period " + to_text(axis.period) + "; expected " +
                to_text(period));
}

// Look-ups at azimuths beyond the nodes would be clamped, hence the ends.
void check_ends(const Axis& axis, double low, double high) {
  if (axis.nodes.front() != low || axis.nodes.back() != high)
    throw Error("axis '" + axis.name + "' runs from " + to_text(axis.nodes.front()) + " to " +
                to_text(axis.nodes.back()) + "; expected " + to_text(low) + " to " + to_text(high));
}

void check_plain_axis(const Axis& axis, double low, double high) {
  check_axis_range(axis, low, high);
  check_period(axis, 0);
}

void check_parameter(const Table& table, const Axis& axis, const char* name) {
  const Interval allowed = allowed_interval(name, table.material);
  check_plain_axis(axis, allowed.low, allowed.high);
}

// That of one direction in an array of factors.
void check_azimuth(Symmetry symmetry, const Axis& phi) {
  check_period(phi, 0);
  if (symmetry == Symmetry::anisotropic) return check_ends(phi, 0, kPi / 2);
  if (phi.size() != 1)
    throw Error("axis '" + phi.name + "' has " + std::to_string(phi.size()) +
                " nodes; an isotropic table has 1");
}

void check_ranks(const Axis& facet_rank) {
  check_period(facet_rank, 0);
  check_ends(facet_rank, 0, 1);
}

void check_same(const ArrayShape& array, const Axis& axis, const ArrayShape& other, const Axis& others) {
  if (!(axis == others))
    throw Error("array '" + array.name() + "': axis '" + axis.name + "' differs from that of '" +
                other.name() + "'");
}

void check_azimuths(Symmetry symmetry, const Axis& phi_i, const Axis& phi_o) {
  check_period(phi_i, 0);
  if (symmetry == Symmetry::isotropic) {
    if (phi_i.size() != 1)
      throw Error("axis 'phi_i' has " + std::to_string(phi_i.size()) + " nodes; an isotropic table has 1");
    check_period(phi_o, 0);
    check_axis_range(phi_o, 0, kPi);
    if (phi_o.size() > 1) check_ends(phi_o, 0, kPi);
  } else {
    check_ends(phi_i, 0, kPi / 2);
    check_period(phi_o, 2 * kPi);
    check_axis_range(phi_o, 0, 2 * kPi);
  }
}

}  // namespace

std::string name_of(Symmetry symmetry) {
  return symmetry == Symmetry::isotropic ? "isotropic" : "anisotropic";
}

void require_finite(const ArrayView& array) {
  array.visit([&](std::span<const float> values) {
    for (const float value : values)
      if (!std::isfinite(value))
        throw Error("array '" + array.shape().name() + "' holds a value that is not finite");
  });
}

NdArray checked_array(TableParts& parts, const std::string& name, std::span<const char* const> axis_names,
                      std::size_t channels) {
  NdArray* array = find(parts, name);
  if (!array) throw Error("array '" + name + "' is missing (the file holds: " + inventory(parts) + ")");
  if (array->axes().size() != axis_names.size())
    throw Error("array '" + name + "' has " + std::to_string(array->axes().size()) + " axes; expected " +
                std::to_string(axis_names.size()));
  for (std::size_t k = 0; k < axis_names.size(); ++k)
    if (array->axes()[k].name != axis_names[k])
      throw Error("array '" + name + "': axis " + std::to_string(k) + " is '" + array->axes()[k].name +
                  "'; expected '" + axis_names[k] + "'");
  if (array->channels() != channels)
    throw Error("array '" + name + "' holds " +
                (channels == 1 ? "colours; expected numbers" : "numbers; expected colours"));
  require_finite(*array);
  NdArray taken = std::move(*array);
  static_cast<ArrayShape&>(*array) = taken;  // messages still list it
  return taken;
}

void check_symmetry(const Table& table) {
  const bool isotropic = table.material.roughness.is_isotropic();
  if (isotropic == (table.symmetry == Symmetry::isotropic)) return;
  throw Error("symmetry is " + name_of(table.symmetry) + " but material.roughness is " +
              to_string(table.material.roughness) + "; expected symmetry " +
              name_of(isotropic ? Symmetry::isotropic : Symmetry::anisotropic));
}

void check_ranges(const Table& table) {
  for (std::size_t k = 0; k < 3; ++k) check_parameter(table, table.parameter_axis(k), kParameterNames[k]);
  if (table.is_factored()) return;
  const auto &axes = table.remainder.axes(), &film = table.film_reflectance.axes();
  for (const std::size_t k : {0u, 1u}) check_parameter(table, film[k], kParameterNames[k]);
  for (const std::size_t k : {3u, 5u}) check_period(axes[k], 0);
  check_period(film[2], 0);
  for (const std::size_t k : {3u, 5u}) check_axis_range(axes[k], 1e-6, 1);
  check_azimuths(table.symmetry, axes[4], axes[6]);
  check_axis_range(table.film_reflectance.axes()[2], 0, 1);
  if (table.rest_stderr.axes() != axes) throw Error("array 'rest_stderr' has other axes than 'remainder'");
  if (!table.film_transmittance.empty() && table.film_transmittance.axes() != table.film_reflectance.axes())
    throw Error("array 'film_transmittance' has other axes than 'film_reflectance'");
}

void check_factor_axes(const Table& table, const NdArray& array, std::size_t first_cosine) {
  const auto& axes = array.axes();
  check_parameter(table, axes[0], "base_ior");
  check_plain_axis(axes[1], 0, kDeepest);
  for (const Axis& axis : axes) {
    if (axis.name == "wavelength_nm") check_plain_axis(axis, 300, 1000);
    if (axis.name == "albedo") check_plain_axis(axis, 0, 1);
    if (axis.name == "fringe_order") check_plain_axis(axis, 0, 1e4);
  }
  for (std::size_t k = first_cosine; k < axes.size(); k += 2) {
    if (axes[k].name.starts_with("warped_cos"))
      check_ends(axes[k], 0, 1);
    else
      check_axis_range(axes[k], 1e-6, 1);
    check_period(axes[k], 0);
    check_azimuth(table.symmetry, axes[k + 1]);
  }
}

void check_crossing_axes(const Table& table, const NdArray& facet_cosine, const NdArray& crossing) {
  const auto &facets = facet_cosine.axes(), &axes = crossing.axes();
  check_plain_axis(facets[0], 0, kPi / 2);
  check_azimuth(table.symmetry, facets[1]);
  check_ranks(facets[2]);
  check_parameter(table, axes[0], "base_ior");
  check_plain_axis(axes[1], 0, kDeepest);
  for (std::size_t k = 0; k < facets.size(); ++k) check_same(crossing, axes[2 + k], facet_cosine, facets[k]);
}

// One cell stands for an opaque base, which is not met.
void check_returning_axes(const Table& table, const NdArray& return_cosine, const NdArray& returning) {
  const Axis& rank = return_cosine.axes()[0];
  if (!table.material.is_opaque()) check_ranks(rank);
  check_plain_axis(rank, 0, 1);
  check_plain_axis(returning.axes()[0], 0, kDeepest);
  check_same(returning, returning.axes()[1], return_cosine, rank);
}

void check_first_visit_axis(const NdArray& first_visit) { check_plain_axis(first_visit.axes()[0], 0, 1000); }

// Look-ups locate wi and wo on the same nodes.
void check_same_ends(const NdArray& exchange, std::size_t first_cosine) {
  const auto& axes = exchange.axes();
  for (const std::size_t k : {first_cosine, first_cosine + 1}) {
    Axis like_o = axes[k];
    like_o.name = axes[k + 2].name;
    if (!(like_o == axes[k + 2]))
      throw Error("array 'exchange': axes '" + axes[k].name + "' and '" + like_o.name + "' differ");
  }
}

}  // namespace v1
}  // namespace sunbeam
