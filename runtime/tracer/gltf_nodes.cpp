#include "runtime/tracer/gltf_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

// Of a quaternion of any length.
Affine rotation(const std::vector<double>& q) {
  double largest = 0, sum = 0;
  for (const double c : q) largest = std::max(largest, std::abs(c));
  if (!(largest > 0)) throw Error("a node's rotation has length 0");
  for (const double c : q) sum += (c / largest) * (c / largest);
  const double size = largest * std::sqrt(sum);
  const double x = q[0] / size, y = q[1] / size, z = q[2] / size, w = q[3] / size;
  return {{Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
           Vec3{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
           Vec3{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
}

Affine matrix_of(const Json& node) {
  if (node.contains("matrix")) return affine_of(numbers(node, "matrix", 16).data());
  Affine result;
  if (node.contains("rotation")) result = rotation(numbers(node, "rotation", 4));
  if (node.contains("scale")) {
    const auto s = numbers(node, "scale", 3);
    for (std::size_t i = 0; i < 3; ++i) result.columns[i] = s[i] * result.columns[i];
  }
  if (node.contains("translation")) {
    const auto t = numbers(node, "translation", 3);
    result.offset = {t[0], t[1], t[2]};
  }
  return result;
}

std::vector<std::size_t> roots(const GltfDocument& document) {
  if (document.has("scenes")) return naturals(document.entry("scenes", document.default_scene()), "nodes");
  std::vector<bool> is_child(document.size("nodes"));
  for (std::size_t i = 0; i < is_child.size(); ++i)
    for (const std::size_t child : naturals(document.entry("nodes", i), "children"))
      if (child < is_child.size()) is_child[child] = true;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) result.push_back(i);
  return result;
}

}  // namespace

Affine affine_of(const double* m) {
  constexpr double kRounding = 1e-5;
  if (!(std::max({std::abs(m[3]), std::abs(m[7]), std::abs(m[11]), std::abs(m[15] - 1)}) <= kRounding))
    throw Error(fmt::format("a matrix has the last row {:g} {:g} {:g} {:g}; allowed: 0 0 0 1", m[3], m[7],
                            m[11], m[15]));
  return {{Vec3{m[0], m[1], m[2]}, Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
}

GltfNodes place_nodes(const GltfDocument& document) {
  struct Visit {
    std::size_t node;
    Affine parent;
  };
  std::vector<Visit> visits;
  const auto add = [&](const std::vector<std::size_t>& nodes, const Affine& parent) {
    for (std::size_t i = nodes.size(); i-- > 0;) visits.push_back({nodes[i], parent});
  };
  GltfNodes result;
  result.to_world.resize(document.size("nodes"));
  add(roots(document), {});
  while (!visits.empty()) {
    const auto [index, parent] = visits.back();
    visits.pop_back();
    const Json& node = document.entry("nodes", index);
    if (result.to_world[index])
      throw Error(fmt::format("node {} is met twice; nodes must form trees", index));
    result.to_world[index] = parent * matrix_of(node);
    result.order.push_back(index);
    add(naturals(node, "children"), *result.to_world[index]);
  }
  return result;
}

}  // namespace sunbeam
