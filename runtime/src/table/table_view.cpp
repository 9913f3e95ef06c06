#include "sunbeam/detail/table_view.h"

#include <algorithm>
#include <utility>

namespace sunbeam {
inline namespace v1 {
namespace {

constexpr std::size_t kLastParameter = kParameterNames.size() - 1;

struct Span {
  std::size_t first, count;
};

// The nodes that a value at x is made of, and their neighbours up to four, so that the part's own stencil is
// the same.
Span nodes_around(const Axis& axis, double x) {
  const std::size_t count = std::min<std::size_t>(4, axis.size());
  const std::size_t lower = axis.locate(x).lower;
  return {std::min(lower > 0 ? lower - 1 : 0, axis.size() - count), count};
}

NdArray read_all(const ArrayView& view) {
  NdArray array(view.shape());
  auto to = array.values().begin();
  view.visit([&](std::span<const float> values) { to = std::ranges::copy(values, to).out; });
  return array;
}

// The nodes `at` of an array over the parameters.
NdArray read_part(const ArrayView& view, const std::array<Span, kParameterNames.size()>& at) {
  const ArrayShape& whole = view.shape();
  std::vector<Axis> axes = whole.axes();
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto first = whole.axes()[k].nodes.begin() + static_cast<std::ptrdiff_t>(at[k].first);
    axes[k].nodes = {first, first + static_cast<std::ptrdiff_t>(at[k].count)};
  }
  NdArray part(whole.name(), axes, whole.precision(), whole.channels());
  auto to = part.values().begin();
  for (std::size_t a = 0; a < at[0].count; ++a)
    for (std::size_t b = 0; b < at[1].count; ++b) {
      const std::size_t cell = (at[0].first + a) * whole.stride(0) + (at[1].first + b) * whole.stride(1);
      const std::size_t node = cell / whole.stride(kLastParameter) + at[2].first;
      to = std::ranges::copy(view.at_nodes(node, at[2].count), to).out;
    }
  return part;
}

}  // namespace

void ArrayView::visit(const std::function<void(std::span<const float> values)>& visit) const {
  if (!values_) return visit(in_memory_);
  constexpr std::size_t kPiece = 1 << 22;  // values, unless a node has more
  const std::size_t stride = shape_.stride(kLastParameter), nodes = shape_.cells() / stride;
  const std::size_t at_once = std::max<std::size_t>(1, kPiece / (stride * shape_.channels()));
  for (std::size_t first = 0; first < nodes; first += at_once)
    visit(values_(first, std::min(at_once, nodes - first)));
}

TableView::TableView(const Table& table) : head_(std::shared_ptr<const Table>(), &table) {}

TableView::TableView(Table&& table) : head_(std::make_shared<const Table>(std::move(table))) {}

TableView::TableView(Table&& head, ArrayView remainder, ArrayView rest_stderr) : TableView(std::move(head)) {
  nodes_ = {std::move(remainder), std::move(rest_stderr)};
}

const Axis& TableView::parameter_axis(std::size_t k) const {
  return is_in_memory() ? head_->parameter_axis(k) : nodes_.front().shape().axes()[k];
}

std::vector<ArrayView> TableView::arrays() const {
  std::vector<ArrayView> result;
  for (const NdArray* array : head_->arrays()) result.emplace_back(*array);
  result.insert(result.end(), nodes_.begin(), nodes_.end());
  return result;
}

const Table& TableView::whole(std::optional<Table>& room) const {
  if (is_in_memory()) return *head_;
  room = *head_;
  room->remainder = read_all(nodes_[0]);
  room->rest_stderr = read_all(nodes_[1]);
  return *room;
}

const Table& TableView::around(const Parameters& parameters, std::optional<Table>& room) const {
  if (is_in_memory()) return *head_;
  std::array<Span, kParameterNames.size()> at{};
  for (std::size_t k = 0; k < at.size(); ++k) at[k] = nodes_around(parameter_axis(k), parameters.values()[k]);
  room = *head_;
  room->remainder = read_part(nodes_[0], at);
  room->rest_stderr = read_part(nodes_[1], at);
  return *room;
}

void TableView::add_info(const std::map<std::string, std::string>& info) {
  Table table = *head_;
  for (const auto& [key, value] : info) table.info[key] = value;
  head_ = std::make_shared<const Table>(std::move(table));
}

}  // namespace v1
}  // namespace sunbeam
