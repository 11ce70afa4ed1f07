/// @file
/// Bullet's deformable world, set up so that it solves the same problem as the simulator and not a lookalike:
///  - Elasticity: btDeformableLinearElasticityForce, the same corotational law (Bullet's polar decomposition stops at a
///    tolerance of 0.01, which makes a deep press 2 % stiffer), and the only one with the same damping: proportional to
///    stiffness, corotated. Explicit elasticity, implicit damping; contacts are held during the solve for damping by
///    Lagrange multipliers (setUseProjection(false)). With implicit elasticity there was no contact force, with the
///    projection an error of 11 % over press-and-drag.
///  - Contacts of faces: node contacts alone let the faces between the nodes through (30 % too little force).
///  - All nodes of the same mass: Bullet spreads a contact's impulse over a face by weight *times nodal mass*. With the
///    lumped masses, which differ from node to node of a block of tetrahedra, a static press came out 50 % too stiff.
///    The motion is slow enough for the distribution of mass not to matter.
///  - No softening of contacts (cfm); penetration is taken back within the step (erp), not by split impulses, whose
///    momentum is not in the velocities. The contact margin is taken off the sphere's radius.
///  - The sphere stands where it is at the start of a step and has the speed of its motion over the step: a kinematic
///    body would stand at the end of it already.
///  - The force is read from the balance of momentum of the tissue, since the impulses of the contacts are changed
///    afterwards by the solve for damping (about 20 % off).
///  - Links between the nodes, with no force on them: the soft body's trees are built from them.
#include "benchmark/bullet_peer.h"

// Bullet's arrays copy elements that nobody has set yet; inlined here, that is reported as ours.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

constexpr double kMargin = 1e-4;  // m; any from 1e-6 to 1e-3 gives the same forces

constexpr double kStableShare = 0.9;  // of stableStep(), for what deformation adds to the stiffness at rest

using NodalForces = btDeformableLagrangianForce::TVStack;

btVector3 toBullet(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Vector3 fromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

void setZero(NodalForces& values) {
  for (int i = 0; i < values.size(); ++i) values[i].setZero();
}

double squaredNorm(const NodalForces& values) {
  double sum = 0.0;
  for (int i = 0; i < values.size(); ++i) sum += values[i].length2();
  return sum;
}

double volume(const PeerScene& scene) {
  double sum = 0.0;
  for (const Tetrahedron& t : scene.tetrahedra) sum += signedVolume(scene.rest, t);
  return sum;
}

class BulletWorld {
 public:
  explicit BulletWorld(const PeerScene& scene);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// One step of Bullet while the sphere moves in a straight line. @return seconds of Bullet's work.
  double step(const Vector3& from, const Vector3& to, double dt_s);

  /// N, on the sphere, mean over the last step of `dt_s`; to be called once after every step.
  Vector3 forceOnSphere(double dt_s);

  /// Largest step (s) at which explicit elasticity with implicit damping is stable in contact; to be called after a
  /// first step.
  double stableStep();

  /// Whether no node is farther from its rest position than `limit_m` (NaN counts as farther).
  bool within(const NodalVectors& rest, double limit_m) const;

 private:
  void configure();
  void addTissue(const PeerScene& scene);
  void setCollisions();
  void addElasticity(const PeerScene& scene);
  void addSphere(const PeerScene& scene);

  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btDeformableMultiBodyConstraintSolver contact_solver_;
  btDeformableBodySolver body_solver_;
  std::unique_ptr<btDeformableMultiBodyDynamicsWorld> world_;
  std::unique_ptr<btDeformableLinearElasticityForce> elasticity_;
  std::unique_ptr<btSoftBody> tissue_;
  std::unique_ptr<btSphereShape> shape_;
  std::unique_ptr<btRigidBody> sphere_;
  double nodal_mass_ = 0.0;
  double damping_s_;
  Vector3 momentum_ = Vector3::Zero();
  NodalForces forces_;
};

BulletWorld::BulletWorld(const PeerScene& scene) : damping_s_(scene.damping_s) {
  contact_solver_.setDeformableSolver(&body_solver_);
  world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher_, &broadphase_, &contact_solver_,
                                                                &configuration_, &body_solver_);
  configure();
  addTissue(scene);
  addElasticity(scene);
  addSphere(scene);
}

