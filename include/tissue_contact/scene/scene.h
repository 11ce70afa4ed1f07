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

enum class ElasticModel { kLinear, kCorotational };

struct MaterialDescription {
  ElasticModel model = ElasticModel::kCorotational;
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
};

/// Rayleigh damping matrix D = mass_per_s * M + stiffness_s * K.
struct DampingDescription {
  double mass_per_s = 0.0;
  double stiffness_s = 0.0;
};

/// Regions of the tissue frame T whose nodes are fixed (boundaries included).
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
using FixedRegion = std::variant<BoxRegion, PlaneRegion, SphereRegion>;

struct TissueDescription {
  std::string name;
  std::variant<BlockDescription, MeshDescription> geometry;
  PoseDescription pose;  ///< of the tissue frame T
  MaterialDescription material;
  DampingDescription damping;
  std::vector<FixedRegion> fixed;  ///< none: a free body
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

struct InstrumentDescription {
  std::string name;
  std::string urdf_file;                    ///< absolute path; empty: the URDF comes from `robot_description_parameter`
  std::string robot_description_parameter;  ///< ROS parameter holding the URDF text; empty if `urdf_file` is given
  PoseDescription base_pose;                ///< of the URDF root link
  std::vector<std::string> joint_state_topics;            ///< empty for a fixed obstacle
  std::map<std::string, std::string> joint_names;         ///< recorded joint name -> URDF joint name
  std::map<std::string, double> initial_joint_positions;  ///< URDF joint name -> rad or m; others start at 0
  std::string tip_link;                                   ///< wrench origin and frame
  std::vector<ContactLinkDescription> contact_links;
};

/// Coulomb friction of one instrument-tissue pair. Pairs not listed are frictionless.
struct FrictionDescription {
  std::string instrument;
  std::string tissue;
  double static_coefficient = 0.0;   ///< mu_s >= mu_k
  double kinetic_coefficient = 0.0;  ///< mu_k >= 0
};

struct StepDescription {
  double max_step_s = 0.001;  ///< an interval between joint states is cut into equal steps no longer than this
  double max_gap_s = 1.0;     ///< a longer interval between joint states is simulated as this long (counted)
};

struct SolverDescription {
  int iterations = 30;      ///< upper bound on ICA iterations (relaxation sweep + contact passes) per step
  int contact_passes = 2;   ///< predictor-corrector passes over the contacts per iteration
  double tolerance = 3e-4;  ///< stop when one iteration changes momentum and impulses by less than this (relative)
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
  std::string world_frame = "world";
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  std::vector<TissueDescription> tissues;
  std::vector<InstrumentDescription> instruments;
  std::vector<FrictionDescription> friction;
  StepDescription step;
  SolverDescription solver;
  PublishDescription publish;
};

}  // namespace tissue_contact
