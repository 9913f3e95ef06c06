// The tangent frame: it follows u on every kind of surface, without facets or seams, and BSDFs see it as
// their local x axis.
#include <gtest/gtest.h>

#include <limits>

#include "runtime/tracer/embree_scene.h"
#include "runtime/tracer/obj.h"
#include "runtime/tracer/tangents.h"
#include "sunbeam/core/frame.h"
#include "sunbeam/detail/warp.h"
#include "tests/render/support.h"
#include "tests/support/warps.h"

namespace sunbeam {
namespace {

constexpr double kDegree = kPi / 180;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

void expect_near(const Vec3& found, const Vec3& expected, double tolerance) {
  EXPECT_NEAR(length(found - expected), 0, tolerance)
      << "found (" << found.x << ", " << found.y << ", " << found.z << "); expected (" << expected.x << ", "
      << expected.y << ", " << expected.z << ")";
}

Scene with(std::variant<Sphere, Mesh> shape) {
  Scene scene;
  scene.materials.push_back({});
  scene.objects.push_back({std::move(shape), 0});
  return scene;
}

SurfaceHit hit_from(const EmbreeScene& geometry, const Vec3& from, const Vec3& towards) {
  const auto hit = geometry.intersect({from, normalize(towards - from)});
  if (!hit) throw Error("the test ray misses");
  return *hit;
}

// What a ray straight down onto (x, y) finds.
SurfaceHit hit_below(const Mesh& mesh, double x, double y) {
  const Scene scene = with(mesh);
  return hit_from(EmbreeScene(scene), {x, y, 10}, {x, y, 0});
}

Mesh obj_mesh(const std::string& text) {
  const ScratchFolder folder;
  return load_obj(folder.write("m.obj", text)).mesh;
}

// --- Frame ---

void expect_right_handed(const Frame& frame, const Vec3& normal, double tolerance) {
  EXPECT_NEAR(length(frame.tangent), 1, tolerance);
  EXPECT_NEAR(length(frame.bitangent), 1, tolerance);
  EXPECT_NEAR(dot(frame.tangent, normal), 0, tolerance);
  EXPECT_NEAR(length(cross(frame.tangent, frame.bitangent) - normal), 0, tolerance);
}

TEST(TangentFrame, IsOrthonormalRightHandedAndLeansTowardsTheTangent) {
  Rng rng(3, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 normal = sample_sphere({rng.uniform(), rng.uniform()});
    const Vec3 tangent =
        std::pow(10.0, 12 * rng.uniform() - 6) * sample_sphere({rng.uniform(), rng.uniform()});
    const Frame frame = Frame::from_normal_and_tangent(normal, tangent);
    expect_right_handed(frame, normal, 1e-12);
    EXPECT_GT(dot(frame.tangent, tangent), 0);
    EXPECT_NEAR(dot(frame.bitangent, normalize(tangent)), 0,
                1e-12);  // only the part along the normal is gone
  }
}

TEST(TangentFrame, WithoutAUsableTangentIsAnyFrame) {
  const Vec3 normal = normalize(Vec3{0.3, -0.5, 0.7});
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& tangent :
       {Vec3{}, normal, -5 * normal, normal + Vec3{1e-9, 0, 0}, Vec3{infinity, 0, 0}, Vec3{0, nan, 0}}) {
    const Frame frame = Frame::from_normal_and_tangent(normal, tangent);
    expect_near(frame.tangent, Frame::from_normal(normal).tangent, 0);
    expect_right_handed(frame, normal, 1e-14);
  }
}

// --- directions of u ---

TEST(Tangent, OnASphereIsAlongTheLongitude) {
  const Scene scene = with(Sphere{{1, 2, 3}, 2});
  const EmbreeScene geometry(scene);
  Rng rng(4, 0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal = sample_sphere({rng.uniform(), rng.uniform()});
    const SurfaceHit hit = hit_from(geometry, Vec3{1, 2, 3} + 5 * normal, {1, 2, 3});
    expect_near(hit.tangent, normalize(cross(Vec3{0, 0, 1}, hit.shading_normal)), 1e-12);
  }
  const SurfaceHit pole = hit_from(geometry, {1, 2, 9}, {1, 2, 3});
  expect_right_handed(Frame::from_normal_and_tangent(pole.shading_normal, pole.tangent), pole.shading_normal,
                      1e-12);
}

TEST(Tangent, OnAQuadIsAlongEdgeUFromBothSides) {
  const Vec3 u = {1, 2, 0.5}, v = {-1, 3, 0};
  const Scene scene = with(quad_mesh({}, u, v));
  const EmbreeScene geometry(scene);
  const Vec3 normal = normalize(cross(u, v));
  for (const Vec3& point : {0.7 * u + 0.2 * v, 0.2 * u + 0.7 * v})  // one in each triangle
    for (const double side : {-1, 1})
      expect_near(hit_from(geometry, point + side * normal, point).tangent, normalize(u), 1e-12);
}

TEST(Tangent, IsNotLookedForWhereTheMaterialIsIsotropic) {
  const Scene scene = with(quad_mesh({}, {1, 0, 0}, {0, 1, 0}));
  const auto tangent = [&](bool isotropic) {
    const EmbreeScene geometry(scene, [=](std::size_t) { return isotropic; });
    return hit_from(geometry, {0.5, 0.5, 1}, {0.5, 0.5, 0}).tangent;
  };
  EXPECT_EQ(length(tangent(true)), 0);
  EXPECT_EQ(length(tangent(false)), 1);
}

// The torus about z, and rays onto it.
struct TorusTest : testing::Test {
  static constexpr int kResolution = 128;
  Scene scene = with(torus_mesh({}, 2, 0.5, {}, kResolution));
  EmbreeScene geometry{scene};

