#include "ros/publish/scene_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "mesh/edge_table.h"
#include "ros/conversions.h"
#include "simulation/nodal_fields.h"
#include "tissue_contact/core/resolve_path.h"

namespace tissue_contact {
namespace {

using visualization_msgs::Marker;

const char* const kForceNamespace = "contact_forces";
const char* const kForceTexts = "force_texts";
const char* const kTipOf = "/tip";  // behind an instrument's name, which has no slash

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
    // A path that could not be resolved here stands as it was written, and RViz's machine may know its package.
    marker.mesh_resource = file.file.rfind('/', 0) == 0 ? fileUri(file.file) : file.file;
    marker.scale = toVector(file.scale);
  }
}

/// Half the width of a shape, m: the middle one of its half extents, so that a rod is as wide as it is thick.
double halfWidth(const ShapeGeometry& geometry, const TriangleMesh* mesh) {
  if (const auto* sphere = std::get_if<SphereGeometry>(&geometry)) return sphere->radius_m;
  if (const auto* cylinder = std::get_if<CylinderGeometry>(&geometry)) return cylinder->radius_m;
  Vector3 extent = Vector3::Zero();
  if (const auto* box = std::get_if<BoxGeometry>(&geometry)) {
    extent = box->size_m;
  } else if (mesh != nullptr) {
    extent = mesh->vertices.rowwise().maxCoeff() - mesh->vertices.rowwise().minCoeff();
  }
  std::sort(extent.data(), extent.data() + 3);
  return 0.5 * extent[1];
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

/// Full scale starts with little for the scene, so that most of what follows is seen, and enough that touching does not paint all of it.
/// It ends where nothing is believed any more, or where a free body is on its way.
FullScale colorScale(const Simulator& simulator, const PictureFrame& frame, const MarkerStyle& style) {
  const double given = style.color_full_scale;
  if (style.color == SurfaceColor::kDisplacement) return {given, 0.02 * frame.size(), frame.size()};
  if (style.color == SurfaceColor::kStrain) return {given, 0.2, 1.0};
  double modulus_pa = 1e12;
  for (const TissueDescription& tissue : simulator.scene().tissues) {
    modulus_pa = std::min(modulus_pa, tissue.material.youngs_modulus_pa);
  }
  return {given, 0.1 * modulus_pa, 10.0 * modulus_pa};
}

/// Of the thinnest shape that moves, m; infinity: there is none.
double thinnestTool(const Simulator& simulator) {
  double thinnest_m = std::numeric_limits<double>::infinity();
  for (const Instrument& instrument : simulator.instruments()) {
    if (instrument.isObstacle()) continue;
    for (const ContactLink& link : instrument.contactLinks()) {
      for (const CollisionShape& shape : link.shapes) {
        const double half_extent_m = smallestHalfExtent(shape);
        if (half_extent_m > 0.0) thinnest_m = std::min(thinnest_m, half_extent_m);
      }
    }
  }
  return thinnest_m;
}

/// The force of one contact that the longest arrow starts with, N: that of a touch. It is E r^2 / 10 with the tool's half extent r, and
/// no more than E L d / 300 with the tissue's extents L >= d.
double firstForceScale(const Simulator& simulator) {
  const double tool_m = thinnestTool(simulator);
  double force_n = 1e12;
  for (std::size_t t = 0; t < simulator.tissues().size(); ++t) {
    const Tissue& tissue = simulator.tissues()[t];
    const NodalVectors& rest = tissue.restPositions();
    const Vector3 extent = rest.rowwise().maxCoeff() - rest.rowwise().minCoeff();
    const double thickness_m = std::max(extent.minCoeff(), tissue.thickness());
    const double area_m2 = std::min(0.003 * extent.norm() * thickness_m, 0.1 * tool_m * tool_m);
    force_n = std::min(force_n, simulator.scene().tissues[t].material.youngs_modulus_pa * area_m2);
  }
  return force_n;
}

}  // namespace

SceneMarkers::SceneMarkers(const Simulator& simulator, const MarkerStyle& style, bool is_shown)
    : simulator_(simulator),
      style_(style),
      frame_(pictureFrame(simulator)),
      color_scale_(colorScale(simulator, frame_, style)),
      force_scale_(0.0, firstForceScale(simulator), 1e12),
      laid_out_(simulator.scene().tissues.size(), -1),
      edges_(laid_out_.size()),
      areas_(laid_out_.size()),
      values_(laid_out_.size()),
      half_widths_(simulator.instruments().size(), 0.0) {
  addTissues();
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) addInstrument(static_cast<int>(i), is_shown);
  addForceTexts();
  addTips();
  legend_.emplace(simulator, frame_, style.color, message_.markers);
  first_arrow_ = message_.markers.size();
}

