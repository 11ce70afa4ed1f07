#include "mesh/reader/assimp_reader.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstddef>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mesh/reader/isolated.h"
#include "mesh/reader/polygon.h"
#include "mesh/reader/surface_bytes.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMaxTriangles = 2000000;  // a collision surface has some hundred to some ten thousand
constexpr unsigned kMaxSeconds = 60;            // a mesh of 64 MB takes a few
constexpr std::size_t kMaxMemory = 1u << 30;    // bytes; a mesh of 64 MB takes some hundred MB
constexpr std::size_t kMostText = 300;          // bytes of what assimp says

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

/// The triangles of a face, as corners of it: as it is where it has three; none of a line or point.
std::vector<Triangle> trianglesOf(const aiMesh& mesh, const aiFace& face) {
  if (face.mNumIndices < 3) return {};
  if (face.mNumIndices == 3) return {{0, 1, 2}};
  std::vector<Vector3> corners;
  for (unsigned k = 0; k < face.mNumIndices; ++k) {
    const unsigned vertex = face.mIndices[k];
    if (vertex >= mesh.mNumVertices) {
      throw std::invalid_argument("a face names vertex " + std::to_string(vertex) + " of " +
                                  std::to_string(mesh.mNumVertices));
    }
    corners.emplace_back(mesh.mVertices[vertex].x, mesh.mVertices[vertex].y, mesh.mVertices[vertex].z);
  }
  return cutPolygon(corners);
}

void requireFewTriangles(std::size_t count, const TriangleSoup& soup) {
  if (count > kMaxTriangles || soup.vertices.size() > 3 * kMaxTriangles) {
    throw std::invalid_argument("it has more than " + std::to_string(kMaxTriangles) + " triangles; simplify it");
  }
}

/// Appends a mesh, moved by its node's transform.
void appendMesh(const aiMesh& mesh, const Matrix4& X, TriangleSoup& soup) {
  requireFewTriangles(soup.triangles.size() + mesh.mNumFaces, soup);
  const auto first = static_cast<int>(soup.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    soup.vertices.emplace_back((X * Eigen::Vector4d(v.x, v.y, v.z, 1.0)).head<3>());
  }
  const bool mirrored = X.topLeftCorner<3, 3>().determinant() < 0.0;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    for (const Triangle& corners : trianglesOf(mesh, face)) {
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = first + static_cast<int>(face.mIndices[corners[k]]);
      if (mirrored) std::swap(triangle[1], triangle[2]);  // a mirror turns triangles inside out
      soup.triangles.push_back(triangle);
    }
    requireFewTriangles(soup.triangles.size(), soup);
  }
}

void appendNode(const aiScene& scene, const aiNode& node, const Matrix4& X_parent, TriangleSoup& soup) {
  const aiMatrix4x4& m = node.mTransformation;
  Matrix4 local;
  local << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  const Matrix4 X = X_parent * local;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) appendMesh(*scene.mMeshes[node.mMeshes[i]], X, soup);
  for (unsigned i = 0; i < node.mNumChildren; ++i) appendNode(scene, *node.mChildren[i], X, soup);
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

TriangleSoup readWithAssimp(const std::string& file) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const std::string ending = lowerCase(std::string_view(file).substr(file.rfind('.') + 1));
  const std::string bytes = otherBytes(file, ending);
  importer.SetIOHandler(
      new SingleFileSystem(file));  // the importer deletes it; what is read from memory asks it for other files, too
  // Without aiProcess_Triangulate, which cuts ears that have corners of a concave polygon on their edges.
  const aiScene* scene = bytes.empty() ? importer.ReadFile(file, 0)
                                       : importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, ending.c_str());
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string error = importer.GetErrorString();  // assimp catches everything, this too:
    if (error.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    // It may quote all that is left of the file.
    throw std::invalid_argument(printable(error, kMostText));
  }
  TriangleSoup soup;
  appendNode(*scene, *scene->mRootNode, Matrix4::Identity(), soup);
  return soup;
}

template <typename T>
void append(const std::vector<T>& from, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(from.data()), from.size() * sizeof(T));
}

template <typename T>
void take(std::size_t count, std::string_view& bytes, std::vector<T>& to) {
  if (count > bytes.size() / sizeof(T)) throw std::invalid_argument("it is malformed");
  to.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(to.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
}

/// The soup as bytes: number of vertices, vertices, triangles.
std::string pack(const TriangleSoup& soup) {
  std::string bytes;
  append(std::vector<std::size_t>{soup.vertices.size()}, bytes);
  append(soup.vertices, bytes);
  append(soup.triangles, bytes);
  return bytes;
}

TriangleSoup unpack(std::string_view bytes) {
  TriangleSoup soup;
  std::vector<std::size_t> vertices;
  take(1, bytes, vertices);
  take(vertices[0], bytes, soup.vertices);
  take(bytes.size() / sizeof(Triangle), bytes, soup.triangles);
  return soup;
}

void check(const TriangleSoup& soup) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    if (!soup.vertices[i].allFinite()) {
      throw std::invalid_argument("vertex " + std::to_string(i) + " is not finite");
    }
  }
  for (const Triangle& triangle : soup.triangles) {
    for (const int v : triangle) {
      if (v < 0 || static_cast<std::size_t>(v) >= soup.vertices.size()) {
        throw std::invalid_argument("a face names vertex " + std::to_string(v) + " of " +
                                    std::to_string(soup.vertices.size()));
      }
    }
  }
}

}  // namespace

TriangleSoup readTriangleSoupUnprotected(const std::string& file) {
  TriangleSoup soup = unpack(pack(readWithAssimp(file)));
  check(soup);
  return soup;
}

TriangleSoup readTriangleSoup(const std::string& file) {
  try {
    TriangleSoup soup = unpack(runIsolated([&file] { return pack(readWithAssimp(file)); }, kMaxSeconds, kMaxMemory));
    check(soup);
    return soup;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("mesh file '" + file + "' cannot be read: " + error.what());
  }
}

}  // namespace tissue_contact
