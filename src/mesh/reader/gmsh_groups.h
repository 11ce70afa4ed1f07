/// @file
/// Room `mesh`, private: the physical groups of Gmsh MSH files, sections $PhysicalNames and $Entities (Gmsh reference manual, "Gmsh file
/// formats").
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file.h"

namespace tissue_contact {

// What all versions have in common, in bytes.
constexpr int kGmshDoubleBytes = 8;
constexpr int kGmshIntBytes = 4;
constexpr int kGmshCountBytes = 8;  ///< `unsigned long` (4.0) and `size_t` (4.1)

/// Errors are the cursor's (MeshFileCursor::fail()), with the file and the place.
class GmshGroups {
 public:
  explicit GmshGroups(MeshFileCursor& in) : in_(in) {}

  /// $PhysicalNames, after that word.
  void readNames();
  /// $Entities of MSH 4, after that word: which entities belong to which groups.
  /// @param is_41 of MSH 4.1, which gives points where 4.0 gives boxes.
  void readEntities(bool is_41);

  /// What is added next belongs to that group; 0: to none.
  void begin(std::int64_t number);
  /// The same, to the groups of an entity.
  void beginEntity(std::int64_t dimension, std::int64_t tag);
  /// The first of these groups; 0: there is none.
  std::int64_t number() const { return numbers_.empty() ? 0 : numbers_[0]; }
  void add(const ElementCorners& corners, int dimension);

  std::vector<MeshFileContents::Group> take() { return std::move(groups_); }

 private:
  void readEntity(int dimension, int coordinates);
  MeshFileContents::Group& group(int dimension, std::int64_t number);

  MeshFileCursor& in_;
  std::vector<MeshFileContents::Group> groups_;
  std::map<std::pair<int, std::int64_t>, std::size_t> group_of_;                           ///< by dimension and number
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::int64_t>> numbers_of_;  ///< of an entity's groups
  std::vector<std::int64_t> numbers_;  ///< of the groups of what is read now
  std::size_t grouped_ = 0;            ///< elements of all groups
};

}  // namespace tissue_contact
