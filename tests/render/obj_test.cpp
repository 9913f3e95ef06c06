// OBJ as exporters write it: what is valid is read right, all else is refused with its line.
#include <gtest/gtest.h>

#include "tests/render/mesh_support.h"

namespace sunbeam {
namespace {

const std::string kSquare = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
constexpr double kArea = 4;

void expect_area(const std::string& text, double area) {
  const Mesh mesh = mesh_from("m.obj", text);
  SCOPED_TRACE(text.substr(0, 300));
  expect_covers(mesh, area);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

TEST(Obj, ConcavePolygonsAreCoveredOnce) {
  const std::string u =
      "v 1 1 0\nv 1 -0.5 0\nv -1 -0.5 0\nv -1 1 0\nv -1.5 1 0\nv -1.5 -1 0\nv 1.5 -1 0\nv 1.5 1 0\n";
  expect_area(u + "f 1 2 3 4 5 6 7 8\n", 3);
  expect_area("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n", 1.5);  // a quad
  expect_area("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 4 1 2 3\n", 1.5);
}

TEST(Obj, FacesMayLeaveOutIndices) {
  for (const char* face :
       {"f 1// 2// 3// 4//", "f 1/ 2/ 3/ 4/", "f 1 2 3 4", "f -4 -3 -2 -1", "f +1 2 3 4",
        "f 1 2 3 4 # a comment", "f 1 2 3 4# 9", "f 1 2 3 4#", "  f\t1  2\t3 4 ", "f 1 2// 3 4/"})
    expect_area(kSquare + face + "\n", kArea);
  for (const char* face : {"f 1/1 2/1 3/1 4/1", "f 1/1/ 2/1/ 3/1/ 4/1/", "f 1/-1 2/-1 3/-1 4/-1"}) {
    const Mesh mesh = mesh_from("m.obj", kSquare + "vt 0.25 0.75\n" + face);
    expect_covers(mesh, kArea);
    ASSERT_FALSE(mesh.uvs.empty()) << face;
    EXPECT_EQ(mesh.uvs[0].x, 0.25);
    EXPECT_EQ(mesh.uvs[0].y, 0.75);
  }
  const Mesh mesh =
      mesh_from("m.obj", kSquare + "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1/1/1 3/2/1 4/1/1\n");
  EXPECT_TRUE(mesh.uvs.empty());
  EXPECT_EQ(mesh.normals.size(), 6u);
}

TEST(Obj, NumbersAreReadAsExportersWriteThem) {
  const std::string rest = "v 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
  for (const char* vertex : {"v -1 -1 1.07797e-046", "v -1 -1 1e-400", "v -1 -1 -1e-400", "v -1 -1 4.9e-324",
                             "v -1 -1 0 1", "v -1 -1 0 0.5 0.25 1", "v -1 -1 0 1 0.5 0.25 1",
                             "v -1. -1.0e0 +0", "v -1 -1 0 # corner", "v\t-1\t-1\t0\t", "v -1E+0 -1 -0.0"})
    expect_area(std::string(vertex) + "\n" + rest, kArea);
}

TEST(Obj, OneTextureCoordinateHasNoV) {
  const Mesh mesh =
      mesh_from("m.obj", kSquare + "vt 0.25\nvt 0.5 0.75\nvt 1 0.5 0\nf 1/1 2/2 3/3\nf 1/1 3/3 4/2\n");
  expect_covers(mesh, kArea);
  ASSERT_EQ(mesh.uvs.size(), 6u);
  EXPECT_EQ(mesh.uvs[0].x, 0.25);
  EXPECT_EQ(mesh.uvs[0].y, 0);
  EXPECT_EQ(mesh.uvs[1].y, 0.75);
  EXPECT_EQ(mesh.uvs[2].x, 1);
}

TEST(Obj, EveryEndOfALineIsOne) {
  const std::string text = "# a file\n" + kSquare + "\ns off\no square\nf 1 2 3\nf 1 3 4\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    expect_area(replaced(text, "\n", end), kArea);
    expect_area("\xef\xbb\xbf" + replaced(text, "\n", end), kArea);
    expect_mesh_file_error("m.obj", replaced(text + "f 1 2 9\n", "\n", end), "m.obj:11: face index 9");
  }
  expect_area(kSquare + "f 1 2 3 4", kArea);  // the last line need not end
  // A reader and a check that disagree about CR read far beyond the vertices.
  const std::string hidden = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# x\rf 1 2 99999999\rf 3 7000000 1\n";
  expect_mesh_file_error("m.obj", hidden, "m.obj:6: face index 99999999; allowed: 1 to 3");
}

TEST(Obj, ABackslashJoinsLines) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    expect_area(replaced(kSquare + "f 1 2 \\\n 3 \\\n4\n", "\n", end), kArea);
    expect_area(replaced(kSquare + "f 1 2 3\\\n 4\n", "\n", end), kArea);
    expect_area(replaced("v -1 \\\n-1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\\\n", "\n", end), kArea);
  }
  // It does not swallow the line behind a comment, which may end with a folder of Windows.
  expect_area("# from C:\\models\\\n" + kSquare + "f 1 2 3 4\n", kArea);
  expect_mesh_file_error("m.obj", kSquare + "f 1 2 \\\n 9\n", "m.obj:6: face index 9");
}

