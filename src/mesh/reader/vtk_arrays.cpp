/// @file
/// Room `mesh`: legacy VTK files (VTK file formats, "Simple legacy formats"; what its writer does beyond that): arrays.
#include "mesh/reader/vtk_arrays.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

namespace tissue_contact {
namespace {

// `long` has 8 bytes: it was written on a 64-bit Unix, or the checks that follow will find it out.
constexpr VtkType kTypes[] = {
    {"FLOAT", 4, true},
    {"DOUBLE", 8, true},
    {"INT", 4, false},
    {"UNSIGNED_INT", 4, false, true},
    {"LONG", 8, false},
    {"UNSIGNED_LONG", 8, false, true},
    {"VTKTYPEINT64", 8, false},
    {"VTKTYPEUINT64", 8, false, true},
    {"VTKTYPEINT32", 4, false},
    {"VTKTYPEUINT32", 4, false, true},
    {"VTKIDTYPE", kVtkIntBytes, false},
    {"SHORT", 2, false},
    {"UNSIGNED_SHORT", 2, false, true},
    {"UNSIGNED_CHAR", 1, false, true},
    {"SIGNED_CHAR", 1, false},
    {"CHAR", 1, false},
};

/// VTK writes what is no letter or digit of a name as %20, say.
std::string decoded(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned char code = 0;
    const char* const digits = name.data() + i + 1;
    const bool is_code =
        name[i] == '%' && i + 2 < name.size() && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
    out += is_code ? static_cast<char>(code) : name[i];
    i += is_code ? 2 : 0;
  }
  return out;
}

bool isBlank(std::string_view line) { return line.find_first_not_of(" \t\r") == std::string_view::npos; }

}  // namespace

const VtkType* findVtkType(const std::string& name) {
  const auto* const type =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const VtkType& known) { return name == known.name; });
  return type == std::end(kTypes) ? nullptr : type;
}

std::string upperCase(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = (c >= 'a' && c <= 'z') ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

std::size_t VtkArrays::readCount(const char* what, ItemSize item) {
  return in_.checkedCount(in_.textInteger(what), item, what);
}

void VtkArrays::skipMetadata() {
  in_.endLine();
  while (in_.remaining() > 0) {
    const std::string_view line = in_.line();
    if (isBlank(line)) return;  // the end of the metadata
    if (line.substr(0, 15) != "COMPONENT_NAMES") continue;
    for (std::size_t i = 0; i < components_ && in_.remaining() > 0; ++i) in_.line();  // blank where one has no name
  }
}

std::vector<MeshLabels::CellData> VtkArrays::readCellData(std::size_t cells, std::size_t points,
                                                          const std::vector<std::size_t>& kept) {
  kept_ = &kept;
  while (!in_.atEnd()) {
    const std::string keyword = upperCase(in_.word("CELL_DATA or POINT_DATA"));
    if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
      of_cells_ = keyword == "CELL_DATA";
      tuples_ = of_cells_ ? cells : points;
      const std::int64_t stated = in_.textInteger(keyword.c_str());
      if (stated >= 0 && static_cast<std::uint64_t>(stated) == tuples_) continue;
      in_.fail(keyword + " is for " + std::to_string(stated) + ", but there are " + std::to_string(tuples_) +
               "; export the file again");
    }
    readAttribute(keyword);
  }
  return std::move(cell_data_);
}

