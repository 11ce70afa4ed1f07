/// @file
/// Room `mesh`: legacy VTK files (VTK file formats, "Simple legacy formats"): an UNSTRUCTURED_GRID in, nodes and
/// tetrahedra out. Up to version 4 a cell is its size and its points; from 5 on, offsets and points are two arrays.
/// Reading stops behind CELL_TYPES, unless cell data are asked for.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file.h"

namespace tissue_contact {
namespace {

constexpr int kVtkIntBytes = 4;  // bytes of `int` and `vtkIdType` in a binary file
constexpr std::int64_t kTetra = 10;

/// Voxels, hexahedra, wedges, pyramids, prisms, polyhedra; quadratic, of several kinds; Lagrange and Bezier.
bool isOtherVolume(std::int64_t type) {
  static constexpr std::int64_t kTypes[] = {11, 12, 13, 14, 15, 16, 25, 26, 27, 29, 31,
                                            32, 33, 37, 42, 72, 73, 74, 79, 80, 81};
  return std::find(std::begin(kTypes), std::end(kTypes), type) != std::end(kTypes);
}

/// Quadratic, Lagrange and Bezier: their corners are their first points.
bool isHighOrderTetrahedron(std::int64_t type) { return type == 24 || type == 71 || type == 78; }

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
    {"FLOAT", 4, true},
    {"DOUBLE", 8, true},
    {"INT", 4, false},
    {"UNSIGNED_INT", 4, false},
    {"LONG", 8, false},
    {"UNSIGNED_LONG", 8, false},
    {"VTKTYPEINT64", 8, false},
    {"VTKTYPEUINT64", 8, false},
    {"VTKTYPEINT32", 4, false},
    {"VTKTYPEUINT32", 4, false},
    {"VTKIDTYPE", kVtkIntBytes, false},
    {"SHORT", 2, false},
    {"UNSIGNED_SHORT", 2, false},
    {"UNSIGNED_CHAR", 1, false},
    {"CHAR", 1, false},
};

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
  VtkReader(MeshFileCursor& in, bool with_labels) : in_(in), with_labels_(with_labels) {}
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
  std::string fieldArrayName();
  void readAttributes();
  void readAttribute(const std::string& keyword);
  void readScalars();
  void readFieldArray();
  void readValues(const std::string& name, std::size_t components, std::size_t tuples, const ValueType& type);
  ValueType readAnyType(const std::string& name);
  ValueType readType(bool real, const char* what);
  IntegerArray readIntegers(std::size_t count, int bytes, const char* what);
  IntegerArray readNamedIntegers(const char* name, std::size_t count);
  std::int64_t readTotal(const char* what, ItemSize item);
  Tetrahedron tetrahedron(std::size_t cell);
  int point(std::size_t cell, std::size_t k);
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
  bool with_labels_;
  std::vector<std::size_t> tetrahedra_;  ///< which cells they are
  std::size_t tuples_ = 0;               ///< of the attributes read now
  bool of_cells_ = false;                ///< they are cell data
};

void VtkReader::failAt(const IntegerArray& array, std::size_t index, const std::string& message) {
  in_.seek(array.start);
  for (std::size_t i = 0; i <= index; ++i) in_.integer(array.bytes, "a number");
  in_.fail(message);
}

MeshFileContents VtkReader::read() {
  readHeader();
  while (!have_types_) readBlock(upperCase(in_.word("POINTS, CELLS or CELL_TYPES")));
  if (with_labels_) readAttributes();
  return std::move(contents_);
}