  SurfaceHit at(double phi, double psi) const {
    const Vec3 outward = {std::cos(phi), std::sin(phi), 0};
    const Vec3 normal = outward * std::cos(psi) + Vec3{0, 0, std::sin(psi)};
    const Vec3 surface = 2 * outward + 0.5 * normal;
    return hit_from(geometry, surface + 0.1 * normal, surface - 0.1 * normal);
  }
  static Vec3 analytic(const SurfaceHit& hit) { return normalize(cross(Vec3{0, 0, 1}, hit.position)); }
};

TEST_F(TorusTest, TangentIsTheAnalyticOne) {
  // A chord of the mesh is half a step, 1.4 degrees, off the tangents at its ends.
  Rng rng(5, 0);
  for (int i = 0; i < 5000; ++i) {
    const SurfaceHit hit = at(2 * kPi * rng.uniform(), 2 * kPi * rng.uniform());
    ASSERT_LT(angle_between(hit.tangent, analytic(hit)), 0.05 * kDegree);
    ASSERT_NEAR(length(hit.tangent), 1, 1e-12);
  }
}

TEST_F(TorusTest, TangentIsContinuousAcrossEdgesAndSeams) {
  constexpr double kStep = 1e-6;
  const double column = 2 * kPi / kResolution, row = 2 * column;
  Rng rng(6, 0);
  for (int i = 0; i < kResolution; ++i) {  // i = 0 is the seam of u; of v every second one
    const double phi = 2 * kPi * rng.uniform(), psi = 2 * kPi * rng.uniform();
    const auto jump = [](const SurfaceHit& a, const SurfaceHit& b) {
      return angle_between(a.tangent, b.tangent);
    };
    ASSERT_LT(jump(at(i * column - kStep, psi), at(i * column + kStep, psi)), 1e-5) << i;
    ASSERT_LT(jump(at(phi, i * row - kStep), at(phi, i * row + kStep)), 1e-5) << i;
  }
}

TEST(Tangent, TorusTurnsWithItsTangents) {
  const Mesh mesh = torus_mesh({0, 0, 1}, 2, 0.5, {90, 0, 90}, 64);  // the axis is now +x
  const std::vector<Vec3> tangents = vertex_tangents(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 expected = normalize(cross(Vec3{1, 0, 0}, mesh.positions[i] - Vec3{0, 0, 1}));
    ASSERT_LT(angle_between(tangents[i], expected), 0.01 * kDegree) << i;
  }
}

TEST(Tangent, TorusCoordinatesHaveNoJumpInsideATriangle) {
  const Mesh mesh = torus_mesh({}, 2, 0.5, {}, 16);
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Point2 &p = mesh.uvs[a], &q = mesh.uvs[b], &r = mesh.uvs[c];
    const double twice = (q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y);
    EXPECT_GT(twice, 0);  // never mirrored, as it would be across a seam
    area += twice / 2;
  }
  EXPECT_NEAR(area, 1, 1e-12);  // the unit square, once
}

