#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "simulation/simulator_implementation.h"
#include "tissue_contact/baselines/make_contact_solver.h"

namespace tissue_contact {
namespace {

/// As numbers and text, what a mesh is made from.
auto parts(const BlockDescription& block) {
  const auto of = [](const AxisGrading& axis) { return std::make_pair(axis.growth, axis.fine_at); };
  return std::make_tuple(block.size_m.x(), block.size_m.y(), block.size_m.z(), block.cells, of(block.grading[0]),
                         of(block.grading[1]), of(block.grading[2]));
}
auto parts(const MeshDescription& mesh) {
  return std::tie(mesh.file, mesh.scale_m_per_unit, mesh.cell_size_m, mesh.cell_size_inside_m, mesh.coincident_nodes,
                  mesh.remove_unreferenced_nodes);
}
auto parts(const SheetDescription& sheet) {
  return std::make_tuple(sheet.size_m.x(), sheet.size_m.y(), sheet.cells, sheet.thickness_m);
}
auto parts(const ShellDescription& shell) { return std::tie(shell.file, shell.scale_m_per_unit, shell.thickness_m); }

bool areSame(const PoseDescription& a, const PoseDescription& b) {
  return a.tf_frame == b.tf_frame && a.X.matrix() == b.X.matrix();
}

bool haveSameGeometry(const TissueDescription& a, const TissueDescription& b) {
  return a.geometry.index() == b.geometry.index() &&
         std::visit(
             [&](const auto& of_a) { return parts(of_a) == parts(std::get<std::decay_t<decltype(of_a)>>(b.geometry)); },
             a.geometry);
}

auto parts(const RefinementDescription& refinement) {
  return std::tie(refinement.mode, refinement.cell_m, refinement.reach_m, refinement.nodes_at_most, refinement.growth);
}

auto fixedParts(const MaterialDescription& material) {
  return std::tie(material.model, material.density_kg_per_m3, material.bending_stiffness_n_m, material.dilatation,
                  material.distortion);
}

bool relaxesAlike(const MaterialDescription& a, const MaterialDescription& b) {
  return std::equal(a.prony_series.begin(), a.prony_series.end(), b.prony_series.begin(), b.prony_series.end(),
                    [](const PronyTerm& one, const PronyTerm& other) {
                      return one.modulus_ratio == other.modulus_ratio && one.time_s == other.time_s;
                    });
}

bool haveSameRegions(const TissueDescription& a, const TissueDescription& b) {
  return std::equal(a.regions.begin(), a.regions.end(), b.regions.begin(), b.regions.end(),
                    [](const TissueRegion& one, const TissueRegion& other) {
                      return one.name == other.name && one.where.size() == other.where.size() &&
                             one.fibre_direction == other.fibre_direction &&
                             fixedParts(one.material) == fixedParts(other.material);
                    });
}

bool haveSameAttachments(const TissueDescription& a, const TissueDescription& b) {
  return std::equal(a.attachments.begin(), a.attachments.end(), b.attachments.begin(), b.attachments.end(),
                    [](const Attachment& one, const Attachment& other) {
                      return one.stiffness_pa_per_m == other.stiffness_pa_per_m &&
                             one.stiffness_n_per_m == other.stiffness_n_per_m;
                    });
}

const char* difference(const TissueDescription& a, const TissueDescription& b) {
  if (a.name != b.name) return "tissues";
  if (!haveSameGeometry(a, b)) return "the mesh of a tissue";
  if (parts(a.refinement) != parts(b.refinement)) return "tissues[].refinement";
  if (fixedParts(a.material) != fixedParts(b.material)) return "a tissue's material but for its constants";
  if (!relaxesAlike(a.material, b.material)) return "tissues[].material.prony_series";
  if (!areSame(a.pose, b.pose)) return "tissues[].pose";
  if (a.fibre_direction != b.fibre_direction) return "tissues[].fibre_direction";
  if (!haveSameRegions(a, b)) return "tissues[].regions";
  if (!haveSameAttachments(a, b)) return "tissues[].attachments";
  if (a.fixed.size() != b.fixed.size()) return "tissues[].fixed";
  if (a.pressure_pa != b.pressure_pa) return "tissues[].pressure_pa";
  return nullptr;
}

bool haveSameCompliance(const InstrumentDescription& a, const InstrumentDescription& b) {
  return std::equal(a.compliant_joints.begin(), a.compliant_joints.end(), b.compliant_joints.begin(),
                    b.compliant_joints.end(), [](const JointCompliance& one, const JointCompliance& other) {
                      return one.joint == other.joint && one.stiffness == other.stiffness &&
                             one.effort_limit == other.effort_limit;
                    });
}

const char* difference(const InstrumentDescription& a, const InstrumentDescription& b) {
  const bool are_same = a.name == b.name && a.urdf_file == b.urdf_file && a.tip_link == b.tip_link &&
                        a.robot_description_parameter == b.robot_description_parameter &&
                        areSame(a.base_pose, b.base_pose) && a.joint_names == b.joint_names &&
                        a.initial_joint_positions == b.initial_joint_positions && haveSameCompliance(a, b) &&
                        a.contact_links.size() == b.contact_links.size();
  return are_same ? nullptr : "instruments";
}

auto fixedParts(const FrictionDescription& pair) {
  return std::tie(pair.instrument, pair.tissue, pair.other_tissue, pair.link, pair.region);
}

/// But for the coefficients, of which there are as many.
bool areAlike(const FrictionLawDescription& a, const FrictionLawDescription& b) {
  const auto parts = [](const FrictionLawDescription& law) {
    return std::tie(law.kind, law.angles_rad, law.axis, law.speeds_m_per_s, law.speed_factors, law.pressures_pa,
                    law.pressure_factors);
  };
  return parts(a) == parts(b) && a.link_axis == b.link_axis &&
         a.static_coefficients.size() == b.static_coefficients.size() &&
         a.kinetic_coefficients.size() == b.kinetic_coefficients.size();
}

const char* difference(const FrictionDescription& a, const FrictionDescription& b) {
  const bool are_same = fixedParts(a) == fixedParts(b) && areAlike(a.law, b.law);
  return are_same ? nullptr : "friction but for its coefficients";
}

template <typename Part>
const char* difference(const std::vector<Part>& a, const std::vector<Part>& b, const char* name) {
  if (a.size() != b.size()) return name;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (const char* const what = difference(a[i], b[i])) return what;
  }
  return nullptr;
}

auto parts(const AdvisorDescription& advisor) {
  return std::tie(advisor.sleep, advisor.sleep_error, advisor.adapt_rotations, advisor.skip_folds,
                  advisor.general_friction);
}

/// What retune() would leave as it is though the scenes differ in it: whoever compares scenes that way would get the same forces and
/// believe them. Places of regions, of `fixed` and of shapes are not looked at, but how many there are. nullptr: nothing.
const char* difference(const Scene& a, const Scene& b) {
  if (const char* const what = difference(a.tissues, b.tissues, "tissues")) return what;
  if (const char* const what = difference(a.instruments, b.instruments, "instruments")) return what;
  if (const char* const what = difference(a.friction, b.friction, "friction")) return what;
  if (a.gravity_m_per_s2 != b.gravity_m_per_s2) return "gravity_m_per_s2";
  if (a.step.max_step_s != b.step.max_step_s || a.step.max_gap_s != b.step.max_gap_s) return "step";
  if (a.solver.method != b.solver.method) return "solver.method";
  if (a.solver.relaxation != b.solver.relaxation) return "solver.relaxation";
  if (a.solver.cone_sides != b.solver.cone_sides) return "solver.cone_sides";
  if (a.solver.time_budget_s != b.solver.time_budget_s) return "solver.time_budget_s";
  if (parts(a.advisor) != parts(b.advisor)) return "advisor";
  const bool have_same_pairs = std::equal(a.tissue_pairs.begin(), a.tissue_pairs.end(), b.tissue_pairs.begin(),
                                          b.tissue_pairs.end(), [](const TissuePair& one, const TissuePair& other) {
                                            return one.tissue == other.tissue && one.other == other.other;
                                          });
  return have_same_pairs ? nullptr : "tissue_pairs";
}

/// @return whether it was another.
template <typename Value>
bool take(const Value& from, Value& to) {
  if (from == to) return false;
  to = from;
  return true;
}

bool takeMaterial(const MaterialDescription& from, MaterialDescription& to) {
  const bool modulus = take(from.youngs_modulus_pa, to.youngs_modulus_pa);
  return take(from.poissons_ratio, to.poissons_ratio) || modulus;
}

bool takeTissue(const TissueDescription& from, TissueDescription& to) {
  bool any = takeMaterial(from.material, to.material);
  any |= take(from.damping.mass_per_s, to.damping.mass_per_s);
  any |= take(from.damping.stiffness_s, to.damping.stiffness_s);
  for (std::size_t r = 0; r < to.regions.size(); ++r) {
    any |= takeMaterial(from.regions[r].material, to.regions[r].material);
    any |= take(from.regions[r].damping_stiffness_s, to.regions[r].damping_stiffness_s);
  }
  return any;
}

bool takeFriction(const Scene& from, Scene& to) {
  bool any = false;
  for (std::size_t i = 0; i < to.friction.size(); ++i) {
    any |= take(from.friction[i].law.static_coefficients, to.friction[i].law.static_coefficients);
    any |= take(from.friction[i].law.kinetic_coefficients, to.friction[i].law.kinetic_coefficients);
  }
  return any;
}

bool takeSolver(const SolverDescription& from, SolverDescription& to) {
  bool any = take(from.iterations, to.iterations);
  any |= take(from.contact_passes, to.contact_passes);
  any |= take(from.tolerance, to.tolerance);
  return any;
}

}  // namespace

