/// @file
/// Room `mesh`: Gmsh MSH files, ASCII and binary (Gmsh reference manual, "Gmsh file formats" and "Legacy formats"): sections
/// $Nodes and $Elements in, $NOD and $ELM of MSH 1, nodes and volumes out, and where asked physical groups. All other sections are
/// skipped, as the manual asks.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mesh/reader/gmsh_groups.h"
#include "mesh/reader/mesh_file.h"
#include "mesh/reader/node_tags.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kLongestName =
    64;  // of a section: its end is searched for, at the cost of the name's length times the file's

constexpr ItemSize kBlockHeader = {4, 20};  // three ints and a count

enum class Version { k1, k2, k40, k41 };

struct ElementKind {
  int dimension;
  int corners;  ///< the first of its nodes, whatever its order
  int nodes;
};

class GmshReader {
 public:
  GmshReader(MeshFileCursor& in, bool with_labels) : in_(in), with_labels_(with_labels) {}
  MeshFileContents read();

 private:
  void readFormat();
  void setBinaryOrder();
  void readNodes2();
  void readNodes4();
  void readNodeBlock4(std::size_t count, std::int64_t parameters);
  void readElements1();
  void readElements2();
  void readBinaryElements2(std::size_t count);
  void readElements4();
  void readElement(std::int64_t tag, std::int64_t type, int tag_bytes);
  int nodeOf(std::int64_t tag, std::int64_t node_tag) const;
  void dropRepeatedVolumes();
  void readTags2(std::size_t count);
  ElementKind kindOf(std::int64_t type, std::int64_t tag) const;
  std::size_t blockCount(std::int64_t count, std::size_t left, ItemSize item, const char* what) const;
  void readSection(const std::string& name);
  std::string nodesSection() const { return version_ == Version::k1 ? "$NOD" : "$Nodes"; }
  std::string elementsSection() const { return version_ == Version::k1 ? "$ELM" : "$Elements"; }
  int tagBytes() const { return version_ == Version::k41 ? kGmshCountBytes : kGmshIntBytes; }
  ItemSize nodeSize() const { return {4, static_cast<std::size_t>(tagBytes()) + 3 * sizeof(double)}; }
  ItemSize elementSize() const {  // of the smallest, a point: in binary its tag and its node
    const std::size_t values = version_ == Version::k1 ? 6 : version_ == Version::k2 ? 4 : 2;
    return {values, 2 * static_cast<std::size_t>(tagBytes())};
  }

  MeshFileCursor& in_;
  Version version_ = Version::k2;
  MeshFileContents contents_;
  NodeTags tags_;
  bool have_nodes_ = false;
  bool have_elements_ = false;
  bool with_labels_;
  GmshGroups groups_{in_};
  std::vector<std::int64_t> number_of_volume_;  ///< of MSH 1 and 2, which have one for each; 0: none
};

MeshFileContents GmshReader::read() {
  readFormat();
  while (!in_.atEnd()) {
    const std::string name(in_.word("a section"));
    if (name.size() < 2 || name.size() > kLongestName || name[0] != '$') {
      in_.fail("expected a section such as $Nodes, found " + excerpt(name) +
               "; the section before is longer than its count says, or the file is damaged: export it again");
    }
    readSection(name);
  }
  if (!have_elements_) {
    in_.fail(
        "the file ends without a " + elementsSection() +
        " section: Gmsh made no mesh (it says why when it meshes), or the file is truncated; mesh or copy it again");
  }
  contents_.groups = groups_.take();
  return std::move(contents_);
}

void GmshReader::readSection(const std::string& name) {
  // MSH 1 has its own two in capitals; to these Gmsh adds sections of later formats, such as $Periodic.
  const bool is_of_first = version_ == Version::k1 && (name == "$NOD" || name == "$ELM");
  const std::string end = (is_of_first ? "$END" : "$End") + name.substr(1);
  if (name == "$ParametricNodes") in_.fail("$ParametricNodes is not read; save without Mesh.SaveParametric");
  if (with_labels_ && name == "$PhysicalNames") groups_.readNames();
  if (with_labels_ && name == "$Entities" && (version_ == Version::k40 || version_ == Version::k41)) {
    groups_.readEntities(version_ == Version::k41);
  }
  const bool is_nodes = name == nodesSection();
  if (!is_nodes && name != elementsSection()) return in_.skipPast(end);
  bool& seen = is_nodes ? have_nodes_ : have_elements_;
  if (seen) in_.fail("a second section " + name + "; there must be one: export the mesh again");
  if (!is_nodes && !have_nodes_) in_.fail(name + " comes before any " + nodesSection() + "; export the mesh again");
  seen = true;
  in_.endLine();
  if (is_nodes) {
    version_ == Version::k1 || version_ == Version::k2 ? readNodes2() : readNodes4();
    tags_.finish(in_);
  } else if (version_ == Version::k1) {
    readElements1();
  } else {
    version_ == Version::k2 ? readElements2() : readElements4();
  }
  if (!is_nodes) dropRepeatedVolumes();
  const std::string found(in_.word(end.c_str()));
  if (found != end) {
    in_.fail("expected " + end + ", found " + excerpt(found) +
             "; the section holds more than its count says: export it again");
  }
}

