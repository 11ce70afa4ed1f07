#include "contact/shape/mesh_field.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "contact/shape/field_cache.h"
#include "contact/shape/grid_axes.h"
#include "contact/shape/sample_distance.h"
#include "contact/shape/surface_points.h"
#include "contact/shape/thin_parts.h"
#include "mesh/mesh_checks.h"
#include "mesh/nodes.h"
#include "mesh/surface/outer_surface.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

constexpr double kSamplesPerDeviationPoint = 50.0;

/// Triangles that have an area, and their vertices.
/// @throws std::invalid_argument when there is none or an index is out of range.
TriangleMesh usablePart(const TriangleMesh& mesh) {
  TriangleMesh usable{mesh.vertices, {}};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    checkNodeIndices(t, i, mesh.vertices.cols(), "triangle", "collision mesh");
    const bool is_flat =
        triangleNormal(mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2])).isZero(0.0);
    if (!is_flat) usable.triangles.push_back(t);
  }
  if (usable.triangles.empty()) throw std::invalid_argument("collision mesh: it has no triangle with an area > 0");
  dropUnusedNodes(usable.vertices, usable.triangles);  // they must not widen the grid
  return usable;
}

/// Vertices that are tips of the solid; a pit is none.
std::vector<MeshTip> tipsOf(const TriangleMesh& mesh, const DistanceGrid& grid, const Matrix3& R_SG) {
  constexpr double kNarrow = 0.866;  // cosine
  constexpr double kAside = 5.0;     // spacings along the axis: inside behind a tip, outside before it
  std::vector<MeshTip> ends(static_cast<std::size_t>(mesh.vertices.cols()));
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const int other : {t[(k + 1) % 3], t[(k + 2) % 3]}) {
        const Vector3 edge = mesh.vertices.col(other) - mesh.vertices.col(t[k]);
        if (edge.norm() > 0.0) ends[static_cast<std::size_t>(t[k])].edges.push_back(edge.normalized());
      }
    }
  }
  std::vector<MeshTip> tips;
  for (std::size_t v = 0; v < ends.size(); ++v) {
    MeshTip& tip = ends[v];
    Vector3 axis = Vector3::Zero();
    for (const Vector3& edge : tip.edges) axis += edge;
    const auto is_wide = [&](const Vector3& edge) { return !(edge.dot(axis) > kNarrow * axis.norm()); };
    if (tip.edges.size() < 6 || std::any_of(tip.edges.begin(), tip.edges.end(), is_wide)) continue;
    tip.p_S = mesh.vertices.col(static_cast<Eigen::Index>(v));
    const Vector3 aside = kAside * grid.spacing * axis.normalized();
    if (!(grid.at(tip.p_S + aside).distance < 0.0 && grid.at(tip.p_S - aside).distance > 0.0)) continue;
    if (!R_SG.isIdentity(0.0)) {
      tip.p_S = R_SG * tip.p_S;
      for (Vector3& edge : tip.edges) edge = R_SG * edge;
    }
    tips.push_back(tip);
  }
  return tips;
}

void requireInside(const DistanceGrid& grid, const std::string& name) {
  if (std::any_of(grid.samples.begin(), grid.samples.end(), [](float value) { return value < 0.0F; })) return;
  throw std::invalid_argument(
      "mesh '" + name +
      "' encloses nothing: it is an open sheet, or thinner than a hundredth of its length; a tool "
      "that touches tissue must be a closed solid");
}

void measureDeviation(const TriangleMesh& outer, double points, MeshField& field) {
  std::vector<std::pair<double, double>> found;  // deviation, share of the area
  double squares = 0.0;
  const ThinParts thin(outer, field.grid, points);
  eachPoint(outer, points, [&](const Vector3& p, double share, const Triangle&) {
    // Where nothing is left of a part, the distance is small all around the mesh, but not to what is left.
    const double deviation = std::max(std::abs(field.grid.at(p).distance), thin.lostAt(p));
    found.emplace_back(deviation, share);
    squares += deviation * deviation * share;
  });
  std::sort(found.begin(), found.end());
  double below = 0.0;
  for (const auto& [deviation, share] : found) {
    if (below <= 0.5) field.median_deviation = deviation;
    below += share;
  }
  field.largest_deviation = found.back().first;
  field.rms_deviation = std::sqrt(squares);
}

