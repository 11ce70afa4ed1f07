/// @file
/// Test helpers for mesh files: temporary files, the committed fixtures, and writers of the formats and byte orders
/// that Gmsh cannot write.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include "support/refusal.h"
#include "support/replaced.h"
#include "support/temporary_directory.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

inline std::string fixturePath(const std::string& name) {
  return std::string(TISSUE_CONTACT_SOURCE_DIR) + "/test/data/meshes/" + name;
}

inline std::string readBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A mesh file that lives as long as this object.
class FileOfBytes {
 public:
  explicit FileOfBytes(const std::string& bytes) { write(bytes); }

  void write(const std::string& bytes) const {
    // A new file each time: overwriting an old one makes some file systems wait for the disk.
    std::remove(path_.c_str());
    std::ofstream out(path_, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out) throw std::runtime_error("cannot write " + path_);
  }
  const std::string& path() const { return path_; }

 private:
  TemporaryDirectory directory_;
  std::string path_ = directory_.path("mesh");
};

inline MeshDescription meshFile(const std::string& path, bool remove_unreferenced_nodes = false) {
  MeshDescription description;
  description.file = path;
  description.remove_unreferenced_nodes = remove_unreferenced_nodes;
  return description;
}

inline TetMesh loadBytes(const std::string& bytes) { return loadTetMesh(meshFile(FileOfBytes(bytes).path())); }

/// The file must be refused, in words that hold all of these.
inline void expectRefused(const std::string& bytes, const std::vector<std::string>& words) {
  SCOPED_TRACE(bytes.substr(0, 300));
  expectRefusal([&] { loadBytes(bytes); }, words);
}

inline void expectSameMesh(const TetMesh& a, const TetMesh& b) {
  ASSERT_EQ(a.positions.cols(), b.positions.cols());
  EXPECT_TRUE(a.positions == b.positions) << "largest difference " << (a.positions - b.positions).cwiseAbs().maxCoeff();
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
}

/// Two tetrahedra on a common face of the unit corner; nodes 0 to 4.
inline TetMesh twoTetrahedra() {
  TetMesh mesh;
  mesh.positions.resize(3, 5);
  mesh.positions.transpose() << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1;
  mesh.tetrahedra = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  return mesh;
}

inline double totalVolume(const TetMesh& mesh) {
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
  return volume;
}

/// Bytes in a chosen order, whatever the machine's own.
class ByteWriter {
 public:
  explicit ByteWriter(bool big_endian) : big_endian_(big_endian) {}

  ByteWriter& text(const std::string& s) {
    bytes_ += s;
    return *this;
  }
  ByteWriter& integer(std::int64_t value, unsigned size) {
    for (unsigned i = 0; i < size; ++i) {
      const unsigned byte = big_endian_ ? size - 1 - i : i;
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8U * byte));
    }
    return *this;
  }
  ByteWriter& real(double value, unsigned size = 8) {
    std::int64_t bits = 0;
    const auto single = static_cast<float>(value);
    std::int32_t single_bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    std::memcpy(&single_bits, &single, sizeof single_bits);
    return integer(size == 8 ? bits : single_bits, size);
  }
  ByteWriter& node(const TetMesh& mesh, int i, unsigned size = 8) {
    for (int axis = 0; axis < 3; ++axis) real(mesh.positions(axis, i), size);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

/// Node tags as sparse and unordered as the format allows: index i gets kTagStep * (n - i).
constexpr std::int64_t kTagStep = 1000;

inline std::string mshBinaryHeader(const char* version, bool big_endian) {
  ByteWriter out(big_endian);
  out.text(std::string("$MeshFormat\n") + version + " 1 8\n").integer(1, 4).text("\n$EndMeshFormat\n");
  return out.bytes();
}

/// MSH 2.2 binary with all tetrahedra in one block, as other writers than Gmsh have it; two tags per element.
inline std::string msh22Binary(const TetMesh& mesh, bool big_endian) {
  const int n = static_cast<int>(mesh.positions.cols());
  const auto tets = static_cast<std::int64_t>(mesh.tetrahedra.size());
  ByteWriter out(big_endian);
  out.text(mshBinaryHeader("2.2", big_endian)).text("$Nodes\n" + std::to_string(n) + "\n");
  for (int i = 0; i < n; ++i) out.integer(kTagStep * (n - i), 4).node(mesh, i);
  out.text("\n$EndNodes\n$Elements\n" + std::to_string(tets + 1) + "\n");
  out.integer(15, 4).integer(1, 4).integer(2, 4).integer(1, 4).integer(0, 4).integer(0, 4).integer(kTagStep, 4);
  out.integer(4, 4).integer(tets, 4).integer(2, 4);
  std::int64_t element = 2;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    out.integer(element++, 4).integer(0, 4).integer(0, 4);
    for (const int node : tet) out.integer(kTagStep * (n - node), 4);
  }
  return out.text("\n$EndElements\n").bytes();
}

