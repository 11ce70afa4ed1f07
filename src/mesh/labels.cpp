#include "mesh/labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <variant>

#include "mesh/face_table.h"
#include "mesh/region.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

bool before(const Vector3& a, const Vector3& b) {
  const double order_a = placeOrder(a);
  const double order_b = placeOrder(b);
  return order_a != order_b ? order_a < order_b
                            : std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Nodes of an element and what it is made of.
void addPlaces(const NodalVectors& x, const std::array<int, 4>& element, std::vector<Vector3>& places) {
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (const int node : element) {
    if (node < 0) continue;
    places.emplace_back(x.col(node));
    sum += x.col(node);
    ++count;
  }
  if (count >= 3) places.emplace_back(sum / count);
  for (std::size_t i = 0; count == 4 && i < 4; ++i) {
    const Triangle face = outwardFace(element, i);
    places.emplace_back((x.col(face[0]) + x.col(face[1]) + x.col(face[2])) / 3.0);
  }
}

MemberRegion members(std::string label, std::vector<Vector3> places) {
  std::sort(places.begin(), places.end(), before);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return {std::move(label), std::make_shared<const std::vector<Vector3>>(std::move(places))};
}

bool isCalled(const MeshLabels::Group& group, const std::string& name) {
  return group.name == name || std::to_string(group.number) == name;
}

std::string groupNames(const MeshLabels& labels) {
  std::vector<std::string> names;
  for (const MeshLabels::Group& group : labels.groups) {
    names.push_back(group.name.empty() ? std::to_string(group.number) : group.name);
  }
  return names.empty() ? "the mesh has no physical groups (they are Gmsh's, in .msh files)"
                       : "there are: " + listOf(names);
}

/// The group that is meant. Gmsh numbers groups of each dimension by themselves, and keeps the name of one without elements.
const MeshLabels::Group& groupOf(const GroupRegion& region, const MeshLabels& labels) {
  static constexpr const char* kThings[] = {"points", "curves", "surfaces", "volumes"};
  const MeshLabels::Group* found = nullptr;
  bool is_known = false;
  for (const MeshLabels::Group& group : labels.groups) {
    if (!isCalled(group, region.name)) continue;
    is_known = true;
    if (group.elements.empty()) continue;
    if (found != nullptr) {
      throw std::invalid_argument("group " + inQuotes(region.name) + " is one of " + kThings[found->dimension] +
                                  " and one of " + kThings[group.dimension] +
                                  "; give each a name or number of its own");
    }
    found = &group;
  }
  if (found != nullptr) return *found;
  if (!is_known) throw std::invalid_argument("there is no group " + inQuotes(region.name) + "; " + groupNames(labels));
  throw std::invalid_argument("group " + inQuotes(region.name) +
                              " has no elements in the file; Gmsh leaves them out of partitioned meshes and with "
                              "Mesh.SaveAll: save it without");
}

MemberRegion membersOf(const GroupRegion& region, const MeshLabels& labels) {
  std::vector<Vector3> places;
  for (const std::array<int, 4>& element : groupOf(region, labels).elements) {
    addPlaces(labels.nodes, element, places);
  }
  return members("group " + inQuotes(region.name), std::move(places));
}

std::string valuesText(const std::vector<double>& values) {
  constexpr std::size_t kMost = 12;
  std::set<double> different;
  for (std::size_t i = 0; i < values.size() && different.size() <= kMost; ++i) different.insert(values[i]);
  std::ostringstream text;
  std::size_t said = 0;
  for (auto value = different.begin(); value != different.end() && said < kMost; ++value) {
    text << (said++ > 0 ? ", " : "") << *value;
  }
  return text.str() + (different.size() > kMost ? ", ..." : "");
}

MemberRegion membersOf(const CellDataRegion& region, const MeshLabels& labels, const TetMesh& mesh) {
  // In a file of single precision a scene's .1 is another number.
  const double rounded = std::abs(region.value) <= static_cast<double>(std::numeric_limits<float>::max())
                             ? static_cast<double>(static_cast<float>(region.value))
                             : region.value;
  std::vector<std::string> names;
  for (const MeshLabels::CellData& data : labels.cell_data) {
    names.push_back(data.name);
    if (data.name != region.name) continue;
    const bool is_there = std::find(data.values.begin(), data.values.end(), region.value) != data.values.end();
    const double wanted = is_there ? region.value : rounded;
    std::vector<Vector3> places;
    for (std::size_t e = 0; e < labels.volume_of.size(); ++e) {
      if (data.values[static_cast<std::size_t>(labels.volume_of[e])] == wanted) {
        addPlaces(mesh.positions, mesh.tetrahedra[e], places);
      }
    }
    const std::string label = "cell data " + inQuotes(region.name) + " = " + twoDigits(region.value);
    if (!places.empty()) return members(label, std::move(places));
    throw std::invalid_argument("no tetrahedron has " + label + "; values are: " + valuesText(data.values));
  }
  throw std::invalid_argument("there is no cell data " + inQuotes(region.name) + "; " +
                              (names.empty()
                                   ? "the mesh has none of one number per cell (they are VTK's, in .vtk files)"
                                   : "there are: " + listOf(names)));
}

}  // namespace

bool namesLabels(const std::vector<Region>& regions) {
  return std::any_of(regions.begin(), regions.end(), [](const Region& region) {
    return std::holds_alternative<GroupRegion>(region) || std::holds_alternative<CellDataRegion>(region);
  });
}

std::vector<Region> withPlaces(const std::vector<Region>& regions, const MeshLabels& labels, const TetMesh& mesh,
                               const std::string& entry, const std::string& source) {
  std::vector<Region> resolved = regions;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    try {
      if (const auto* group = std::get_if<GroupRegion>(&regions[r])) resolved[r] = membersOf(*group, labels);
      if (const auto* data = std::get_if<CellDataRegion>(&regions[r])) resolved[r] = membersOf(*data, labels, mesh);
    } catch (const std::invalid_argument& error) {
      throw EntryError(elementOf(entry, r), source + ": " + error.what());
    }
  }
  return resolved;
}

std::vector<Region> withParts(const std::vector<Region>& regions, const std::vector<LastingPart>& parts,
                              double rounding) {
  std::vector<Region> all = regions;
  for (Region& region : all) {
    const auto* const wholes = std::get_if<MemberRegion>(&region);
    if (wholes == nullptr) continue;
    const std::vector<Region> whole = {region};
    std::vector<Vector3> places = *wholes->places;
    for (const LastingPart& part : parts) {
      if (anyHolds(whole, part.whole, rounding)) places.push_back(part.part);
    }
    region = members(wholes->label, std::move(places));
  }
  return all;
}

}  // namespace tissue_contact
