/// What must not matter: the units a scene is written in, the direction it is turned to, the order in which nodes,
/// instruments and friction entries are listed. Absolute thresholds, preferred axes and dependence on order show here.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "support/temporary_directory.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "validation/closed_forms.h"
#include "validation/invariance_scenes.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

/// Relative. Round-off of doubles, which a run of 120 steps may multiply, but no decision may hang on it.
constexpr double kSame = 1e-9;

/// Relative. A mesh shape's distance has single-precision samples, and the search for its lowest point on a triangle ends
/// within a hundredth of the grid's spacing, here 1 um of an indentation of 2 mm.
constexpr double kSameOfAMesh = 5e-4;

struct NamedScene {
  std::string name;
  Scene scene;
  double same = kSame;
};

std::vector<NamedScene> allScenes(const std::string& stl_file) {
  std::vector<NamedScene> scenes;
  for (const RelaxationKind relaxation : {RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky}) {
    for (NamedScene& one : std::vector<NamedScene>{{"two tools", twoToolsScene()},
                                                   {"two tools, neo-Hookean", twoToolsScene(ElasticModel::kNeoHookean)},
                                                   {"sharp tools", sharpToolsScene(stl_file), kSameOfAMesh},
                                                   {"sheet on block", sheetOnBlockScene()}}) {
      one.name += relaxation == RelaxationKind::kCholesky ? ", Cholesky" : ", Gauss-Seidel";
      one.scene.solver.relaxation = relaxation;
      // Round-off grows in what a step leaves unsolved: with 1e-3 and Cholesky to 1e-7 within the 120 steps, with one flip to 1e-3.
      one.scene.solver.tolerance = 1e-4;
      scenes.push_back(one);
    }
  }
  return scenes;
}

/// A decimal factor, so that round-off is another one too.
void otherUnits(const NamedScene& one, const Run& plain, Report& report) {
  for (const Units& units : {Units{1000.0, 1.0}, Units{1000.0, 1000.0}, Units{1e6, 1.0}}) {
    RunOptions options;
    options.units = units;
    report.atMost(one.name + (units.length == 1e6 ? ": in um, kg"
                              : units.mass == 1.0 ? ": in mm, kg"
                                                  : ": in mm, g"),
                  "", one.same, difference(plain, run(inUnits(one.scene, units), options)),
                  "the same problem in m, kg");
  }
}

/// @param up where the scene's z axis goes.
void turnedTo(const NamedScene& one, const Run& plain, const Vector3& up, Report& report) {
  RunOptions options;
  options.R = Quaternion::FromTwoVectors(Vector3::UnitZ(), up).toRotationMatrix();
  const Run got = run(turned(one.scene, options.R), options);
  std::ostringstream name;
  const Vector3 without_minus_zero = up.array() + 0.0;
  const Eigen::IOFormat plainly(Eigen::StreamPrecision, Eigen::DontAlignCols);
  name << one.name << ": up is (" << without_minus_zero.transpose().format(plainly) << ")";
  report.atMost(name.str(), "", one.same, difference(plain, got), "the same wrench, turned");
  // Else it was not the direction that it should have been.
  report.atMost(name.str() + ", normal", "", one.same, (options.R * plain.normal - got.normal).norm(),
                "the same normal, turned");
}

/// The axes and the diagonals of the cube, forwards and backwards, and directions that single out nothing.
std::vector<Vector3> directions() {
  std::vector<Vector3> directions;
  for (int axis = 0; axis < 3; ++axis) {
    directions.emplace_back(Vector3::Unit(axis));
    directions.emplace_back(-Vector3::Unit(axis));
  }
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) directions.emplace_back(x, y, z);
    }
  }
  directions.emplace_back(2.0, 3.0, 6.0);
  directions.emplace_back(-2.0, -3.0, -6.0);
  return directions;
}

