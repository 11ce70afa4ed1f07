#include "ros/publish/scene_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "mesh/edge_table.h"
#include "ros/conversions.h"

namespace tissue_contact {
namespace {

using visualization_msgs::Marker;

const char* const kForceNamespace = "contact_forces";

std_msgs::ColorRGBA color(float r, float g, float b, float a = 1.0F) {
  std_msgs::ColorRGBA rgba;
  rgba.r = r;
  rgba.g = g;
  rgba.b = b;
  rgba.a = a;
  return rgba;
}

geometry_msgs::Vector3 scale(double x, double y, double z) { return toVector(Vector3(x, y, z)); }

void setTriangles(const TriangleMesh& mesh, Marker& marker) {
  marker.type = Marker::TRIANGLE_LIST;
  marker.scale = scale(1.0, 1.0, 1.0);
  for (const Triangle& triangle : mesh.triangles) {
    for (const int vertex : triangle) marker.points.push_back(toPoint(mesh.vertices.col(vertex)));
  }
}

/// Type and size of a shape. `mesh` is the surface it acts with if it is a mesh that touches; else RViz reads the file itself.
void setGeometry(const ShapeGeometry& geometry, const TriangleMesh* mesh, Marker& marker) {
  if (const auto* sphere = std::get_if<SphereGeometry>(&geometry)) {
    marker.type = Marker::SPHERE;
    marker.scale = scale(2.0 * sphere->radius_m, 2.0 * sphere->radius_m, 2.0 * sphere->radius_m);
  } else if (const auto* box = std::get_if<BoxGeometry>(&geometry)) {
    marker.type = Marker::CUBE;
    marker.scale = toVector(box->size_m);
  } else if (const auto* cylinder = std::get_if<CylinderGeometry>(&geometry)) {
    marker.type = Marker::CYLINDER;
    marker.scale = scale(2.0 * cylinder->radius_m, 2.0 * cylinder->radius_m, cylinder->length_m);
  } else if (mesh != nullptr) {
    setTriangles(*mesh, marker);
  } else {
    const auto& file = std::get<MeshGeometry>(geometry);
    marker.type = Marker::MESH_RESOURCE;
    marker.mesh_resource = "file://" + file.file;
    marker.scale = toVector(file.scale);
  }
}

/// Outward normals of the surface nodes, weighted by area (not unit); 0 for inner nodes.
void sumNormals(const std::vector<Triangle>& triangles, const NodalVectors& x, NodalVectors& normals) {
  normals.setZero();
  for (const Triangle& t : triangles) {
    const Vector3 normal = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0]));
    for (const int node : t) normals.col(node) += normal;
  }
}

/// RViz does not light coloured triangles, and a dent without shading is not seen as one. Lit alike from two opposite
/// sides, since z may point up or down in the world frame.
void shade(const Vector3& normal, std_msgs::ColorRGBA& rgba) {
  const Vector3 light = Vector3(0.35, -0.45, 0.82).normalized();
  const double length = normal.norm();
  const double facing = length > 0.0 ? std::abs(normal.dot(light)) / length : 1.0;
  const auto factor = static_cast<float>(0.6 + 0.4 * facing);
  rgba.r *= factor;
  rgba.g *= factor;
  rgba.b *= factor;
}

}  // namespace

std_msgs::ColorRGBA displacementColor(double fraction) {
  static constexpr std::array<std::array<double, 3>, 6> kColors = {{{0.95, 0.84, 0.77},
                                                                    {0.95, 0.66, 0.48},
                                                                    {0.89, 0.38, 0.30},
                                                                    {0.68, 0.16, 0.35},
                                                                    {0.38, 0.09, 0.36},
                                                                    {0.12, 0.05, 0.22}}};
  const double position = (fraction > 0.0 ? std::min(fraction, 1.0) : 0.0) * (kColors.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(position), kColors.size() - 2);
  const double part = position - static_cast<double>(low);
  const auto mix = [&](std::size_t c) {
    return static_cast<float>(kColors[low][c] + part * (kColors[low + 1][c] - kColors[low][c]));
  };
  return color(mix(0), mix(1), mix(2));
}

