/// @file
/// Room `mesh`, private: the arrays of a legacy VTK file beside its grid: FIELD, METADATA, CELL_DATA and POINT_DATA.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/labels.h"
#include "mesh/reader/mesh_file_cursor.h"

namespace tissue_contact {

constexpr int kVtkIntBytes = 4;  // bytes of `int` and `vtkIdType` in a binary file

struct VtkType {
  const char* name;
  int bytes;
  bool real;
  bool is_unsigned = false;
};

/// The type called so, in capitals; null: none that is read.
const VtkType* findVtkType(const std::string& name);

std::string upperCase(std::string_view text);

class VtkArrays {
 public:
  explicit VtkArrays(MeshFileCursor& in) : in_(in) {}

  /// Behind the word METADATA, of the array read last.
  void skipMetadata();
  /// An array with so many components has been read by someone else.
  void noteArray(std::size_t components) { components_ = components; }

  /// Behind the word FIELD.
  void skipField() { readField(); }

  /// From behind the grid to the end of the file: cell data of one number per cell, those of the cells `kept` (ascending).
  std::vector<MeshLabels::CellData> readCellData(std::size_t cells, std::size_t points,
                                                 const std::vector<std::size_t>& kept);

  /// @throws std::invalid_argument as the cursor's, also where the rest of the file cannot hold as many.
  std::size_t readCount(const char* what, ItemSize item);

 private:
  void readAttribute(const std::string& keyword);
  void readScalars();
  void readColors(std::size_t tuples, std::size_t components);
  void readField();
  std::string readName(const char* what);
  VtkType readType(const std::string& name);
  void readValues(const std::string& name, std::size_t components, std::size_t tuples, const VtkType& type);
  double readValue(const VtkType& type);

  MeshFileCursor& in_;
  std::vector<MeshLabels::CellData> cell_data_;
  std::size_t components_ = 1;                      ///< of the array read last
  std::size_t tuples_ = 0;                          ///< of the attributes read now
  bool of_cells_ = false;                           ///< they are cell data
  const std::vector<std::size_t>* kept_ = nullptr;  ///< null: no cell data are read
};

}  // namespace tissue_contact