BulletWorld::~BulletWorld() {
  world_->removeRigidBody(sphere_.get());
  world_->removeSoftBody(tissue_.get());
}

void BulletWorld::configure() {
  world_->setGravity(btVector3(0.0, 0.0, 0.0));
  world_->setImplicit(false);
  world_->setLineSearch(false);
  world_->setUseProjection(false);
  btContactSolverInfo& info = world_->getSolverInfo();
  info.m_numIterations = 10;  // Bullet's default; 50 change the forces by 0.01 %
  info.m_splitImpulse = 0;
  info.m_deformable_erp = 0.8;  // the smallest error over press-and-drag of 0, 0.06 (default), 0.2, 0.5, 0.8
  info.m_deformable_cfm = 0.0;
}

void BulletWorld::addTissue(const PeerScene& scene) {
  const int nodes = static_cast<int>(scene.rest.cols());
  btAlignedObjectArray<btVector3> positions;
  for (int i = 0; i < nodes; ++i) positions.push_back(toBullet(scene.rest.col(i)));
  tissue_ = std::make_unique<btSoftBody>(&world_->getWorldInfo(), nodes, &positions[0], nullptr);
  std::set<std::pair<int, int>> edges;
  for (const Tetrahedron& t : scene.tetrahedra) {
    tissue_->appendTetra(t[0], t[1], t[2], t[3]);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) edges.insert(std::minmax(t[i], t[j]));
    }
  }
  for (const auto& [a, b] : edges) tissue_->appendLink(a, b);
  for (const Triangle& t : scene.surface) tissue_->appendFace(t[0], t[1], t[2]);
  nodal_mass_ = scene.density * volume(scene) / nodes;
  for (int i = 0; i < nodes; ++i) tissue_->setMass(i, scene.fixed[i] ? 0.0 : nodal_mass_);
  tissue_->initializeDmInverse();
  tissue_->m_tetraScratches.resize(tissue_->m_tetras.size());
  tissue_->m_tetraScratchesTn.resize(tissue_->m_tetras.size());
  setCollisions();
  world_->addSoftBody(tissue_.get());
}

void BulletWorld::setCollisions() {
  tissue_->getCollisionShape()->setMargin(kMargin);
  tissue_->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDF;
  tissue_->m_cfg.kDF = 1.0;  // friction is this times the sphere's
  tissue_->m_cfg.drag = 0.0;
  tissue_->setSelfCollision(false);
  tissue_->setActivationState(DISABLE_DEACTIVATION);
}

void BulletWorld::addElasticity(const PeerScene& scene) {
  const double mu = scene.youngs_modulus_pa / (2.0 * (1.0 + scene.poissons_ratio));
  const double lambda = 2.0 * mu * scene.poissons_ratio / (1.0 - 2.0 * scene.poissons_ratio);
  elasticity_ = std::make_unique<btDeformableLinearElasticityForce>(mu, lambda, 0.0, scene.damping_s);
  world_->addForce(tissue_.get(), elasticity_.get());
  forces_.resize(tissue_->m_nodes.size());
}

void BulletWorld::addSphere(const PeerScene& scene) {
  shape_ = std::make_unique<btSphereShape>(scene.sphere_radius_m - kMargin);
  const btRigidBody::btRigidBodyConstructionInfo info(0.0, nullptr, shape_.get());  // no mass: moved by hand
  sphere_ = std::make_unique<btRigidBody>(info);
  sphere_->setFriction(scene.mu);
  world_->addRigidBody(sphere_.get());
}

