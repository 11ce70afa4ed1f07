/// @file
/// Room `simulation`: Simulator saved and restored, and whether a state is of its scene.
#include <cmath>
#include <cstdint>
#include <vector>

#include "simulation/simulator_implementation.h"
#include "tissue_contact/core/content_hash.h"

namespace tissue_contact {
namespace {

void add(const Pose& pose, ContentHash& hash) { hash.add(pose.data(), sizeof(double) * 16); }

/// Of where its links are at the start, and of its shapes as far as these are numbers of their own.
std::uint64_t instrumentHash(const Instrument& instrument) {
  std::vector<Pose> X_WL;
  instrument.linkPoses(instrument.initialPositions(), X_WL);
  ContentHash hash;
  for (const Pose& pose : X_WL) add(pose, hash);
  for (const ContactLink& link : instrument.contactLinks()) {
    hash.add(&link.link, sizeof link.link);
    for (const CollisionShape& shape : link.shapes) {
      const double half_extent = smallestHalfExtent(shape);
      add(shape.X_LS, hash);
      hash.add(&half_extent, sizeof half_extent);
    }
  }
  return hash.value();
}

std::uint64_t complianceHash(const Instrument& instrument) {
  ContentHash hash;
  for (const CompliantJoint& joint : instrument.compliantJoints()) {
    hash.add(&joint.joint, sizeof joint.joint);
    hash.add(&joint.stiffness, sizeof joint.stiffness);
    hash.add(&joint.effort_limit, sizeof joint.effort_limit);
  }
  return hash.value();
}

/// Of what the material makes of the undeformed mesh.
std::uint64_t materialHash(const Tissue& tissue, const TissueDescription& description) {
  const auto undeformed = tissue.elasticity().makeState();
  ContentHash hash;
  hash.add(&description.material.model, sizeof description.material.model);  // laws are alike where nothing is deformed
  for (const TissueRegion& region : description.regions) {
    hash.add(&region.material.model, sizeof region.material.model);
  }
  hash.add(tissue.nodeMasses().data(), sizeof(double) * static_cast<std::size_t>(tissue.nodeMasses().size()));
  for (const BlockMatrix* matrix : {&undeformed->stiffness, &undeformed->damping}) {
    hash.add(matrix->diagonal.data(), sizeof(Matrix3) * matrix->diagonal.size());
  }
  for (const PronyTerm& term : description.material.prony_series) {
    hash.add(&term.modulus_ratio, sizeof term.modulus_ratio);
    hash.add(&term.time_s, sizeof term.time_s);
  }
  for (const double number : {tissue.damping().stiffness_s, tissue.damping().mass_per_s, description.pressure_pa}) {
    hash.add(&number, sizeof number);
  }
  return hash.value();
}

template <typename Values>
std::uint64_t hashOf(const Values& values) {
  ContentHash hash;
  hash.add(values.data(), sizeof(*values.data()) * static_cast<std::size_t>(values.size()));
  return hash.value();
}

}  // namespace

void Simulator::Implementation::carry(StateArchive& archive) {
  if (retuned) {
    retune();                  // numbers that the next step has
    problem.contacts.clear();  // solved with other numbers
    solution.states.clear();
  }
  carryMeshes(archive);
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    archive.section("instrument '" + instruments[i].name() + "'");
    archive.require(instrumentHash(instruments[i]), "it has another model, or stands elsewhere");
    if (!instruments[i].compliantJoints().empty()) {
      archive.require(complianceHash(instruments[i]), "other joints of it are compliant, or otherwise");
    }
    motion.carry(static_cast<int>(i), archive);
    archive.carry(wrenches[i].force);
    archive.carry(wrenches[i].torque);
    archive.check(wrenches[i].force.allFinite() && wrenches[i].torque.allFinite(), "a force that is not finite");
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    archive.section("tissue '" + tissues[t].name() + "' in motion");
    moving[t].carry(archive);
    archive.carry(solution.slow_changes[t]);
    archive.check(
        solution.slow_changes[t].allFinite() && solution.slow_changes[t].cwiseAbs().maxCoeff() <= MovingTissue::kMost,
        "a change of velocity that no tissue has");
  }
  archive.section("contacts");
  contacts.carry(archive, instruments);
  solution.impulses.resize(contacts.solved().size(), Vector3::Zero());
  archive.carry(solution.impulses);
  archive.carry(step_count);
  archive.carry(last_dt);
  archive.check(std::isfinite(last_dt) && last_dt >= 0.0 && step_count >= 0,
                "a time step, or a number of them, that is none");
  solver->reset();  // also on writing: what it carries is not stored, so both go on without it
  if (!archive.isReading()) return;
  problem.contacts.clear();
  solution.states.clear();
  force_errors.reset();
  report = StepReport();
  residuals = Residuals();
}

/// Also what tells whether a state is of this scene.
void Simulator::Implementation::carryMeshes(StateArchive& archive) {
  if (archive.isReading()) contacts.clear();
  archive.section("scene");
  archive.require(tissues.size(), "it has another number of tissues");
  archive.require(instruments.size(), "it has another number of instruments");
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    archive.section("tissue '" + tissues[t].name() + "'");
    bool is_refined = refinements[t] != nullptr;
    archive.require(is_refined ? 1 : 0, "is refined in one of scene and state only");
    if (is_refined) {
      if (archive.isReading()) followers[t]->drop();
      refinements[t]->carry(archive);
      if (archive.isReading()) restartMesh(static_cast<int>(t));
      followers[t]->carry(archive, tissues[t].nodeCount());
    }
    archive.require(hashOf(tissues[t].restPositions()), "the mesh, or its place in the world, is another one");
    archive.require(hashOf(tissues[t].tetrahedra()), "the elements are others");
    archive.require(materialHash(tissues[t], scene.tissues[t]),
                    "the material is another one, or was changed while it ran: change it likewise first");
  }
}

}  // namespace tissue_contact
