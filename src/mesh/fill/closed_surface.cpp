#include "mesh/fill/closed_surface.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "core/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/fill/crossing_triangles.h"
#include "mesh/nodes.h"
#include "mesh/reader/mesh_cleanup.h"
#include "mesh/surface/winding_tree.h"

namespace tissue_contact {
namespace {

constexpr double kLargestHole =
    3.0;  // cells across: what a fan of triangles spans without changing what cells can resolve
constexpr double kLeastPart = 2.0;  // cells across: smaller ones hold no tetrahedron worth having

std::string placeText(const Vector3& p) {
  std::ostringstream text;
  text.precision(3);
  text << "(" << p.transpose() << ") m";
  return text.str();
}

std::string millimetres(double length_m) {
  std::ostringstream text;
  text.precision(2);
  text << 1e3 * length_m << " mm";
  return text.str();
}

std::string counted(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

void dropDuplicates(TriangleMesh& mesh, std::vector<std::string>& notes) {
  std::set<Triangle> seen;
  const auto is_seen = [&](Triangle t) {
    std::sort(t.begin(), t.end());
    return !seen.insert(t).second;
  };
  const std::size_t before = mesh.triangles.size();
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_seen), mesh.triangles.end());
  const std::size_t dropped = before - mesh.triangles.size();
  if (dropped > 0) notes.push_back("dropped " + counted(dropped, "triangle") + " that stood there twice");
}

/// Per vertex the smallest of its part's vertices; parts are what edges connect.
std::vector<int> partsOf(const TriangleMesh& mesh) {
  const auto vertices = static_cast<std::size_t>(mesh.vertices.cols());
  DisjointSets joined(vertices);
  for (const Triangle& t : mesh.triangles) {
    for (const int other : {t[1], t[2]}) joined.join(t[0], other);
  }
  std::vector<int> root(vertices);
  for (std::size_t v = 0; v < vertices; ++v) root[v] = joined.first(static_cast<int>(v));
  return root;
}

struct Part {
  int root = 0;
  Eigen::AlignedBox3d box;
  double size() const { return box.diagonal().norm(); }
};

/// Largest first.
std::vector<Part> listParts(const TriangleMesh& mesh, const std::vector<int>& root) {
  std::map<int, Part> parts;
  for (const Triangle& t : mesh.triangles) {
    Part& part = parts[root[t[0]]];
    part.root = root[t[0]];
    for (const int v : t) part.box.extend(Vector3(mesh.vertices.col(v)));
  }
  std::vector<Part> list;
  list.reserve(parts.size());
  for (const auto& [first, part] : parts) list.push_back(part);
  std::stable_sort(list.begin(), list.end(), [](const Part& a, const Part& b) { return a.size() > b.size(); });
  return list;
}

void dropSmallParts(TriangleMesh& mesh, double cell_m, std::vector<std::string>& notes) {
  const std::vector<int> root = partsOf(mesh);
  const std::vector<Part> parts = listParts(mesh, root);
  std::set<int> dropped;
  for (std::size_t p = 1; p < parts.size(); ++p) {
    if (parts[p].size() < kLeastPart * cell_m) dropped.insert(parts[p].root);
  }
  if (dropped.empty()) return;
  const auto is_dropped = [&](const Triangle& t) { return dropped.count(root[t[0]]) > 0; };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_dropped), mesh.triangles.end());
  dropUnusedNodes(mesh.vertices, mesh.triangles);
  notes.push_back("dropped " + counted(dropped.size(), "loose part") + " smaller than two cells");
}

void requireManifold(const TriangleMesh& mesh, const EdgeTable& edges, const std::string& source) {
  std::size_t count = 0;
  const EdgeTable::Edge* first = nullptr;
  for (const EdgeTable::Edge& edge : edges) {
    if (edge.count <= 2) continue;
    ++count;
    if (first == nullptr) first = &edge;
  }
  if (first == nullptr) return;
  const Vector3 middle = 0.5 * (mesh.vertices.col(first->nodes[0]) + mesh.vertices.col(first->nodes[1]));
  throw std::invalid_argument(source + ": " + counted(count, "edge") + " of more than two triangles, the first at " +
                              placeText(middle) +
                              ": walls meet there, so that nothing says what is inside; remove inner walls (Blender: "
                              "Select > All by Trait > Non Manifold)");
}

/// Border edges from each of their ends to the other.
using Borders = std::set<std::pair<int, int>>;