/// MSH 4.0 or 4.1 binary: two blocks of nodes, the second parametric on a surface; one block of points, one of
/// tetrahedra. 4.1 has 64-bit tags; they get an offset beyond 2^53 to show that no double is in between.
inline std::string msh4Binary(const TetMesh& mesh, bool big_endian, bool version_41) {
  const int n = static_cast<int>(mesh.positions.cols());
  const unsigned width = version_41 ? 8 : 4;
  const std::int64_t base = version_41 ? (std::int64_t{1} << 60) + 1 : 0;
  const auto tag = [&](int i) { return base + kTagStep * (n - i); };
  const auto entity = [&](ByteWriter& out, int dimension) {
    out.integer(version_41 ? dimension : 5, 4).integer(version_41 ? 5 : dimension, 4);
  };
  ByteWriter out(big_endian);
  out.text(mshBinaryHeader(version_41 ? "4.1" : "4.0", big_endian)).text("$Nodes\n").integer(2, 8).integer(n, 8);
  if (version_41) out.integer(tag(n - 1), 8).integer(tag(0), 8);
  const int half = n / 2;
  for (const bool second : {false, true}) {
    const int begin = second ? half : 0;
    const int end = second ? n : half;
    entity(out, second ? 2 : 1);
    out.integer(second ? 1 : 0, 4).integer(end - begin, 8);
    for (int i = begin; version_41 && i < end; ++i) out.integer(tag(i), 8);
    for (int i = begin; i < end; ++i) {
      if (!version_41) out.integer(tag(i), 4);
      out.node(mesh, i);
      if (second) out.real(0.25).real(0.75);
    }
  }
  const auto tets = static_cast<std::int64_t>(mesh.tetrahedra.size());
  out.text("\n$EndNodes\n$Elements\n").integer(2, 8).integer(tets + 1, 8);
  if (version_41) out.integer(1, 8).integer(tets + 1, 8);
  entity(out, 0);
  out.integer(15, 4).integer(1, 8).integer(1, width).integer(tag(0), width);
  entity(out, 3);
  out.integer(4, 4).integer(tets, 8);
  std::int64_t element = 2;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    out.integer(element++, width);
    for (const int node : tet) out.integer(tag(node), width);
  }
  return out.text("\n$EndElements\n").bytes();
}

/// What a VTK file looks like. The metadata and field data are those that VTK's own writer and ParaView add.
struct VtkStyle {
  const char* version;  ///< from "5" on cells are written as offsets and connectivity
  bool binary;
  unsigned real_bytes = 8;
  unsigned offset_bytes = 8;  ///< version 5: vtktypeint64 or vtktypeint32
  bool extras = true;         ///< field data before the points, METADATA behind them, point data at the end
};

class VtkWriter {
 public:
  explicit VtkWriter(const VtkStyle& style) : style_(style), out_(true) {}

  std::string write(const TetMesh& mesh) {
    const auto tets = mesh.tetrahedra.size();
    out_.text(std::string("# vtk DataFile Version ") + style_.version + "\nvtk output\n");
    out_.text(style_.binary ? "BINARY\n" : "ASCII\n").text("DATASET UNSTRUCTURED_GRID\n");
    if (style_.extras) field();
    out_.text("POINTS " + std::to_string(mesh.positions.cols()) + (style_.real_bytes == 8 ? " double\n" : " float\n"));
    for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
      for (int axis = 0; axis < 3; ++axis) real(mesh.positions(axis, i));
    }
    out_.text("\n");
    if (style_.extras) out_.text("METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 2 \n\n");
    style_.version[0] >= '5' ? cellsByOffset(mesh) : cellsBySize(mesh);
    out_.text("\nCELL_TYPES " + std::to_string(tets + 1) + "\n");
    integer(5, 4);
    for (std::size_t i = 0; i < tets; ++i) integer(10, 4);
    if (style_.extras) out_.text("\nPOINT_DATA 1\nSCALARS unread float 1\n");
    return out_.bytes();
  }

 private:
  void integer(std::int64_t value, unsigned size) {
    style_.binary ? out_.integer(value, size) : out_.text(std::to_string(value) + " ");
  }
  void real(double value) {
    std::ostringstream text;
    text.precision(17);
    text << value << ' ';
    style_.binary ? out_.real(value, style_.real_bytes) : out_.text(text.str());
  }
  void field() {
    out_.text("FIELD FieldData 2\nTIME 1 1 double\n");
    style_.binary ? out_.real(0.5) : out_.text("0.5");
    out_.text("\nMETADATA\nINFORMATION 0\n\nCYCLE 3 1 int\n");
    for (int i = 0; i < 3; ++i) integer(10, 4);  // 10 is also a line feed: binary data may look like text
    out_.text("\n");
  }
  void cellsBySize(const TetMesh& mesh) {
    const auto tets = mesh.tetrahedra.size();
    out_.text("CELLS " + std::to_string(tets + 1) + " " + std::to_string(5 * tets + 4) + "\n");
    for (const int value : {3, 0, 1, 2}) integer(value, 4);
    for (const Tetrahedron& tet : mesh.tetrahedra) {
      integer(4, 4);
      for (const int node : tet) integer(node, 4);
    }
  }
  void cellsByOffset(const TetMesh& mesh) {
    const auto tets = mesh.tetrahedra.size();
    const std::string type = style_.offset_bytes == 8 ? "vtktypeint64" : "vtktypeint32";
    out_.text("CELLS " + std::to_string(tets + 2) + " " + std::to_string(4 * tets + 3) + "\nOFFSETS " + type + "\n");
    integer(0, style_.offset_bytes);
    for (std::size_t i = 0; i <= tets; ++i) integer(static_cast<std::int64_t>(3 + 4 * i), style_.offset_bytes);
    out_.text("\nCONNECTIVITY " + type + "\n");
    for (const int value : {0, 1, 2}) integer(value, style_.offset_bytes);
    for (const Tetrahedron& tet : mesh.tetrahedra) {
      for (const int node : tet) integer(node, style_.offset_bytes);
    }
  }

  VtkStyle style_;
  ByteWriter out_;
};

}  // namespace tissue_contact