SceneMarkers::SceneMarkers(const Simulator& simulator, const MarkerStyle& style, bool is_shown)
    : simulator_(simulator),
      style_(style),
      laid_out_(simulator.scene().tissues.size(), -1),
      edges_(laid_out_.size()),
      normals_(laid_out_.size()) {
  addTissues();
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) addInstrument(static_cast<int>(i), is_shown);
  first_arrow_ = message_.markers.size();
}

void SceneMarkers::addTissues() {
  for (const TissueDescription& tissue : simulator_.scene().tissues) {
    Marker marker;
    marker.header.frame_id = simulator_.scene().world_frame;
    marker.ns = tissue.name;
    marker.type = Marker::TRIANGLE_LIST;
    marker.pose.orientation.w = 1.0;
    marker.scale = scale(1.0, 1.0, 1.0);
    marker.color = color(1.0F, 1.0F, 1.0F);
    message_.markers.push_back(marker);
  }
  for (const TissueDescription& tissue : simulator_.scene().tissues) {
    Marker marker;
    marker.header.frame_id = simulator_.scene().world_frame;
    marker.ns = tissue.name;
    marker.id = 1;
    marker.type = Marker::LINE_LIST;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = 0.00015;  // m: thin beside elements of some millimetres
    marker.color = color(0.25F, 0.1F, 0.1F, 0.5F);
    message_.markers.push_back(marker);
  }
}

/// Links that touch tissue are drawn as the shapes that touch, meshes with the edges they act with; the others as the URDF draws them, paler.
void SceneMarkers::addInstrument(int instrument, bool is_shown) {
  const Instrument& tool = simulator_.instruments()[static_cast<std::size_t>(instrument)];
  std::set<int> touching;
  for (std::size_t c = 0; c < tool.contactLinks().size(); ++c) {
    const ContactLink& link = tool.contactLinks()[c];
    touching.insert(link.link);
    for (std::size_t s = 0; s < link.shapes.size(); ++s) {
      const TriangleMesh* surface =
          is_shown ? simulator_.actingSurface(instrument, static_cast<int>(c), static_cast<int>(s)) : nullptr;
      addShape(instrument, link.link, {link.shapes[s].geometry, link.shapes[s].X_LS}, surface, true);
    }
  }
  for (std::size_t l = 0; l < tool.model().links().size(); ++l) {
    if (touching.count(static_cast<int>(l)) > 0) continue;
    const LinkGeometry& geometry = tool.model().links()[l].geometry;
    for (const ShapeDescription& shape : geometry.visual.empty() ? geometry.collision : geometry.visual) {
      addShape(instrument, static_cast<int>(l), shape, nullptr, false);
    }
  }
}

void SceneMarkers::addShape(int instrument, int link, const ShapeDescription& shape, const TriangleMesh* mesh,
                            bool touches) {
  Marker marker;
  marker.header.frame_id = simulator_.scene().world_frame;
  marker.ns = simulator_.instruments()[static_cast<std::size_t>(instrument)].name();
  marker.id = static_cast<int>(shapes_.size());
  marker.color = touches ? color(0.75F, 0.78F, 0.82F, 0.8F) : color(0.6F, 0.6F, 0.62F, 0.4F);
  setGeometry(shape.geometry, mesh, marker);
  shapes_.push_back({message_.markers.size(), instrument, link, shape.X_LS});
  message_.markers.push_back(marker);
}

