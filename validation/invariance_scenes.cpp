#include "validation/invariance_scenes.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace {

/// Base, slides along x, y, z and turns about z; no limits to speak of, since limits have units.
std::string carrierUrdf() {
  std::string urdf =
      "<robot name='carrier'><link name='base'/><link name='x'/><link name='y'/><link name='z'/>"
      "<link name='tip'/>";
  const std::string links[5] = {"base", "x", "y", "z", "tip"};
  const std::string axes[4] = {"1 0 0", "0 1 0", "0 0 1", "0 0 1"};
  for (int i = 0; i < 4; ++i) {
    urdf += "<joint name='joint_" + links[i + 1] + "' type='" + (i < 3 ? "prismatic" : "revolute") +
            "'><parent link='" + links[i] + "'/><child link='" + links[i + 1] + "'/><axis xyz='" + axes[i] +
            "'/><limit lower='-1e6' upper='1e6' effort='1' velocity='1'/></joint>";
  }
  return urdf + "</robot>";
}

InstrumentDescription makeTool(const std::string& name, const Vector3& position, const ShapeDescription& shape) {
  InstrumentDescription tool;
  tool.name = name;
  tool.robot_description_parameter = "carrier";
  tool.base_pose.X.translation() = position;
  tool.joint_state_topics = {{"/" + name}};
  tool.tip_link = "tip";
  tool.contact_links = {{"tip", {shape}}};
  return tool;
}

FrictionDescription makeFriction(const std::string& tool, const std::string& tissue, double mu_static,
                                 double mu_kinetic) {
  FrictionDescription friction;
  friction.instrument = tool;
  friction.tissue = tissue;
  friction.law.static_coefficients = {mu_static};
  friction.law.kinetic_coefficients = {mu_kinetic};
  return friction;
}

/// 40 x 40 x 20 mm, bottom fixed.
TissueDescription makeSoftBlock(ElasticModel model) {
  TissueDescription block;
  block.name = "block";
  BlockDescription geometry;
  geometry.size_m = Vector3(0.04, 0.04, 0.02);
  geometry.cells = {7, 7, 4};
  block.geometry = geometry;
  block.material = {model, 5e3, 0.4, 1000.0};
  block.damping = {1.0, 0.004};
  block.fixed = {PlaneRegion{}};
  return block;
}

Scene makeScene(TissueDescription block) {
  Scene scene;
  scene.gravity_m_per_s2 = Vector3(0.0, 0.0, -9.81);
  scene.tissues = {std::move(block)};
  return scene;
}

/// Indices of `list` in the order of the names.
template <typename T>
std::vector<int> byName(const std::vector<T>& list) {
  std::vector<int> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return list[a].name() < list[b].name(); });
  return order;
}

double relative(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff() / a.colwise().norm().maxCoeff();
}

}  // namespace

Scene twoToolsScene(ElasticModel model) {
  Scene scene = makeScene(makeSoftBlock(model));
  ShapeDescription ball{SphereGeometry{0.005}, Pose::Identity()};
  ShapeDescription stick{CylinderGeometry{0.002, 0.012}, Pose::Identity()};
  stick.X_LS.linear() = Eigen::AngleAxisd(1.3, Vector3(1.0, 0.2, 0.0).normalized()).toRotationMatrix();
  scene.instruments = {makeTool("ball", Vector3(-0.0087, 0.0012, 0.025), ball),
                       makeTool("stick", Vector3(0.0113, -0.0021, 0.024), stick)};
  scene.friction = {makeFriction("ball", "block", 0.5, 0.3), makeFriction("stick", "block", 0.4, 0.4)};
  return scene;
}