/// Says how far a long preparation has come.
class Progress {
 public:
  /// @param done behind the share: what that is.
  Progress(const std::string& name, const std::string& done, const MeshPreparation& preparation)
      : name_(name), done_(done), preparation_(preparation) {
    if (preparation.clock) last_ = preparation.clock();
  }
  void at(double share) {
    if (!preparation_.say || !preparation_.clock) return;
    const double now = preparation_.clock();
    if (now - last_ < 1.0) return;
    last_ = now;
    preparation_.say("mesh " + name_ + ": " + std::to_string(static_cast<int>(100.0 * share)) + " % " + done_);
  }

 private:
  const std::string& name_;
  const std::string done_;
  const MeshPreparation& preparation_;
  double last_ = 0.0;
};

void reportLeft(const std::string& name, const TriangleMesh& mesh, std::size_t left,
                const MeshPreparation& preparation) {
  if (left == 0 || !preparation.say) return;
  preparation.say("mesh " + name + ": it passes through itself all over; inner parts of the last " +
                  std::to_string(left) + " of its " + std::to_string(mesh.triangles.size()) +
                  " triangles count as its surface, so forces deep inside may be too small; unite its parts into one");
}

MeshField build(const TriangleMesh& mesh, const std::string& name, const MeshPreparation& preparation,
                double sample_count) {
  const GridPlan plan = planGrid(mesh, sample_count);
  const WindingTree all(mesh);
  Progress looked_at(name, "looked through for where it passes through itself", preparation);
  std::size_t left = 0;
  const TriangleMesh outer = outerSurface(
      mesh, all, GridPlan::kBlock * plan.spacing, [&](double share) { looked_at.at(share); }, &left);
  reportLeft(name, mesh, left, preparation);
  MeshField field;
  field.low = mesh.vertices.rowwise().minCoeff();
  field.high = mesh.vertices.rowwise().maxCoeff();
  if (outer.triangles.empty()) requireInside(field.grid, name);
  const TriangleTree outer_tree(outer.vertices, outer.triangles);
  Progress progress(name, "prepared", preparation);
  field.grid = sampleDistance(all, outer_tree, plan, [&](double share) { progress.at(share); });
  requireInside(field.grid, name);
  measureDeviation(outer, sample_count / kSamplesPerDeviationPoint, field);
  return field;
}

/// Across an opening of the mesh, wherever one is wider than the samples tell apart.
void reportJump(const std::string& name, const MeshField& field, const MeshPreparation& preparation) {
  const FieldJump jump = widestJump(field.grid);
  if (!preparation.say || !(jump.width_m > 0.0)) return;
  const Vector3 p_S = field.R_SG * jump.p_S;
  std::array<char, 384> text{};
  std::snprintf(
      text.data(), text.size(),
      ": not closed: at (%.4g, %.4g, %.4g) m of its frame, scaled, is an opening about %.3g mm wide, the widest if "
      "there are more; inside and outside meet there and the distance jumps, so tissue that gets there is pushed "
      "suddenly and to a side of the opening; fill it in the mesh, or use a closed mesh or a box, cylinder or sphere",
      p_S.x(), p_S.y(), p_S.z(), 1e3 * jump.width_m);
  preparation.say("mesh " + name + text.data());
}