const visualization_msgs::MarkerArray& SceneMarkers::update(const SceneSnapshot& snapshot) {
  for (std::size_t t = 0; t < laid_out_.size(); ++t) {
    const MeshRevision& mesh = *snapshot.revisions[t];
    if (mesh.revision != laid_out_[t]) layOut(t, mesh);
    updateTissue(t, mesh, snapshot.positions[t]);
  }
  for (const ShapeMarker& shape : shapes_) {
    const Pose& X_WL =
        snapshot.link_poses[static_cast<std::size_t>(shape.instrument)][static_cast<std::size_t>(shape.link)];
    message_.markers[shape.marker].pose = toPose(X_WL * shape.X_LS);
  }
  updateForces(snapshot.contacts);
  for (Marker& marker : message_.markers) marker.header.stamp = toTime(snapshot.stamp_ns);
  return message_;
}

void SceneMarkers::layOut(std::size_t tissue, const MeshRevision& mesh) {
  std::vector<std::array<int, 2>>& edges = edges_[tissue];
  edges.clear();
  for (const EdgeTable::Edge& edge : EdgeTable(mesh.surface)) edges.push_back(edge.nodes);
  normals_[tissue].resize(3, mesh.nodeCount());
  Marker& triangles = message_.markers[tissue];
  triangles.points.resize(3 * mesh.surface.size());
  triangles.colors.resize(triangles.points.size());
  message_.markers[laid_out_.size() + tissue].points.resize(2 * edges.size());
  laid_out_[tissue] = mesh.revision;
}

void SceneMarkers::updateTissue(std::size_t tissue, const MeshRevision& mesh, const NodalVectors& x) {
  NodalVectors& normals = normals_[tissue];
  sumNormals(mesh.surface, x, normals);
  Marker& marker = message_.markers[tissue];
  std::size_t corner = 0;
  for (const Triangle& triangle : mesh.surface) {
    for (const int node : triangle) {
      const double displacement = (x.col(node) - mesh.rest_positions.col(node)).norm();
      marker.points[corner] = toPoint(x.col(node));
      marker.colors[corner] = displacementColor(displacement / style_.displacement_full_scale_m);
      shade(normals.col(node), marker.colors[corner++]);
    }
  }
  Marker& lines = message_.markers[laid_out_.size() + tissue];
  std::size_t end = 0;
  for (const std::array<int, 2>& edge : edges_[tissue]) {
    for (const int node : edge) lines.points[end++] = toPoint(x.col(node));
  }
}

/// Arrows that are no longer needed are sent once more as deletions, then forgotten.
void SceneMarkers::updateForces(const std::vector<SolvedContact>& contacts) {
  std::vector<Marker>& markers = message_.markers;
  while (markers.size() > first_arrow_ && markers.back().action == Marker::DELETE) markers.pop_back();
  std::size_t used = first_arrow_;
  for (const SolvedContact& contact : contacts) {
    if (contact.state == ContactState::kOpen || !(contact.force_on_tissue_n.norm() > 0.0)) continue;
    setArrow(used++, contact);
  }
  for (std::size_t i = used; i < markers.size(); ++i) markers[i].action = Marker::DELETE;
}

void SceneMarkers::setArrow(std::size_t index, const SolvedContact& contact) {
  if (index == message_.markers.size()) {
    Marker marker;
    marker.header.frame_id = simulator_.scene().world_frame;
    marker.ns = kForceNamespace;
    marker.id = static_cast<int>(index - first_arrow_);
    marker.type = Marker::ARROW;
    marker.pose.orientation.w = 1.0;
    marker.scale = scale(0.001, 0.0025, 0.004);  // shaft and head diameter, head length: thin beside a tool of 8 mm
    marker.points.resize(2);
    message_.markers.push_back(marker);
  }
  Marker& marker = message_.markers[index];
  marker.action = Marker::ADD;
  marker.color = contact.state == ContactState::kStatic ? color(0.1F, 0.45F, 0.95F) : color(0.9F, 0.15F, 0.1F);
  // On the instrument, so that the head stands out of the tissue.
  const Vector3& start = contact.contact.p_WC;
  marker.points[0] = toPoint(start);
  marker.points[1] = toPoint(start - style_.force_arrow_m_per_n * contact.force_on_tissue_n);
}

}  // namespace tissue_contact
