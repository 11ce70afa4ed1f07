#include "simulation/build_scene.h"

#include <stdexcept>
#include <utility>

#include "simulation/scene_budget.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {
namespace {

/// Factors of so many bytes take some seconds to compute.
constexpr std::size_t kSlowFactor = std::size_t{100} << 20U;

Pose placeInWorld(const PoseDescription& pose, const std::string& owner, const SceneEnvironment& environment) {
  if (pose.tf_frame.empty()) return pose.X;
  return atEntry("tf_frame", [&]() -> Pose {
    if (!environment.frame_pose) {
      throw std::invalid_argument(owner + " is placed in tf frame '" + pose.tf_frame +
                                  "', but no tf is available here; give position_m and rpy_rad without tf_frame");
    }
    return environment.frame_pose(pose.tf_frame) * pose.X;
  });
}

RobotModel readUrdf(const InstrumentDescription& instrument, const SceneEnvironment& environment) {
  if (!instrument.urdf_file.empty()) return loadUrdf(instrument.urdf_file, environment.package_path);
  const std::string& parameter = instrument.robot_description_parameter;
  if (!environment.urdf_text) {
    throw std::invalid_argument("instrument '" + instrument.name + "' takes its URDF from parameter '" + parameter +
                                "', but no parameters are available here; name a file with the key 'urdf'");
  }
  return parseUrdf(environment.urdf_text(parameter), "parameter '" + parameter + "'", "", environment.package_path);
}

}  // namespace

std::vector<Instrument> buildInstruments(const Scene& scene, const SceneEnvironment& environment) {
  std::vector<Instrument> instruments;
  SceneBudget budget(scene);
  for (const InstrumentDescription& description : scene.instruments) {
    atEntry(elementOf("instruments", instruments.size()), [&] {
      const Pose X_WB = atEntry("base_pose", [&] {
        return placeInWorld(description.base_pose, "instrument '" + description.name + "'", environment);
      });
      RobotModel model = atEntry(description.urdf_file.empty() ? "robot_description" : "urdf",
                                 [&] { return readUrdf(description, environment); });
      instruments.emplace_back(description, std::move(model), X_WB);
      budget.add(instruments.back());
    });
  }
  return instruments;
}

std::vector<Tissue> buildTissues(const Scene& scene, const SceneEnvironment& environment,
                                 std::vector<std::unique_ptr<TissueRefinement>>& refinements) {
  SceneBudget(scene).addGenerated();  // before the first of them is built
  SceneBudget budget(scene);
  BuildProgress progress(environment.meshes.say);
  std::vector<Tissue> tissues;
  for (const TissueDescription& description : scene.tissues) {
    atEntry(elementOf("tissues", tissues.size()), [&] {
      const Pose X_WT = atEntry(
          "pose", [&] { return placeInWorld(description.pose, "tissue '" + description.name + "'", environment); });
      const std::string ordinal = std::to_string(tissues.size() + 1) + " of " + std::to_string(scene.tissues.size());
      const auto on_size = [&](std::size_t nodes, std::size_t elements) {
        budget.add(description, nodes, elements);
        progress.beginTissue(description, ordinal, nodes, elements);
      };
      if (description.refinement.mode == RefinementDescription::Mode::kNever) {
        refinements.emplace_back();
        tissues.emplace_back(description, X_WT, on_size, environment.meshes);
      } else {
        refinements.push_back(std::make_unique<TissueRefinement>(description, X_WT, on_size, environment.meshes));
        tissues.push_back(refinements.back()->tissue());
      }
    });
  }
  progress.stage("tissues are built; preparing their surfaces and first stiffness");
  if (budget.factorBytes() > kSlowFactor && environment.meshes.say) {
    environment.meshes.say("the first step factorises the stiffness of the tissues, about " +
                           std::to_string(budget.factorBytes() >> 20U) +
                           " MB; that may take minutes (solver.relaxation: gauss_seidel does without)");
  }
  return tissues;
}

std::vector<TouchingTissues> buildTissuePairs(const Scene& scene) {
  const auto index = [&](const std::string& name) {
    for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
      if (scene.tissues[t].name == name) return static_cast<int>(t);
    }
    throw std::invalid_argument("tissue_pairs names the unknown tissue '" + name + "'");
  };
  std::vector<TouchingTissues> pairs;
  for (const TissuePair& pair : scene.tissue_pairs) {
    atEntry(elementOf("tissue_pairs", pairs.size()), [&] { pairs.push_back({index(pair.tissue), index(pair.other)}); });
  }
  return pairs;
}

void requireMethodForLaws(const Scene& scene) {
  const SolverMethod method = scene.solver.method;
  if (method == SolverMethod::kPredictorCorrector || method == SolverMethod::kReference) return;
  if (scene.advisor.general_friction) {
    throw EntryError("advisor.friction_path",
                     "solver.method " + std::string(solverMethodName(method)) +
                         " handles isotropic friction only, but advisor.friction_path is general; make it auto");
  }
  for (std::size_t i = 0; i < scene.friction.size(); ++i) {
    const FrictionDescription& pair = scene.friction[i];
    if (pair.law.kind == FrictionLawDescription::Kind::kIsotropic) continue;
    throw EntryError(elementOf("friction", i) + ".law",
                     "solver.method " + std::string(solverMethodName(method)) +
                         " handles isotropic friction only, but friction on tissue '" + pair.tissue +
                         "' depends on direction; use predictor_corrector or reference");
  }
}

}  // namespace tissue_contact
