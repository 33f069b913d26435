// SPDX-License-Identifier: Apache-2.0
// Small meshes in every format, written for the tests, and a folder that goes when the test ends.
#pragma once

#include <filesystem>
#include <string>

#include "offline/mesh/mesh.h"

namespace sextant {

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  /// Writes a file (folders too) and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& content) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The message of the InputError that f throws; fails the test (and gives "") where it throws none.
template <typename F>
std::string input_error_of(const F& f);

/// A file that the repository brings.
std::filesystem::path repository_file(const std::string& name);

std::string file_content(const std::filesystem::path& file);

/// A tetrahedron with corners (0,0,0), (1,0,0), (0,2,0), (0,0,3): every axis has its own length.
std::string tetrahedron_ply();
std::string tetrahedron_obj();
std::string tetrahedron_stl();  ///< text
std::string tetrahedron_binary_stl();
/// `scale` and `translate` of the node; the vertex colours of corners 1 to 3 are linear red, green, blue
/// halves.
std::string tetrahedron_gltf(const std::string& node_members = "");
std::string tetrahedron_dae(const std::string& up_axis = "Z_UP", const std::string& metres = "1",
                            const std::string& node_matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");

/// Triangles only, for tests of geometry: a closed box around the origin.
Mesh box_mesh(double x, double y, double z);
/// A closed cylinder about z around the origin.
Mesh cylinder_mesh(double radius, double height, int sides);
/// Joins two meshes without textures.
Mesh joined(const Mesh& a, const Mesh& b);
Mesh moved(Mesh mesh, const Eigen::Vector3d& by);
Mesh scaled(Mesh mesh, double by);

}  // namespace sextant

#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {

template <typename F>
std::string input_error_of(const F& f) {
  try {
    f();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace sextant