void VtkReader::readBlock(const std::string& keyword) {
  if (keyword == "METADATA") return skipMetadata();
  if (keyword == "FIELD") return skipField();
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
  binary_ = encoding == "BINARY";
  if (binary_) in_.setEncoding(MeshFileCursor::Encoding::kBigEndian);
  const std::string dataset = upperCase(in_.word("DATASET"));
  if (dataset != "DATASET") in_.fail("expected DATASET, found " + excerpt(dataset) + "; export the file again");
  const std::string kind = upperCase(in_.word("the kind of data set"));
  if (kind != "UNSTRUCTURED_GRID") {
    in_.fail("the data set is " + excerpt(kind) +
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
           ", found " + excerpt(name) + "; export the file again");
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
  const auto count = static_cast<std::size_t>(readTotal("cells", {1, kVtkIntBytes}));
  const auto size = static_cast<std::size_t>(readTotal("values of CELLS", {1, kVtkIntBytes}));
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
  const std::string found = upperCase(in_.word(name));
  if (found != name)
    in_.fail(std::string("expected ") + name + ", found " + excerpt(found) + "; export the file again");
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
  const auto count = static_cast<std::size_t>(readTotal("cell types", {1, kVtkIntBytes}));
  if (count != cells_.size()) {
    in_.fail("there are " + std::to_string(count) + " cell types for " + std::to_string(cells_.size()) +
             " cells; export the file again");
  }
  const IntegerArray types = readIntegers(count, kVtkIntBytes, "cell types");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t type = types.values[i];
    const bool high_order = isHighOrderTetrahedron(type);
    const std::size_t size = cells_[i].size;
    if ((type == kTetra && size != 4) || (high_order && size < 10)) {
      failAt(types, i,
             "cell " + std::to_string(i) + " is a tetrahedron (type " + std::to_string(type) + ") with " +
                 std::to_string(size) + " points; it must have " + (high_order ? "10 or more" : "4") +
                 ": export the file again");
    }
    if (high_order) {
      ++contents_.higher_order;
      for (std::size_t k = 4; k < size; ++k) contents_.between_corners.push_back(point(i, k));
    }
    if (type == kTetra || high_order) {
      contents_.tetrahedra.push_back(tetrahedron(i));
      tetrahedra_.push_back(i);
    } else {
      ++contents_.other_elements;
      if (isOtherVolume(type)) ++contents_.other_volumes;
    }
  }
  have_types_ = true;
}

Tetrahedron VtkReader::tetrahedron(std::size_t cell) {
  Tetrahedron tet{};
  for (std::size_t k = 0; k < tet.size(); ++k) tet[k] = point(cell, k);
  return tet;
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

std::string VtkReader::fieldArrayName() {
  std::string name(in_.word("the name of a field array"));
  if (upperCase(name) == "METADATA") {  // of the array before
    skipMetadata();
    name = in_.word("the name of a field array");
  }
  return name;
}

ValueType VtkReader::readAnyType(const std::string& name) {
  const std::string type_name = upperCase(in_.word("the type of an array"));
  const auto* type = std::find_if(std::begin(kValueTypes), std::end(kValueTypes),
                                  [&](const ValueType& known) { return type_name == known.name; });
  if (type == std::end(kValueTypes)) {
    in_.fail("the array " + excerpt(name) + " has the type " + excerpt(type_name) +
             ", which is not read; export the file without field data of this kind");
  }
  return *type;
}

/// Point data and cell data, to the end of the file.
void VtkReader::readAttributes() {
  while (!in_.atEnd()) {
    const std::string keyword = upperCase(in_.word("CELL_DATA or POINT_DATA"));
    if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
      of_cells_ = keyword == "CELL_DATA";
      tuples_ = of_cells_ ? cells_.size() : contents_.nodes.size();
      const std::int64_t stated = in_.textInteger(keyword.c_str());
      if (stated >= 0 && static_cast<std::uint64_t>(stated) == tuples_) continue;
      in_.fail(keyword + " is for " + std::to_string(stated) + ", but there are " + std::to_string(tuples_) +
               "; export the file again");
    }
    readAttribute(keyword);
  }
}

