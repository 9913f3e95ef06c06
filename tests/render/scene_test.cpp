// Scene files: what a good one means, and what a bad one is told.
#include "runtime/tracer/scene.h"

#include <gtest/gtest.h>

#include "runtime/tracer/image_io.h"
#include "runtime/tracer/snake.h"
#include "tests/render/support.h"

namespace sunbeam {
namespace {

const std::string kCamera = "[camera]\nposition = [0, -5, 1]\nlook_at = [0, 0, 0]\n";
const std::string kMaterial = "[[material]]\nname = 'grey'\ntype = 'diffuse'\n";
const std::string kSphere =
    "[[object]]\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\nmaterial = 'grey'\n";

TEST(Scene, ReadsEveryKey) {
  const Scene scene = read_scene(ConfigTable::parse(R"(
    recipe = "../recipes/a.toml"
    table = "b.exr"
    diffuse_albedo = [0.1, 0.2, 0.3]
    [camera]
    position = [1, 2, 3]
    look_at = [0, 0, 0]
    up = [0, 2, 0]
    fov_deg = 30
    [render]
    width = 10
    height = 20
    spp = 3
    max_bounces = 5
    [environment]
    color = [1, 2, 3]
    scale = 2
    [[light]]
    type = "quad"
    center = [0, 0, 4]
    edge_u = [0, 2, 0]
    edge_v = [4, 0, 0]
    radiance = 7
    [[light]]
    type = "point"
    position = [0, 0, 9]
    intensity = [1, 2, 3]
    [[material]]
    name = "film"
    type = "skin"
    film_thickness_nm = 300
    absorption_per_nm = 0.01
    tangent_rotation_deg = 30
    [[material]]
    name = "floor"
    type = "diffuse"
    albedo = 0.25
    [[object]]
    type = "plane"
    center = [0, 0, -1]
    half_size = 2
    material = "floor"
    [[object]]
    type = "sphere"
    center = [1, 0, 0]
    radius = 3
    material = "film"
  )",
                                                    "folder/scenes/test.toml"));
  EXPECT_EQ(scene.recipe, "folder/recipes/a.toml");
  EXPECT_EQ(scene.table, "folder/scenes/b.exr");
  EXPECT_EQ(scene.diffuse_albedo, Rgb(0.1, 0.2, 0.3));
  EXPECT_EQ(scene.camera.up.y, 1);
  EXPECT_EQ(scene.camera.fov_deg, 30);
  EXPECT_EQ(scene.render.width, 10);
  EXPECT_EQ(scene.render.height, 20);
  EXPECT_EQ(scene.render.spp, 3);
  EXPECT_EQ(scene.render.max_bounces, 5);
  EXPECT_EQ(scene.environment.color, Rgb(2, 4, 6));
  ASSERT_EQ(scene.quad_lights.size(), 1u);
  EXPECT_EQ(scene.quad_lights[0].corner.x, -2);
  EXPECT_EQ(scene.quad_lights[0].corner.y, -1);
  ASSERT_EQ(scene.point_lights.size(), 1u);
  EXPECT_EQ(scene.point_lights[0].intensity, Rgb(1, 2, 3));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].type, SceneMaterial::Type::skin);
  EXPECT_EQ(scene.materials[0].parameters_at({}).film_thickness_nm, 300);
  EXPECT_FALSE(scene.materials[0].parameters[1]);
  EXPECT_EQ(scene.materials[0].parameters_at({}).absorption_per_nm, 0.01);
  EXPECT_FALSE(scene.materials[0].varies());
  EXPECT_EQ(scene.materials[0].tangent_rotation_deg, 30);
  EXPECT_EQ(scene.materials[1].albedo, Rgb(0.25));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].material, 1);
  const Mesh& plane = std::get<Mesh>(scene.objects[0].shape);
  for (const Vec3& corner : plane.positions) {
    EXPECT_EQ(std::abs(corner.x), 2);
    EXPECT_EQ(std::abs(corner.y), 2);
    EXPECT_EQ(corner.z, -1);
  }
  EXPECT_EQ(scene.objects[1].material, 0);
  EXPECT_EQ(std::get<Sphere>(scene.objects[1].shape).radius, 3);
}

