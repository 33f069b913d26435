// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mesh_import.h"

#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>

#include "offline/mesh/mesh_folder.h"
#include "offline/mesh/texture.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

struct Format {
  const char* extension;
  const char* importer;  // assimp's name of the only importer that may read it
};
constexpr Format kFormats[] = {{"ply", "Stanford Polygon Library (PLY) Importer"},
                               {"obj", "Wavefront Object Importer"},
                               {"stl", "Stereolithography (STL) Importer"},
                               {"gltf", "glTF2 Importer"},
                               {"glb", "glTF2 Importer"},
                               {"dae", "Collada Importer"}};

// All textures of a mesh together: as many pixels as one of the largest size.
constexpr std::size_t kMaxTexturePixels = std::size_t{kMaxTextureSide} * kMaxTextureSide;

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

const Format* format_of(const fs::path& file) {
  const std::string extension = lower_extension(file);
  for (const Format& format : kFormats) {
    if (extension == format.extension) return &format;
  }
  return nullptr;
}

void keep_only(Assimp::Importer& importer, const char* name) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const aiImporterDesc* description = importer.GetImporterInfo(i);
    if (description == nullptr || std::strcmp(description->mName, name) != 0) {
      Assimp::BaseImporter* other = importer.GetImporter(i);
      importer.UnregisterLoader(other);
    }
  }
}

// glTF stores factors and vertex colours linearly; textures and every other format are sRGB encoded.
float srgb_from_linear(float c) {
  return c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F;
}

float to_unit_range(float c) { return c >= 0 ? std::min(c, 1.0F) : 0.0F; }  // NaN becomes 0