TEST(Obj, OtherLinesArePassedOver) {
  expect_area("mtllib a.mtl\ng\nusemtl skin # 1\nvp 0.3 0.4\n" + kSquare +
                  "l 1 2\np 3\ncurv 0 1 1 2\nfo 9 9 9\nvtx\n\n \t\ng a b\nf 1 2 3 4\nend\n",
              kArea);
  expect_area("f 1 2 3 4\n" + kSquare, kArea);  // indices may point ahead
}

TEST(Obj, WhatIsWrongIsRefusedWithItsLine) {
  const auto expect_error = [](const std::string& line, const std::string& part) {
    expect_mesh_file_error("m.obj", kSquare + line + "\nf 1 2 3\n", part);
  };
  expect_error("f 1 2 x", "m.obj:5: face index 'x'; allowed: 1 up, or -1 down to -4");
  expect_error("f 1 2 3.5", "m.obj:5: face index '3.5'");
  expect_error("f 1 2 3x", "m.obj:5: face index '3x'");
  expect_error("f 1 2 /3", "m.obj:5: face index '/3'");
  expect_error("f 1 2 +-3", "m.obj:5: face index '+-3'");
  expect_error("f 1 2 0", "m.obj:5: face index '0'");
  expect_error("f 1 2 -5", "m.obj:5: face index '-5'");
  expect_error("f 1 2 5", "m.obj:5: face index 5; allowed: 1 to 4");
  expect_error("f 1 2 4294967297", "m.obj:5: face index 4294967297; allowed: 1 to 4");
  expect_error("f 1 2 99999999999999999999", "m.obj:5: face index '99999999999999999999'");
  expect_error("f 1/2/3/4 2 3", "m.obj:5: a face has the corner '1/2/3/4'; allowed: up to v/vt/vn");
  expect_error("v 0 0", "m.obj:5: 'v' entry 3 is ''; allowed: a finite number");
  expect_error("v 0 0 # 1", "m.obj:5: 'v' entry 3 is ''");
  expect_error("vn 0 0", "m.obj:5: 'vn' entry 3 is ''");
  expect_error("vt", "m.obj:5: 'vt' entry 1 is ''");
  expect_error("vt 0 nan", "m.obj:5: 'vt' entry 2 is 'nan'");
  expect_error("v 1,5 0 0", "m.obj:5: 'v' entry 1 is '1,5'");
  expect_error("v 0 0 1e39", "m.obj:5: 'v' entry 3 is '1e39'");  // beyond single precision
  expect_error("v 0 0 " + std::string(5000, 'x'), std::string(60, 'x') + "...'");
  expect_error("v 0 0 \x1b[31m", "\\x1b[31m");
  expect_mesh_file_error("m.obj", "\xff\xfev\0 \0", "UTF-16");
}

// A corner takes 2 bytes of the file and 204 of the mesh.
TEST(Obj, AMeshBeyondTheLimitIsRefused) {
  std::string text = kSquare + "f";
  for (int i = 0; i < 1300000; ++i) text += " 1 2 3 4";
  expect_mesh_file_error("m.obj", text, "a mesh of 15599994 vertices and 5199998 triangles asks for 1061 MB");
}

}  // namespace
}  // namespace sunbeam