void GmshReader::readFormat() {
  const std::size_t begin = in_.offset();
  std::string start(in_.word("$MeshFormat"));
  if (start == "$NOD") {  // MSH 1 is text, and has nothing else before its nodes
    version_ = Version::k1;
    return in_.seek(begin);
  }
  while (start == "$Comments") {
    in_.skipPast("$EndComments");
    start = in_.word("$MeshFormat");
  }
  if (start != "$MeshFormat") {
    in_.fail("expected $MeshFormat, or $NOD of MSH 1, found " + excerpt(start) +
             "; convert the file with gmsh -save -format msh41");
  }
  const std::string version(in_.word("the format version"));
  if (version == "4.1") {
    version_ = Version::k41;
  } else if (version == "4" || version == "4.0") {
    version_ = Version::k40;
  } else if (version != "2" && version != "2.0" && version != "2.1" && version != "2.2") {
    in_.fail("MSH version " + excerpt(version) +
             " is not read (1, 2.x, 4.0 and 4.1 are); convert the file with gmsh -save -format msh41");
  }
  const std::int64_t file_type = in_.textInteger("the file type");
  if (file_type != 0 && file_type != 1) {
    in_.fail("the file type is " + std::to_string(file_type) + "; it must be 0 (ASCII) or 1 (binary): export it again");
  }
  const std::int64_t data_size = in_.textInteger("the data size");
  if (file_type == 1 && data_size != kGmshDoubleBytes) {
    in_.fail("the data size is " + std::to_string(data_size) +
             " bytes; it must be 8: save the mesh on a 64-bit machine");
  }
  in_.endLine();
  if (file_type == 1) setBinaryOrder();
  const std::string end(in_.word("$EndMeshFormat"));
  if (end != "$EndMeshFormat") in_.fail("expected $EndMeshFormat, found " + excerpt(end) + "; export the mesh again");
}

void GmshReader::setBinaryOrder() {
  in_.setEncoding(MeshFileCursor::Encoding::kLittleEndian);
  const std::size_t start = in_.offset();
  if (in_.integer(kGmshIntBytes, "the number one that tells the byte order") == 1) return;
  in_.seek(start);
  in_.setEncoding(MeshFileCursor::Encoding::kBigEndian);
  if (in_.integer(kGmshIntBytes, "the number one that tells the byte order") != 1) {
    in_.fail(
        "the four bytes after the format line must be the number 1 in either byte order: "
        "the file was changed by a text-mode transfer or is damaged; copy it again");
  }
}

