#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "check_dae.h"
#include "mesh_cleanup.h"
#include "read_file.h"
#include "tissue_contact/instrument/collision_shape.h"

namespace tissue_contact {
namespace {

constexpr std::uintmax_t kMaxMeshBytes = 128u << 20;
constexpr std::size_t kMaxTriangles = 2000000;  // a collision surface has some hundred to some ten thousand

using Matrix4 = Eigen::Matrix4d;

/// Lets assimp open the mesh file and nothing else: material and texture files do not matter here, and a name in a file
/// must not make us read devices or pipes.
class SingleFileSystem : public Assimp::DefaultIOSystem {
 public:
  explicit SingleFileSystem(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* file) const override { return file_ == file && Assimp::DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return file_ == file ? Assimp::DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  std::string file_;
};

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw std::invalid_argument("mesh file '" + file + "' " + what);
}

std::string lowerCaseExtension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

struct Soup {
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
};

/// Appends a mesh, moved by its node's transform. Points and lines are skipped.
void appendMesh(const aiMesh& mesh, const Matrix4& X, const std::string& file, Soup& soup) {
  if (soup.triangles.size() + mesh.mNumFaces > kMaxTriangles) {
    refuse(file, "has more than " + std::to_string(kMaxTriangles) + " triangles; simplify it");
  }
  const auto first = static_cast<int>(soup.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    const Vector3 p = (X * Eigen::Vector4d(v.x, v.y, v.z, 1.0)).head<3>();
    if (!p.allFinite()) refuse(file, "has a vertex that is not finite (number " + std::to_string(i) + " of a mesh)");
    soup.vertices.push_back(p);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    Triangle triangle{};
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) refuse(file, "has a face with an index out of range");
      triangle[k] = first + static_cast<int>(face.mIndices[k]);
    }
    // A node that mirrors its mesh turns the triangles inside out.
    if (X.topLeftCorner<3, 3>().determinant() < 0.0) std::swap(triangle[1], triangle[2]);
    soup.triangles.push_back(triangle);
  }
}

/// Depth-first over the nodes; their depth is bounded by checkDae() (STL and OBJ have one level).
void appendNode(const aiScene& scene, const aiNode& node, const Matrix4& X_parent, const std::string& file,
                Soup& soup) {
  const aiMatrix4x4& m = node.mTransformation;
  Matrix4 local;
  local << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  const Matrix4 X = X_parent * local;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) appendMesh(*scene.mMeshes[node.mMeshes[i]], X, file, soup);
  for (unsigned i = 0; i < node.mNumChildren; ++i) appendNode(scene, *node.mChildren[i], X, file, soup);
}

Soup readSoup(const std::string& file) {
  Assimp::Importer importer;
  importer.SetIOHandler(new SingleFileSystem(file));  // the importer deletes it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse(file, std::string("cannot be read: ") + importer.GetErrorString());
  }
  Soup soup;
  appendNode(*scene, *scene->mRootNode, Matrix4::Identity(), file, soup);
  return soup;
}

void applyScale(const Vector3& scale, const std::string& file, TriangleMesh& mesh) {
  mesh.vertices = scale.asDiagonal() * mesh.vertices;
  if (!mesh.vertices.allFinite()) refuse(file, "has vertices that are not finite after scaling");
  if (scale.prod() < 0.0) {  // a mirror turns the triangles inside out
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace

TriangleMesh loadTriangleMesh(const std::string& file, const Vector3& scale) {
  requireRegularFile(file, "mesh file", kMaxMeshBytes);
  const std::string extension = lowerCaseExtension(file);
  if (extension != ".stl" && extension != ".obj" && extension != ".dae") {
    refuse(file, "has the extension '" + extension + "'; use .stl, .obj or .dae");
  }
  if (!scale.allFinite() || !(scale.array() != 0.0).all()) {
    refuse(file, "has a scale that is zero or not finite; use e.g. 0.001 0.001 0.001 for a file in millimetres");
  }
  if (extension == ".dae") checkDae(readFile(file, "mesh file", kMaxMeshBytes), "mesh file '" + file + "'");
  const Soup soup = readSoup(file);
  if (soup.triangles.empty()) refuse(file, "has no triangles");
  TriangleMesh mesh = mergeVertices(soup.vertices, soup.triangles);
  orientOutward(mesh);
  dropFlatTriangles(mesh);
  dropUnusedVertices(mesh);
  if (mesh.triangles.empty()) refuse(file, "has degenerate triangles only");
  applyScale(scale, file, mesh);
  return mesh;
}

}  // namespace tissue_contact
