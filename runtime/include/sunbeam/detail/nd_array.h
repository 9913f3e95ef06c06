// This file holds dense arrays of colours or of single numbers over named axes, with interpolation along
// each. They are the one in-memory form of everything a table holds.
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sunbeam/core/export.h"
#include "sunbeam/core/vec.h"
#include "sunbeam/detail/axis.h"

namespace sunbeam {
inline namespace v1 {

enum class Precision { half_float, single_float };

// Rounds a value as it is rounded on disk; in memory values are floats that already have that rounding.
float round_to(Precision precision, double value);

// Describes an array without its values: its name, axes and precision, and where a cell lies.
class SUNBEAM_EXPORT ArrayShape {
 public:
  static constexpr std::size_t kMaxRank = 9;

  ArrayShape() = default;
  // Throws Error if an axis is unsound, there are none or too many, or the array is too large. `channels` is
  // 3 (colours) or 1.
  ArrayShape(std::string name, std::vector<Axis> axes, Precision precision, std::size_t channels = 3);

  const std::string& name() const { return name_; }
  const std::vector<Axis>& axes() const { return axes_; }
  Precision precision() const { return precision_; }
  std::size_t channels() const { return channels_; }
  std::size_t cells() const { return cells_; }  // colours or numbers
  bool empty() const { return cells_ == 0; }

  // Returns the distance in cells between neighbours along axis k. Arrays are row-major: the last axis runs
  // fastest.
  std::size_t stride(std::size_t k) const { return strides_[k]; }

  bool operator==(const ArrayShape&) const = default;

 private:
  std::string name_;
  std::vector<Axis> axes_;
  Precision precision_ = Precision::single_float;
  std::size_t channels_ = 3;
  std::array<std::size_t, kMaxRank> strides_{};
  std::size_t cells_ = 0;
};

class SUNBEAM_EXPORT NdArray : public ArrayShape {
 public:
  NdArray() = default;
  // All values are zero.
  explicit NdArray(ArrayShape shape)
      : ArrayShape(std::move(shape)), values_(ArrayShape::channels() * ArrayShape::cells()) {}
  NdArray(std::string name, std::vector<Axis> axes, Precision precision, std::size_t channels = 3)
      : NdArray(ArrayShape(std::move(name), std::move(axes), precision, channels)) {}

  // These give the values, channels() a cell.
  std::span<const float> values() const { return values_; }
  std::span<float> values() { return values_; }
  // Returns the value of a cell. A single number is the same in every channel.
  Rgb get(std::size_t cell) const {
    if (channels() == 1) return Rgb(values_[cell]);
    return {values_[3 * cell], values_[3 * cell + 1], values_[3 * cell + 2]};
  }
  // Sets the value of a cell, rounded to the precision of the array; -0 becomes 0 so that every file form
  // keeps it. Of a single number it takes the first channel.
  void set(std::size_t cell, const Rgb& value);

  // Returns the value at x (one number an axis), clamped to the axes.
  Rgb interpolate(std::span<const double> x) const;

  // Returns the array over the trailing axes with the leading ones fixed at x.
  NdArray slice(std::span<const double> x) const;

  bool operator==(const NdArray&) const = default;

 private:
  std::vector<float> values_;
};

}  // namespace v1
}  // namespace sunbeam