void SceneMarkers::addTissues() {
  for (const TissueDescription& tissue : simulator_.scene().tissues) {
    Marker& marker = message_.markers.emplace_back(newMarker(simulator_, tissue.name, 0, Marker::TRIANGLE_LIST));
    marker.scale = scale(1.0, 1.0, 1.0);
    marker.color = rgba(1.0F, 1.0F, 1.0F);
  }
  for (const TissueDescription& tissue : simulator_.scene().tissues) {
    Marker& marker = message_.markers.emplace_back(newMarker(simulator_, tissue.name, 1, Marker::LINE_LIST));
    marker.scale.x = frame_.size() / 700.0;  // about a pixel of a window that shows all
    marker.color = rgba(0.25F, 0.1F, 0.1F, 0.5F);
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
      double& widest = half_widths_[static_cast<std::size_t>(instrument)];
      widest = std::max(widest, halfWidth(link.shapes[s].geometry, surface));
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
  Marker marker = newMarker(simulator_, simulator_.instruments()[static_cast<std::size_t>(instrument)].name(),
                            static_cast<int>(shapes_.size()), Marker::TRIANGLE_LIST);
  marker.color = touches ? rgba(0.75F, 0.78F, 0.82F, 0.55F) : rgba(0.6F, 0.6F, 0.62F, 0.4F);
  setGeometry(shape.geometry, mesh, marker);
  shapes_.push_back({message_.markers.size(), instrument, link, shape.X_LS});
  message_.markers.push_back(marker);
}

void SceneMarkers::addForceTexts() {
  first_text_ = message_.markers.size();
  for (std::size_t i = 0; i < simulator_.instruments().size(); ++i) {
    message_.markers.push_back(newMarker(simulator_, kForceTexts, static_cast<int>(i), Marker::TEXT_VIEW_FACING));
    message_.markers.back().scale.z = 1.2 * frame_.letter();
  }
}

void SceneMarkers::addTips() {
  first_tip_ = message_.markers.size();
  for (const Instrument& instrument : simulator_.instruments()) {
    Marker& marker =
        message_.markers.emplace_back(newMarker(simulator_, instrument.name() + kTipOf, 0, Marker::SPHERE));
    const double diameter_m = 0.3 * frame_.letter();
    marker.scale = scale(diameter_m, diameter_m, diameter_m);
    marker.color = wordColor();
  }
}

const visualization_msgs::MarkerArray& SceneMarkers::update(const SceneSnapshot& snapshot) {
  for (std::size_t t = 0; t < laid_out_.size(); ++t) {
    const MeshRevision& mesh = *snapshot.revisions[t];
    if (mesh.revision != laid_out_[t]) layOut(t, mesh);
    findColors(t, mesh, snapshot);
  }
  for (std::size_t t = 0; t < laid_out_.size(); ++t) updateTissue(t, *snapshot.revisions[t], snapshot.positions[t]);
  for (const ShapeMarker& shape : shapes_) {
    const Pose& X_WL =
        snapshot.link_poses[static_cast<std::size_t>(shape.instrument)][static_cast<std::size_t>(shape.link)];
    message_.markers[shape.marker].pose = toPose(X_WL * shape.X_LS);
  }
  updateForces(snapshot.contacts);
  updateForceTexts(snapshot);
  legend_->update(color_scale_.value(), arrowPerNewton(), message_.markers);
  for (Marker& marker : message_.markers) marker.header.stamp = toTime(snapshot.stamp_ns);
  return message_;
}

void SceneMarkers::layOut(std::size_t tissue, const MeshRevision& mesh) {
  std::vector<std::array<int, 2>>& edges = edges_[tissue];
  edges.clear();
  for (const EdgeTable::Edge& edge : EdgeTable(mesh.surface)) edges.push_back(edge.nodes);
  Marker& triangles = message_.markers[tissue];
  triangles.points.resize(3 * mesh.surface.size());
  triangles.colors.resize(triangles.points.size());
  message_.markers[laid_out_.size() + tissue].points.resize(2 * edges.size());
  laid_out_[tissue] = mesh.revision;
}

/// And lets the scale grow with them.
void SceneMarkers::findColors(std::size_t tissue, const MeshRevision& mesh, const SceneSnapshot& snapshot) {
  const NodalVectors& x = snapshot.positions[tissue];
  VectorX& values = values_[tissue];
  nodalAreas(mesh.surface, x, areas_[tissue]);
  if (style_.color == SurfaceColor::kDisplacement) {
    values = (x - mesh.rest_positions).colwise().norm();
  } else if (style_.color == SurfaceColor::kPressure) {
    nodalPressure(snapshot.contacts, static_cast<int>(tissue), areas_[tissue], mesh.tetrahedra.empty(), values);
  } else {
    nodalStrain(mesh.tetrahedra, mesh.surface, mesh.rest_positions, x, values);
  }
  for (const Triangle& triangle : mesh.surface) {
    for (const int node : triangle) color_scale_.take(values[node]);
  }
}

void SceneMarkers::updateTissue(std::size_t tissue, const MeshRevision& mesh, const NodalVectors& x) {
  Marker& marker = message_.markers[tissue];
  std::size_t corner = 0;
  for (const Triangle& triangle : mesh.surface) {
    for (const int node : triangle) {
      marker.points[corner] = toPoint(x.col(node));
      marker.colors[corner] = scaleColor(values_[tissue][node] / color_scale_.value());
      shade(areas_[tissue].col(node), marker.colors[corner++]);
    }
  }
  Marker& lines = message_.markers[laid_out_.size() + tissue];
  std::size_t end = 0;
  for (const std::array<int, 2>& edge : edges_[tissue]) {
    for (const int node : edge) lines.points[end++] = toPoint(x.col(node));
  }
}

/// And the tips they are of. With the name where there are several, in the colour of what bears most of it.
void SceneMarkers::updateForceTexts(const SceneSnapshot& snapshot) {
  const std::vector<Instrument>& instruments = simulator_.instruments();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    Vector3 force_n = Vector3::Zero();
    double held_n = 0.0;
    double slides_n = 0.0;
    for (const SolvedContact& contact : snapshot.contacts) {
      if (contact.contact.key.instrument != static_cast<int>(i) || contact.state == ContactState::kOpen) continue;
      force_n -= contact.force_on_tissue_n;
      (contact.state == ContactState::kStatic ? held_n : slides_n) += contact.force_on_tissue_n.norm();
    }
    Marker& marker = message_.markers[first_text_ + i];
    marker.text = (instruments.size() > 1 ? instruments[i].name() + " " : "") + forceText(force_n.norm());
    marker.color = slides_n > held_n ? kineticColor() : held_n > 0.0 ? staticColor() : wordColor();
    const Vector3 tip = snapshot.link_poses[i][static_cast<std::size_t>(instruments[i].tipLink())].translation();
    const Vector3 half_text = 1.2 * frame_.halfWidth(marker.text);
    const Vector3 place = textPlace(tip, half_widths_[i]) + half_text;
    marker.pose.position = toPoint(place + riseAbove(snapshot.positions, place, half_text.norm()) * frame_.upwards());
    message_.markers[first_tip_ + i].pose.position = toPoint(tip);
  }
}

