/// @file
/// Room `scene`: a scene as plain data in SI units: what the YAML file says, checked, with every path resolved and
/// every default filled in. Nothing here refers to ROS, FCL or a mesh library. Keys, units and defaults: doc/scene.md.
#pragma once

#include <array>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A pose in the world frame W, or in a tf frame that is looked up once at start.
struct PoseDescription {
  Pose X = Pose::Identity();  ///< pose in W if `tf_frame` is empty, else in `tf_frame`
  std::string tf_frame;       ///< empty: placed by the scene alone
};

/// Spacing of the cells of a block along one axis: each cell is `growth` times as long as its neighbour nearer
/// `fine_at`.
struct AxisGrading {
  enum class FineAt { kMinimum, kCenter, kMaximum };
  double growth = 1.0;  ///< >= 1, dimensionless; 1 = even spacing
  FineAt fine_at = FineAt::kCenter;
};

/// Generated block. Tissue frame T: origin at the centre of the block's lowest face (z = 0), z up to size_m.z().
struct BlockDescription {
  Vector3 size_m = Vector3::Zero();
  std::array<int, 3> cells = {0, 0, 0};  ///< cells (not nodes) along x, y, z; 5 tetrahedra each, alternating split
  std::array<AxisGrading, 3> grading;
};

/// A tetrahedral mesh file (.msh, .vtk). File coordinates times `scale_m_per_unit` are metres in the tissue frame T.
struct MeshDescription {
  std::string file;  ///< absolute path
  double scale_m_per_unit = 1.0;
  bool remove_unreferenced_nodes = false;  ///< drop nodes that no tetrahedron uses instead of refusing the file
};

/// Generated flat sheet (membrane, cloth, strip). Tissue frame T: origin at its centre, normal along z.
struct SheetDescription {
  Vector2 size_m = Vector2::Zero();
  std::array<int, 2> cells = {0, 0};  ///< along x, y; 2 triangles each, alternating split
  double thickness_m = 0.0;
};

/// Triangle mesh file (.stl, .obj, .dae) used as a membrane. File coordinates times the scale are metres in T.
struct ShellDescription {
  std::string file;  ///< absolute path
  double scale_m_per_unit = 1.0;
  double thickness_m = 0.0;
};

/// kLinear to kMassSpring are for volumes (block, mesh); kMembrane is for surfaces (sheet, shell) and their only model.
enum class ElasticModel { kLinear, kCorotational, kNeoHookean, kMassSpring, kMembrane };

/// Over what a linear or corotational volume averages its change of volume.
enum class Dilatation {
  kAuto,     ///< kPatch from Poisson's ratio 0.3 on, where it pays; else kElement
  kElement,  ///< each tetrahedron: locks as Poisson's ratio nears 1/2
  kPatch     ///< the five tetrahedra of a block's cell, or about five neighbours of a mesh: does not
};

struct MaterialDescription {
  ElasticModel model = ElasticModel::kCorotational;
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  /// Membranes: bending stiffness per width, N m; negative: that of a plate, E h^3 / (12 (1 - nu^2)).
  double bending_stiffness_n_m = -1.0;
  Dilatation dilatation = Dilatation::kAuto;
};

/// Damping matrix D = mass_per_s * M + stiffness_s * K (Rayleigh; the second part is Kelvin-Voigt's, with
/// viscosity = stiffness_s * modulus).
struct DampingDescription {
  double mass_per_s = 0.0;
  double stiffness_s = 0.0;
};

/// Regions of the tissue frame T (boundaries included): where nodes are fixed, where a material applies.
struct BoxRegion {
  Vector3 min_m = Vector3::Zero();
  Vector3 max_m = Vector3::Zero();
};
struct PlaneRegion {  ///< nodes on the plane or on the side the normal points away from: normal . (x - point) <= 0
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();
};
struct SphereRegion {
  Vector3 center_m = Vector3::Zero();
  double radius_m = 0.0;
};
using Region = std::variant<BoxRegion, PlaneRegion, SphereRegion>;

/// A named part of a tissue with a material, damping, fibre direction or friction of its own: the elements (and surface
/// triangles) whose centroid lies in any of `where`. Where several regions hold an element, the last one counts.
struct TissueRegion {
  std::string name;                  ///< unique in its tissue
  std::vector<Region> where;         ///< in the tissue frame T, at rest
  MaterialDescription material;      ///< that of the tissue where the scene gives none; same `model` as the tissue's
  double damping_stiffness_s = 0.0;  ///< that of the tissue where the scene gives none
  Vector3 fibre_direction = Vector3::Zero();  ///< that of the tissue where the scene gives none
};