Scene sharpToolsScene(const std::string& stl_file) {
  Scene scene = makeScene(makeSoftBlock(ElasticModel::kNeoHookean));
  // By element: over what is averaged an edge snaps from one vertex to the next, at a step that round-off decides (doc/notes/method.md).
  scene.tissues[0].material.dilatation = Dilatation::kElement;
  TissueRegion core;
  core.name = "core";
  core.where = {SphereRegion{Vector3(0.005, 0.0, 0.01), 0.009}};
  core.material = scene.tissues[0].material;
  core.material.youngs_modulus_pa *= 10.0;
  core.damping_stiffness_s = 0.002;
  scene.tissues[0].regions = {core};
  ShapeDescription box{BoxGeometry{Vector3(0.01, 0.006, 0.004)}, Pose::Identity()};
  box.X_LS.linear() = Eigen::AngleAxisd(0.4, Vector3(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
  ShapeDescription tetrahedron{MeshGeometry{stl_file, Vector3::Ones()}, Pose::Identity()};
  scene.instruments = {makeTool("box", Vector3(-0.0087, 0.0012, 0.0245), box),
                       makeTool("tetrahedron", Vector3(0.0103, -0.0021, 0.0242), tetrahedron)};
  scene.friction = {makeFriction("box", "block", 0.6, 0.4), makeFriction("tetrahedron", "block", 0.3, 0.3)};
  return scene;
}

Scene sheetOnBlockScene() {
  Scene scene = makeScene(makeSoftBlock(ElasticModel::kMassSpring));
  TissueDescription sheet;
  sheet.name = "sheet";
  sheet.geometry = SheetDescription{Vector2(0.03, 0.03), {7, 7}, 0.001};
  sheet.pose.X.translation() = Vector3(0.001, 0.0005, 0.0208);
  sheet.material = {ElasticModel::kMembrane, 1e5, 0.3, 1000.0, 1e-6};
  sheet.damping = {1.0, 0.004};
  scene.tissues.push_back(sheet);
  scene.tissue_pairs = {{"sheet", "block"}};
  scene.instruments = {
      makeTool("ball", Vector3(-0.0027, 0.0012, 0.0265), ShapeDescription{SphereGeometry{0.005}, Pose::Identity()})};
  FrictionDescription between = makeFriction("", "sheet", 0.3, 0.3);
  between.other_tissue = "block";
  scene.friction = {makeFriction("ball", "sheet", 0.5, 0.3), between};
  return scene;
}

std::string tetrahedronStl() {
  const char* const corners[4] = {"0.005 0 0.004", "-0.003 0.004 0.004", "-0.003 -0.004 0.004", "0 0 -0.004"};
  const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  std::string stl = "solid tetrahedron\n";
  for (const auto& face : faces) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) stl += std::string("vertex ") + corners[corner] + "\n";
    stl += "endloop\nendfacet\n";
  }
  return stl + "endsolid tetrahedron\n";
}

Run run(const Scene& scene, const RunOptions& options) {
  SceneEnvironment environment;
  environment.urdf_text = [](const std::string&) { return carrierUrdf(); };
  Simulator simulator(scene, environment);
  const std::vector<int> tools = byName(simulator.instruments());
  const Matrix3 R_back = options.R.transpose();
  Run result;
  result.forces.assign(tools.size(), Eigen::Matrix3Xd(3, options.samples));
  result.torques = result.forces;
  for (int k = 0; k < options.samples; ++k) {
    const double done = 2.0 * (k + 1) / options.samples;
    const double way = 0.003 * options.units.length;
    const double slid = std::max(0.0, done - 1.0);
    VectorX joints(4);
    joints << slid * way, 0.0, -std::min(1.0, done) * way, 0.3 * slid;
    simulator.advance(options.sample_s, std::vector<VectorX>(tools.size(), joints));
    for (std::size_t i = 0; i < tools.size(); ++i) {
      const Wrench wrench = simulator.wrench(tools[i]);
      const Matrix3 R_tip = simulator.linkPoses(tools[i])[simulator.instruments()[tools[i]].tipLink()].linear();
      result.forces[i].col(k) = R_back * (R_tip * wrench.force) / options.units.force();
      result.torques[i].col(k) = R_back * (R_tip * wrench.torque) / options.units.torque();
    }
  }
  for (const int t : byName(simulator.tissues())) {
    const NodalVectors moved = simulator.positions(t) - simulator.tissues()[t].restPositions();
    result.displacements.emplace_back(R_back * moved / options.units.length);
  }
  for (const SolvedContact& solved : simulator.contacts()) {
    result.normal += solved.contact.R_WC.col(0) * solved.contact.R_WC.col(0).dot(solved.force_on_tissue_n);
  }
  result.normal.normalize();
  result.steps = simulator.stepCount();
  return result;
}

double difference(const Run& a, const Run& b) {
  double worst = a.steps == b.steps ? 0.0 : 1.0;
  for (std::size_t i = 0; i < a.forces.size(); ++i) {
    worst = std::max({worst, relative(a.forces[i], b.forces[i]), relative(a.torques[i], b.torques[i])});
  }
  for (std::size_t t = 0; t < a.displacements.size(); ++t) {
    worst = std::max(worst, relative(a.displacements[t], b.displacements[t]));
  }
  return worst;
}

}  // namespace tissue_contact
