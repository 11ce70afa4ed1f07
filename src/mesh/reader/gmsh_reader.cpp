/// @file
/// Room `mesh`: Gmsh MSH files, ASCII and binary (Gmsh reference manual, "Gmsh file formats"): sections $Nodes and
/// $Elements in, nodes and tetrahedra out. All other sections are skipped, as the manual asks.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file.h"

namespace tissue_contact {
namespace {

constexpr int kDouble = 8;       // bytes
constexpr int kInt = 4;          // bytes
constexpr int kCount = 8;        // bytes of `unsigned long` (4.0) and `size_t` (4.1)
constexpr int kTetrahedron = 4;  // element type

constexpr ItemSize kBlockHeader = {4, 20};  // three ints and a count

enum class Version { k2, k40, k41 };

/// From the node tags of a file (sparse, in any order) to node indices in file order. Sorted pairs, not a table by tag: memory
/// follows the number of nodes, whatever the largest tag.
class NodeTags {
 public:
  void reserve(std::size_t count) { indices_.reserve(count); }

  /// The next node in file order has this tag.
  void add(std::int64_t tag, const MeshFileCursor& in) {
    if (tag < 0) in.fail("node tag " + std::to_string(tag) + " is negative; tags must be >= 0: export the mesh again");
    indices_.emplace_back(tag, static_cast<int>(indices_.size()));
  }

  /// To be called once all tags are added.
  void finish(const MeshFileCursor& in) {
    if (!std::is_sorted(indices_.begin(), indices_.end())) std::sort(indices_.begin(), indices_.end());
    const auto same = std::adjacent_find(indices_.begin(), indices_.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (same == indices_.end()) return;
    in.fail("nodes " + std::to_string(same->second) + " and " + std::to_string((same + 1)->second) +
            " (0-based, in file order) both have the tag " + std::to_string(same->first) +
            "; tags must be unique: export the mesh again");
  }

  /// Index of the node with this tag, or -1.
  int find(std::int64_t tag) const {
    const auto found = std::lower_bound(indices_.begin(), indices_.end(), std::make_pair(tag, -1));
    return found != indices_.end() && found->first == tag ? found->second : -1;
  }

 private:
  std::vector<std::pair<std::int64_t, int>> indices_;
};

class GmshReader {
 public:
  explicit GmshReader(MeshFileCursor& in) : in_(in) {}
  MeshFileContents read();

 private:
  void readFormat();
  void setBinaryOrder();
  void readNodes2();
  void readNodes4();
  void readNodeBlock4(std::size_t count, std::int64_t parameters);
  void readElements2();
  void readBinaryElements2(std::size_t count);
  void readElements4();
  void readElement(std::int64_t tag, std::int64_t type, int tag_bytes);
  int nodeCount(std::int64_t type, std::int64_t tag) const;
  std::size_t blockCount(std::int64_t count, std::size_t left, ItemSize item, const char* what) const;
  void readSection(const std::string& name);
  int tagBytes() const { return version_ == Version::k41 ? kCount : kInt; }
  ItemSize nodeSize() const { return {4, static_cast<std::size_t>(tagBytes()) + 3 * sizeof(double)}; }
  ItemSize elementSize() const {  // of the smallest, a point: in binary its tag and its node
    const std::size_t values = version_ == Version::k2 ? 4 : 2;
    return {values, 2 * static_cast<std::size_t>(tagBytes())};
  }