/// Tissue goes through walls that the samples do not hold, without a force.
void reportThin(const std::string& name, const TriangleMesh& mesh, const MeshField& field,
                const MeshPreparation& preparation) {
  constexpr double kMuch = 0.2;  // edges of blades and small parts make some per cent
  constexpr double kPoints = 20000.0;
  const ThinParts thin(mesh, field.grid, kPoints);
  const ThinParts::Part part = thin.largest(mesh);
  if (!(thin.share() > kMuch) && !(part.share > 0.0)) return;
  std::array<char, 192> where{};
  const Vector3 p_S = field.R_SG * part.p_S;
  if (part.share > 0.0) {
    std::snprintf(where.data(), where.size(), " (%.2g %% together, around (%.4g, %.4g, %.4g) m of its frame, scaled",
                  100.0 * part.share, p_S.x(), p_S.y(), p_S.z());
    const std::size_t written = std::strlen(where.data());
    const bool has_back = std::isfinite(part.thickness_m);  // open meshes may have none
    std::snprintf(where.data() + written, where.size() - written, has_back ? ", where it is %.3g mm thick)" : ")",
                  1e3 * part.thickness_m);
  }
  std::array<char, 640> text{};
  std::snprintf(
      text.data(), text.size(),
      ": behind %.2g %% of its surface%s is less than about %.3g mm of it, one spacing of the grid: tissue goes "
      "through walls as thin as that, with too little force or none; make them thicker in the mesh, or give them "
      "as shapes of their own: boxes, cylinders or shorter meshes, whose grids are finer",
      100.0 * thin.share(), where.data(), 1e3 * field.grid.spacing);
  preparation.say("mesh " + name + text.data());
}

void report(const std::string& name, std::size_t triangles, const TriangleMesh& mesh, const MeshField& field,
            const std::string& origin, const MeshPreparation& preparation) {
  if (!preparation.say) return;
  std::array<char, 256> text{};
  const DistanceGrid& grid = field.grid;
  std::snprintf(text.data(), text.size(),
                ": %zu triangles, grid %d x %d x %d of %.3g mm, which rounds edges; off the mesh by %.3g mm at most, "
                "%.3g mm rms, half of it less than %.2g mm; ",
                triangles, grid.size[0], grid.size[1], grid.size[2], 1e3 * grid.spacing, 1e3 * field.largest_deviation,
                1e3 * field.rms_deviation, 1e3 * field.median_deviation);
  preparation.say("mesh " + name + text.data() + origin);
  reportJump(name, field, preparation);
  reportThin(name, mesh, field, preparation);
  constexpr double kLargeTool = 2.0;   // m
  constexpr double kSmallTool = 1e-3;  // m
  const double extent = (field.high - field.low).maxCoeff();
  if (extent < kLargeTool && extent > kSmallTool) return;
  std::snprintf(text.data(), text.size(), ": it is %.3g m long; %s", extent,
                extent > kSmallTool ? "is it in millimetres? then give it scale 0.001"
                                    : "is it in metres already? then give it scale 1");
  preparation.say("mesh " + name + text.data());
}

}  // namespace

std::shared_ptr<const MeshField> prepareMeshField(const TriangleMesh& original, const std::string& name,
                                                  MeshPreparation& preparation, double sample_count) {
  TriangleMesh mesh = usablePart(original);
  const Matrix3 R_SG = gridAxes(mesh);
  const bool is_turned = !R_SG.isIdentity(0.0);
  if (is_turned) mesh.vertices = NodalVectors(R_SG.transpose() * mesh.vertices);
  const std::string key = fieldKey(mesh, sample_count);
  auto field = std::make_shared<MeshField>();
  if (readField(preparation.cache_directory, key, *field)) {
    if (is_turned) field->R_SG = R_SG;
    field->tips = tipsOf(mesh, field->grid, R_SG);
    report(name, original.triangles.size(), mesh, *field, "from the cache", preparation);
    return field;
  }
  const double start = preparation.clock ? preparation.clock() : 0.0;
  *field = build(mesh, name, preparation, sample_count);
  if (is_turned) field->R_SG = R_SG;
  field->tips = tipsOf(mesh, field->grid, R_SG);
  std::array<char, 64> took{"built"};
  if (preparation.clock) std::snprintf(took.data(), took.size(), "built in %.1f s", preparation.clock() - start);
  const std::string trouble = writeField(preparation.cache_directory, key, *field);
  report(name, original.triangles.size(), mesh, *field, took.data(), preparation);
  if (!trouble.empty()) {
    if (preparation.say) preparation.say("meshes are prepared again at every start: " + trouble);
    preparation.cache_directory.clear();
  }
  return field;
}

}  // namespace tissue_contact
