// SPDX-License-Identifier: Apache-2.0
// Every format gives the same triangles in the file's own frame.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "offline/mesh/bundled/writers.h"
#include "offline/mesh/mesh_reader.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using testing::HasSubstr;

const std::vector<Eigen::Vector3f> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};

bool contains(const Mesh& mesh, const Eigen::Vector3f& p) {
  return std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [&](const Eigen::Vector3f& q) { return (p - q).norm() < 1e-5F; });
}

double signed_volume(const Mesh& mesh) {
  double six = 0;
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
      six += a.dot(mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
    }
  }
  return six / 6;
}

// Four triangles, outside out, the four corners after `change` and nothing else, unit normals outwards.
void expect_tetrahedron(const Mesh& mesh, const Eigen::Affine3f& change = Eigen::Affine3f::Identity()) {
  EXPECT_EQ(mesh.triangle_count(), 4U);
  EXPECT_NEAR(signed_volume(mesh), std::abs(change.linear().determinant()), 1e-5);
  std::vector<Eigen::Vector3f> wanted;
  for (const Eigen::Vector3f& p : kCorners) {
    wanted.emplace_back(change * p);
    EXPECT_TRUE(contains(mesh, wanted.back())) << wanted.back().transpose();
  }
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const Eigen::Vector3f& q : mesh.vertices) {
    EXPECT_TRUE(
        std::any_of(wanted.begin(), wanted.end(), [&](const auto& p) { return (p - q).norm() < 1e-5F; }));
  }
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      const Eigen::Vector3f a = mesh.vertices[t[0]];
      const Eigen::Vector3f out = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
      for (const auto v : t) {
        EXPECT_GT(mesh.normals[v].dot(out), 0.99F);
      }
    }
  }
}

const Eigen::Vector3f& colour_of(const Mesh& mesh, const Eigen::Vector3f& p) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if ((mesh.vertices[i] - p).norm() < 1e-5F) return mesh.colours[i];
  }
  throw std::logic_error("no such vertex");
}

class MeshFormats : public testing::Test {
 protected:
  Mesh read(const std::string& name, const std::string& content) {
    return read_mesh(folder_.write(name, content));
  }
  TemporaryFolder folder_;
};

TEST_F(MeshFormats, PlyWithColoursDropsUnusedVertices) {
  const Mesh mesh = read("t.ply", tetrahedron_ply());
  expect_tetrahedron(mesh);
  EXPECT_TRUE(colour_of(mesh, {1, 0, 0}).isApprox(Eigen::Vector3f(1, 0, 0)));
  EXPECT_TRUE(colour_of(mesh, {0, 0, 3}).isApprox(Eigen::Vector3f(0, 0, 0.2F)));
  EXPECT_EQ(mesh.parts[0].diffuse, Eigen::Vector3f(1, 1, 1));
}

TEST_F(MeshFormats, ObjWithoutMaterialIsWhite) {
  const Mesh mesh = read("t.obj", tetrahedron_obj());
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.parts[0].texture, -1);
  EXPECT_EQ(mesh.parts[0].diffuse, Eigen::Vector3f(1, 1, 1));
}

TEST_F(MeshFormats, StlTextAndBinary) {
  expect_tetrahedron(read("t.stl", tetrahedron_stl()));
  const Mesh mesh = read("b.STL", tetrahedron_binary_stl());
  expect_tetrahedron(mesh);
  EXPECT_EQ(mesh.parts[0].diffuse, Eigen::Vector3f(1, 1, 1));
}

TEST_F(MeshFormats, GltfColoursBecomeSrgb) {
  const Mesh mesh = read("t.gltf", tetrahedron_gltf());
  expect_tetrahedron(mesh);
  EXPECT_NEAR(colour_of(mesh, {1, 0, 0}).x(), 0.7354F, 1e-3F);  // sRGB of linear one half
  EXPECT_NEAR(colour_of(mesh, {1, 0, 0}).y(), 0, 1e-6F);
}

TEST_F(MeshFormats, GltfNodeTransformsApply) {
  Eigen::Affine3f change = Eigen::Affine3f::Identity();
  change.translate(Eigen::Vector3f(4, 5, 6)).scale(Eigen::Vector3f(2, 1, 0.5F));
  expect_tetrahedron(read("t.gltf", tetrahedron_gltf(R"(,"translation":[4,5,6],"scale":[2,1,0.5])")), change);
}

TEST_F(MeshFormats, AMirroringNodeKeepsTheOutsideOut) {
  Eigen::Affine3f change = Eigen::Affine3f::Identity();
  change.scale(Eigen::Vector3f(-1, 1, 1));
  expect_tetrahedron(read("t.gltf", tetrahedron_gltf(R"(,"scale":[-1,1,1])")), change);
}

TEST_F(MeshFormats, ColladaKeepsItsAxesAndAppliesItsUnit) {
  for (const char* axis : {"X_UP", "Y_UP", "Z_UP"}) expect_tetrahedron(read("t.dae", tetrahedron_dae(axis)));
  Eigen::Affine3f change = Eigen::Affine3f::Identity();
  change.scale(0.25F);
  expect_tetrahedron(read("u.dae", tetrahedron_dae("Y_UP", "0.25")), change);
  // A node turned about x by 90 deg and moved: y goes to z, z to -y.
  change = Eigen::Affine3f::Identity();
  change.translate(Eigen::Vector3f(1, 2, 3)).rotate(Eigen::AngleAxisf(1.57079633F, Eigen::Vector3f::UnitX()));
  expect_tetrahedron(read("n.dae", tetrahedron_dae("Y_UP", "1", "1 0 0 1 0 0 -1 2 0 1 0 3 0 0 0 1")), change);
}

