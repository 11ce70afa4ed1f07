/// @file
/// Room `mesh`: legacy VTK files (VTK file formats, "Simple legacy formats"): an UNSTRUCTURED_GRID in, nodes and
/// volumes out. Up to version 4 a cell is its size and its points; from 5 on, offsets and points are two arrays.
/// Reading stops behind CELL_TYPES, unless cell data are asked for.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file.h"
#include "mesh/reader/vtk_arrays.h"

namespace tissue_contact {
namespace {

constexpr std::int64_t kVoxel = 11;     // a hexahedron with its points in the order of x, y and z
constexpr std::int64_t kWedge = 13;     // a prism, numbered from its other end
constexpr std::int64_t kLagrange = 71;  // from here on any order, which may differ between directions

/// Of a cell that is read: how many of its points are corners, the first ones, and how many it has of second order.
struct CellKind {
  std::size_t corners = 0;  ///< 0: another cell
  std::size_t quadratic = 0;
};

CellKind kindOf(std::int64_t type) {
  constexpr CellKind kTetrahedron = {4, 10}, kPyramid = {5, 13}, kPrism = {6, 12}, kHexahedron = {8, 20};
  switch (type) {  // linear; quadratic, of one kind or more; Lagrange, Bezier
    case 10:
    case 24:
    case kLagrange:
    case 78:
      return kTetrahedron;
    case 14:
    case 27:
    case 37:
    case 74:
    case 81:
      return kPyramid;
    case kWedge:
    case 26:
    case 31:
    case 32:
    case 73:
    case 80:
      return kPrism;
    case kVoxel:
    case 12:
    case 25:
    case 29:
    case 33:
    case 72:
    case 79:
      return kHexahedron;
    default:
      return {};
  }
}

/// Points, lines and surfaces, which fill no space.
bool isFlat(std::int64_t type) {
  static constexpr std::pair<int, int> kRanges[] = {{0, 9},   {21, 23}, {28, 28}, {30, 30}, {34, 36},
                                                    {51, 54}, {60, 63}, {68, 70}, {75, 77}};
  return std::any_of(std::begin(kRanges), std::end(kRanges),
                     [&](const auto& range) { return range.first <= type && type <= range.second; });
}

/// Values with where they stand, so that a message about one of them can say where.
struct IntegerArray {
  std::vector<std::int64_t> values;
  std::size_t start = 0;  ///< offset in the file
  int bytes = kVtkIntBytes;
};

struct Cell {
  std::size_t first;  ///< index of its first point in the connectivity
  std::size_t size;
};

class VtkReader {
 public:
  VtkReader(MeshFileCursor& in, bool with_labels) : in_(in), arrays_(in), with_labels_(with_labels) {}
  MeshFileContents read();

 private:
  void readHeader();
  void readBlock(const std::string& keyword);
  void readPoints();
  void readCellsBySize();
  void readCellsByOffset();
  void readCellTypes();
  VtkType readType(bool real, const char* what);
  IntegerArray readIntegers(std::size_t count, int bytes, const char* what);
  IntegerArray readNamedIntegers(const char* name, std::size_t count);
  void readCell(std::size_t cell, std::int64_t type);
  int point(std::size_t cell, std::size_t k);
  [[noreturn]] void failAt(const IntegerArray& array, std::size_t index, const std::string& message);