std::string percent_decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() &&
        std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
        std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0) {
      out += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

class Flattener {
 public:
  Flattener(const aiScene& scene, const MeshFolder& folder, const fs::path& file)
      : scene_(scene), folder_(folder), file_(file), format_(format_of(file)->extension) {}

  Mesh run() {
    struct Visit {
      const aiNode* node;
      Eigen::Matrix4d mesh_from_parent;
    };
    std::vector<Visit> stack{{scene_.mRootNode, Eigen::Matrix4d::Identity()}};
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      Eigen::Matrix4d parent_from_node;
      for (unsigned r = 0; r < 4; ++r) {
        for (unsigned c = 0; c < 4; ++c) parent_from_node(r, c) = visit.node->mTransformation[r][c];
      }
      const Eigen::Matrix4d mesh_from_node = visit.mesh_from_parent * parent_from_node;
      for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
        const unsigned index = visit.node->mMeshes[i];
        if (index >= scene_.mNumMeshes)
          throw InputError(file_.string(), "refers to a mesh that it does not have");
        add(*scene_.mMeshes[index], mesh_from_node);
      }
      for (unsigned i = visit.node->mNumChildren; i-- > 0;)
        stack.push_back({visit.node->mChildren[i], mesh_from_node});
    }
    return std::move(mesh_);
  }

 private:
  struct Look {
    int texture = -1;
    unsigned uv_channel = 0;
    Eigen::Vector3f diffuse{1, 1, 1};
  };

  void add(const aiMesh& part, const Eigen::Matrix4d& mesh_from_node) {
    if (part.mNumVertices == 0 || part.mVertices == nullptr || part.mNumFaces == 0) return;
    triangles_ += part.mNumFaces;
    vertices_ += part.mNumVertices;
    if (triangles_ > kMaxTriangles || vertices_ > 3 * kMaxTriangles) {
      throw InputError(file_.string(), "has more than 2,000,000 triangles",
                       "simplify it first (10,000 to 100,000 are plenty)");
    }
    const Look& look = look_of(part.mMaterialIndex);
    const bool uvs =
        look.uv_channel < AI_MAX_NUMBER_OF_TEXTURECOORDS && part.HasTextureCoords(look.uv_channel);
    const bool linear = format_ == "gltf" || format_ == "glb";
    const Eigen::Matrix3d turn = mesh_from_node.topLeftCorner<3, 3>();
    const double determinant = turn.determinant();
    // An STL's normals belong to its facets, not to the surface that they approximate.
    const bool normals = part.HasNormals() && format_ != "stl" && std::abs(determinant) > 0;
    const Eigen::Matrix3d turn_normal = normals ? Eigen::Matrix3d(turn.inverse().transpose()) : turn;
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& p = part.mVertices[i];
      mesh_.vertices.emplace_back(
          (mesh_from_node * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>().cast<float>());
      Eigen::Vector3d n = Eigen::Vector3d::Zero();
      if (normals)
        n = turn_normal * Eigen::Vector3d(part.mNormals[i].x, part.mNormals[i].y, part.mNormals[i].z);
      const double length = n.norm();
      mesh_.normals.emplace_back(length > 0 && std::isfinite(length)
                                     ? Eigen::Vector3f((n / length).cast<float>())
                                     : Eigen::Vector3f(0, 0, 0));
      Eigen::Vector3f colour(1, 1, 1);
      if (part.HasVertexColors(0)) {
        const aiColor4D& c = part.mColors[0][i];
        colour = {to_unit_range(c.r), to_unit_range(c.g), to_unit_range(c.b)};
        if (linear) colour = colour.unaryExpr(&srgb_from_linear);
      }
      mesh_.colours.push_back(colour);
      Eigen::Vector2f uv(0, 0);
      if (uvs) {
        const aiVector3D& t = part.mTextureCoords[look.uv_channel][i];
        if (std::isfinite(t.x) && std::isfinite(t.y)) uv = {t.x, t.y};
      }
      mesh_.uvs.push_back(uv);
    }
    MeshPart& to = part_for(look, uvs);
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::array<std::uint32_t, 3> corners{};
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) {
          throw InputError(file_.string(), "a triangle refers to a vertex that is not there",
                           "export it again");
        }
        corners.at(k) = first + face.mIndices[k];
      }
      if (determinant < 0) std::swap(corners[1], corners[2]);  // a mirror turns the inside out
      to.triangles.push_back(corners);
    }
  }

  MeshPart& part_for(const Look& look, bool uvs) {
    const int texture = uvs ? look.texture : -1;
    for (MeshPart& part : mesh_.parts) {
      if (part.texture == texture && part.diffuse == look.diffuse) return part;
    }
    mesh_.parts.push_back({{}, texture, look.diffuse});
    return mesh_.parts.back();
  }

  const Look& look_of(unsigned material) {
    const auto known = looks_.find(material);
    if (known != looks_.end()) return known->second;
    Look look;
    if (material < scene_.mNumMaterials) look = read_look(*scene_.mMaterials[material]);
    return looks_.emplace(material, look).first->second;
  }

  Look read_look(const aiMaterial& material) {
    Look look;
    const bool gltf = format_ == "gltf" || format_ == "glb";
    // assimp invents a grey default material where the file has none.
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    const bool invented =
        format_ == "ply" || format_ == "stl" || std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) == 0;
    aiColor4D c(1, 1, 1, 1);
    const bool found = (gltf && material.Get(AI_MATKEY_BASE_COLOR, c) == aiReturn_SUCCESS) ||
                       material.Get(AI_MATKEY_COLOR_DIFFUSE, c) == aiReturn_SUCCESS;
    if (found && !invented) {
      look.diffuse = {to_unit_range(c.r), to_unit_range(c.g), to_unit_range(c.b)};
      if (gltf) look.diffuse = look.diffuse.unaryExpr(&srgb_from_linear);
    }
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString path;
      if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) continue;
      int channel = 0;
      if (material.Get(AI_MATKEY_UVWSRC(type, 0), channel) == aiReturn_SUCCESS && channel >= 0) {
        look.uv_channel = static_cast<unsigned>(channel);
      }
      look.texture = texture_at(path.C_Str());
      // Some exporters write a black diffuse colour beside a texture and mean the texture alone.
      if (look.diffuse.isZero()) look.diffuse.setOnes();
      break;
    }
    return look;
  }

  int texture_at(const std::string& name) {
    const auto known = textures_.find(name);
    if (known != textures_.end()) return known->second;
    cv::Mat image;
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
      if (embedded->mHeight != 0) {
        throw InputError(file_.string(), "has an embedded texture without a file format",
                         "embed a PNG or JPEG");
      }
      image = decode_texture({reinterpret_cast<const std::byte*>(embedded->pcData), embedded->mWidth},
                             file_.string() + " (embedded texture)");
    } else {
      const std::string plain = percent_decoded(name);
      const bool encoded = plain != name && !folder_.resolve(plain).empty();
      const std::string& found = encoded ? plain : name;
      image = decode_texture(folder_.read(found), (file_.parent_path() / found).string());
    }
    texture_pixels_ += image.total();
    if (texture_pixels_ > kMaxTexturePixels) {
      throw InputError(file_.string(), "has textures of more than 64 million pixels", "make them smaller");
    }
    mesh_.textures.push_back(image);
    const int index = static_cast<int>(mesh_.textures.size()) - 1;
    textures_.emplace(name, index);
    return index;
  }

  const aiScene& scene_;
  const MeshFolder& folder_;
  const fs::path& file_;
  const std::string format_;
  Mesh mesh_;
  std::map<unsigned, Look> looks_;
  std::map<std::string, int> textures_;
  std::size_t triangles_ = 0;
  std::size_t vertices_ = 0;
  std::size_t texture_pixels_ = 0;
};

}  // namespace

std::string mesh_format(const fs::path& file) {
  const Format* format = format_of(file);
  return format == nullptr ? "" : format->extension;
}

Mesh import_mesh(const fs::path& file) {
  const Format* format = format_of(file);
  if (format == nullptr)
    throw InputError(file.string(), "is not a mesh", "give a PLY, OBJ, STL, glTF, GLB or DAE file");
  auto folder_owner = std::make_unique<MeshFolder>(file);
  const MeshFolder& folder = *folder_owner;
  Assimp::Importer importer;
  keep_only(importer, format->importer);
  importer.SetIOHandler(folder_owner.release());
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.filename().string(), aiProcess_Triangulate);
  folder.complain(".mtl");
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError(file.string(),
                     "cannot be read as " + std::string(format->extension) + ": " + reason.substr(0, 200),
                     "export it again");
  }
  if ((scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0)
    throw InputError(file.string(), "is incomplete", "export it again");
  Mesh mesh = Flattener(*scene, folder, file).run();
  folder.complain(".mtl");
  return mesh;
}

}  // namespace sextant
