/// @file
/// Room `mesh`: Gmsh MSH files, ASCII and binary (Gmsh reference manual, "Gmsh file formats" and "Legacy formats"): sections
/// $Nodes and $Elements in, $NOD and $ELM of MSH 1, nodes and tetrahedra out, and where asked physical groups ($PhysicalNames,
/// $Entities). All other sections are skipped, as the manual asks.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file.h"
#include "mesh/reader/node_tags.h"

namespace tissue_contact {
namespace {

constexpr int kDouble = 8;        // bytes
constexpr int kGmshIntBytes = 4;  // bytes
constexpr int kCount = 8;         // bytes of `unsigned long` (4.0) and `size_t` (4.1)
constexpr std::size_t kMostGroups = 16;
constexpr std::size_t kLongestName =
    64;  // of a section: its end is searched for, at the cost of the name's length times the file's

constexpr ItemSize kBlockHeader = {4, 20};  // three ints and a count

enum class Version { k1, k2, k40, k41 };

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
  void readTetrahedron(std::int64_t tag, int count, int tag_bytes);
  void readTags2(std::size_t count);
  void readPhysicalNames();
  void readEntities();
  void readEntity(int dimension);
  MeshLabels::Group& group(int dimension, std::int64_t number);
  void addToGroups(const std::array<int, 4>& nodes, int dimension);
  int nodeCount(std::int64_t type, std::int64_t tag) const;
  std::size_t blockCount(std::int64_t count, std::size_t left, ItemSize item, const char* what) const;
  void readSection(const std::string& name);
  std::string nodesSection() const { return version_ == Version::k1 ? "$NOD" : "$Nodes"; }
  std::string elementsSection() const { return version_ == Version::k1 ? "$ELM" : "$Elements"; }
  int tagBytes() const { return version_ == Version::k41 ? kCount : kGmshIntBytes; }
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
  std::map<std::pair<int, std::int64_t>, std::size_t> group_of_;                  ///< by dimension and number
  std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>> numbers_of_;  ///< of an entity's groups
  std::vector<std::int64_t> numbers_;                                             ///< of the groups of what is read now
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
    in_.fail("the file ends without a " + elementsSection() + " section: it is truncated; export or copy it again");
  }
  return std::move(contents_);
}