TEST_F(MeshFormats, UnitsScale) {
  Eigen::Affine3f change = Eigen::Affine3f::Identity();
  change.scale(0.001F);
  const Mesh mesh = read_mesh(folder_.write("t.ply", tetrahedron_ply()), 0.001);
  EXPECT_NEAR(signed_volume(mesh), 1e-9, 1e-12);
  expect_tetrahedron(scaled(mesh, 1000));
}

// A 2 x 2 picture, one colour per texel; the vertices' texture coordinates are texel centres.
class Textures : public MeshFormats {
 protected:
  Textures() {
    cv::Mat image(2, 2, CV_8UC3);
    image.at<cv::Vec3b>(0, 0) = {255, 0, 0};
    image.at<cv::Vec3b>(0, 1) = {0, 255, 0};
    image.at<cv::Vec3b>(1, 0) = {0, 0, 255};
    image.at<cv::Vec3b>(1, 1) = {9, 9, 9};
    const FileBytes bytes = png_bytes(image);
    png_.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  Mesh read_with(const std::string& mtl) {
    folder_.write("t.mtl", mtl);
    return read("t.obj", "mtllib t.mtl\nusemtl m\n" + tetrahedron_obj());
  }
  std::string png_;
};

TEST_F(Textures, ObjTextureIsRgbWithVUp) {
  folder_.write("t.png", png_);
  const Mesh mesh = read_with("newmtl m\nKd 0.5 1 1\nmap_Kd t.png\n");
  expect_tetrahedron(mesh);
  ASSERT_EQ(mesh.textures.size(), 1U);
  ASSERT_EQ(mesh.parts.size(), 1U);
  EXPECT_EQ(mesh.parts[0].texture, 0);
  EXPECT_NEAR(mesh.parts[0].diffuse.x(), 0.5F, 1e-6F);
  EXPECT_EQ(mesh.textures[0].at<cv::Vec3b>(0, 0), cv::Vec3b(255, 0, 0));
  // uv (0.25, 0.75): the upper left texel.
  EXPECT_TRUE(std::any_of(mesh.uvs.begin(), mesh.uvs.end(),
                          [](const auto& t) { return t.isApprox(Eigen::Vector2f(0.25F, 0.75F)); }));
}

TEST_F(Textures, BlackDiffuseBesideATextureMeansTheTexture) {
  folder_.write("t.png", png_);
  EXPECT_EQ(read_with("newmtl m\nKd 0 0 0\nmap_Kd t.png\n").parts[0].diffuse, Eigen::Vector3f(1, 1, 1));
}

TEST_F(Textures, InAFolderBelowAndWithBackslash) {
  folder_.write("pictures/t.png", png_);
  EXPECT_EQ(read_with("newmtl m\nmap_Kd pictures\\t.png\n").textures.size(), 1U);
  EXPECT_EQ(read_with("newmtl m\nmap_Kd ./pictures/../pictures/t.png\n").textures.size(), 1U);
}

TEST_F(Textures, OutsideOfTheFolderIsRefused) {
  const std::string outside = folder_.write("outside/t.png", png_).string();
  folder_.write("inside/t.obj", "mtllib t.mtl\nusemtl m\n" + tetrahedron_obj());
  std::filesystem::create_symlink(outside, folder_.path() / "inside/link.png");
  for (const std::string& name :
       {std::string("../outside/t.png"), outside, std::string("../../../../etc/hostname"),
        std::string("..\\outside\\t.png"), std::string("C:\\t.png"), std::string("link.png")}) {
    folder_.write("inside/t.mtl", "newmtl m\nmap_Kd " + name + "\n");
    const std::string error = input_error_of([&] { read_mesh(folder_.path() / "inside/t.obj"); });
    EXPECT_THAT(error, HasSubstr("outside of the mesh's folder")) << name;
    EXPECT_THAT(error, HasSubstr("inside/t.obj")) << name;
  }
}

TEST_F(Textures, MaterialsOutsideOfTheFolderAreRefused) {
  folder_.write("t.mtl", "newmtl m\nKd 1 0 0\n");
  const auto file = folder_.write("inside/t.obj", "mtllib ../t.mtl\nusemtl m\n" + tetrahedron_obj());
  EXPECT_THAT(input_error_of([&] { read_mesh(file); }), HasSubstr("outside of the mesh's folder"));
}

TEST_F(Textures, MissingFilesAreNamed) {
  EXPECT_THAT(input_error_of([&] { read_with("newmtl m\nmap_Kd gone.png\n"); }), HasSubstr("gone.png"));
  EXPECT_THAT(input_error_of([&] { read("m.obj", "mtllib gone.mtl\nusemtl m\n" + tetrahedron_obj()); }),
              HasSubstr("gone.mtl"));
}

TEST_F(Textures, DamagedPictureIsNamed) {
  folder_.write("t.png", png_.substr(0, png_.size() / 2));
  EXPECT_THAT(input_error_of([&] { read_with("newmtl m\nmap_Kd t.png\n"); }), HasSubstr("t.png: bad PNG"));
  folder_.write("t.png", "GIF89a, not a PNG");
  EXPECT_THAT(input_error_of([&] { read_with("newmtl m\nmap_Kd t.png\n"); }),
              HasSubstr("neither PNG nor JPEG"));
}

}  // namespace
}  // namespace sextant