void VtkReader::readAttribute(const std::string& keyword) {
  if (keyword == "METADATA") return skipMetadata();
  if (keyword == "SCALARS") return readScalars();
  if (keyword == "FIELD") {
    in_.word("the name of the field");
    for (std::int64_t left = readTotal("field arrays", {4, 8}); left > 0; --left) readFieldArray();
    return;
  }
  const bool is_vector = keyword == "VECTORS" || keyword == "NORMALS";
  if (!is_vector && keyword != "TENSORS") {
    in_.fail("data of the kind " + excerpt(keyword) +
             " are not read (SCALARS, FIELD, VECTORS, NORMALS and TENSORS are); export the file without them");
  }
  const std::string name(in_.word("the name of the data"));
  const ValueType type = readAnyType(name);
  readValues(name, is_vector ? 3 : 9, tuples_, type);
}

/// SCALARS name type [components]; LOOKUP_TABLE name; values.
void VtkReader::readScalars() {
  const std::string name(in_.word("the name of the scalars"));
  const ValueType type = readAnyType(name);
  const std::string_view rest = in_.line();
  const std::size_t digit = rest.find_first_not_of(" \t\r");
  std::size_t components = 1;
  if (digit != std::string_view::npos) {
    if (rest[digit] < '1' || rest[digit] > '4') in_.fail("scalars have 1 to 4 components; export the file again");
    components = static_cast<std::size_t>(rest[digit] - '0');
  }
  if (upperCase(in_.word("LOOKUP_TABLE")) != "LOOKUP_TABLE") {
    in_.fail("the scalars " + excerpt(name) + " must be followed by LOOKUP_TABLE; export the file again");
  }
  in_.word("the name of the lookup table");
  readValues(name, components, tuples_, type);
}

void VtkReader::readFieldArray() {
  const std::string name = fieldArrayName();
  const auto components = static_cast<std::size_t>(readTotal("components of a field array", {1, 1}));
  const auto tuples = static_cast<std::size_t>(readTotal("tuples of a field array", {1, 1}));
  const ValueType type = readAnyType(name);
  readValues(name, components, tuples, type);
}

/// Keeps those of cells that are one number each, of the tetrahedra.
void VtkReader::readValues(const std::string& name, std::size_t components, std::size_t tuples, const ValueType& type) {
  // Both factors are below the file's size (2^30), so that their product cannot overflow.
  const auto stated = static_cast<std::int64_t>(components * tuples);
  const std::size_t count = in_.checkedCount(stated, {1, static_cast<std::size_t>(type.bytes)}, "values of an array");
  in_.endLine();
  const bool is_kept = of_cells_ && components == 1 && tuples == cells_.size();
  MeshLabels::CellData data{name, {}};
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = type.real ? in_.real(type.bytes, "a value of an array")
                                   : static_cast<double>(in_.integer(type.bytes, "a value of an array"));
    if (!is_kept || next == tetrahedra_.size() || tetrahedra_[next] != i) continue;
    data.values.push_back(value);
    ++next;
  }
  if (is_kept) contents_.cell_data.push_back(std::move(data));
}

void VtkReader::skipFieldArray() {
  const std::string name = fieldArrayName();
  const auto components = static_cast<std::size_t>(readTotal("components of a field array", {1, 1}));
  const auto tuples = static_cast<std::size_t>(readTotal("tuples of a field array", {1, 1}));
  const ValueType type = readAnyType(name);
  // Both factors are below the file's size (2^30), so that their product cannot overflow.
  const auto values = static_cast<std::int64_t>(components * tuples);
  const auto bytes = static_cast<std::size_t>(type.bytes);
  const std::size_t count = in_.checkedCount(values, {1, bytes}, "values of a field array");
  in_.endLine();
  if (binary_) return in_.skipBytes(count * bytes);
  for (std::size_t i = 0; i < count; ++i) in_.word("a value of a field array");
}

}  // namespace

MeshFileContents readVtk(MeshFileCursor& in, bool with_labels) { return VtkReader(in, with_labels).read(); }

}  // namespace tissue_contact