/// Of MSH 1 as well.
void GmshReader::readNodes2() {
  const std::int64_t stated = in_.textInteger("the number of nodes");
  if (in_.binary()) in_.endLine();
  const std::size_t count = in_.checkedCount(stated, nodeSize(), "nodes");
  contents_.nodes.reserve(count);
  tags_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    tags_.add(in_.integer(kGmshIntBytes, "a node tag"), in_);
    contents_.nodes.push_back(readNode(in_, kGmshDoubleBytes, i));
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
  const std::int64_t blocks = in_.integer(kGmshCountBytes, "the number of entity blocks");
  const std::int64_t stated = in_.integer(kGmshCountBytes, "the number of nodes");
  std::size_t left = in_.checkedCount(stated, nodeSize(), "nodes");
  contents_.nodes.reserve(left);
  tags_.reserve(left);
  if (version_ == Version::k41) {
    in_.integer(kGmshCountBytes, "the smallest node tag");
    in_.integer(kGmshCountBytes, "the largest node tag");
  }
  for (std::size_t b = in_.checkedCount(blocks, kBlockHeader, "entity blocks"); b > 0; --b) {
    const std::int64_t first = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t second = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t dimension = version_ == Version::k41 ? first : second;
    if (dimension < 0 || dimension > 3) {
      in_.fail("entity dimension " + std::to_string(dimension) + "; it must be 0 to 3: export the mesh again");
    }
    const std::int64_t parameters = in_.integer(kGmshIntBytes, "the parametric flag") != 0 ? dimension : 0;
    const std::int64_t block = in_.integer(kGmshCountBytes, "the number of nodes of a block");
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
  for (std::size_t i = 0; tags_first && i < count; ++i) tags_.add(in_.integer(kGmshCountBytes, "a node tag"), in_);
  for (std::size_t i = 0; i < count; ++i) {
    if (!tags_first) tags_.add(in_.integer(kGmshIntBytes, "a node tag"), in_);
    contents_.nodes.push_back(readNode(in_, kGmshDoubleBytes, contents_.nodes.size()));
    for (std::int64_t p = 0; p < parameters; ++p) in_.real(kGmshDoubleBytes, "a parametric coordinate");
  }
}

void GmshReader::readElements1() {
  const std::int64_t stated = in_.textInteger("the number of elements");
  for (std::size_t i = in_.checkedCount(stated, elementSize(), "elements"); i > 0; --i) {
    const std::int64_t tag = in_.integer(kGmshIntBytes, "an element tag");
    const std::int64_t type = in_.integer(kGmshIntBytes, "an element type");
    const std::int64_t group_number = in_.integer(kGmshIntBytes, "an element's physical group");
    in_.integer(kGmshIntBytes, "an element's elementary entity");
    const std::int64_t stated_nodes = in_.integer(kGmshIntBytes, "an element's number of nodes");
    const int needed = kindOf(type, tag).nodes;
    if (stated_nodes != needed) {
      in_.fail("element " + std::to_string(tag) + " has " + std::to_string(stated_nodes) + " nodes; its type " +
               std::to_string(type) + " must have " + std::to_string(needed) + ": export the mesh again");
    }
    groups_.begin(group_number);
    readElement(tag, type, kGmshIntBytes);
  }
}

void GmshReader::readElements2() {
  const std::int64_t stated = in_.textInteger("the number of elements");
  if (in_.binary()) in_.endLine();
  const std::size_t count = in_.checkedCount(stated, elementSize(), "elements");
  if (in_.binary()) return readBinaryElements2(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t tag = in_.integer(kGmshIntBytes, "an element tag");
    const std::int64_t type = in_.integer(kGmshIntBytes, "an element type");
    const std::int64_t stated_tags = in_.integer(kGmshIntBytes, "the number of an element's tags");
    readTags2(in_.checkedCount(stated_tags, {1, kGmshIntBytes}, "an element's tags"));
    readElement(tag, type, kGmshIntBytes);
  }
}

/// The first is the physical group, 0: none.
void GmshReader::readTags2(std::size_t count) {
  groups_.begin(0);
  for (std::size_t t = 0; t < count; ++t) {
    const std::int64_t tag = in_.integer(kGmshIntBytes, "an element's tag");
    if (t == 0) groups_.begin(tag);
  }
}

void GmshReader::readBinaryElements2(std::size_t count) {
  while (count > 0) {
    const std::int64_t type = in_.integer(kGmshIntBytes, "an element type");
    const std::int64_t following = in_.integer(kGmshIntBytes, "the number of elements of a block");
    const std::size_t block = blockCount(following, count, elementSize(), "elements");
    if (block == 0) in_.fail("a block has 0 elements; it must have at least 1: export the mesh again");
    const std::int64_t stated_tags = in_.integer(kGmshIntBytes, "the number of an element's tags");
    const std::size_t tags = in_.checkedCount(stated_tags, {1, kGmshIntBytes}, "an element's tags");
    for (std::size_t i = 0; i < block; ++i) {
      const std::int64_t tag = in_.integer(kGmshIntBytes, "an element tag");
      readTags2(tags);
      readElement(tag, type, kGmshIntBytes);
    }
    count -= block;
  }
}

void GmshReader::readElements4() {
  const std::int64_t blocks = in_.integer(kGmshCountBytes, "the number of entity blocks");
  const std::int64_t stated = in_.integer(kGmshCountBytes, "the number of elements");
  std::size_t left = in_.checkedCount(stated, elementSize(), "elements");
  if (version_ == Version::k41) {
    in_.integer(kGmshCountBytes, "the smallest element tag");
    in_.integer(kGmshCountBytes, "the largest element tag");
  }
  for (std::size_t b = in_.checkedCount(blocks, kBlockHeader, "entity blocks"); b > 0; --b) {
    const std::int64_t first = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t second = in_.integer(kGmshIntBytes, "an entity");
    version_ == Version::k41 ? groups_.beginEntity(first, second) : groups_.beginEntity(second, first);
    const std::int64_t type = in_.integer(kGmshIntBytes, "an element type");
    const std::size_t count =
        blockCount(in_.integer(kGmshCountBytes, "the number of elements of a block"), left, elementSize(), "elements");
    left -= count;
    for (std::size_t i = 0; i < count; ++i) readElement(in_.integer(tagBytes(), "an element tag"), type, tagBytes());
  }
  if (left != 0) {
    in_.fail("the blocks of $Elements hold " + std::to_string(left) +
             " elements fewer than its total; export the mesh again");
  }
}

ElementKind GmshReader::kindOf(std::int64_t type, std::int64_t tag) const {
  // Points, lines, triangles, quadrangles, tetrahedra, pyramids, prisms and hexahedra, up to fifth order.
  static constexpr ElementKind kKinds[] = {
      {},         {1, 2, 2},  {2, 3, 3},  {2, 4, 4},  {3, 4, 4},  {3, 8, 8},  {3, 6, 6},  {3, 5, 5},
      {1, 2, 3},  {2, 3, 6},  {2, 4, 9},  {3, 4, 10}, {3, 8, 27}, {3, 6, 18}, {3, 5, 14}, {0, 1, 1},
      {2, 4, 8},  {3, 8, 20}, {3, 6, 15}, {3, 5, 13}, {2, 3, 9},  {2, 3, 10}, {2, 3, 12}, {2, 3, 15},
      {2, 3, 15}, {2, 3, 21}, {1, 2, 4},  {1, 2, 5},  {1, 2, 6},  {3, 4, 20}, {3, 4, 35}, {3, 4, 56}};
  if (type < 1 || type >= static_cast<std::int64_t>(std::size(kKinds))) {
    in_.fail("element " + std::to_string(tag) + " has the type " + std::to_string(type) +
             ", whose number of nodes is not known here (1 to 31 are): export the mesh with linear elements");
  }
  return kKinds[type];
}

void GmshReader::readElement(std::int64_t tag, std::int64_t type, int tag_bytes) {
  const ElementKind kind = kindOf(type, tag);
  const bool is_volume = kind.dimension == 3;
  ElementCorners corners = kNoCorners;
  for (int i = 0; i < kind.nodes; ++i) {
    const std::int64_t node_tag = in_.integer(tag_bytes, "a node tag of an element");
    const bool is_corner = i < kind.corners;
    if (is_volume) {
      const int node = nodeOf(tag, node_tag);
      if (!is_corner) contents_.between_corners.push_back(node);
      if (is_corner) corners[static_cast<std::size_t>(i)] = node;
    } else if (with_labels_ && is_corner) {
      corners[static_cast<std::size_t>(i)] = tags_.find(node_tag);
    }
  }
  if (with_labels_) groups_.add(corners, kind.dimension);
  if (!is_volume) {
    ++contents_.other_elements;
    return;
  }
  contents_.higher_order += kind.nodes > kind.corners ? 1 : 0;
  contents_.volumes.push_back(corners);
  if (version_ == Version::k1 || version_ == Version::k2) number_of_volume_.push_back(groups_.number());
}

int GmshReader::nodeOf(std::int64_t tag, std::int64_t node_tag) const {
  const int node = tags_.find(node_tag);
  if (node < 0) {
    in_.fail("element " + std::to_string(tag) + " refers to node tag " + std::to_string(node_tag) + ", which " +
             nodesSection() + " does not define; export the mesh again with all its nodes");
  }
  return node;
}

/// Gmsh writes an element of several physical groups once for each where the format has one number per element. Those of one group twice
/// stay, for checkTetMesh() to refuse.
void GmshReader::dropRepeatedVolumes() {
  std::vector<std::size_t> order(number_of_volume_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto& volumes = contents_.volumes;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(volumes[a], number_of_volume_[a], a) < std::tie(volumes[b], number_of_volume_[b], b);
  });
  std::vector<bool> is_repeated(order.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool is_same = volumes[order[i]] == volumes[order[i - 1]];
    is_repeated[order[i]] = is_same && number_of_volume_[order[i]] != number_of_volume_[order[i - 1]];
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < is_repeated.size(); ++i) {
    if (!is_repeated[i]) contents_.volumes[kept++] = contents_.volumes[i];
  }
  if (kept == contents_.volumes.size() || is_repeated.empty()) return;
  contents_.volumes.resize(kept);
  contents_.higher_order = std::min(contents_.higher_order, kept);  // all are, or none: Gmsh's meshes have one order
}

}  // namespace

MeshFileContents readGmsh(MeshFileCursor& in, bool with_labels) { return GmshReader(in, with_labels).read(); }

}  // namespace tissue_contact