/// $NOD and $ELM, in capitals. To these Gmsh adds sections of later formats where it writes the first one, such as $Periodic.
bool isOfFirstFormat(const std::string& section) {
  return std::none_of(section.begin(), section.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

void GmshReader::readSection(const std::string& name) {
  const std::string end = (isOfFirstFormat(name) ? "$END" : "$End") + name.substr(1);
  if (name == "$ParametricNodes") in_.fail("$ParametricNodes is not read; save without Mesh.SaveParametric");
  if (with_labels_ && name == "$PhysicalNames") readPhysicalNames();
  if (with_labels_ && name == "$Entities" && (version_ == Version::k40 || version_ == Version::k41)) readEntities();
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
  if (file_type == 1 && data_size != kDouble) {
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
    const std::int64_t first = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t second = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t dimension = version_ == Version::k41 ? first : second;
    if (dimension < 0 || dimension > 3) {
      in_.fail("entity dimension " + std::to_string(dimension) + "; it must be 0 to 3: export the mesh again");
    }
    const std::int64_t parameters = in_.integer(kGmshIntBytes, "the parametric flag") != 0 ? dimension : 0;
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
    if (!tags_first) tags_.add(in_.integer(kGmshIntBytes, "a node tag"), in_);
    contents_.nodes.push_back(readNode(in_, kDouble, contents_.nodes.size()));
    for (std::int64_t p = 0; p < parameters; ++p) in_.real(kDouble, "a parametric coordinate");
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
    const int needed = nodeCount(type, tag);
    if (stated_nodes != needed) {
      in_.fail("element " + std::to_string(tag) + " has " + std::to_string(stated_nodes) + " nodes; its type " +
               std::to_string(type) + " must have " + std::to_string(needed) + ": export the mesh again");
    }
    numbers_.clear();
    if (group_number != 0) numbers_.push_back(group_number);
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
  numbers_.clear();
  for (std::size_t t = 0; t < count; ++t) {
    const std::int64_t tag = in_.integer(kGmshIntBytes, "an element's tag");
    if (t == 0 && tag != 0) numbers_.push_back(tag);
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
  const std::int64_t blocks = in_.integer(kCount, "the number of entity blocks");
  const std::int64_t stated = in_.integer(kCount, "the number of elements");
  std::size_t left = in_.checkedCount(stated, elementSize(), "elements");
  if (version_ == Version::k41) {
    in_.integer(kCount, "the smallest element tag");
    in_.integer(kCount, "the largest element tag");
  }
  for (std::size_t b = in_.checkedCount(blocks, kBlockHeader, "entity blocks"); b > 0; --b) {
    const std::int64_t first = in_.integer(kGmshIntBytes, "an entity");
    const std::int64_t second = in_.integer(kGmshIntBytes, "an entity");
    const auto entity = version_ == Version::k41 ? std::make_pair(first, second) : std::make_pair(second, first);
    const auto known = numbers_of_.find({static_cast<int>(entity.first), entity.second});
    numbers_ = known == numbers_of_.end() ? std::vector<std::int64_t>() : known->second;
    const std::int64_t type = in_.integer(kGmshIntBytes, "an element type");
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
  if (type < 1 || type >= static_cast<std::int64_t>(kNodes.size())) {
    in_.fail("element " + std::to_string(tag) + " has the type " + std::to_string(type) +
             ", whose number of nodes is not known here (1 to 31 are): export the mesh with linear elements");
  }
  return kNodes[static_cast<std::size_t>(type)];
}

/// Of element types 0 to 31: the dimension of points, lines, triangles and tetrahedra, whose corners are their first nodes; else -1 for
/// a surface, -3 for a volume.
constexpr std::array<int, 32> kSimplexDimension = {-1, 1,  2,  -1, 3, -3, -3, -3, 1, 2, -1, 3, -3, -3, -3, 0,
                                                   -1, -3, -3, -3, 2, 2,  2,  2,  2, 2, 1,  1, 1,  3,  3,  3};

void GmshReader::readElement(std::int64_t tag, std::int64_t type, int tag_bytes) {
  const int count = nodeCount(type, tag);
  const int dimension = kSimplexDimension[static_cast<std::size_t>(type)];
  if (dimension == 3) return readTetrahedron(tag, count, tag_bytes);
  const bool is_kept = with_labels_ && dimension >= 0;
  std::array<int, 4> nodes = {-1, -1, -1, -1};
  for (int i = 0; i < count; ++i) {
    const std::int64_t node_tag = in_.integer(tag_bytes, "a node tag of an element");
    if (is_kept && i <= dimension) nodes[static_cast<std::size_t>(i)] = tags_.find(node_tag);
  }
  if (is_kept) addToGroups(nodes, dimension);
  ++contents_.other_elements;
  if (dimension == -3) ++contents_.other_volumes;
}

void GmshReader::readTetrahedron(std::int64_t tag, int count, int tag_bytes) {
  const auto readNodeIndex = [&] {
    const std::int64_t node_tag = in_.integer(tag_bytes, "a node tag of an element");
    const int node = tags_.find(node_tag);
    if (node < 0) {
      in_.fail("element " + std::to_string(tag) + " refers to node tag " + std::to_string(node_tag) + ", which " +
               nodesSection() + " does not define; export the mesh again with all its nodes");
    }
    return node;
  };
  Tetrahedron tet;
  for (int& node : tet) node = readNodeIndex();
  for (int i = 4; i < count; ++i) contents_.between_corners.push_back(readNodeIndex());
  if (count > 4) ++contents_.higher_order;
  contents_.tetrahedra.push_back(tet);
  if (with_labels_) addToGroups(tet, 3);
}

MeshLabels::Group& GmshReader::group(int dimension, std::int64_t number) {
  const auto [found, is_new] = group_of_.emplace(std::make_pair(dimension, number), contents_.groups.size());
  if (is_new) contents_.groups.push_back({dimension, number, "", {}});
  return contents_.groups[found->second];
}

void GmshReader::addToGroups(const std::array<int, 4>& nodes, int dimension) {
  for (const std::int64_t number : numbers_) group(dimension, number).elements.push_back(nodes);
}

void GmshReader::readPhysicalNames() {
  const std::int64_t stated = in_.textInteger("the number of physical names");
  for (std::size_t i = in_.checkedCount(stated, {3, 6}, "physical names"); i > 0; --i) {
    const std::int64_t dimension = in_.textInteger("the dimension of a physical group");
    const std::int64_t number = in_.textInteger("the number of a physical group");
    const std::string_view rest = in_.line();
    const std::size_t from = rest.find('"');
    const std::size_t to = rest.rfind('"');
    if (dimension < 0 || dimension > 3 || from == std::string_view::npos || to == from) {
      in_.fail(
          "a physical group must be its dimension, 0 to 3, its number and its name in quotes; export the mesh again");
    }
    group(static_cast<int>(dimension), number).name = std::string(rest.substr(from + 1, to - from - 1));
  }
}

/// Of MSH 4: which entities belong to which physical groups.
void GmshReader::readEntities() {
  in_.endLine();
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) {
    count = in_.checkedCount(in_.integer(kCount, "a number of entities"), {5, 32}, "entities");
  }
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) readEntity(dimension);
  }
}

void GmshReader::readEntity(int dimension) {
  const std::int64_t tag = in_.integer(kGmshIntBytes, "an entity");
  const int corners = dimension == 0 && version_ == Version::k41 ? 3 : 6;
  for (int i = 0; i < corners; ++i) in_.real(kDouble, "a coordinate of an entity");
  const std::int64_t stated = in_.integer(kCount, "the number of an entity's physical groups");
  const std::size_t count = in_.checkedCount(stated, {1, kGmshIntBytes}, "physical groups");
  // Each element of the entity is noted for each of them.
  if (count > kMostGroups) {
    in_.fail("an entity belongs to " + std::to_string(count) + " physical groups; at most " +
             std::to_string(kMostGroups) + " are read: use fewer");
  }
  if (numbers_of_.count({dimension, tag}) > 0) in_.fail("an entity is given twice");
  for (std::size_t i = 0; i < count; ++i) {
    // Gmsh writes the number of a group that is oriented the other way with a minus.
    numbers_of_[{dimension, tag}].push_back(std::abs(in_.integer(kGmshIntBytes, "a physical group")));
  }
  if (dimension == 0) return;
  const std::int64_t bounding = in_.integer(kCount, "the number of an entity's boundaries");
  for (std::size_t i = in_.checkedCount(bounding, {1, kGmshIntBytes}, "boundaries"); i > 0; --i)
    in_.integer(kGmshIntBytes, "a boundary");
}

}  // namespace

MeshFileContents readGmsh(MeshFileCursor& in, bool with_labels) { return GmshReader(in, with_labels).read(); }

}  // namespace tissue_contact