struct TissueDescription {
  std::string name;
  std::variant<BlockDescription, MeshDescription, SheetDescription, ShellDescription> geometry;
  PoseDescription pose;  ///< of the tissue frame T
  MaterialDescription material;
  DampingDescription damping;
  Vector3 fibre_direction = Vector3::Zero();  ///< at rest, in T, any length; zero: none. Carried by the deformation
  std::vector<TissueRegion> regions;
  std::vector<Region> fixed;  ///< none: a free body
};

/// Two tissues that may touch each other; the same one twice: folds of one tissue.
struct TissuePair {
  std::string tissue;
  std::string other;
};

/// Collision geometry in its own frame S: sphere and box centred, cylinder centred with its axis along z (as in URDF).
struct SphereGeometry {
  double radius_m = 0.0;
};
struct BoxGeometry {
  Vector3 size_m = Vector3::Zero();  ///< full edge lengths
};
struct CylinderGeometry {
  double radius_m = 0.0;
  double length_m = 0.0;
};
struct MeshGeometry {
  std::string file;  ///< absolute path: STL, OBJ or DAE
  Vector3 scale = Vector3::Ones();
};
using ShapeGeometry = std::variant<SphereGeometry, BoxGeometry, CylinderGeometry, MeshGeometry>;

struct ShapeDescription {
  ShapeGeometry geometry;
  Pose X_LS = Pose::Identity();  ///< pose of the shape in its link's frame L
};

/// A link that touches tissue. With no shapes named here its URDF <collision> is used, or else its <visual>.
struct ContactLinkDescription {
  std::string link;
  std::vector<ShapeDescription> shapes;
};

/// A topic of joint states of an instrument.
struct JointStateTopic {
  std::string name;
  /// Its stamps are moments of the simulation, each with a wrench. If not, it only updates joints (a jaw beside its arm).
  bool triggers = true;
};

struct InstrumentDescription {
  std::string name;
  std::string urdf_file;                    ///< absolute path; empty: the URDF comes from `robot_description_parameter`
  std::string robot_description_parameter;  ///< ROS parameter holding the URDF text; empty if `urdf_file` is given
  PoseDescription base_pose;                ///< of the URDF root link
  std::vector<JointStateTopic> joint_state_topics;        ///< empty for a fixed obstacle; else at least one triggers
  std::map<std::string, std::string> joint_names;         ///< recorded joint name -> URDF joint name
  std::map<std::string, double> initial_joint_positions;  ///< URDF joint name -> rad or m; others start at 0
  std::string tip_link;                                   ///< wrench origin and frame
  std::vector<ContactLinkDescription> contact_links;
};

/// A dry-friction law as numbers: what friction opposes sliding in each direction of the contact plane. Directions are
/// those in which the INSTRUMENT slides over the tissue (the opposite of the tissue's velocity relative to the
/// instrument), as angles from the law's axis 1 towards axis 2; axis 2 = n x axis 1, n from the instrument into the
/// tissue. So "forward" of a jaw with an asymmetric law is the jaw moving along its own +axis 1 over the tissue, and
/// with axis 1 along the fibre it is the instrument moving along +fibre. The force the instrument feels opposes that
/// motion. Of two tissues, the one n points away from takes the instrument's part.
struct FrictionLawDescription {
  enum class Kind {
    kIsotropic,    ///< coefficients: mu
    kOrthotropic,  ///< mu along axis 1, mu along axis 2: elliptic limit, force not collinear with sliding
    kAsymmetric,   ///< mu sliding along +axis 1, mu along -axis 1, mu along axis 2: quarter ellipses, force as above
    kTable,  ///< mu at each of `angles_rad` of the sliding direction, linear in between, periodic; force collinear
    kTensor  ///< m11, m12, m21, m22: force = -M d, d the sliding direction; sym(M) must be positive semidefinite
  };
  enum class Axis {
    kNone,  ///< isotropic laws
    kLink,  ///< `link_axis` turns with the instrument link
    kFibre  ///< the tissue's fibre direction, carried by its deformation
  };
  Kind kind = Kind::kIsotropic;
  std::vector<double> static_coefficients;   ///< nowhere below the kinetic ones
  std::vector<double> kinetic_coefficients;  ///< same number
  std::vector<double> angles_rad;            ///< kTable: ascending, from 0, below 2 pi
  Axis axis = Axis::kNone;
  Vector3 link_axis = Vector3::UnitX();  ///< axis 1 in the link's frame, projected into the contact plane
  /// Stribeck: kinetic coefficients are multiplied by a factor that depends on sliding speed, linear in between, held
  /// beyond the ends. Empty: 1 at every speed.
  std::vector<double> speeds_m_per_s;  ///< ascending, from 0
  std::vector<double> speed_factors;   ///< 0 to 1: kinetic friction never exceeds static
};