Borders bordersOf(const EdgeTable& edges) {
  Borders borders;
  for (const EdgeTable::Edge& edge : edges) {
    if (edge.count != 1) continue;
    borders.emplace(edge.nodes[0], edge.nodes[1]);
    borders.emplace(edge.nodes[1], edge.nodes[0]);
  }
  return borders;
}

/// Takes an edge that begins at `from` out of `borders`. @return where it ends.
int takeBorder(Borders& borders, int from) {
  const auto step = borders.lower_bound({from, 0});
  const int to = step->second;
  borders.erase(step);
  borders.erase({to, from});
  return to;
}

/// Loops of border edges, none through a vertex twice. As no edge has more than two triangles, borders lead on at every vertex.
std::vector<std::vector<int>> borderLoops(const EdgeTable& edges) {
  Borders borders = bordersOf(edges);
  std::vector<std::vector<int>> loops;
  std::vector<int> way;
  std::unordered_map<int, std::ptrdiff_t> place_of;  // on the way: a border may have as many vertices as the mesh
  while (!borders.empty() || way.size() > 1) {
    if (way.empty()) {
      way.push_back(borders.begin()->first);
      place_of = {{way.front(), 0}};
    }
    const int to = takeBorder(borders, way.back());
    const auto [met, is_new] = place_of.emplace(to, way.size());
    if (is_new) {
      way.push_back(to);
      continue;
    }
    const auto begin = way.begin() + met->second;
    loops.emplace_back(begin, way.end());
    for (auto left = begin + 1; left != way.end(); ++left) place_of.erase(*left);
    way.erase(begin + 1, way.end());
    if (way.size() == 1) way.clear();
  }
  return loops;
}

double widthOf(const TriangleMesh& mesh, const std::vector<int>& loop) {
  Eigen::AlignedBox3d box;
  for (const int v : loop) box.extend(Vector3(mesh.vertices.col(v)));
  return box.diagonal().norm();
}

Vector3 middleOf(const TriangleMesh& mesh, const std::vector<int>& loop) {
  Vector3 sum = Vector3::Zero();
  for (const int v : loop) sum += mesh.vertices.col(v);
  return sum / static_cast<double>(loop.size());
}

void refuseOpen(const TriangleMesh& mesh, const std::vector<std::vector<int>>& loops, double allowed_m,
                const std::string& source) {
  std::size_t large = 0;
  const std::vector<int>* widest = nullptr;
  double widest_m = -1.0;
  for (const std::vector<int>& loop : loops) {
    const double width_m = widthOf(mesh, loop);
    if (width_m > allowed_m) ++large;
    if (!(width_m > widest_m)) continue;
    widest = &loop;
    widest_m = width_m;
  }
  if (large == 0) return;
  throw std::invalid_argument(source + ": it is open: " + counted(large, "hole") + ", the widest " +
                              millimetres(widest_m) + " across at " + placeText(middleOf(mesh, *widest)) +
                              "; holes up to three cells (" + millimetres(allowed_m) +
                              ") are closed, larger ones are yours to close (Blender: Fill; MeshLab: Close Holes), or "
                              "use the surface as it is as a `shell`");
}

void closeHoles(TriangleMesh& mesh, double cell_m, const std::string& source, std::vector<std::string>& notes) {
  const EdgeTable edges(mesh.triangles);
  requireManifold(mesh, edges, source);
  const std::vector<std::vector<int>> loops = borderLoops(edges);
  if (loops.empty()) return;
  refuseOpen(mesh, loops, kLargestHole * cell_m, source);
  double widest = 0.0;
  Eigen::Index centre = mesh.vertices.cols();
  mesh.vertices.conservativeResize(Eigen::NoChange, centre + static_cast<Eigen::Index>(loops.size()));
  for (const std::vector<int>& loop : loops) {
    widest = std::max(widest, widthOf(mesh, loop));
    mesh.vertices.col(centre) = middleOf(mesh, loop);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      mesh.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], static_cast<int>(centre)});
    }
    ++centre;
  }
  notes.push_back("closed " + counted(loops.size(), "hole") + ", up to " + millimetres(widest) + " across");
}

void turnOutward(TriangleMesh& mesh, const std::string& source) {
  orientOutward(mesh);
  const EdgeTable edges(mesh.triangles);
  for (const EdgeTable::Edge& edge : edges) {
    const EdgeTable::Uses uses = edges.usesOf(edge);
    if (uses.size() == 2 && uses[0].forward != uses[1].forward) continue;
    throw std::invalid_argument(source + ": its inside and outside run into each other at " +
                                placeText(mesh.vertices.col(edge.nodes[0])) +
                                " (one-sided like a Moebius strip); it cannot be filled: repair it");
  }
}