/// The block of twoToolsScene() as a VTK file. @param shuffle nodes and elements in another order, and other corners of
/// an element first.
std::string blockFile(const Scene& scene, bool shuffle) {
  const TetMesh mesh = makeBlockMesh(std::get<BlockDescription>(scene.tissues[0].geometry));
  const auto nodes = static_cast<long>(mesh.positions.cols());
  const auto elements = static_cast<long>(mesh.tetrahedra.size());
  // Steps without a common divisor with the counts visit everything once.
  const auto stepFor = [](long count) {
    long step = 7 * count / 11;
    while (std::gcd(step, count) != 1) ++step;
    return step;
  };
  const long node_step = shuffle ? stepFor(nodes) : 1;
  const long element_step = shuffle ? stepFor(elements) : 1;
  std::vector<long> new_index(nodes);
  std::ostringstream file;
  file.precision(17);
  file << "# vtk DataFile Version 2.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << nodes << " double\n";
  for (long i = 0; i < nodes; ++i) {
    const long old = i * node_step % nodes;
    new_index[old] = i;
    file << mesh.positions.col(old).transpose() << "\n";
  }
  file << "CELLS " << elements << " " << 5 * elements << "\n";
  for (long i = 0; i < elements; ++i) {
    const Tetrahedron& t = mesh.tetrahedra[i * element_step % elements];
    const long a = new_index[t[0]], b = new_index[t[1]], c = new_index[t[2]], d = new_index[t[3]];
    file << "4 ";
    (shuffle ? file << c << " " << d << " " << a << " " << b : file << a << " " << b << " " << c << " " << d) << "\n";
  }
  file << "CELL_TYPES " << elements << "\n";
  for (long i = 0; i < elements; ++i) file << "10\n";
  return file.str();
}

/// Largest difference of forces, as in difference(): displacements are in another order.
double forceDifference(Run a, Run b) {
  a.displacements.clear();
  b.displacements.clear();
  return difference(a, b);
}

/// Converged, since a solver that stops on the way stops at a place that depends on the order in which it goes.
Scene converged(Scene scene) {
  scene.solver.iterations = 5000;
  scene.solver.tolerance = 1e-11;
  return scene;
}

/// Relative. Solved to 1e-11 per iteration; Gauss-Seidel takes hundreds of them, and a step hands its error on.
constexpr double kSolved = 1e-8;

void otherOrder(const std::string& stl_file, Report& report) {
  for (const NamedScene& one :
       {NamedScene{"two tools", twoToolsScene()}, NamedScene{"sharp tools", sharpToolsScene(stl_file)}}) {
    for (const RelaxationKind relaxation : {RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky}) {
      Scene scene = converged(one.scene);
      scene.solver.relaxation = relaxation;
      const std::string name = one.name + (relaxation == RelaxationKind::kCholesky ? ", Cholesky" : ", Gauss-Seidel");
      report.atMost(name + ": tools, friction backwards", "", kSolved,
                    difference(run(scene), run(listedBackwards(scene))), "converged: the same answer");
      if (one.name != "two tools") continue;
      Run runs[2];
      for (const bool shuffle : {false, true}) {
        const TemporaryDirectory directory;
        Scene from_file = scene;
        MeshDescription mesh;
        mesh.file = directory.write("block.vtk", blockFile(scene, shuffle));
        from_file.tissues[0].geometry = mesh;
        runs[shuffle] = run(from_file);
      }
      report.atMost(name + ": nodes, elements shuffled", "", kSolved, forceDifference(runs[0], runs[1]),
                    "converged: the same answer");
    }
    report.progress(one.name == "two tools" ? 0.8 : 1.0);
  }
}

}  // namespace

void validateInvariances(Report& report) {
  const TemporaryDirectory directory;
  const std::string stl = directory.write("tetrahedron.stl", tetrahedronStl());
  const std::vector<NamedScene> scenes = allScenes(stl);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Run plain = run(scenes[i].scene);
    otherUnits(scenes[i], plain, report);
    if (i == 0) {
      for (const Vector3& up : directions()) turnedTo(scenes[i], plain, up, report);
    } else {
      turnedTo(scenes[i], plain, Vector3(1.0, 1.0, 1.0), report);
      turnedTo(scenes[i], plain, Vector3(0.0, -1.0, 0.0), report);
    }
    report.progress(0.6 * static_cast<double>(i + 1) / static_cast<double>(scenes.size()));
  }
  otherOrder(stl, report);
}

}  // namespace tissue_contact