void Simulator::retune(const Scene& changed) {
  if (const char* const what = difference(changed, implementation_->scene)) {
    throw std::invalid_argument(
        std::string(
            "a running scene may change in moduli, Poisson's ratios, damping, coefficients of friction and limits "
            "of the solver only; this one has other ") +
        what + ": make a simulator of it");
  }
  implementation_->retuned = changed;
}

/// Within a step and not when asked to: till then residuals, contacts and force errors are those of the step before, and are computed
/// from its materials and laws. Refined meshes are made from a description of their own, which takes the numbers as well.
void Simulator::Implementation::retune() {
  const Scene changed = std::move(*retuned);
  retuned.reset();
  bool is_other_body = false;
  for (const auto& follower : followers) {
    if (follower) follower->pause();  // it may be making a tissue from those numbers
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!takeTissue(changed.tissues[t], scene.tissues[t])) continue;
    if (refinements[t]) takeTissue(changed.tissues[t], refinements[t]->description());
    tissues[t].changeMaterials(scene.tissues[t]);
    load_watch.setMaterials(static_cast<int>(t), scene.tissues[t]);
    moving[t].changeMaterials();
    if (followers[t]) followers[t]->goOn();
    is_other_body = true;
  }
  if (is_other_body) contacts.setMaterials(scene.tissues);
  if (takeFriction(changed, scene)) {
    friction = FrictionTable(scene, instruments, tissues);
    problem.contacts.clear();  // their laws are gone; the step makes new ones, or does not come so far
    solution.states.clear();
  }
  if (takeSolver(changed.solver, scene.solver)) {
    solver = makeContactSolver(scene.solver, clock);
    const bool never =
        std::isinf(deadline_s) && std::isinf(prompt_s);  // of which a solver without a clock need not hear
    if (!never) solver->setDeadline(deadline_s, prompt_s);
  } else if (is_other_body) {
    solver->reset();
  }
}

}  // namespace tissue_contact