TEST(Scene, ReliefsAreInUnitsOfTheSurface) {
  const ScratchFolder folder;
  write_height_map(folder.file("h.exr"), {2, 1, {0.0f, 1.0f}});
  const Scene scene = load_scene(folder.write("a.toml", kCamera + kSphere + R"(
    [[material]]
    name = "grey"
    type = "diffuse"
    scales = { around = 10, height = 0.2 }
    [[material]]
    name = "voronoi"
    type = "skin"
    scales = { pattern = "voronoi", around = 10, rows = 40, height = 0.2 }
    [[material]]
    name = "file"
    type = "skin"
    bump = { file = "h.exr", tiles = [4, 5], height = 0.1 }
  )"));
  const Relief &hexagons = *scene.materials[0].relief, &voronoi = *scene.materials[1].relief,
               &file = *scene.materials[2].relief;
  EXPECT_NEAR(hexagons.height, 0.02, 1e-12);  // of a unit of u, which ten scales share
  EXPECT_NEAR(hexagons.tiles.x, 10, 1e-12);
  EXPECT_NEAR(hexagons.tiles.y, 10 / std::sqrt(3.0), 1e-12);  // a tile holds two rows
  EXPECT_NEAR(voronoi.tiles.x, 1, 1e-12);
  EXPECT_NEAR(voronoi.tiles.y, 1, 1e-12);
  EXPECT_NEAR(file.height, 0.025, 1e-12);
  EXPECT_EQ(file.tiles.y, 5);
  EXPECT_EQ(file.map->values, (std::vector<float>{0, 1}));
}

TEST(Scene, SnakeScalesFitBodyAndHead) {
  const Relief relief = *scene_from(kCamera + kMaterial +
                                    "scales = { pattern = 'snake', around = 13, height = 0.2 }\n" + kSphere)
                             .materials[0]
                             .relief;
  EXPECT_NEAR(relief.height, 0.2 / 13, 1e-12);
  EXPECT_EQ(relief.tiles.x, 1);
  EXPECT_EQ(relief.tiles.y, 8);  // whole; of regular hexagons 7.5
  ASSERT_TRUE(relief.head);
  // Both maps have pixels of one shape.
  EXPECT_NEAR(relief.head->height / relief.tiles.y / relief.head->width,
              1.0 * relief.map->height / relief.map->width, 1e-3);
}

TEST(Scene, EyesComeLastWithTheirOwnMaterialOrThatOfTheSkin) {
  const std::string snake = "[[object]]\ntype = 'snake'\nresolution = 16\nscale = 3\nmaterial = 'grey'\n";
  const std::string gloss = "[[material]]\nname = 'eye'\ntype = 'gloss'\nroughness = 0.2\n";
  const Scene scene =
      scene_from(kCamera + kMaterial + gloss + snake + "eye_material = 'eye'\n" + snake + kSphere);
  EXPECT_EQ(scene.materials[1].type, SceneMaterial::Type::gloss);
  EXPECT_EQ(scene.materials[1].roughness, 0.2);
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_TRUE(std::holds_alternative<Sphere>(scene.objects[2].shape));
  EXPECT_EQ(scene.objects[0].material, 0);
  EXPECT_EQ(scene.objects[3].material, 1);
  EXPECT_EQ(scene.objects[4].material, 0);
  const Snake unscaled = make_snake({.resolution = 16});
  EXPECT_EQ(length(std::get<Mesh>(scene.objects[3].shape).positions[5] - 3 * unscaled.eyes.positions[5]), 0);
}

TEST(Scene, ObjectsAreScaledThenTurnedThenMoved) {
  const Scene scene = scene_from(kCamera + kMaterial + R"(
    [[object]]
    type = "torus"
    major_radius = 1
    minor_radius = 0.5
    scale = 2
    rotate_deg = [90, 0, 0]
    translate = [10, 0, 0]
    center = [0, 5, 0]
    material = "grey"
    [[object]]
    type = "sphere"
    radius = 1
    scale = 3
    translate = [1, 2, 3]
    material = "grey"
  )");
  const Mesh& torus = std::get<Mesh>(scene.objects[0].shape);
  for (const Vec3& p : torus.positions) EXPECT_LE(std::abs(p.y - 5), 1 + 1e-12);  // its axis is y now
  EXPECT_NEAR(torus.positions[0].x, 10 + 2 * 1.5, 1e-12);
  const Sphere& sphere = std::get<Sphere>(scene.objects[1].shape);
  EXPECT_EQ(sphere.radius, 3);
  EXPECT_EQ(sphere.center.z, 3);
}

TEST(Scene, EnvironmentFileIsLoadedAndScaled) {
  const ScratchFolder folder;
  Image map(4, 2);
  map.set(1, 1, {1, 2, 3});
  write_exr(folder.file("sky.exr"), {map, {}, {}});
  const std::string path =
      folder.write("a.toml", kCamera + kMaterial + kSphere + "[environment]\nfile = 'sky.exr'\nscale = 2\n");
  EXPECT_EQ(load_scene(path).environment.map.get(1, 1), Rgb(2, 4, 6));
  EXPECT_TRUE(load_scene(path).warnings.empty());

  map.set(0, 0, Rgb(-1));
  write_exr(folder.file("sky.exr"), {map, {}, {}});
  const Scene scene = load_scene(path);
  EXPECT_EQ(scene.environment.map.get(0, 0), Rgb());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("1 of 8 pixels have negative components"), std::string::npos)
      << scene.warnings[0];

  map.set(0, 0, Rgb(1e9));
  write_exr(folder.file("sky.exr"), {map, {}, {}});
  EXPECT_NE(
      error_of([&] { load_scene(path); }).find("holds the value 1e+09; allowed: up to 1e+09 after scale"),
      std::string::npos);
}

