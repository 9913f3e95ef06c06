#include "sunbeam/nd_array.h"

#include <half.h>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 32;

// Corners of the cell around x and their weights; single-node axes and exact hits add none.
struct Corners {
  std::array<std::size_t, std::size_t{1} << NdArray::kMaxRank> offset;
  std::array<double, std::size_t{1} << NdArray::kMaxRank> weight;
  std::size_t count = 1;
};

Corners corners(const NdArray& array, std::span<const double> x) {
  Corners result;
  result.offset[0] = 0;
  result.weight[0] = 1;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Bracket at = array.axes()[k].locate(x[k]);
    const std::size_t lower = at.lower * array.stride(k), upper = at.upper * array.stride(k);
    const std::size_t count = result.count;
    if (at.upper_weight > 0) {
      for (std::size_t c = 0; c < count; ++c) {
        result.offset[count + c] = result.offset[c] + upper;
        result.weight[count + c] = result.weight[c] * at.upper_weight;
        result.weight[c] *= 1 - at.upper_weight;
      }
      result.count = 2 * count;
    }
    for (std::size_t c = 0; c < count; ++c) result.offset[c] += lower;
  }
  return result;
}

}  // namespace

float round_to(Precision precision, double value) {
  const auto single = static_cast<float>(value);
  const float rounded = precision == Precision::half_float ? static_cast<float>(Imath::half(single)) : single;
  return rounded + 0.0f;  // -0 becomes 0
}

NdArray::NdArray(std::string name, std::vector<Axis> axes, Precision precision)
    : name_(std::move(name)), axes_(std::move(axes)), precision_(precision), cells_(1) {
  if (axes_.empty() || axes_.size() > kMaxRank)
    throw Error("array '" + name_ + "': has " + std::to_string(axes_.size()) + " axes; allowed: 1 to 7");
  for (std::size_t k = axes_.size(); k-- > 0;) {
    const std::string defect = axes_[k].defect();
    if (!defect.empty()) throw Error("array '" + name_ + "': axis '" + axes_[k].name + "' " + defect);
    strides_[k] = cells_;
    if (axes_[k].size() > kMaxCells / cells_) throw Error("array '" + name_ + "': has more than 2^32 cells");
    cells_ *= axes_[k].size();
  }
  values_.resize(3 * cells_);
}

void NdArray::set(std::size_t cell, const Rgb& value) {
  for (int c = 0; c < 3; ++c)
    values_[3 * cell + static_cast<std::size_t>(c)] = round_to(precision_, value[c]);
}

Rgb NdArray::interpolate(std::span<const double> x) const {
  const Corners near = corners(*this, x);
  Rgb sum;
  for (std::size_t c = 0; c < near.count; ++c) sum += near.weight[c] * get(near.offset[c]);
  return sum;
}

NdArray NdArray::slice(std::span<const double> x) const {
  const Corners near = corners(*this, x);
  NdArray result(name_, {axes_.begin() + static_cast<std::ptrdiff_t>(x.size()), axes_.end()},
                 Precision::single_float);
  for (std::size_t cell = 0; cell < result.cells(); ++cell) {
    Rgb sum;
    for (std::size_t c = 0; c < near.count; ++c) sum += near.weight[c] * get(near.offset[c] + cell);
    result.set(cell, sum);
  }
  return result;
}

}  // namespace sunbeam
