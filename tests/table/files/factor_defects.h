// Ways to spoil a factored table.
#pragma once

#include "tests/table/files/defects.h"

namespace sunbeam::test {

inline NdArray rebuilt(const NdArray& array, std::vector<Axis> axes, std::size_t channels = 1) {
  NdArray result(array.name(), std::move(axes), array.precision(), channels);
  fill_randomly(result, 0, 1, 9);
  return result;
}

using ArrayOf = NdArray Factors::*;

inline std::function<void(Table&)> under_another_name(ArrayOf array) {
  return [=](Table& table) {
    const NdArray& old = table.factors.*array;
    table.factors.*array = NdArray("stray", old.axes(), old.precision(), 1);
  };
}

inline std::function<void(Table&)> with_axis(ArrayOf array, std::size_t k,
                                             const std::function<void(Axis&)>& change) {
  return [=](Table& table) {
    auto axes = (table.factors.*array).axes();
    change(axes[k]);
    table.factors.*array = rebuilt(table.factors.*array, axes);
  };
}

inline std::function<void(Table&)> with_nodes(ArrayOf array, std::size_t k,
                                              const std::vector<double>& nodes) {
  return with_axis(array, k, [=](Axis& axis) { axis.nodes = nodes, axis.power = 1; });
}

inline std::function<void(Table&)> with_name(ArrayOf array, std::size_t k, const std::string& name) {
  return with_axis(array, k, [=](Axis& axis) { axis.name = name; });
}

inline std::function<void(Table&)> without_last_axis(ArrayOf array) {
  return [=](Table& table) {
    auto axes = (table.factors.*array).axes();
    axes.pop_back();
    table.factors.*array = rebuilt(table.factors.*array, axes);
  };
}

inline std::function<void(Table&)> in_colours(ArrayOf array) {
  return [=](Table& table) {
    table.factors.*array = rebuilt(table.factors.*array, (table.factors.*array).axes(), 3);
  };
}

inline std::function<void(Table&)> with_grid(std::size_t k, const std::function<void(Axis&)>& change) {
  return [=](Table& table) { change(table.factors.grid[k]); };
}

inline std::function<void(Table&)> with_wavelengths(const std::function<void(Wavelengths&)>& change) {
  return [=](Table& table) { change(table.factors.wavelengths); };
}

}  // namespace sunbeam::test