double BulletWorld::step(const Vector3& from, const Vector3& to, double dt_s) {
  const btTransform pose(btQuaternion::getIdentity(), toBullet(from));
  sphere_->setWorldTransform(pose);
  sphere_->setInterpolationWorldTransform(pose);
  sphere_->setLinearVelocity(toBullet((to - from) / dt_s));
  const auto start = std::chrono::steady_clock::now();
  world_->stepSimulation(dt_s, 0);  // 0: one step of just that length
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Elastic and damping forces cancel over all nodes, so on the free nodes together they are minus those on the fixed:
// contact = change of momentum / dt + forces on the fixed nodes. Bullet's deformation is still that of the start of the
// step here, the velocities those of its end: the very forces the step was made with.
Vector3 BulletWorld::forceOnSphere(double dt_s) {
  setZero(forces_);
  elasticity_->addScaledForces(1.0, forces_);
  Vector3 on_base = Vector3::Zero();
  Vector3 momentum = Vector3::Zero();
  for (int i = 0; i < forces_.size(); ++i) {
    const btSoftBody::Node& node = tissue_->m_nodes[i];
    if (node.m_im > 0.0) {
      momentum += nodal_mass_ * fromBullet(node.m_v);
    } else {
      on_base += fromBullet(forces_[i]);
    }
  }
  const Vector3 on_tissue = (momentum - momentum_) / dt_s + on_base;
  momentum_ = momentum;
  return -on_tissue;
}

// x'' = -w^2 (x + b x'), x explicit and x' implicit, is stable up to b + sqrt(b^2 + 4 / w^2); the largest w^2 is that
// of the undeformed tissue, by power iteration. In contact the first b is not to be had: press-and-drag (605 nodes,
// limit 6.4 ms with b = 3 ms) was smooth at 3.5 ms, rough at 4 ms and blew up at 4.5 ms; without damping it ran up to
// its limit (1.6 ms).
double BulletWorld::stableStep() {
  constexpr int kIterations = 100;
  NodalForces direction;
  direction.resize(forces_.size());
  for (int i = 0; i < direction.size(); ++i) {  // anything not orthogonal to the fastest mode
    direction[i] = btVector3(std::sin(1.0 + 7.0 * i), std::sin(2.0 + 11.0 * i), std::sin(3.0 + 13.0 * i));
  }
  double w2 = 0.0;
  for (int k = 0; k < kIterations; ++k) {
    const double size = std::sqrt(squaredNorm(direction));
    for (int i = 0; i < direction.size(); ++i) direction[i] *= tissue_->m_nodes[i].m_im > 0.0 ? 1.0 / size : 0.0;
    setZero(forces_);
    elasticity_->addScaledElasticForceDifferential(1.0 / nodal_mass_, direction, forces_);
    w2 = std::sqrt(squaredNorm(forces_));
    direction = forces_;
  }
  return std::sqrt(damping_s_ * damping_s_ + 4.0 / w2);
}

bool BulletWorld::within(const NodalVectors& rest, double limit_m) const {
  for (int i = 0; i < tissue_->m_nodes.size(); ++i) {
    if (!((fromBullet(tissue_->m_nodes[i].m_x) - rest.col(i)).norm() <= limit_m)) return false;
  }
  return true;
}

void requireRange(double value, const char* name, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  std::ostringstream text;
  text << "Bullet scene: " << name << " is " << value << ", must be between " << low << " and " << high;
  throw std::invalid_argument(text.str());
}

void requireIndices(const int* first, std::size_t count, int nodes, const char* name) {
  if (std::all_of(first, first + count, [nodes](int i) { return i >= 0 && i < nodes; })) return;
  throw std::invalid_argument(std::string("Bullet scene: a ") + name + " refers to a node that is not in rest");
}

void requireScene(const PeerScene& scene) {
  const int nodes = static_cast<int>(scene.rest.cols());
  if (nodes == 0 || !scene.rest.allFinite()) throw std::invalid_argument("Bullet scene: rest must hold finite nodes");
  if (scene.tetrahedra.empty() || scene.surface.empty() || scene.fixed.size() != static_cast<std::size_t>(nodes)) {
    throw std::invalid_argument("Bullet scene: needs tetrahedra, a surface and one fixed flag per node");
  }
  for (const Tetrahedron& t : scene.tetrahedra) requireIndices(t.data(), t.size(), nodes, "tetrahedron");
  for (const Triangle& t : scene.surface) requireIndices(t.data(), t.size(), nodes, "triangle");
  for (const Tetrahedron& t : scene.tetrahedra) {
    if (!(signedVolume(scene.rest, t) > 0.0)) throw std::invalid_argument("Bullet scene: a tetrahedron is inverted");
  }
  if (std::all_of(scene.fixed.begin(), scene.fixed.end(), [](bool fixed) { return fixed; })) {
    throw std::invalid_argument("Bullet scene: all nodes are fixed; leave some free");
  }
  if (!scene.sphere_centre) throw std::invalid_argument("Bullet scene: sphere_centre is empty; give the sphere's path");
  requireRange(scene.youngs_modulus_pa, "youngs_modulus_pa", 1.0, 1e12);
  requireRange(scene.poissons_ratio, "poissons_ratio", 0.0, 0.499);
  requireRange(scene.density, "density (kg/m^3)", 1.0, 1e5);
  requireRange(scene.damping_s, "damping_s", 0.0, 10.0);
  requireRange(scene.mu, "mu", 0.0, 10.0);
  requireRange(scene.sphere_radius_m, "sphere_radius_m", 10.0 * kMargin, 10.0);
  requireRange(scene.dt_s, "dt_s", 1e-7, 1.0);
  requireRange(scene.steps, "steps", 1, 1e8);
}

std::string describe(double damping_s, int substeps) {
  std::ostringstream text;
  text << "Bullet " << btGetVersion() / 100 << '.' << btGetVersion() % 100
       << ", double precision, deformable world, corotational, explicit, "
       << (damping_s > 0.0 ? "implicit damping, " : "no damping, ") << substeps
       << (substeps == 1 ? " sub-step" : " sub-steps");
  return text.str();
}

}  // namespace