void VtkArrays::readAttribute(const std::string& keyword) {
  if (keyword == "METADATA") return skipMetadata();
  if (keyword == "SCALARS") return readScalars();
  if (keyword == "FIELD") return readField();
  static const std::map<std::string, std::size_t> kComponents = {
      {"VECTORS", 3},      {"NORMALS", 3},      {"TENSORS", 9},       {"TENSORS6", 6},           {"GLOBAL_IDS", 1},
      {"PEDIGREE_IDS", 1}, {"LOOKUP_TABLE", 4}, {"COLOR_SCALARS", 0}, {"TEXTURE_COORDINATES", 0}};
  const auto known = kComponents.find(keyword);
  if (known == kComponents.end()) {
    in_.fail("data of the kind " + excerpt(keyword) + " are not read; export the file without them");
  }
  const std::string name = readName("the name of the data");
  const std::size_t tuples = keyword == "LOOKUP_TABLE" ? readCount("colors of a lookup table", {1, 1}) : tuples_;
  const bool says = known->second == 0;  // how many components
  const std::size_t components = says ? readCount("components of the data", {1, 1}) : known->second;
  if (keyword == "LOOKUP_TABLE" || keyword == "COLOR_SCALARS") return readColors(tuples, components);
  readValues(name, components, tuples, readType(name));
}

/// SCALARS name type [components]; LOOKUP_TABLE name; values.
void VtkArrays::readScalars() {
  const std::string name = readName("the name of the scalars");
  const VtkType type = readType(name);
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

/// Numbers from 0 to 1 as text, bytes if binary; not kept.
void VtkArrays::readColors(std::size_t tuples, std::size_t components) {
  const bool of_cells = std::exchange(of_cells_, false);
  readValues("colors", components, tuples, {"FLOAT", in_.binary() ? 1 : 4, !in_.binary()});
  of_cells_ = of_cells;
}

/// FIELD name arrays; then of each array name components tuples type; values.
void VtkArrays::readField() {
  in_.word("the name of the field");
  for (std::size_t left = readCount("field arrays", {1, 1}); left > 0; --left) {
    std::string name = readName("the name of a field array");
    if (upperCase(name) == "METADATA") {  // of the array before
      skipMetadata();
      name = readName("the name of a field array");
    }
    if (name == "NULL_ARRAY") continue;  // what VTK writes for one that there is not
    const std::size_t components = readCount("components of a field array", {1, 1});
    const std::size_t tuples = readCount("tuples of a field array", {1, 1});
    readValues(name, components, tuples, readType(name));
  }
}

std::string VtkArrays::readName(const char* what) { return decoded(in_.word(what)); }

VtkType VtkArrays::readType(const std::string& name) {
  const std::string type_name = upperCase(in_.word("the type of an array"));
  const VtkType* const type = findVtkType(type_name);
  if (type != nullptr) return *type;
  in_.fail("the array " + excerpt(name) + " has the type " + excerpt(type_name) +
           ", which is not read; export the file without field data of this kind");
}

/// Keeps those of cells that are one number each, of the cells kept.
void VtkArrays::readValues(const std::string& name, std::size_t components, std::size_t tuples, const VtkType& type) {
  // Both factors are below the file's size (2^28), so that their product cannot overflow.
  const auto stated = static_cast<std::int64_t>(components * tuples);
  const auto bytes = static_cast<std::size_t>(type.bytes);
  const std::size_t count = in_.checkedCount(stated, {1, bytes}, "values of an array");
  in_.endLine();
  components_ = components;
  if (kept_ == nullptr || !of_cells_ || components != 1 || tuples != tuples_) {
    if (in_.binary()) return in_.skipBytes(count * bytes);
    for (std::size_t i = 0; i < count; ++i) in_.word("a value of an array");
    return;
  }
  MeshLabels::CellData data{name, {}};
  data.values.reserve(kept_->size());
  for (std::size_t i = 0; i < count; ++i) {
    const double value = readValue(type);
    const std::size_t next = data.values.size();
    if (next < kept_->size() && (*kept_)[next] == i) data.values.push_back(value);
  }
  cell_data_.push_back(std::move(data));
}

double VtkArrays::readValue(const VtkType& type) {
  if (type.real) return in_.real(type.bytes, "a value of an array");
  const auto value = static_cast<double>(in_.integer(type.bytes, "a value of an array"));
  // What the cursor reads is signed.
  return type.is_unsigned && value < 0.0 ? value + std::ldexp(1.0, 8 * type.bytes) : value;
}

}  // namespace tissue_contact
