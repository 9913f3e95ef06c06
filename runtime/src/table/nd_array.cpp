#include "sunbeam/detail/nd_array.h"

#include <half.h>

#include <utility>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 32;

// Calls visit(offset, weight) for every cell that a value at x is made of; exact hits have few.
template <class F>
void visit_cells(const NdArray& array, std::span<const double> x, std::size_t axis, std::size_t offset,
                 double weight, F& visit) {
  if (axis == x.size()) return visit(offset, weight);
  const Stencil at = array.axes()[axis].stencil(x[axis]);
  for (std::size_t k = 0; k < at.count; ++k)
    visit_cells(array, x, axis + 1, offset + at.node[k] * array.stride(axis), weight * at.weight[k], visit);
}

}  // namespace

float round_to(Precision precision, double value) {
  const auto single = static_cast<float>(value);
  const float rounded = precision == Precision::half_float ? static_cast<float>(Imath::half(single)) : single;
  return rounded + 0.0f;  // -0 becomes 0
}

ArrayShape::ArrayShape(std::string name, std::vector<Axis> axes, Precision precision, std::size_t channels)
    : name_(std::move(name)), axes_(std::move(axes)), precision_(precision), channels_(channels), cells_(1) {
  if (axes_.empty() || axes_.size() > kMaxRank)
    throw Error("array '" + name_ + "': has " + std::to_string(axes_.size()) + " axes; allowed: 1 to " +
                std::to_string(kMaxRank));
  for (std::size_t k = axes_.size(); k-- > 0;) {
    const Axis& axis = axes_[k];
    const std::string defect = axis.defect();
    if (!defect.empty()) throw Error("array '" + name_ + "': axis '" + axis.name + "' " + defect);
    strides_[k] = cells_;
    if (axis.size() > kMaxCells / cells_) throw Error("array '" + name_ + "': has more than 2^32 cells");
    cells_ *= axis.size();
  }
}

void NdArray::set(std::size_t cell, const Rgb& value) {
  for (std::size_t c = 0; c < channels(); ++c)
    values_[channels() * cell + c] = round_to(precision(), value[static_cast<int>(c)]);
}

Rgb NdArray::interpolate(std::span<const double> x) const {
  Rgb sum;
  auto add = [&](std::size_t offset, double weight) { sum += weight * get(offset); };
  visit_cells(*this, x, 0, 0, 1, add);
  return sum;
}

NdArray NdArray::slice(std::span<const double> x) const {
  NdArray result(name(), {axes().begin() + static_cast<std::ptrdiff_t>(x.size()), axes().end()},
                 Precision::single_float, channels());
  std::vector<double> sums(result.values_.size());
  auto add = [&](std::size_t offset, double weight) {
    const float* from = values_.data() + channels() * offset;
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += weight * static_cast<double>(from[k]);
  };
  visit_cells(*this, x, 0, 0, 1, add);
  for (std::size_t k = 0; k < sums.size(); ++k)
    result.values_[k] = round_to(Precision::single_float, sums[k]);
  return result;
}

}  // namespace v1
}  // namespace sunbeam