TEST(Scene, TheShippedScenesLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SUNBEAM_SCENES_DIR)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    EXPECT_EQ(error_of([&] { load_scene(entry.path().string()); }), "");
  }
  EXPECT_GT(count, 0);
}

struct BadScene {
  const char* name;
  std::string text;
  std::string message;  // a part of it
};

// For a failed test to say which.
void PrintTo(const BadScene& bad, std::ostream* out) { *out << bad.name; }

class BadSceneTest : public testing::TestWithParam<BadScene> {};

TEST_P(BadSceneTest, IsRefusedWithAMessage) {
  const std::string message = error_of([&] { scene_from(GetParam().text); });
  EXPECT_NE(message.find("test.toml"), std::string::npos) << "message: " << message;
  EXPECT_NE(message.find(GetParam().message), std::string::npos) << "message: " << message;
}

std::string light(const std::string& keys) {
  return kCamera + kMaterial + kSphere + "[[light]]\nradiance = 1\n" + keys;
}
std::string object(const std::string& keys) {
  return kCamera + kMaterial + "[[object]]\nmaterial = 'grey'\n" + keys;
}
std::string material(const std::string& keys) {
  return kCamera + kMaterial + kSphere + "[[material]]\n" + keys;
}
std::string camera(const std::string& keys) { return "[camera]\n" + keys + kMaterial + kSphere; }