  MeshFileCursor& in_;
  Version version_ = Version::k2;
  MeshFileContents contents_;
  NodeTags tags_;
  bool have_nodes_ = false;
  bool have_elements_ = false;
};

MeshFileContents GmshReader::read() {
  readFormat();
  while (!in_.atEnd()) {
    const std::string name(in_.word("a section"));
    if (name.size() < 2 || name[0] != '$') {
      in_.fail("expected a section such as $Nodes, found " + quoted(name) +
               "; the section before is longer than its count says, or the file is damaged: export it again");
    }
    readSection(name);
  }
  if (!have_elements_) in_.fail("the file ends without a $Elements section: it is truncated; export or copy it again");
  return std::move(contents_);
}

void GmshReader::readSection(const std::string& name) {
  const std::string end = "$End" + name.substr(1);
  if (name == "$ParametricNodes") in_.fail("$ParametricNodes is not read; save without Mesh.SaveParametric");
  if (name != "$Nodes" && name != "$Elements") return in_.skipPast(end);
  bool& seen = name == "$Nodes" ? have_nodes_ : have_elements_;
  if (seen) in_.fail("a second section " + name + "; there must be one: export the mesh again");
  if (name == "$Elements" && !have_nodes_) in_.fail("$Elements comes before any $Nodes; export the mesh again");
  seen = true;
  in_.endLine();
  if (name == "$Nodes") {
    version_ == Version::k2 ? readNodes2() : readNodes4();
    tags_.finish(in_);
  } else {
    version_ == Version::k2 ? readElements2() : readElements4();
  }
  const std::string found(in_.word(end.c_str()));
  if (found != end) {
    in_.fail("expected " + end + ", found " + quoted(found) +
             "; the section holds more than its count says: export it again");
  }
}

void GmshReader::readFormat() {
  std::string start(in_.word("$MeshFormat"));
  while (start == "$Comments") {
    in_.skipPast("$EndComments");
    start = in_.word("$MeshFormat");
  }
  if (start != "$MeshFormat") {
    in_.fail("expected $MeshFormat, found " + quoted(start) + (start == "$NOD" ? " (MSH 1.0, which is not read)" : "") +
             "; convert the file with gmsh -save -format msh41");
  }
  const std::string version(in_.word("the format version"));
  if (version == "4.1") {
    version_ = Version::k41;
  } else if (version == "4" || version == "4.0") {
    version_ = Version::k40;
  } else if (version != "2" && version != "2.0" && version != "2.1" && version != "2.2") {
    in_.fail("MSH version " + quoted(version) +
             " is not read (2.x, 4.0 and 4.1 are); convert the file with gmsh -save -format msh41");
  }
  const std::int64_t file_type = in_.textInteger("the file type");
  if (file_type != 0 && file_type != 1) {
    in_.fail("the file type is " + std::to_string(file_type) + "; it must be 0 (ASCII) or 1 (binary): export it again");
  }
  const std::int64_t data_size = in_.textInteger("the data size");
  if (file_type == 1 && data_size != kDouble) {
    in_.fail("the data size is " + std::to_string(data_size) +
             " bytes; it must be 8: save the mesh on a 64-bit machine");
  }
  in_.endLine();
  if (file_type == 1) setBinaryOrder();
  const std::string end(in_.word("$EndMeshFormat"));
  if (end != "$EndMeshFormat") in_.fail("expected $EndMeshFormat, found " + quoted(end) + "; export the mesh again");
}

void GmshReader::setBinaryOrder() {
  in_.setEncoding(MeshFileCursor::Encoding::kLittleEndian);
  const std::size_t start = in_.offset();
  if (in_.integer(kInt, "the number one that tells the byte order") == 1) return;
  in_.seek(start);
  in_.setEncoding(MeshFileCursor::Encoding::kBigEndian);
  if (in_.integer(kInt, "the number one that tells the byte order") != 1) {
    in_.fail(
        "the four bytes after the format line must be the number 1 in either byte order: "
        "the file was changed by a text-mode transfer or is damaged; copy it again");
  }
}

void GmshReader::readNodes2() {
  const std::int64_t stated = in_.textInteger("the number of nodes");
  if (in_.binary()) in_.endLine();
  const std::size_t count = in_.checkedCount(stated, nodeSize(), "nodes");
  contents_.nodes.reserve(count);
  tags_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    tags_.add(in_.integer(kInt, "a node tag"), in_);
    contents_.nodes.push_back(readNode(in_, kDouble, i));
  }
}

std::size_t GmshReader::blockCount(std::int64_t count, std::size_t left, ItemSize item, const char* what) const {
  const std::size_t size = in_.checkedCount(count, item, what);
  if (size > left) {
    in_.fail("a block has " + std::to_string(size) + " " + what + ", but only " + std::to_string(left) +
             " are left of the section's total; export the mesh again");
  }
  return size;
}

void GmshReader::readNodes4() {
  const std::int64_t blocks = in_.integer(kCount, "the number of entity blocks");
  const std::int64_t stated = in_.integer(kCount, "the number of nodes");
  std::size_t left = in_.checkedCount(stated, nodeSize(), "nodes");
  contents_.nodes.reserve(left);
  tags_.reserve(left);
  if (version_ == Version::k41) {
    in_.integer(kCount, "the smallest node tag");
    in_.integer(kCount, "the largest node tag");
  }
  for (std::size_t b = in_.checkedCount(blocks, kBlockHeader, "entity blocks"); b > 0; --b) {
    const std::int64_t first = in_.integer(kInt, "an entity");
    const std::int64_t second = in_.integer(kInt, "an entity");
    const std::int64_t dimension = version_ == Version::k41 ? first : second;
    if (dimension < 0 || dimension > 3) {
      in_.fail("entity dimension " + std::to_string(dimension) + "; it must be 0 to 3: export the mesh again");
    }
    const std::int64_t parameters = in_.integer(kInt, "the parametric flag") != 0 ? dimension : 0;
    const std::int64_t block = in_.integer(kCount, "the number of nodes of a block");
    const std::size_t count = blockCount(block, left, nodeSize(), "nodes");
    left -= count;
    readNodeBlock4(count, parameters);
  }
  if (left != 0) {
    in_.fail("the blocks of $Nodes hold " + std::to_string(left) +
             " nodes fewer than its total; export the mesh again");
  }
}

void GmshReader::readNodeBlock4(std::size_t count, std::int64_t parameters) {
  const bool tags_first = version_ == Version::k41;  // 4.0 has each tag with its coordinates
  for (std::size_t i = 0; tags_first && i < count; ++i) tags_.add(in_.integer(kCount, "a node tag"), in_);
  for (std::size_t i = 0; i < count; ++i) {
    if (!tags_first) tags_.add(in_.integer(kInt, "a node tag"), in_);
    contents_.nodes.push_back(readNode(in_, kDouble, contents_.nodes.size()));
    for (std::int64_t p = 0; p < parameters; ++p) in_.real(kDouble, "a parametric coordinate");
  }
}

void GmshReader::readElements2() {
  const std::int64_t stated = in_.textInteger("the number of elements");
  if (in_.binary()) in_.endLine();
  const std::size_t count = in_.checkedCount(stated, elementSize(), "elements");
  if (in_.binary()) return readBinaryElements2(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t tag = in_.integer(kInt, "an element tag");
    const std::int64_t type = in_.integer(kInt, "an element type");
    const std::int64_t stated_tags = in_.integer(kInt, "the number of an element's tags");
    for (std::size_t t = in_.checkedCount(stated_tags, {1, kInt}, "an element's tags"); t > 0; --t) {
      in_.integer(kInt, "an element's tag");
    }
    readElement(tag, type, kInt);
  }
}

void GmshReader::readBinaryElements2(std::size_t count) {
  while (count > 0) {
    const std::int64_t type = in_.integer(kInt, "an element type");
    const std::int64_t following = in_.integer(kInt, "the number of elements of a block");
    const std::size_t block = blockCount(following, count, elementSize(), "elements");
    if (block == 0) in_.fail("a block has 0 elements; it must have at least 1: export the mesh again");
    const std::int64_t stated_tags = in_.integer(kInt, "the number of an element's tags");
    const std::size_t tags = in_.checkedCount(stated_tags, {1, kInt}, "an element's tags");
    for (std::size_t i = 0; i < block; ++i) {
      const std::int64_t tag = in_.integer(kInt, "an element tag");
      for (std::size_t t = 0; t < tags; ++t) in_.integer(kInt, "an element's tag");
      readElement(tag, type, kInt);
    }
    count -= block;
  }
}

void GmshReader::readElements4() {
  const std::int64_t blocks = in_.integer(kCount, "the number of entity blocks");
  const std::int64_t stated = in_.integer(kCount, "the number of elements");
  std::size_t left = in_.checkedCount(stated, elementSize(), "elements");
  if (version_ == Version::k41) {
    in_.integer(kCount, "the smallest element tag");
    in_.integer(kCount, "the largest element tag");
  }
  for (std::size_t b = in_.checkedCount(blocks, kBlockHeader, "entity blocks"); b > 0; --b) {
    in_.integer(kInt, "an entity");
    in_.integer(kInt, "an entity");
    const std::int64_t type = in_.integer(kInt, "an element type");
    const std::size_t count =
        blockCount(in_.integer(kCount, "the number of elements of a block"), left, elementSize(), "elements");
    left -= count;
    for (std::size_t i = 0; i < count; ++i) readElement(in_.integer(tagBytes(), "an element tag"), type, tagBytes());
  }
  if (left != 0) {
    in_.fail("the blocks of $Elements hold " + std::to_string(left) +
             " elements fewer than its total; export the mesh again");
  }
}

int GmshReader::nodeCount(std::int64_t type, std::int64_t tag) const {
  // By element type: nodes of lines, triangles, quadrangles, hexahedra, prisms, pyramids and points, up to fifth order.
  static constexpr std::array<int, 32> kNodes = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  const bool high_order_tetrahedron = type == 11 || (type >= 29 && type <= 33) || (type >= 71 && type <= 75) ||
                                      (type >= 79 && type <= 83) || type == 137;
  if (high_order_tetrahedron) {
    in_.fail("element " + std::to_string(tag) + " is a tetrahedron of higher order (type " + std::to_string(type) +
             "); only those with 4 nodes (type 4) are read: save the mesh with gmsh -order 1");
  }
  if (type < 1 || type >= static_cast<std::int64_t>(kNodes.size())) {
    in_.fail("element " + std::to_string(tag) + " has the type " + std::to_string(type) +
             ", whose number of nodes is not known here (1 to 31 are): save the mesh with gmsh -order 1");
  }
  return kNodes[static_cast<std::size_t>(type)];
}

void GmshReader::readElement(std::int64_t tag, std::int64_t type, int tag_bytes) {
  const int count = nodeCount(type, tag);
  if (type != kTetrahedron) {
    for (int i = 0; i < count; ++i) in_.integer(tag_bytes, "a node tag of an element");
    ++contents_.other_elements;
    return;
  }
  Tetrahedron tet;
  for (int& node : tet) {
    const std::int64_t node_tag = in_.integer(tag_bytes, "a node tag of an element");
    node = tags_.find(node_tag);
    if (node < 0) {
      in_.fail("element " + std::to_string(tag) + " refers to node tag " + std::to_string(node_tag) +
               ", which $Nodes does not define; export the mesh again with all its nodes");
    }
  }
  contents_.tetrahedra.push_back(tet);
}

}  // namespace

MeshFileContents readGmsh(MeshFileCursor& in) { return GmshReader(in).read(); }

}  // namespace tissue_contact