/// Beside an instrument, where neither it nor arrows are as a rule, though not far from its tip however wide it is.
Vector3 SceneMarkers::textPlace(const Vector3& tip, double half_width_m) const {
  const double aside = frame_.letter() + std::min(half_width_m, 6.0 * frame_.letter());
  return tip + aside * frame_.rightwards() + 3.0 * frame_.letter() * frame_.upwards();
}

/// How far a text here has to rise, m, for tissue not to hide it from anyone who looks down steeply enough, as in open_rviz.py's views.
double SceneMarkers::riseAbove(const std::vector<NodalVectors>& tissues, const Vector3& text,
                               double half_width_m) const {
  constexpr double kSlope = 0.48;  // tan of the views' pitch
  double rise_m = 0.0;
  for (const NodalVectors& nodes : tissues) {
    for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
      const Vector3 to_node = nodes.col(i) - text;
      const double aside_m = std::max(0.0, to_node.head<2>().norm() - half_width_m);
      rise_m = std::max(rise_m, frame_.up * to_node.z() + frame_.letter() - kSlope * aside_m);
    }
  }
  return rise_m;
}

/// Arrows that are no longer needed are sent once more as deletions, then forgotten.
void SceneMarkers::updateForces(const std::vector<SolvedContact>& contacts) {
  std::vector<Marker>& markers = message_.markers;
  while (markers.size() > first_arrow_ && markers.back().action == Marker::DELETE) markers.pop_back();
  for (const SolvedContact& contact : contacts) force_scale_.take(contact.force_on_tissue_n.norm());
  std::size_t used = first_arrow_;
  for (const SolvedContact& contact : contacts) {
    if (contact.state == ContactState::kOpen || !(contact.force_on_tissue_n.norm() > 0.0)) continue;
    setArrow(used++, contact);
  }
  for (std::size_t i = used; i < markers.size(); ++i) markers[i].action = Marker::DELETE;
}

double SceneMarkers::arrowPerNewton() const {
  if (style_.force_arrow_m_per_n > 0.0) return style_.force_arrow_m_per_n;
  return frame_.longestArrow() / force_scale_.value();
}

void SceneMarkers::setArrow(std::size_t index, const SolvedContact& contact) {
  if (index == message_.markers.size()) {
    Marker marker = newMarker(simulator_, kForceNamespace, static_cast<int>(index - first_arrow_), Marker::ARROW);
    const double longest = frame_.longestArrow();
    marker.scale = scale(longest / 30.0, longest / 12.0, longest / 8.0);  // shaft and head diameter, head length
    marker.points.resize(2);
    message_.markers.push_back(marker);
  }
  Marker& marker = message_.markers[index];
  marker.action = Marker::ADD;
  marker.color = contact.state == ContactState::kStatic ? staticColor() : kineticColor();
  // On the instrument, so that the head stands out of the tissue.
  const Vector3& start = contact.contact.p_WC;
  marker.points[0] = toPoint(start);
  marker.points[1] = toPoint(start - arrowPerNewton() * contact.force_on_tissue_n);
}

}  // namespace tissue_contact