// --- OBJ ---

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Tangent, FollowsTheTextureCoordinatesOfAnObj) {
  // u runs along +y, v along -x.
  const std::string uvs = "vt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\n";
  for (const char* faces :
       {"f 1/1 2/2 3/3 4/4\n", "f -4/-4 -3/-3 -2/-2 -1/-1\n", "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n"}) {
    const Mesh mesh = obj_mesh(kSquare + uvs + faces);
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    expect_near(hit_below(mesh, 0.7, 0.2).tangent, {0, 1, 0}, 1e-9);
    expect_near(hit_below(mesh, 0.2, 0.7).tangent, {0, 1, 0}, 1e-9);
  }
}

TEST(Tangent, CoordinatesAreNotMixedUpWithNormals) {
  const Mesh mesh =
      obj_mesh(kSquare + "vt 5 6\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 1 1\nf 1/2/1 2/3/1 4/4/2\n");
  ASSERT_EQ(mesh.uvs.size(), 3u);
  EXPECT_EQ(mesh.uvs[1].x, 1);
  EXPECT_EQ(mesh.uvs[2].y, 1);
  expect_near(mesh.normals[2], normalize(Vec3{0, 1, 1}), 1e-9);
}

// An open cylinder about z of radius 1 between z = -1 and 1 in `n` strips with exact normals. u runs once
// around, so the last strip ends at u = 1 where the first starts at 0.
std::string cylinder_obj(int n) {
  std::string text;
  for (int i = 0; i < n; ++i) {
    const double phi = 2 * kPi * i / n;
    const std::string direction = std::to_string(std::cos(phi)) + " " + std::to_string(std::sin(phi)) + " ";
    text += "v " + direction + "-1\nv " + direction + "1\nvn " + direction + "0\n";
  }
  for (int i = 0; i <= n; ++i) {
    const std::string u = std::to_string(static_cast<double>(i) / n);
    text += "vt " + u + " 0\nvt " + u + " 1\n";
  }
  for (int i = 1; i <= n; ++i) {
    const auto corner = [&](int column, int end) {
      const int wrapped = (column - 1) % n + 1;
      return " " + std::to_string(2 * wrapped - 1 + end) + "/" + std::to_string(2 * column - 1 + end) + "/" +
             std::to_string(wrapped);
    };
    text += "f" + corner(i, 0) + corner(i + 1, 0) + corner(i + 1, 1) + corner(i, 1) + "\n";
  }
  return text;
}

