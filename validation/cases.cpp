#include "validation/cases.h"

#include "validation/closed_forms.h"
#include "validation/hard/hard_cases.h"

namespace tissue_contact {

const std::vector<ValidationCase>& validationCases() {
  static const std::vector<ValidationCase> cases = {
      {"one-contact", "A: stick, slip, threshold and hysteresis of one contact, to round-off", validateOneContact},
      {"incline", "B: a block on an incline holds, creeps not, slides at g (sin - mu cos)", validateIncline},
      {"directional-incline", "I: orthotropic and asymmetric friction on an incline", validateDirectionalIncline},
      {"held-contact", "B: what static friction holds does not creep, point by point", validateHeldContact},
      {"spring-block", "C: a block on a spring stops where friction holds it; order in dt", validateSpringBlock},
      {"stick-slip", "C: a block on a spring and a belt, mu_s > mu_k and mu_s = mu_k", validateStickSlip},
      {"shear-lag", "D: a strip pulled over a floor, both relaxations; order in the mesh", validateShearLag},
      {"capstan", "E: a belt on a drum, a polygon of nodes; order in the turn per facet", validateCapstan},
      {"elasticity", "J: patch test, bar, cantilever and bent beam of linear tetrahedra", validateElasticity},
      {"elastic-models", "J: neo-Hookean and mass-spring bars, layers in series, creep, relaxation",
       validateElasticModels},
      {"membrane", "J: patch test, strips, plates in bending and twist", validateMembrane},
      {"held-and-pressed", "J: a block on springs sinks and swings; hydrostatic pressure, a pressed slab",
       validateHeldAndPressed},
      {"layer-indentation", "F: sphere on a bonded layer", validateLayerIndentation},
      {"partial-slip", "G, H: a sphere is dragged; an annulus slides while the centre holds", validatePartialSlip},
      {"landing", "G, H: contacts that begin within a step slide only from then on", validateLanding},
      {"pressure-friction", "mu(p): plate on a layer, slab on an incline, sphere by Hertz", validatePressureFriction},
      {"benchmark-block", "H, J: press force over meshes, equilibrium, determinism", validateBenchmarkBlock},
      {"coarse-press", "a deep press over coarse, fine and graded meshes: what they cost", validateCoarsePress},
      {"press-laws", "H and a deep press: linear, corotational and neo-Hookean tissue", validatePressLaws},
      {"grasp", "jaws close on a flap, lift, hold, pull until it slips, open; mu_s >> mu_k too", validateGrasp},
      {"invariances", "units, directions and the order of lists do not matter", validateInvariances},
      {"ploughing", "friction in contact frames, a slow press at any step, impulses over dt", validatePloughing},
      {"hard-incompressible", "nu .49 at default settings; .495, .499 with cholesky", validateHardIncompressible},
      {"hard-stiffness-contrast", "1000:1: soft on stiff; with cholesky stiff on soft, a stone",
       validateHardStiffnessContrast},
      {"hard-time-steps", ".1, 1, 5 ms at default settings; 10, 33 ms with cholesky", validateHardTimeSteps},
      {"hard-friction", "mu 0, .01, 1, 2; 1 to stick but .1 to slide, with cholesky too", validateHardFriction},
      {"hard-sharp-tip", "a cone and a .2 mm ball on a vertex, an edge and a face", validateHardSharpTip},
      {"hard-bad-elements", "slivers, needles 1:1000 run with cholesky; flat, inverted: refused",
       validateHardBadElements},
      {"hard-inversion", "elements turned inside out under load recover", validateHardInversion},
      {"hard-fast-entry", "0.5 m/s at 1 ms, and at 10 ms with cholesky: no tunnelling", validateHardFastEntry},
      {"hard-placement", "an instrument starts inside the tissue, teleports into and out of it", validateHardPlacement},
      {"hard-many-contacts", "2048 contacts at once, and 1 to 300 as a ball settles", validateHardManyContacts},
      {"hard-pinch", "tissue pinched between two instruments", validateHardPinch},
      {"hard-long-hold", "held for 10 min, 10 ms steps with cholesky: no creep, no drift", validateHardLongHold},
      {"hard-cycles", "1000 cycles of press, drag and lift return to rest", validateHardCycles},
      {"hard-joint-states", "joint states with gaps, duplicates, NaN, time running backwards", validateHardJointStates},
  };
  return cases;
}

}  // namespace tissue_contact
