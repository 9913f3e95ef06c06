#include "runtime/tracer/tangents.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace sunbeam {
namespace {

constexpr double kSameChartCosine = 0.5;  // 60 degrees: more than a step around a coarse torus turns

Vec3 in_plane(const Vec3& v, const Vec3& normal) { return v - dot(v, normal) * normal; }

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

UvDerivatives triangle_derivatives(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners) {
  const auto [i, j, k] = corners;
  const auto edge = [&](std::uint32_t to) {
    return Point2{mesh.uvs[to].x - mesh.uvs[i].x, mesh.uvs[to].y - mesh.uvs[i].y};
  };
  const Point2 a = edge(j), b = edge(k);
  const double area = a.x * b.y - b.x * a.y;
  const double size = square(a.x) + square(a.y) + square(b.x) + square(b.y);
  if (!(std::abs(area) > 1e-7 * size)) return {};  // the rounding of single-precision files
  const Vec3 p = mesh.positions[j] - mesh.positions[i], q = mesh.positions[k] - mesh.positions[i];
  return {(b.y * p - a.y * q) / area, (a.x * q - b.x * p) / area};
}

double corner_angle(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle, std::size_t corner) {
  const Vec3& p = mesh.positions[triangle[corner]];
  return angle_between(mesh.positions[triangle[(corner + 1) % 3]] - p,
                       mesh.positions[triangle[(corner + 2) % 3]] - p);
}

// The sum at each vertex, weighted by the angle of the triangle there: how a surface is cut into triangles
// then hardly matters.
std::vector<Vec3> sum_over_triangles(const Mesh& mesh) {
  const std::vector<Vec3> tangents = triangle_tangents(mesh);
  std::vector<Vec3> sums(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t i = mesh.triangles[t][corner];
      const Vec3 direction = unit_or_zero(in_plane(tangents[t], mesh.normals[i]));
      sums[i] = sums[i] + corner_angle(mesh, mesh.triangles[t], corner) * direction;
    }
  return sums;
}

// The same of derivatives, with the sum of the weights.
struct DerivativeSum {
  UvDerivatives sum;
  double weight = 0;

  void add(const UvDerivatives& derivatives, double w) {
    sum.du = sum.du + w * derivatives.du;
    sum.dv = sum.dv + w * derivatives.dv;
    weight += w;
  }
  UvDerivatives mean() const { return weight > 0 ? UvDerivatives{sum.du / weight, sum.dv / weight} : sum; }
};

std::vector<DerivativeSum> sum_derivatives(const Mesh& mesh) {
  std::vector<DerivativeSum> sums(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    const UvDerivatives derivatives = triangle_derivatives(mesh, triangle);
    for (std::size_t corner = 0; corner < 3; ++corner)
      sums[triangle[corner]].add(derivatives, corner_angle(mesh, triangle, corner));
  }
  return sums;
}

auto place(const Mesh& mesh, std::uint32_t vertex) {
  const Vec3 &p = mesh.positions[vertex], &n = mesh.normals[vertex];
  return std::tuple(p.x, p.y, p.z, n.x, n.y, n.z);
}

// All vertices, copies side by side.
std::vector<std::uint32_t> sorted_by_place(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return place(mesh, a) < place(mesh, b); });
  return order;
}

bool is_similar(const Vec3& a, const Vec3& b) {
  return dot(a, b) >= kSameChartCosine * length(a) * length(b);
}

Vec3 mean_of_similar(const Vec3& own, const std::vector<Vec3>& sums, std::span<const std::uint32_t> copies) {
  Vec3 total;
  for (const std::uint32_t i : copies)
    if (is_similar(own, sums[i])) total = total + sums[i];
  return unit_or_zero(total);
}

UvDerivatives mean_of_similar(const DerivativeSum& own, const std::vector<DerivativeSum>& sums,
                              std::span<const std::uint32_t> copies) {
  DerivativeSum total;
  for (const std::uint32_t i : copies)
    if (is_similar(own.sum.du, sums[i].sum.du) && is_similar(own.sum.dv, sums[i].sum.dv))
      total.add(sums[i].mean(), sums[i].weight);
  return total.mean();
}

// For each vertex what mean_of_similar() makes of the sums at its copies.
template <class Result, class Sum>
std::vector<Result> merge_copies(const Mesh& mesh, const std::vector<Sum>& sums) {
  const std::vector<std::uint32_t> order = sorted_by_place(mesh);
  std::vector<Result> results(sums.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && place(mesh, order[end]) == place(mesh, order[begin])) ++end;
    const std::span copies(&order[begin], end - begin);
    for (const std::uint32_t i : copies) results[i] = mean_of_similar(sums[i], sums, copies);
  }
  return results;
}

}  // namespace

std::vector<Vec3> triangle_tangents(const Mesh& mesh) {
  std::vector<Vec3> tangents;
  if (mesh.uvs.empty()) return tangents;
  tangents.reserve(mesh.triangles.size());
  for (const auto& corners : mesh.triangles)
    tangents.push_back(unit_or_zero(triangle_derivatives(mesh, corners).du));
  return tangents;
}

std::vector<Vec3> vertex_tangents(const Mesh& mesh) {
  if (mesh.normals.empty() || mesh.uvs.empty()) return {};
  return merge_copies<Vec3>(mesh, sum_over_triangles(mesh));
}

std::vector<UvDerivatives> vertex_derivatives(const Mesh& mesh) {
  if (mesh.uvs.empty()) return {};
  const std::vector<DerivativeSum> sums = sum_derivatives(mesh);
  if (!mesh.normals.empty()) return merge_copies<UvDerivatives>(mesh, sums);
  std::vector<UvDerivatives> means;
  for (const DerivativeSum& sum : sums) means.push_back(sum.mean());
  return means;
}

}  // namespace sunbeam