/// Friction of one pair. Pairs not listed are frictionless. The most specific entry counts: with link and region, with
/// link, with region, with neither.
struct FrictionDescription {
  std::string instrument;  ///< empty when `other_tissue` is given
  std::string link;        ///< of the instrument; empty: all
  std::string tissue;
  std::string region;        ///< of the tissue; empty: everywhere
  std::string other_tissue;  ///< tissue against tissue (or its own folds)
  FrictionLawDescription law;
};

/// Which joint states the simulation stops at.
enum class StatePolicy {
  kAuto,        ///< whoever plays them decides: kEveryState for recordings, kNewestState beside a robot driver
  kEveryState,  ///< each, in the order of their stamps; nothing is skipped however long it takes
  kNewestState  ///< the newest there is; older ones are merged into the motion towards it
};

struct StepDescription {
  double max_step_s = 0.001;  ///< an interval between joint states is cut into equal steps no longer than this
  double max_gap_s = 1.0;     ///< a longer interval between joint states is simulated as this long (counted)
  StatePolicy joint_states = StatePolicy::kAuto;
  double max_lag_s = 0.02;  ///< how far the answer may lag behind the newest joint state under kNewestState
};

/// How a step's contact problem is solved. All but kPredictorCorrector and kReference are rivals kept for comparison.
enum class SolverMethod {
  kPredictorCorrector,  ///< the product: iterative predictor-corrector on ICA
  kReference,           ///< Delassus matrix by sparse Cholesky, semismooth Newton: exact and slow
  kCone4,               ///< ICA with the 4-sided cone compacted along the previous sliding velocity
  kPolyhedral,          ///< ICA with a polyhedral cone of `cone_sides` sides (MLCP)
  kCondensedLcp,        ///< static condensation to an LCP with a polyhedral cone, Lemke's pivoting
  kImpulse              ///< frictionless step, then friction impulses (Bridson, Fedkiw & Anderson 2002)
};

/// What relaxes A v = b + J'lambda between the passes over the contacts.
enum class RelaxationKind {
  kGaussSeidel,  ///< block Gauss-Seidel sweeps: O(n) memory, right for small steps
  kCholesky      ///< lagged sparse Cholesky factor: for stiff or near-incompressible tissue and large steps
};

struct SolverDescription {
  SolverMethod method = SolverMethod::kPredictorCorrector;
  RelaxationKind relaxation = RelaxationKind::kGaussSeidel;
  int iterations = 30;         ///< upper bound on iterations (relaxation + contact passes) per step
  int contact_passes = 20;     ///< upper bound on predictor-corrector passes over the contacts per iteration
  double tolerance = 1e-4;     ///< stop when one iteration changes momentum and impulses by less than this (relative)
  double time_budget_s = 0.0;  ///< stop after this wall time per step; 0: none. Gives up bit-identical replay
  int cone_sides = 8;          ///< of the polyhedral rivals, even, 4 to 64
};

/// The name of a method or relaxation in scene files and on command lines, and back.
/// @throws std::invalid_argument naming the known ones.
const char* solverMethodName(SolverMethod method);
SolverMethod solverMethodByName(const std::string& name);
const char* relaxationName(RelaxationKind relaxation);
RelaxationKind relaxationByName(const std::string& name);

/// Which simplifications the simulator may choose for itself, where the scene allows them.
struct AdvisorDescription {
  bool sleep = true;             ///< nodes at rest away from contacts are left out
  double sleep_error = 0.001;    ///< what holds them may sum up to this share of the contact force
  bool adapt_rotations = false;  ///< corotational bodies are linear while nothing in them turns far
  bool skip_folds = true;        ///< folds of convex bodies are not looked for while they are impossible
  bool general_friction =
      false;  ///< isotropic friction and none take the path of directional laws: to measure its cost
};

/// Rates are of simulated (message) time; 0 switches a topic off.
struct PublishDescription {
  double mesh_rate_hz = 30.0;
  double contacts_rate_hz = 100.0;
  double status_rate_hz = 10.0;
  double markers_rate_hz = 30.0;
  bool tf = false;  ///< publish the instrument links' transforms
};

struct Scene {
  std::string file;  ///< where it was read from, for messages; may be empty
  /// Line of each entry of that file by its path of keys, "tissues[0].material"; empty for a scene that was not read.
  std::map<std::string, int> entry_lines;
  std::string world_frame = "world";
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  std::vector<TissueDescription> tissues;
  std::vector<InstrumentDescription> instruments;
  std::vector<TissuePair> tissue_pairs;
  std::vector<FrictionDescription> friction;
  StepDescription step;
  SolverDescription solver;
  AdvisorDescription advisor;
  PublishDescription publish;
};

/// "file:line: entry" for messages, the line being that of the nearest entry around it that the file has; without what
/// the scene does not know.
std::string placeOf(const Scene& scene, const std::string& entry);

}  // namespace tissue_contact