/// One body, with cavities perhaps. A cavity's triangles are to face into it.
void requireOneBody(TriangleMesh& mesh, const std::string& source, std::vector<std::string>& notes) {
  const std::vector<int> root = partsOf(mesh);
  const std::vector<Part> parts = listParts(mesh, root);
  if (parts.size() < 2) return;
  std::map<int, std::vector<Triangle>> triangles_of;  // parts, by their root
  for (const Triangle& t : mesh.triangles) triangles_of[root[t[0]]].push_back(t);
  const auto treeOf = [&](const Part& part) {
    std::map<int, int> own_place;
    TriangleMesh own{{}, triangles_of[part.root]};
    for (Triangle& t : own.triangles) {
      for (int& v : t) v = own_place.emplace(v, static_cast<int>(own_place.size())).first->second;
    }
    own.vertices.resize(3, static_cast<Eigen::Index>(own_place.size()));
    for (const auto& [v, place] : own_place) own.vertices.col(place) = mesh.vertices.col(v);
    return std::make_unique<WindingTree>(own);
  };
  const auto refuse = [&](const Part& part, const std::string& what) {
    const Crossings crossings = findCrossings(mesh);
    if (crossings.count > 0) throw std::invalid_argument(source + ": it cannot be filled: " + crossingText(crossings));
    throw std::invalid_argument(source + ": it has " + std::to_string(parts.size()) +
                                " separate parts, one of them around " + placeText(part.box.center()) + " and " +
                                millimetres(part.size()) + " across" + what +
                                "; a tissue is one body: save each part in a file of its own and make it a tissue");
  };
  std::vector<std::unique_ptr<WindingTree>> trees(parts.size());  // of those that others may lie in
  for (std::size_t p = 1; p < parts.size(); ++p) {
    const Vector3 place = mesh.vertices.col(parts[p].root);
    const auto isInside = [&](std::size_t other) {
      if (!parts[other].box.contains(place)) return false;
      if (trees[other] == nullptr) trees[other] = treeOf(parts[other]);
      return trees[other]->windingNumber(place) > 0.5;
    };
    if (!isInside(0)) refuse(parts[p], "");
    for (std::size_t cavity = 1; cavity < p; ++cavity) {
      if (isInside(cavity)) refuse(parts[p], ", loose in the cavity of another");
    }
  }
  for (Triangle& t : mesh.triangles) {
    if (root[t[0]] != parts.front().root) std::swap(t[1], t[2]);
  }
  notes.push_back("left " + counted(parts.size() - 1, "closed part") + " inside it hollow");
}

/// @param given triangles as they were in the file, which those of the mesh begin with.
void noteTurned(const std::vector<Triangle>& given, const TriangleMesh& mesh, std::vector<std::string>& notes) {
  std::size_t turned = 0;
  for (std::size_t t = 0; t < given.size(); ++t) turned += given[t] != mesh.triangles[t] ? 1 : 0;
  if (turned == given.size()) {
    notes.emplace_back("it was inside out: turned round");
  } else if (turned > 0) {
    notes.push_back("turned " + counted(turned, "triangle") + " that faced the wrong way");
  }
}

}  // namespace

double volumeInside(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0.0;
  const Vector3 apex = mesh.vertices.col(mesh.triangles.front()[0]);
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3 a = mesh.vertices.col(t[0]) - apex;
    const Vector3 b = mesh.vertices.col(t[1]) - apex;
    const Vector3 c = mesh.vertices.col(t[2]) - apex;
    sum += a.cross(b).dot(c) / 6.0;
  }
  return sum;
}

ClosedSurface closeSurface(TriangleMesh mesh, double cell_m, const std::string& source) {
  ClosedSurface closed;
  dropDuplicates(mesh, closed.notes);
  dropSmallParts(mesh, cell_m, closed.notes);
  const std::vector<Triangle> given = mesh.triangles;
  closeHoles(mesh, cell_m, source, closed.notes);
  turnOutward(mesh, source);
  requireOneBody(mesh, source, closed.notes);
  noteTurned(given, mesh, closed.notes);
  closed.volume = volumeInside(mesh);
  closed.mesh = std::move(mesh);
  return closed;
}

}  // namespace tissue_contact