  MeshFileCursor& in_;
  VtkArrays arrays_;
  std::int64_t major_version_ = 0;
  MeshFileContents contents_;
  IntegerArray connectivity_;
  std::vector<Cell> cells_;
  bool have_points_ = false;
  bool have_cells_ = false;
  bool have_types_ = false;
  bool with_labels_;
  std::vector<std::size_t> volumes_;  ///< which cells they are
};

void VtkReader::failAt(const IntegerArray& array, std::size_t index, const std::string& message) {
  in_.seek(array.start);
  for (std::size_t i = 0; i <= index; ++i) in_.integer(array.bytes, "a number");
  in_.fail(message);
}

MeshFileContents VtkReader::read() {
  readHeader();
  while (!have_types_) readBlock(upperCase(in_.word("POINTS, CELLS or CELL_TYPES")));
  if (with_labels_) {
    contents_.cell_data = arrays_.readCellData(cells_.size(), contents_.nodes.size(), volumes_);
  }
  return std::move(contents_);
}

void VtkReader::readBlock(const std::string& keyword) {
  if (keyword == "METADATA") return arrays_.skipMetadata();
  if (keyword == "FIELD") return arrays_.skipField();
  const bool points = keyword == "POINTS";
  const bool cells = keyword == "CELLS";
  if (!points && !cells && keyword != "CELL_TYPES") {
    in_.fail("expected POINTS, CELLS or CELL_TYPES, found " + excerpt(keyword) +
             "; the block before is longer than its count says, or one is missing: export the file again");
  }
  if ((points && have_points_) || (cells && have_cells_)) {
    in_.fail("a second block " + keyword + "; there must be one: export the file again");
  }
  if (points) return readPoints();
  if (cells) return major_version_ < 5 ? readCellsBySize() : readCellsByOffset();
  if (!have_points_ || !have_cells_) in_.fail("CELL_TYPES must follow POINTS and CELLS; export the file again");
  readCellTypes();
}

void VtkReader::readHeader() {
  constexpr std::string_view kStart = "# vtk DataFile Version ";
  const std::string_view first = in_.line();
  if (first.substr(0, kStart.size()) == kStart) {
    const std::string_view version = first.substr(kStart.size());
    std::from_chars(version.data(), version.data() + version.size(), major_version_);
  }
  if (major_version_ < 1 || major_version_ > 5) {
    in_.fail("the first line is " + excerpt(first) + "; it must be '" + std::string(kStart) +
             "x.y' with a version from 1.0 to 5.x: export the file as legacy VTK");
  }
  in_.line();  // the title: any text
  const std::string encoding = upperCase(in_.word("ASCII or BINARY"));
  if (encoding != "ASCII" && encoding != "BINARY") {
    in_.fail("expected ASCII or BINARY, found " + excerpt(encoding) + "; export the file as legacy VTK");
  }
  if (encoding == "BINARY") in_.setEncoding(MeshFileCursor::Encoding::kBigEndian);
  const std::string dataset = upperCase(in_.word("DATASET"));
  if (dataset != "DATASET") in_.fail("expected DATASET, found " + excerpt(dataset) + "; export the file again");
  const std::string kind = upperCase(in_.word("the kind of data set"));
  if (kind != "UNSTRUCTURED_GRID") {
    in_.fail("the data set is " + excerpt(kind) + "; only UNSTRUCTURED_GRID holds tetrahedra: " +
             (kind == "POLYDATA"
                  ? "save the surface as .stl (gmsh FILE.vtk -save -o FILE.stl), which make_scene.py fills"
                  : "mesh the volume and save it as one"));
  }
}

VtkType VtkReader::readType(bool real, const char* what) {
  const std::string name = upperCase(in_.word(what));
  const VtkType* const type = findVtkType(name);
  if (type != nullptr && type->real == real) return *type;
  in_.fail(std::string("expected ") + what + (real ? " (float or double)" : " (int, long, vtktypeint64, ...)") +
           ", found " + excerpt(name) + "; export the file again");
}

void VtkReader::readPoints() {
  const auto count = arrays_.readCount("points", {3, 3 * sizeof(float)});
  const VtkType type = readType(true, "the type of the points");
  in_.checkedCount(static_cast<std::int64_t>(count), {3, 3 * static_cast<std::size_t>(type.bytes)}, "points");
  in_.endLine();
  contents_.nodes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) contents_.nodes.push_back(readNode(in_, type.bytes, i));
  arrays_.noteArray(3);
  have_points_ = true;
}

IntegerArray VtkReader::readIntegers(std::size_t count, int bytes, const char* what) {
  in_.checkedCount(static_cast<std::int64_t>(count), {1, static_cast<std::size_t>(bytes)}, what);
  in_.endLine();
  arrays_.noteArray(1);
  IntegerArray array;
  array.start = in_.offset();
  array.bytes = bytes;
  array.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) array.values.push_back(in_.integer(bytes, what));
  return array;
}

void VtkReader::readCellsBySize() {
  const auto count = arrays_.readCount("cells", {1, kVtkIntBytes});
  const auto size = arrays_.readCount("values of CELLS", {1, kVtkIntBytes});
  connectivity_ = readIntegers(size, kVtkIntBytes, "values of CELLS");
  cells_.reserve(count);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string cell = "cell " + std::to_string(i);
    if (next >= size)
      in_.fail(cell + " lies behind the " + std::to_string(size) + " values of CELLS; export the file again");
    const std::int64_t points = connectivity_.values[next];
    if (points < 0 || static_cast<std::uint64_t>(points) > size - next - 1) {
      failAt(connectivity_, next,
             cell + " has " + std::to_string(points) + " points, but " + std::to_string(size - next - 1) +
                 " values of CELLS follow; export the file again");
    }
    cells_.push_back({next + 1, static_cast<std::size_t>(points)});
    next += 1 + static_cast<std::size_t>(points);
  }
  if (next != size) {
    failAt(connectivity_, next,
           "CELLS has " + std::to_string(size - next) + " values more than its cells use; export the file again");
  }
  have_cells_ = true;
}

