#include "scene/scene_ranges.h"
#include "scene/scene_sections.h"

namespace tissue_contact {
namespace {

constexpr Range kTimeBudgetRange{0.0, 10.0, "s", "give seconds: 1 ms is 0.001; 0 sets no budget"};

}  // namespace

SolverDescription parseSolver(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  SolverDescription solver;
  if (const YamlCursor* value = map.find("method")) solver.method = value->choice(kSolverMethodNames);
  if (const YamlCursor* value = map.find("relaxation")) solver.relaxation = value->choice(kRelaxationNames);
  if (const YamlCursor* value = map.find("iterations")) solver.iterations = value->integer(1, kMaxIterations);
  if (const YamlCursor* value = map.find("contact_passes")) {
    solver.contact_passes = value->integer(1, kMaxContactPasses);
  }
  if (const YamlCursor* value = map.find("tolerance")) solver.tolerance = value->number(kToleranceRange);
  if (const YamlCursor* value = map.find("time_budget_s")) solver.time_budget_s = value->number(kTimeBudgetRange);
  if (const YamlCursor* value = map.find("cone_sides")) {
    solver.cone_sides = value->integer(kMinConeSides, kMaxConeSides);
    if (solver.cone_sides % 2 != 0) {
      value->fail("is " + std::to_string(solver.cone_sides) +
                  "; it must be even, so that the cone resists both ways along each direction; give one more");
    }
  }
  return solver;
}

}  // namespace tissue_contact
