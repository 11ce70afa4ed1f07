/// @file
/// Room `mesh`: legacy VTK files (VTK file formats, "Simple legacy formats"): an UNSTRUCTURED_GRID in, nodes and
/// tetrahedra out. Up to version 4 a cell is its size and its points; from 5 on, offsets and points are two arrays.
/// Reading stops behind CELL_TYPES: the point and cell data that may follow are of no use here.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/reader/mesh_file.h"

namespace tissue_contact {
namespace {

constexpr int kInt = 4;  // bytes of `int` and `vtkIdType` in a binary file
constexpr std::int64_t kTetra = 10;

std::string upperCase(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = (c >= 'a' && c <= 'z') ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

struct ValueType {
  const char* name;
  int bytes;
  bool real;
};

// `long` has 8 bytes: it was written on a 64-bit Unix, or the checks that follow will find it out.
constexpr ValueType kValueTypes[] = {
    {"FLOAT", 4, true},           {"DOUBLE", 8, true},         {"INT", 4, false},          {"UNSIGNED_INT", 4, false},
    {"LONG", 8, false},           {"UNSIGNED_LONG", 8, false}, {"VTKTYPEINT64", 8, false}, {"VTKTYPEUINT64", 8, false},
    {"VTKTYPEINT32", 4, false},   {"VTKTYPEUINT32", 4, false}, {"VTKIDTYPE", kInt, false}, {"SHORT", 2, false},
    {"UNSIGNED_SHORT", 2, false}, {"UNSIGNED_CHAR", 1, false}, {"CHAR", 1, false},
};

/// Values with where they stand, so that a message about one of them can say where.
struct IntegerArray {
  std::vector<std::int64_t> values;
  std::size_t start = 0;  ///< offset in the file
  int bytes = kInt;
};

struct Cell {
  std::size_t first;  ///< index of its first point in the connectivity
  std::size_t size;
};

class VtkReader {
 public:
  explicit VtkReader(MeshFileCursor& in) : in_(in) {}
  MeshFileContents read();

 private:
  void readHeader();
  void readBlock(const std::string& keyword);
  void readPoints();
  void readCellsBySize();
  void readCellsByOffset();
  void readCellTypes();
  void skipMetadata();
  void skipField();
  void skipFieldArray();
  ValueType readType(bool real, const char* what);
  IntegerArray readIntegers(std::size_t count, int bytes, const char* what);
  IntegerArray readNamedIntegers(const char* name, std::size_t count);
  std::int64_t readTotal(const char* what, ItemSize item);
  Tetrahedron tetrahedron(std::size_t cell);
  [[noreturn]] void failAt(const IntegerArray& array, std::size_t index, const std::string& message);

  MeshFileCursor& in_;
  std::int64_t major_version_ = 0;
  bool binary_ = false;
  MeshFileContents contents_;
  IntegerArray connectivity_;
  std::vector<Cell> cells_;
  bool have_points_ = false;
  bool have_cells_ = false;
  bool have_types_ = false;
};

void VtkReader::failAt(const IntegerArray& array, std::size_t index, const std::string& message) {
  in_.seek(array.start);
  for (std::size_t i = 0; i <= index; ++i) in_.integer(array.bytes, "a number");
  in_.fail(message);
}

MeshFileContents VtkReader::read() {
  readHeader();
  while (!have_types_) readBlock(upperCase(in_.word("POINTS, CELLS or CELL_TYPES")));
  return std::move(contents_);
}

void VtkReader::readBlock(const std::string& keyword) {
  if (keyword == "METADATA") return skipMetadata();
  if (keyword == "FIELD") return skipField();
  const bool points = keyword == "POINTS";
  const bool cells = keyword == "CELLS";
  if (!points && !cells && keyword != "CELL_TYPES") {
    in_.fail("expected POINTS, CELLS or CELL_TYPES, found " + quoted(keyword) +
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
    in_.fail("the first line is " + quoted(first) + "; it must be '" + std::string(kStart) +
             "x.y' with a version from 1.0 to 5.x: export the file as legacy VTK");
  }
  in_.line();  // the title: any text
  const std::string encoding = upperCase(in_.word("ASCII or BINARY"));
  if (encoding != "ASCII" && encoding != "BINARY") {
    in_.fail("expected ASCII or BINARY, found " + quoted(encoding) + "; export the file as legacy VTK");
  }
  binary_ = encoding == "BINARY";
  if (binary_) in_.setEncoding(MeshFileCursor::Encoding::kBigEndian);
  const std::string dataset = upperCase(in_.word("DATASET"));
  if (dataset != "DATASET") in_.fail("expected DATASET, found " + quoted(dataset) + "; export the file again");
  const std::string kind = upperCase(in_.word("the kind of data set"));
  if (kind != "UNSTRUCTURED_GRID") {
    in_.fail("the data set is " + quoted(kind) +
             "; only UNSTRUCTURED_GRID holds tetrahedra: mesh the volume and save it as one");
  }
}

std::int64_t VtkReader::readTotal(const char* what, ItemSize item) {
  const std::int64_t stated = in_.textInteger(what);
  in_.checkedCount(stated, item, what);
  return stated;
}

ValueType VtkReader::readType(bool real, const char* what) {
  const std::string name = upperCase(in_.word(what));
  for (const ValueType& type : kValueTypes) {
    if (type.real == real && name == type.name) return type;
  }
  in_.fail(std::string("expected ") + what + (real ? " (float or double)" : " (int, long, vtktypeint64, ...)") +
           ", found " + quoted(name) + "; export the file again");
}

void VtkReader::readPoints() {
  const auto count = static_cast<std::size_t>(readTotal("points", {3, 3 * sizeof(float)}));
  const ValueType type = readType(true, "the type of the points");
  in_.checkedCount(static_cast<std::int64_t>(count), {3, 3 * static_cast<std::size_t>(type.bytes)}, "points");
  in_.endLine();
  contents_.nodes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) contents_.nodes.push_back(readNode(in_, type.bytes, i));
  have_points_ = true;
}

IntegerArray VtkReader::readIntegers(std::size_t count, int bytes, const char* what) {
  in_.checkedCount(static_cast<std::int64_t>(count), {1, static_cast<std::size_t>(bytes)}, what);
  in_.endLine();
  IntegerArray array;
  array.start = in_.offset();
  array.bytes = bytes;
  array.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) array.values.push_back(in_.integer(bytes, what));
  return array;
}

void VtkReader::readCellsBySize() {
  const auto count = static_cast<std::size_t>(readTotal("cells", {1, kInt}));
  const auto size = static_cast<std::size_t>(readTotal("values of CELLS", {1, kInt}));
  connectivity_ = readIntegers(size, kInt, "values of CELLS");
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
  const std::string found = upperCase(in_.word(name));
  if (found != name) in_.fail(std::string("expected ") + name + ", found " + quoted(found) + "; export the file again");
  const ValueType type = readType(false, "the type of the array");
  return readIntegers(count, type.bytes, name);
}

void VtkReader::readCellsByOffset() {
  const auto offset_count = static_cast<std::size_t>(readTotal("offsets", {1, 1}));
  const auto size = static_cast<std::size_t>(readTotal("values of CONNECTIVITY", {1, 1}));
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
  const auto count = static_cast<std::size_t>(readTotal("cell types", {1, kInt}));
  if (count != cells_.size()) {
    in_.fail("there are " + std::to_string(count) + " cell types for " + std::to_string(cells_.size()) +
             " cells; export the file again");
  }
  const IntegerArray types = readIntegers(count, kInt, "cell types");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t type = types.values[i];
    const bool high_order =
        type == 24 || type == 64 || type == 71 || type == 78;  // quadratic, parametric, Lagrange, Bezier
    if (high_order) {
      failAt(types, i,
             "cell " + std::to_string(i) + " is a tetrahedron of higher order (type " + std::to_string(type) +
                 "); only those with 4 points (type 10) are read: export the mesh with linear elements");
    }
    if (type == kTetra && cells_[i].size != 4) {
      failAt(types, i,
             "cell " + std::to_string(i) + " is a tetrahedron (type 10) with " + std::to_string(cells_[i].size) +
                 " points; it must have 4: export the file again");
    }
    if (type == kTetra) {
      contents_.tetrahedra.push_back(tetrahedron(i));
    } else {
      ++contents_.other_elements;
    }
  }
  have_types_ = true;
}

Tetrahedron VtkReader::tetrahedron(std::size_t cell) {
  const std::size_t first = cells_[cell].first;
  Tetrahedron tet{};
  for (std::size_t i = 0; i < tet.size(); ++i) {
    const std::int64_t point = connectivity_.values[first + i];
    if (point < 0 || static_cast<std::uint64_t>(point) >= contents_.nodes.size()) {
      failAt(connectivity_, first + i,
             "cell " + std::to_string(cell) + " refers to point " + std::to_string(point) + ", but there are " +
                 std::to_string(contents_.nodes.size()) + " points (numbered from 0): export the file again");
    }
    tet[i] = static_cast<int>(point);
  }
  return tet;
}

void VtkReader::skipMetadata() {
  in_.endLine();
  while (in_.remaining() > 0) {
    const std::string_view text = in_.line();
    if (text.find_first_not_of(" \t") == std::string_view::npos) return;  // a blank line ends the metadata
  }
}

void VtkReader::skipField() {
  in_.word("the name of the field");
  const auto arrays = static_cast<std::size_t>(readTotal("field arrays", {4, 8}));
  for (std::size_t i = 0; i < arrays; ++i) skipFieldArray();
}

void VtkReader::skipFieldArray() {
  std::string name(in_.word("the name of a field array"));
  if (upperCase(name) == "METADATA") {  // of the array before
    skipMetadata();
    name = in_.word("the name of a field array");
  }
  const auto components = static_cast<std::size_t>(readTotal("components of a field array", {1, 1}));
  const auto tuples = static_cast<std::size_t>(readTotal("tuples of a field array", {1, 1}));
  const std::string type_name = upperCase(in_.word("the type of a field array"));
  const auto* type = std::find_if(std::begin(kValueTypes), std::end(kValueTypes),
                                  [&](const ValueType& known) { return type_name == known.name; });
  if (type == std::end(kValueTypes)) {
    in_.fail("field array " + quoted(name) + " has the type " + quoted(type_name) +
             ", which is not read; export the file without field data");
  }
  // Both factors are below the file's size (2^30), so that their product cannot overflow.
  const auto values = static_cast<std::int64_t>(components * tuples);
  const auto bytes = static_cast<std::size_t>(type->bytes);
  const std::size_t count = in_.checkedCount(values, {1, bytes}, "values of a field array");
  in_.endLine();
  if (binary_) return in_.skipBytes(count * bytes);
  for (std::size_t i = 0; i < count; ++i) in_.word("a value of a field array");
}

}  // namespace

MeshFileContents readVtk(MeshFileCursor& in) { return VtkReader(in).read(); }

}  // namespace tissue_contact