TEST(Tangent, ASmoothObjShowsNeitherFacetsNorItsSeam) {
  const Scene scene = with(obj_mesh(cylinder_obj(32)));
  const EmbreeScene geometry(scene);
  const auto at = [&](double phi, double z) {
    return hit_from(geometry, {2 * std::cos(phi), 2 * std::sin(phi), z}, {0, 0, z}).tangent;
  };
  for (int i = 0; i < 32; ++i) {  // i = 0 is the seam
    const double edge = 2 * kPi * i / 32;
    ASSERT_LT(angle_between(at(edge - 1e-6, 0.3), at(edge + 1e-6, 0.3)), 1e-5) << i;
    for (const double inside : {0.0, 0.03, 0.1, 0.17}) {
      const double phi = edge + inside;
      ASSERT_LT(angle_between(at(phi, 0.3), {-std::sin(phi), std::cos(phi), 0}), 0.05 * kDegree) << i;
    }
  }
}

TEST(Tangent, MirroredCoordinatesKeepTheirOwnDirection) {
  // Two unit squares side by side; u grows from both outer edges towards the common one at x = 1.
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nvn 0 0 1\n"
      "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"
      "f 1/1/1 2/2/1 5/4/1 4/3/1\nf 2/2/1 3/1/1 6/3/1 5/4/1\n";
  const Mesh mesh = obj_mesh(text);
  for (const double x : {0.1, 0.5, 0.999}) expect_near(hit_below(mesh, x, 0.4).tangent, {1, 0, 0}, 1e-9);
  for (const double x : {1.001, 1.5, 1.9}) expect_near(hit_below(mesh, x, 0.4).tangent, {-1, 0, 0}, 1e-9);
  // Mirrored in v alone: u runs on, and so does the tangent.
  const Mesh mirrored_v = obj_mesh(kSquare + "vt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\nf 1/1 2/2 3/3 4/4\n");
  expect_near(hit_below(mirrored_v, 0.5, 0.4).tangent, {1, 0, 0}, 1e-9);
}

TEST(Tangent, WithoutUsableCoordinatesIsZero) {
  const std::string normal = "vn 0 0 1\n";
  for (const std::string& text : {
           kSquare + "f 1 2 3 4\n", kSquare + normal + "f 1//1 2//1 3//1 4//1\n",
           kSquare + "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n",  // not every corner has one
           kSquare + "vt 0.1 0.2\nf 1/1 2/1 3/1 4/1\n",
           kSquare + normal + "vt 0.1 0.2\nf 1/1/1 2/1/1 3/1/1 4/1/1\n",
           kSquare + "vt 0 0\nvt 0.1 0.3\nvt 0.2 0.6\nf 1/1 2/2 3/3\nf 1/1 3/2 4/3\n",  // on a line
       })
    expect_near(hit_below(obj_mesh(text), 0.6, 0.3).tangent, {}, 0);
}

void expect_obj_error(const std::string& text, const std::string& part) {
  const std::string message = error_of([&] { obj_mesh(text); });
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Tangent, BadTextureCoordinatesAreRefusedWithTheirLine) {
  const std::string uvs = "vt 0 0\nvt 1 0\nvt 0 1\n";
  expect_obj_error(kSquare + uvs + "f 1/1 2/2 3/4\n", "m.obj:8: texture index 4; allowed: 1 to 3");
  expect_obj_error(kSquare + uvs + "f 1/1 2/2 3/-4\n", "m.obj:8: texture index '3/-4'; allowed: 1 up");
  expect_obj_error(kSquare + uvs + "f 1/1 2/2 3/0\n", "m.obj:8: texture index '3/0'");
  expect_obj_error(kSquare + uvs + "f 1/1 2/2 3/\n", "m.obj:8: texture index '3/'");
  expect_obj_error(kSquare + "f 1/1 2/1 3/1\n", "m.obj:5: texture index 1; allowed: 1 to 0");
  expect_obj_error(kSquare + "vt nan 0\nf 1/1 2/1 3/1\n", "m.obj:5: 'vt' entry 1 is 'nan'");
  expect_obj_error(kSquare + "vt\nf 1/1 2/1 3/1\n", "m.obj:5: 'vt' entry 1 is ''");
  expect_obj_error(kSquare + uvs + "vn 0 0 1\nf 1/1/1 2/2/1 3/3/2\n",
                   "m.obj:9: normal index 2; allowed: 1 to 1");
  expect_obj_error(kSquare + "vn 0 0 1\nf 1//1 2//1 3//-2\n", "m.obj:6: normal index '3//-2'");
}