PeerRun runBulletPeer(const PeerScene& scene) {
  requireScene(scene);
  const double extent = (scene.rest.rowwise().maxCoeff() - scene.rest.rowwise().minCoeff()).norm();
  BulletWorld world(scene);
  // Bullet sets up its trees and numbers its nodes in its first step: not timed, over no time, the sphere out of reach.
  const double radius = scene.sphere_radius_m;
  const Vector3 far = scene.rest.rowwise().maxCoeff() + Vector3::Constant(3.0 * radius + extent);
  world.step(far, far, 1e-9);
  world.forceOnSphere(1e-9);
  const int substeps = static_cast<int>(std::ceil(scene.dt_s / (kStableShare * world.stableStep())));
  const double h = scene.dt_s / substeps;
  PeerRun run;
  run.nodes = static_cast<int>(scene.rest.cols());
  run.how = describe(scene.damping_s, substeps);
  run.forces_n.assign(scene.steps, Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  run.step_seconds.assign(scene.steps, std::numeric_limits<double>::quiet_NaN());
  for (int k = 0; k < scene.steps && world.within(scene.rest, extent); ++k) {
    Vector3 sum = Vector3::Zero();
    double seconds = 0.0;
    for (int i = 0; i < substeps; ++i) {
      const double t = k * scene.dt_s + i * h;
      seconds += world.step(scene.sphere_centre(t), scene.sphere_centre(t + h), h);
      sum += world.forceOnSphere(h);
    }
    run.forces_n[k] = sum / substeps;
    run.step_seconds[k] = seconds;
  }
  return run;
}

}  // namespace tissue_contact
