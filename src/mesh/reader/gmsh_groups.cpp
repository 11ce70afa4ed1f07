#include "mesh/reader/gmsh_groups.h"

#include <array>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>

namespace tissue_contact {
namespace {

constexpr std::int64_t kMostTag = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t kMostGroups = 16;  // of an entity
// Elements of all groups together, of which a file may hold each for two bytes.
constexpr std::size_t kMostGrouped = 4 * kMostElements;

}  // namespace

void GmshGroups::begin(std::int64_t number) {
  numbers_.clear();
  if (number != 0) numbers_.push_back(number);
}

void GmshGroups::beginEntity(std::int64_t dimension, std::int64_t tag) {
  const auto known = numbers_of_.find({dimension, tag});
  numbers_ = known == numbers_of_.end() ? std::vector<std::int64_t>() : known->second;
}

MeshFileContents::Group& GmshGroups::group(int dimension, std::int64_t number) {
  const auto [found, is_new] = group_of_.emplace(std::make_pair(dimension, number), groups_.size());
  if (is_new) groups_.push_back({dimension, number, "", {}});
  return groups_[found->second];
}

void GmshGroups::add(const ElementCorners& corners, int dimension) {
  for (const std::int64_t number : numbers_) group(dimension, number).elements.push_back(corners);
  grouped_ += numbers_.size();
  if (grouped_ <= kMostGrouped) return;
  in_.fail("the physical groups have more than " + std::to_string(kMostGrouped) +
           " elements; save the mesh with fewer");
}

void GmshGroups::readNames() {
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

void GmshGroups::readEntities(bool is_41) {
  in_.endLine();
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) {
    count = in_.checkedCount(in_.integer(kGmshCountBytes, "a number of entities"), {5, 32}, "entities");
  }
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < counts[static_cast<std::size_t>(dimension)]; ++i) {
      readEntity(dimension, dimension == 0 && is_41 ? 3 : 6);
    }
  }
}

void GmshGroups::readEntity(int dimension, int coordinates) {
  const std::int64_t tag = in_.integer(kGmshIntBytes, "an entity");
  for (int i = 0; i < coordinates; ++i) in_.real(kGmshDoubleBytes, "a coordinate of an entity");
  const std::int64_t stated = in_.integer(kGmshCountBytes, "the number of an entity's physical groups");
  const std::size_t count = in_.checkedCount(stated, {1, kGmshIntBytes}, "physical groups");
  // Each element of the entity is noted for each of them.
  if (count > kMostGroups) {
    in_.fail("an entity belongs to " + std::to_string(count) + " physical groups; at most " +
             std::to_string(kMostGroups) + " are read: use fewer");
  }
  if (numbers_of_.count({dimension, tag}) > 0) in_.fail("an entity is given twice");
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t number = in_.integer(kGmshIntBytes, "a physical group");
    if (number < -kMostTag || number > kMostTag) in_.fail("a physical group has a number of more than 32 bits");
    // Gmsh writes the number of a group that is oriented the other way with a minus.
    numbers_of_[{dimension, tag}].push_back(std::abs(number));
  }
  if (dimension == 0) return;
  const std::int64_t bounding = in_.integer(kGmshCountBytes, "the number of an entity's boundaries");
  for (std::size_t i = in_.checkedCount(bounding, {1, kGmshIntBytes}, "boundaries"); i > 0; --i)
    in_.integer(kGmshIntBytes, "a boundary");
}

}  // namespace tissue_contact