INSTANTIATE_TEST_SUITE_P(
    Scene, BadSceneTest,
    testing::Values(
        BadScene{"unknown_key", kCamera + kMaterial + "albdo = 0.3\n" + kSphere,
                 "key 'material[0].albdo': is not known; the nearest valid key is 'albedo'"},
        BadScene{"unknown_section", kCamera + kMaterial + kSphere + "[rendr]\nspp = 3\n",
                 "nearest valid key is 'render'"},
        BadScene{"unknown_material",
                 kCamera + kMaterial + kSphere + "[[object]]\ntype = 'plane'\nmaterial = 'gray'\n",
                 "key 'object[1].material': found \"gray\"; the nearest material is \"grey\""},
        BadScene{"no_material", kCamera + kSphere, "the scene has no [[material]]"},
        BadScene{"duplicate_material", material("name = 'grey'\ntype = 'diffuse'\n"),
                 "found \"grey\" a second time"},
        BadScene{"zero_objects", kCamera + kMaterial, "key 'object': found none; allowed: at least one"},
        BadScene{"no_camera", kMaterial + kSphere, "key 'camera.position'"},
        BadScene{"camera_at_look_at", camera("position = [1, 2, 3]\nlook_at = [1, 2, 3]\n"),
                 "key 'camera.look_at': is the same point as position"},
        BadScene{"up_along_view", camera("position = [0, 0, 9]\nlook_at = [0, 0, 0]\n"),
                 "key 'camera.up': is parallel"},
        BadScene{"zero_up", camera("position = [0, 0, 9]\nlook_at = [0, 0, 0]\nup = [0, 0, 0]\n"),
                 "of length 0"},
        BadScene{"fov", camera("position = [0, 9, 9]\nlook_at = [0, 0, 0]\nfov_deg = 180\n"),
                 "found 180; allowed: 0.1 to 175"},
        BadScene{"nan_position", camera("position = [nan, 0, 9]\nlook_at = [0, 0, 0]\n"),
                 "key 'camera.position'"},
        BadScene{"far_position", camera("position = [1e30, 0, 9]\nlook_at = [0, 0, 0]\n"), "found 1e+30"},
        BadScene{"zero_width", kCamera + kMaterial + kSphere + "[render]\nwidth = 0\n",
                 "key 'render.width': found 0"},
        BadScene{"zero_spp", kCamera + kMaterial + kSphere + "[render]\nspp = 0\n",
                 "key 'render.spp': found 0"},
        BadScene{"negative_radius", object("type = 'sphere'\ncenter = [0, 0, 0]\nradius = -1\n"),
                 "key 'object[0].radius': found -1"},
        BadScene{"turned_exact_sphere", object("type = 'sphere'\nradius = 1\nrotate_deg = [0, 90, 0]\n"),
                 "key 'object[0].rotate_deg': turns no exact sphere"},
        BadScene{"far_object", object("type = 'torus'\nmajor_radius = 9e5\nminor_radius = 5e5\nscale = 2\n"),
                 "key 'object[0].type': the object reaches"},
        BadScene{"eye_material", object("type = 'snake'\nresolution = 16\neye_material = 'gray'\n"),
                 "key 'object[0].eye_material': found \"gray\"; the nearest material is \"grey\""},
        BadScene{"eye_material_of_a_torus",
                 object("type = 'torus'\nmajor_radius = 2\nminor_radius = 1\neye_material = 'grey'\n"),
                 "'object[0].eye_material': is not known"},
        BadScene{"gloss_ior", material("name = 'b'\ntype = 'gloss'\nior = 1\n"),
                 "key 'material[1].ior': found 1; allowed: 1.01 to 4"},
        BadScene{"few_scales_of_a_snake",
                 material("name = 'b'\ntype = 'skin'\nscales = { pattern = 'snake', around = 11 }\n"),
                 "key 'material[1].scales.around': found 11; allowed: 12 to 400"},
        BadScene{
            "rows_of_a_snake",
            material("name = 'b'\ntype = 'skin'\nscales = { pattern = 'snake', around = 12, rows = 12 }\n"),
            "'material[1].scales.rows': is not known"},
        BadScene{"snake_turns", object("type = 'snake'\nturns = 0.5\n"), "found 0.5; allowed: 1 to 6"},
        BadScene{
            "scales_and_bump",
            material("name = 'b'\ntype = 'diffuse'\nscales = { around = 3 }\nbump = { file = 'a.exr' }\n"),
            "key 'material[1].bump': cannot stand beside scales"},
        BadScene{"scales_without_number", material("name = 'b'\ntype = 'skin'\nscales = {}\n"),
                 "key 'material[1].scales.around'"},
        BadScene{"unknown_scales_key",
                 material("name = 'b'\ntype = 'skin'\nscales = { around = 3, hight = 1 }\n"),
                 "nearest valid key is 'height'"},
        BadScene{"jitter_of_hexagons",
                 material("name = 'b'\ntype = 'skin'\nscales = { around = 3, jitter = 1 }\n"),
                 "'material[1].scales.jitter': is not known"},
        BadScene{"bump_file", material("name = 'b'\ntype = 'skin'\nbump = { file = 'a.jpg', height = 1 }\n"),
                 "key 'material[1].bump.file': a.jpg: extension is '.jpg'"},
        BadScene{"fat_torus",
                 object("type = 'torus'\ncenter = [0, 0, 0]\nmajor_radius = 1\nminor_radius = 1\n"),
                 "key 'object[0].minor_radius': found 1; allowed: below major_radius, 1"},
        BadScene{"zero_normal", object("type = 'plane'\nnormal = [0, 0, 0]\n"), "key 'object[0].normal'"},
        BadScene{"object_type", object("type = 'cube'\n"), "found \"cube\"; allowed: \"sphere\", \"torus\""},
        BadScene{"material_type", material("name = 'b'\ntype = 'metal'\n"),
                 "allowed: \"skin\", \"diffuse\", \"gloss\""},
        BadScene{"albedo", material("name = 'b'\ntype = 'diffuse'\nalbedo = 1.5\n"),
                 "found 1.5; allowed: 0 to 1"},
        BadScene{"skin_albedo", material("name = 'b'\ntype = 'skin'\nalbedo = 0.5\n"),
                 "'material[1].albedo': is not known"},
        BadScene{"film_thickness", material("name = 'b'\ntype = 'skin'\nfilm_thickness_nm = -1\n"),
                 "found -1"},
        BadScene{"base_ior", material("name = 'b'\ntype = 'skin'\nbase_ior = 0.9\n"),
                 "found 0.9; allowed: 1 to inf"},
        BadScene{"absorption", material("name = 'b'\ntype = 'skin'\nabsorption_per_nm = -0.1\n"),
                 "found -0.1"},
        BadScene{"flat_quad",
                 light("type = 'quad'\ncenter = [0, 0, 1]\nedge_u = [1, 0, 0]\nedge_v = [-2, 0, 0]\n"),
                 "key 'light[0].edge_v': spans no area"},
        BadScene{"corner_and_center",
                 light("type = 'quad'\ncenter = [0, 0, 1]\ncorner = [0, 0, 1]\nedge_u = [1, 0, 0]\nedge_v = "
                       "[0, 1, 0]\n"),
                 "allowed: exactly one of corner and center"},
        BadScene{"negative_radiance",
                 kCamera + kMaterial + kSphere +
                     "[[light]]\ntype = 'point'\nposition = [0, 0, 3]\nintensity = -1\n",
                 "key 'light[0].intensity': found -1"},
        BadScene{"sun_below_the_horizon",
                 kCamera + kMaterial + kSphere + "[environment]\nsky = {sun_direction = [1, 0, -0.1]}\n",
                 "key 'environment.sky.sun_direction': points below the horizon"},
        BadScene{"sphere_light_without_size", light("type = 'sphere'\ncenter = [0, 0, 1]\nradius = 0\n"),
                 "key 'light[0].radius': found 0"},
        BadScene{"directional_light_without_direction", light("type = 'directional'\ntowards = [0, 0, 0]\n"),
                 "found a vector of length 0"},
        BadScene{"two_environments",
                 kCamera + kMaterial + kSphere + "[environment]\ncolor = 1\nfile = 'sky.exr'\n",
                 "key 'environment.color': found more than one of color, file and sky"}),
    [](const auto& info) { return std::string(info.param.name); });