IntegerArray VtkReader::readNamedIntegers(const char* name, std::size_t count) {
  std::string found = upperCase(in_.word(name));
  if (found == "METADATA") {  // of the array before
    arrays_.skipMetadata();
    found = upperCase(in_.word(name));
  }
  if (found != name)
    in_.fail(std::string("expected ") + name + ", found " + excerpt(found) + "; export the file again");
  const VtkType type = readType(false, "the type of the array");
  return readIntegers(count, type.bytes, name);
}

void VtkReader::readCellsByOffset() {
  const auto offset_count = arrays_.readCount("offsets", {1, 1});
  const auto size = arrays_.readCount("values of CONNECTIVITY", {1, 1});
  in_.endLine();
  const IntegerArray offsets = readNamedIntegers("OFFSETS", offset_count);
  const std::size_t connectivity_header = in_.offset();
  connectivity_ = readNamedIntegers("CONNECTIVITY", size);
  if (offset_count == 0 && size > 0) {
    in_.seek(connectivity_header);
    in_.fail("there are no OFFSETS for the values of CONNECTIVITY; export the file again");
  }
  cells_.reserve(offset_count);
  std::int64_t last = 0;
  for (std::size_t i = 0; i < offset_count; ++i) {
    const std::int64_t offset = offsets.values[i];
    const std::int64_t least = i == 0 ? 0 : last;
    const auto most = i == 0 ? std::int64_t{0} : static_cast<std::int64_t>(size);
    const bool end = i + 1 == offset_count;
    if (offset < least || offset > most || (end && offset != static_cast<std::int64_t>(size))) {
      failAt(offsets, i,
             "offset " + std::to_string(i) + " is " + std::to_string(offset) +
                 "; offsets must rise from 0 to the size of CONNECTIVITY, " + std::to_string(size) +
                 ": export the file again");
    }
    if (i > 0) cells_.push_back({static_cast<std::size_t>(last), static_cast<std::size_t>(offset - last)});
    last = offset;
  }
  have_cells_ = true;
}

void VtkReader::readCellTypes() {
  const auto count = arrays_.readCount("cell types", {1, kVtkIntBytes});
  if (count != cells_.size()) {
    in_.fail("there are " + std::to_string(count) + " cell types for " + std::to_string(cells_.size()) +
             " cells; export the file again");
  }
  const IntegerArray types = readIntegers(count, kVtkIntBytes, "cell types");
  for (std::size_t i = 0; i < count; ++i) {
    const CellKind kind = kindOf(types.values[i]);
    const std::size_t size = cells_[i].size;
    const std::size_t next = types.values[i] < kLagrange ? kind.quadratic : kind.corners;
    if (kind.corners > 0 && size != kind.corners && size < next) {
      failAt(types, i,
             "cell " + std::to_string(i) + " has the type " + std::to_string(types.values[i]) + " and " +
                 std::to_string(size) + " points; it must have " + std::to_string(kind.corners) + ", or " +
                 std::to_string(kind.quadratic) + " or more if it is of higher order: export the file again");
    }
    readCell(i, types.values[i]);
  }
  have_types_ = true;
}

void VtkReader::readCell(std::size_t cell, std::int64_t type) {
  const std::size_t size = cells_[cell].size;
  const std::size_t corners = kindOf(type).corners;
  if (corners == 0) {
    ++contents_.other_elements;
    if (!isFlat(type)) ++contents_.other_volumes;
    return;
  }
  ElementCorners volume = kNoCorners;
  for (std::size_t k = 0; k < corners; ++k) volume[k] = point(cell, k);
  if (type == kVoxel) {
    std::swap(volume[2], volume[3]);
    std::swap(volume[6], volume[7]);
  }
  if (type == kWedge) std::swap_ranges(volume.begin(), volume.begin() + 3, volume.begin() + 3);
  for (std::size_t k = corners; k < size; ++k) contents_.between_corners.push_back(point(cell, k));
  if (size > corners) ++contents_.higher_order;
  contents_.volumes.push_back(volume);
  volumes_.push_back(cell);
}

/// Index of the k-th point of a cell.
int VtkReader::point(std::size_t cell, std::size_t k) {
  const std::size_t at = cells_[cell].first + k;
  const std::int64_t point = connectivity_.values[at];
  if (point < 0 || static_cast<std::uint64_t>(point) >= contents_.nodes.size()) {
    failAt(connectivity_, at,
           "cell " + std::to_string(cell) + " refers to point " + std::to_string(point) + ", but there are " +
               std::to_string(contents_.nodes.size()) + " points (numbered from 0): export the file again");
  }
  return static_cast<int>(point);
}

}  // namespace

MeshFileContents readVtk(MeshFileCursor& in, bool with_labels) { return VtkReader(in, with_labels).read(); }

}  // namespace tissue_contact
