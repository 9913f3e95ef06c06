// This file finds the columns of a CSV of points and reads its rows: angles, wavelength and material keys.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bake/check/csv.h"
#include "sunbeam/core/vec.h"
#include "sunbeam/material.h"

namespace sunbeam {

enum class Quantity { brdf, albedo, film };

// Returns the names of the columns that a quantity appends.
std::vector<std::string> result_names(Quantity quantity, bool monochromatic);

struct Point {
  Vec3 wi, wo;
  std::optional<double> wavelength_nm;
  std::size_t stream;
};

class PointColumns {
 public:
  // Throws Error if a column is missing, has the name of a result, or has a name that is almost a key, so
  // that a misspelt one is not passed over. `csv` must outlive this.
  PointColumns(const Csv& csv, Quantity quantity);

  bool is_monochromatic() const { return wavelength_.has_value(); }
  const std::vector<std::size_t>& material_columns() const { return material_columns_; }
  // Returns the names, if any, of the columns that are no keys.
  const std::vector<std::string>& unused() const { return unused_; }

  // Both throw Error that names file and line.
  Point point(std::size_t row_index) const;
  Material material(std::size_t row_index, Material material) const;

 private:
  std::size_t require(const std::string& key) const;
  double azimuth_deg(const CsvRow& row, std::size_t column) const;
  Vec3 polar(const CsvRow& row, std::size_t theta, double phi_deg) const;

  const Csv& csv_;
  std::size_t theta_i_ = 0;
  std::optional<std::size_t> theta_o_, phi_, phi_i_, wavelength_;
  std::vector<std::size_t> material_columns_;
  std::vector<std::string> unused_;
};

}  // namespace sunbeam