SceneMaterial varying_skin(const std::string& thickness) {
  return scene_from(kCamera + kSphere + "[[material]]\nname = 'grey'\ntype = 'skin'\nfilm_thickness_nm = {" +
                    thickness + "}\n")
      .materials[0];
}

TEST(Scene, ParametersVaryOverTheSurface) {
  const auto at = [](const SceneMaterial& skin, double u, double v) {
    return skin.parameters_at({u, v}).film_thickness_nm;
  };
  const SceneMaterial ramp = varying_skin("from = 200, to = 400, ramp = [0.5, 0]");
  EXPECT_TRUE(ramp.varies());
  EXPECT_DOUBLE_EQ(at(ramp, 1, 7), 300);
  EXPECT_DOUBLE_EQ(at(ramp, 5, 0), 400);  // held
  const SceneMaterial bands = varying_skin("from = 400, to = 200, bands = [0, 3]");
  EXPECT_NEAR(at(bands, 0.3, 1.0 / 3), 400, 1e-9);
  EXPECT_NEAR(at(bands, 0.3, 0.5), 200, 1e-9);
  EXPECT_EQ(bands.parameters[0]->bounds(), std::pair(200.0, 400.0));
  const SceneMaterial noise = varying_skin("from = 200, to = 400, noise = {cells = 3}, tiles = [2, 1]");
  double low = 1000, high = 0;
  for (int i = 0; i < 4096; ++i) {
    const double u = (i % 64) / 64.0, v = (i / 64) / 64.0, value = at(noise, u, v);
    EXPECT_NEAR(value, at(noise, u + 0.5, v - 1), 1e-9);  // repeats
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_GE(low, 200);
  EXPECT_LT(low, 250);
  EXPECT_GT(high, 350);
  EXPECT_LE(high, 400);
}

TEST(Scene, BadFieldsAreRefused) {
  EXPECT_NE(error_of([] {
              varying_skin("from = 200, to = 400");
            }).find("exactly one of ramp, bands, noise and file"),
            std::string::npos);
  EXPECT_NE(error_of([] { varying_skin("from = 200, to = -1, ramp = [1, 0]"); }).find("film_thickness_nm.to"),
            std::string::npos);
  EXPECT_NE(error_of([] { varying_skin("from = 200, to = 400, bands = [1]"); }).find("allowed: 2"),
            std::string::npos);
  EXPECT_NE(error_of([] { varying_skin("from = 200, to = 400, file = 'missing.png'"); }).find("missing.png"),
            std::string::npos);
}

TEST(Scene, SkyBringsItsSun) {
  const std::string sky = kCamera + kMaterial + kSphere + "[environment]\nsky = {sun_direction = [1, 0, 2]";
  const Scene scene = scene_from(sky + "}\n");
  EXPECT_EQ(scene.environment.map.width, 512);
  ASSERT_EQ(scene.directional_lights.size(), 1u);
  EXPECT_NEAR(scene.directional_lights[0].towards.z, 2 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(scene.directional_lights[0].angle_deg, 0.53, 0.01);
  EXPECT_TRUE(scene_from(sky + ", sun = false}\n").directional_lights.empty());
}

TEST(Scene, MissingEnvironmentFileIsNamed) {
  const std::string message =
      error_of([] { scene_from(kCamera + kMaterial + kSphere + "[environment]\nfile = 'missing.exr'\n"); });
  EXPECT_NE(message.find("key 'environment.file': missing.exr: cannot read: No such file"), std::string::npos)
      << message;
}

// --- OBJ meshes ---

std::string mesh_error(const std::string& obj) {
  const ScratchFolder folder;
  folder.write("m.obj", obj);
  const std::string text =
      kCamera + kMaterial + "[[object]]\ntype = 'mesh'\nfile = 'm.obj'\nmaterial = 'grey'\n";
  return error_of([&] { load_scene(folder.write("a.toml", text)); });
}

void expect_mesh_error(const std::string& obj, const std::string& part) {
  const std::string message = mesh_error(obj);
  EXPECT_NE(message.find("m.obj"), std::string::npos) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Scene, MissingMeshFileIsNamed) {
  const std::string text =
      kCamera + kMaterial + "[[object]]\ntype = 'mesh'\nfile = 'missing.obj'\nmaterial = 'grey'\n";
  const std::string message = error_of([&] { scene_from(text); });
  EXPECT_TRUE(message.starts_with("test.toml")) << message;
  EXPECT_NE(message.find("key 'object[0].file': missing.obj: cannot read: No such file"), std::string::npos)
      << message;
}

TEST(Scene, BadMeshesAreRefused) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(mesh_error(corners + "f 1 2 3\n"), "");
  expect_mesh_error("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
                    "m.obj:2: 'v' entry 1 is 'nan'; allowed: a finite number");
  expect_mesh_error("v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n", "m.obj:2: 'v' entry 2 is 'inf'");
  expect_mesh_error("v 0 0 0\nv 1 0 1e99\nv 0 1 0\nf 1 2 3\n", "m.obj:2: 'v' entry 3 is '1e99'");
  expect_mesh_error("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "m.obj:2: 'v' entry 3 is ''");
  expect_mesh_error(corners + "f 1 2 4\n", "m.obj:4: face index 4; allowed: 1 to 3");
  expect_mesh_error(corners + "f 1 2 -4\n", "m.obj:4: face index '-4'");
  expect_mesh_error(corners + "f 0 1 2\n", "m.obj:4: face index '0'");
  expect_mesh_error(corners + "vn 0 0 1\nf 1//1 2//1 3//9\n", "m.obj:5: normal index 9; allowed: 1 to 1");
  expect_mesh_error(corners + "vn 0 0 0\nf 1//1 2//1 3//1\n", "normal 1 has length 0");
  expect_mesh_error(corners, "the mesh has no face");
  expect_mesh_error("", "the mesh has no face");
  expect_mesh_error("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
                    "found 1 triangles without area and no other face");
  expect_mesh_error(corners + "f 1 2 2\n", "found 1 triangles without area and no other face");
}

}  // namespace
}  // namespace sunbeam