// --- what a BSDF sees ---

// Its value tells the local x and y of both directions.
class Compass final : public Bsdf {
 public:
  static double value(const Vec3& wo, const Vec3& wi) {
    return 1 + 0.4 * wo.x + 0.3 * wi.x + 0.1 * wo.y + 0.2 * wi.y;
  }
  Rgb eval(const Vec3& wo, const Vec3& wi, Rng&) const override { return Rgb(value(wo, wi)); }
  std::optional<BsdfSample> sample(const Vec3&, Rng&) const override { return {}; }
  double pdf(const Vec3&, const Vec3&, Rng&) const override { return 0; }
  double mis_pdf(const Vec3&, const Vec3&) const override { return 0; }
};

constexpr Vec3 kCamera = {3, 1, 2}, kLight = {-1, 2, 2};

// A quad through the origin in the plane z = 0, seen from kCamera and lit from kLight.
Scene lit_quad(const Vec3& u, const Vec3& v) {
  Scene scene = with(quad_mesh(-0.5 * (u + v), u, v));
  scene.camera = {.position = kCamera, .look_at = {}, .fov_deg = 0.01};
  scene.point_lights.push_back({kLight, Rgb(dot(kLight, kLight))});
  return scene;
}

double picture_of(const Scene& scene) {
  return grey_estimate(render_with(scene, Compass(), {.width = 2, .height = 2, .spp = 1})).mean;
}

// What the picture must be if the local axes lie along x and y.
double value_along(const Vec3& x, const Vec3& y) {
  const auto local = [&](const Vec3& w) { return Vec3{dot(w, x), dot(w, y), w.z}; };
  const Vec3 wi = normalize(kLight);
  return wi.z * Compass::value(local(normalize(kCamera)), local(wi));
}

TEST(TangentFrame, LocalXOfABsdfIsTheDirectionOfIncreasingU) {
  const Vec3 x = normalize(Vec3{1, 2, 0}), y = {-x.y, x.x, 0};
  EXPECT_NEAR(picture_of(lit_quad(4 * x, 4 * y)), value_along(x, y), 1e-3);
  EXPECT_NEAR(picture_of(lit_quad(4 * y, -4 * x)), value_along(y, -x), 1e-3);
  EXPECT_NEAR(picture_of(lit_quad(4 * x, 4 * y + 3 * x)), value_along(x, y), 1e-3);  // u, v not perpendicular
  EXPECT_GT(std::abs(value_along(x, y) - value_along(y, -x)), 0.1);                  // so the above can fail
}

TEST(TangentFrame, SeenFromTheBackXStaysAndYTurnsOver) {
  const Vec3 x = normalize(Vec3{1, 2, 0}), y = {-x.y, x.x, 0};
  EXPECT_NEAR(picture_of(lit_quad(4 * x, -4 * y)), value_along(x, y), 1e-3);  // the winding normal is -z
}

TEST(TangentFrame, RotationTurnsCounterClockwiseAboutTheOuterNormal) {
  const Vec3 x = normalize(Vec3{1, 2, 0}), y = {-x.y, x.x, 0};
  const double c = std::cos(30 * kDegree), s = std::sin(30 * kDegree);
  Scene front = lit_quad(4 * x, 4 * y), back = lit_quad(4 * x, -4 * y);
  front.materials[0].tangent_rotation_deg = back.materials[0].tangent_rotation_deg = 30;
  EXPECT_NEAR(picture_of(front), value_along(c * x + s * y, c * y - s * x), 1e-3);
  EXPECT_NEAR(picture_of(back), value_along(c * x - s * y, c * y + s * x), 1e-3);
}

}  // namespace
}  // namespace sunbeam
