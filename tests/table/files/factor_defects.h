// Ways to spoil a factored table, and what readers must say of each.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/table/support.h"

namespace sunbeam::test {

inline constexpr const char* kName = "folder/some.table";

struct Defect {
  std::string description;
  std::function<void(Table&)> make;
  std::vector<std::string> named;  // what the message must say
};

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

inline void expect_named(const Table& sound, const std::vector<Defect>& defects) {
  for (const Form& form : forms())
    for (const Defect& defect : defects) {
      Table table = sound;
      ASSERT_EQ(refusal(form, form.bytes(table), kName), "accepted");
      defect.make(table);
      const std::string message = refusal(form, form.bytes(table), kName);
      EXPECT_THAT(message, ::testing::StartsWith(kName)) << form.name << ", " << defect.description;
      for (const std::string& part : defect.named)
        EXPECT_THAT(message, ::testing::HasSubstr(part)) << form.name << ", " << defect.description;
    }
}

}  // namespace sunbeam::test
