/// Hard cases of geometry: tips sharper than the mesh on a face, an edge and a vertex; slivers, needles and elements
/// that are no elements; elements turned inside out under load.

#include <sstream>

#include "support/temporary_directory.h"
#include "support/tissue_files.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "validation/hard/hard_cases.h"
#include "validation/hard/hard_scene.h"

namespace tissue_contact {
namespace {

void facet(std::ostream& stl, const Vector3& a, const Vector3& b, const Vector3& c) {
  stl << "facet normal 0 0 0\nouter loop\n";
  for (const Vector3& p : {a, b, c}) stl << "vertex " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  stl << "endloop\nendfacet\n";
}

/// A cone of 12 sides, 5 mm wide at the top, whose point is the origin, 20 mm below: half angle of 14 degrees.
std::string coneStl() {
  constexpr int kSides = 12;
  std::ostringstream stl;
  stl.precision(17);
  stl << "solid cone\n";
  const Vector3 top(0.0, 0.0, 0.02);
  for (int i = 0; i < kSides; ++i) {
    const auto rim = [&](int k) {
      const double angle = 2.0 * M_PI * (k % kSides) / kSides;
      return Vector3(0.005 * std::cos(angle), 0.005 * std::sin(angle), 0.02);
    };
    facet(stl, Vector3::Zero(), rim(i + 1), rim(i));
    facet(stl, top, rim(i), rim(i + 1));
  }
  stl << "endsolid cone\n";
  return stl.str();
}

/// Block whose grid lines pair up at a thousandth of the cell size in the middle of each axis: cells between two pairs
/// are flat (1000 x 1000 x 1), long (1000 x 1 x 1) and regular; in legacy VTK text. `spoil` may change the mesh first.
std::string sliverVtk(const std::function<void(TetMesh&)>& spoil = {}) {
  TetMesh mesh = makeBlockMesh({Vector3(7.0, 7.0, 5.0), {7, 7, 5}, {}});
  const auto place = [](double line, int cells) {  // the middle cell shrinks to a thousandth of 1
    const double at = line < 0.5 * cells ? line : line - 0.999;
    return 0.06 / 6.001 * (at - 0.5 * (cells - 0.999));
  };
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    Vector3 p = mesh.positions.col(i);
    p = Vector3(place(p.x() + 3.5, 7), place(p.y() + 3.5, 7), place(p.z(), 5));
    p.z() += 0.06 / 6.001 * 0.5 * 4.001;
    mesh.positions.col(i) = p;
  }
  if (spoil) spoil(mesh);
  return vtkOf(mesh);
}

/// Building the pad from this mesh must fail with a message that holds all of these words.
void mustBeRefused(const std::string& statement, const std::function<void(TetMesh&)>& spoil,
                   std::initializer_list<const char*> words, Report& report) {
  const TemporaryDirectory directory;
  PadScene scene;
  scene.tissue = "mesh: {file: " + directory.write("refused.vtk", sliverVtk(spoil)) + "}";
  std::string message;
  try {
    makePad(scene);
  } catch (const std::invalid_argument& error) {
    message = error.what();
  }
  bool named = !message.empty();
  for (const char* const word : words) named = named && message.find(word) != std::string::npos;
  report.require(statement, named, "the message names the element");
  report.note(message.substr(message.find("tetrahedron") == std::string::npos ? 0 : message.find("tetrahedron")));
}

/// Worst of signed volume over rest volume.
double worstVolumeRatio(const Simulator& simulator) {
  const Tissue& tissue = simulator.tissues()[0];
  double worst = 1.0;
  for (const Tetrahedron& tet : tissue.tetrahedra()) {
    worst = std::min(worst, signedVolume(simulator.positions(0), tet) / signedVolume(tissue.restPositions(), tet));
  }
  return worst;
}

/// Presses far deeper than elements are high, drags, lets go, waits: turned inside out, and back.
void invertAndRecover(const std::string& model, Report& report, double from, double to) {
  PadScene scene;
  scene.model = model;
  scene.youngs_modulus_pa = 2000.0;
  scene.radius_m = 0.004;
  scene.damping_s = 0.01;  // so that the slowest mode dies within the second of waiting
  Simulator simulator = makePad(scene);
  double worst = 1.0;
  {
    HardRun run(simulator, 23);
    PressDrag path;
    path.depth_m = 0.02;
    path.way_m = 0.02;
    path.period_s = 0.5;
    for (int k = 1; k <= 1500; ++k) {
      simulator.advance(0.001, {path.at(0.001 * k)});
      worst = std::min(worst, worstVolumeRatio(simulator));
      if (k % 100 == 0) report.progress(from + (to - from) * k / 2500);
    }
    for (int k = 1; k <= 1000; ++k) simulator.advance(0.001, {path.at(0.0)});
    run.report(model, {}, report);
  }
  const double away = (simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff();
  report.atMost(model + ": worst volume ratio under load", "", 0.0, worst, "the case is about inverted elements");
  report.atLeast(model + ": worst volume ratio after release", "", 0.99, worstVolumeRatio(simulator), "recovered");
  report.atMost(model + ": left of the deformation after 1 s", "m", 1e-5, away, "recovered");
}

}  // namespace

void validateHardSharpTip(Report& report) {
  const TemporaryDirectory directory;
  const std::string cone = directory.write("cone.stl", coneStl());
  // Cells of 7.5 mm: (0, 0) is a vertex; the edges beside it run along x and y, the diagonals at 45 degrees.
  const std::pair<const char*, Vector3> places[] = {
      {"vertex", {0.0, 0.0, 0.0}}, {"edge", {0.00375, 0.0, 0.0}}, {"face", {0.00375, 0.0015, 0.0}}};
  PadScene scene;
  PressDrag path;
  path.depth_m = 0.003;
  path.way_m = 0.003;
  double done = 0.0;
  for (const auto& [name, at] : places) {
    path.at_m = at;
    scene.radius_m = 0.0;
    scene.urdf = tipUrdf("<mesh filename='file://" + cone + "'/>");
    // The point sits in the fold it presses, touching both sides: contacts that share an edge can push each other into
    // holding more than friction allows for some steps before they let go (change per iteration below the tolerance; 500
    // iterations would tell). A known limit, at most a quarter of the steps; which those are hangs by the tolerance.
    HardBands bands;
    bands.let_go_else = 0.25;
    runPad(std::string("cone on ") + name, scene, path, bands, report, done, done + 1.0 / 6);
    scene.radius_m = 0.0002;
    scene.urdf.clear();
    bands.let_go_else = name == std::string("edge") ? 0.15 : 0.1;  // 3 (face, vertex) and 5 of 45
    runPad(std::string("0.2 mm ball on ") + name, scene, path, bands, report, done + 1.0 / 6, done + 2.0 / 6);
    done += 2.0 / 6;
  }
}

void validateHardBadElements(Report& report) {
  const TemporaryDirectory directory;
  PadScene scene;
  scene.tissue = "mesh: {file: " + directory.write("slivers.vtk", sliverVtk()) + "}";
  scene.radius_m = 0.02;
  PressDrag path;
  path.at_m.z() = 0.06 / 6.001 * 4.001 - 0.03;
  // A needle is 1000 times as stiff along its short edges: as a stiff part, it wants Cholesky.
  scene.solver = "{relaxation: cholesky}";
  runPad("slivers, needles 1:1000", scene, path, {}, report);
  const auto last_on_face = [](TetMesh& mesh) {  // node 3 of tetrahedron 17 into the plane of the others
    const Tetrahedron& t = mesh.tetrahedra[17];
    mesh.positions.col(t[3]) = (mesh.positions.col(t[0]) + mesh.positions.col(t[1]) + mesh.positions.col(t[2])) / 3.0;
  };
  mustBeRefused("an element without volume is refused by name", last_on_face, {"tetrahedron", "no volume"}, report);
  const auto last_through_face = [](TetMesh& mesh) {  // and on to the other side, which its neighbour has
    const Tetrahedron& t = mesh.tetrahedra[17];
    const Vector3 middle = (mesh.positions.col(t[0]) + mesh.positions.col(t[1]) + mesh.positions.col(t[2])) / 3.0;
    mesh.positions.col(t[3]) = 1.5 * middle - 0.5 * mesh.positions.col(t[3]);
  };
  mustBeRefused("an inverted element is refused by name", last_through_face, {"tetrahedron", "is inverted"}, report);
}

void validateHardInversion(Report& report) {
  invertAndRecover("corotational", report, 0.0, 0.5);
  invertAndRecover("neo_hookean", report, 0.5, 1.0);
}

}  // namespace tissue_contact
