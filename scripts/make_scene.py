#!/usr/bin/python3
"""Makes a scene of an organ from its surface or its tetrahedra: a probe presses the highest point and drags over it.

Writes a folder with
  scene.yaml  the organ, a surface filled with tetrahedra (which is tried, and kept for the first run), held at as much of its lowest part as it stands on; every choice explained
  probe.bag   joint states of urdf/probe.urdf: press, drag, lift
and prints the command that turns both into forces. Edit the scene, or record your own robot over it.
"""
import argparse
import itertools
import json
import logging
import math
import os
import re
import shlex
import shutil
import sys

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from make_joint_bag import write
from read_surface import SurfaceError, read_surface
from whole_file import whole_file

TOPIC = "/probe/joint_states"
BALL_M = 0.005  # radius of the probe's ball, urdf/probe.urdf
CLEARANCE_M = 0.005
SPEED_M_PER_S = 0.02
HOLD_S = 0.2
HELD_PERCENT = range(15, 65, 5)  # of the height: the first that the organ stands on
SURFACES, TETRAHEDRA = (".stl", ".obj", ".ply"), (".msh", ".vtk")
OTHERS = {".unv": "to convert it: gmsh FILE -save -o organ.msh",
          **dict.fromkeys([".msh2", ".msh4"], "if it is Gmsh's, rename it to .msh"),
          **dict.fromkeys([".glb", ".gltf", ".dae", ".3ds", ".fbx", ".off", ".vtp", ".x3d", ".wrl"],
                          "save the surface as .stl, for instance with MeshLab or Blender")}
LONGEST_M, SHORTEST_M = 2.0, 0.002  # of an organ
LONGEST_NAME = 50  # of a tissue: 64, with organ_

SCENE = """\
# {name} from {file}, by make_scene.py. Keys and units: doc/scene.md.
world_frame: world

tissues:
  - name: {name}
    mesh:
      file: {quoted}
      scale_m_per_unit: {scale:g}  # it then is {size[0]:.3g} x {size[1]:.3g} x {size[2]:.3g} m
{cells}
    material: {{preset: {material}, model: neo_hookean}}  # doc/organ.md; or youngs_modulus_pa, poissons_ratio, density_kg_per_m3
    fixed:
      - plane: {{point_m: [0, 0, {held:.7f}], normal: [0, 0, 1]}}  # the lowest {percent} % of its height: {why}

instruments:
  - name: probe
    urdf: package://tissue_contact/urdf/probe.urdf
    base_pose:
      position_m: [{start[0]:.5f}, {start[1]:.5f}, {start[2]:.5f}]  # the ball {clearance:g} mm above the highest point
    joint_state_topics: [{topic}]
    tip_link: tip
    contact_links: [tip]

friction:  # wet tissue on metal: our choice, to be measured
  - {{instrument: probe, tissue: {name}, static: 0.3, kinetic: 0.2}}

solver:
  iterations: 100  # at most: 30, the default, leave every fifth step of a long and thin organ unfinished

step:
  max_step_s: 0.002  # one for each joint state of the recording,
  joint_states: every_state  # of the recording, also where the computer is slower than it; live, beside a driver, leave it out

publish:
  tf: true
"""


SURFACE_CELLS = """\
      cell_size_m: {cell:.3g}  # edge of the tetrahedra: half of it has eight times as many
    refinement: {{cell_m: {fine:.3g}}}  # and fine ones where the probe is, a third of its ball's radius at most"""
TETRAHEDRA_CELLS = "    refinement: auto  # cut finer where the probe is, and elsewhere where the file's are too coarse to bend"
# Keys that a mesh of a file may need, by the word of the error that asks for one: value, and why it is there.
MESH_KEYS = {"remove_unreferenced_nodes": ("true", "it has some"),
             "coincident_nodes": ("merge", "some lay in the place of others; keep: where that is a cut")}


def fail(message):
    sys.exit("make_scene.py: " + message)


def height_over(corners, x, y):
    """Of the uppermost triangle over (x, y); NaN where there is none."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    with numpy.errstate(divide="ignore", invalid="ignore"):
        v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
        hit = (v >= -1e-9) & (w >= -1e-9) & (v + w <= 1.0 + 1e-9)
        heights = (a[:, 2] + v * (b[:, 2] - a[:, 2]) + w * (c[:, 2] - a[:, 2]))[hit]
    return heights.max() if len(heights) else math.nan


def is_between(place, places):
    """Whether a place of the plane lies within the convex hull of others: seen from it, no half of the plane is free of them."""
    away = places - place
    directions = numpy.sort(numpy.arctan2(away[:, 1], away[:, 0]))
    return numpy.diff(directions, append=directions[:1] + 2.0 * math.pi).max() < math.pi


def held_height(corners):
    """z (m) up to which the organ is held, how much of its height that is (%), and whether it stands on it, its middle over what is held.

    Held by less, an organ on a stalk swings away from the probe and comes back: its force then is that of a blow, and hangs on all that
    was before.
    """
    vertices = corners.reshape(-1, 3)
    areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middle = (areas[:, None] * corners.mean(axis=1)).sum(axis=0)[:2] / areas.sum()
    low, height = vertices[:, 2].min(), numpy.ptp(vertices[:, 2])
    for percent in HELD_PERCENT:
        held = low + 0.01 * percent * height
        if is_between(middle, vertices[vertices[:, 2] <= held][:, :2]):
            return held, percent, True
    return held, percent, False


def drag_path(corners, depth_m, length_m):
    """Positions of the ball's centre (m): above the highest point, pressed in, dragged towards the organ's middle, lifted."""
    vertices = corners.reshape(-1, 3)
    top = vertices[vertices[:, 2].argmax()]
    way = vertices.mean(axis=0)[:2] - top[:2]
    way = way / numpy.linalg.norm(way) if numpy.linalg.norm(way) > 1e-9 else numpy.array([1.0, 0.0])
    over = numpy.array([top[0], top[1], top[2] + BALL_M + CLEARANCE_M])
    path = [over]
    for along in numpy.linspace(0.0, length_m, 21):
        x, y = top[:2] + along * way
        height = height_over(corners, x, y)
        if math.isnan(height):
            break
        path.append(numpy.array([x, y, height + BALL_M - depth_m]))
    if len(path) < 2:
        path.append(numpy.array([top[0], top[1], top[2] + BALL_M - depth_m]))
    path.append(numpy.array([path[-1][0], path[-1][1], over[2]]))
    return path


def timed(path):
    """[(time (s), position relative to the first)]: at one speed, holding still at the start, pressed, before the lift, at the end."""
    rows = [(0.0, path[0] - path[0]), (HOLD_S, path[0] - path[0])]
    for i, (before, after) in enumerate(zip(path, path[1:])):
        rows.append((rows[-1][0] + max(numpy.linalg.norm(after - before) / SPEED_M_PER_S, 1e-3), after - path[0]))
        if i in (0, len(path) - 3, len(path) - 2):
            rows.append((rows[-1][0] + HOLD_S, after - path[0]))
    return rows


def position_at(rows, time):
    times = [row[0] for row in rows]
    return [float(numpy.interp(time, times, [row[1][axis] for row in rows])) for axis in range(3)]


def quoted(text):
    """As a scene can hold it."""
    return json.dumps(text, ensure_ascii=False)


def within_mesh(error):
    """What is wrong with a mesh, without where it stands in a scene that nobody sees."""
    return re.sub(r"^scene\.yaml:[0-9]+: tissues\[0\]\.mesh(\.file)?[:.] ?", "", str(error))


def read_tetrahedra(path, scale):
    """Corners of the surface of a tetrahedral mesh, n x 3 x 3, m, and more lines for the mesh; by the simulator, for all that it checks."""
    if not os.path.isfile(path):
        fail("%r is no file" % path)
    if not path.isprintable():
        fail("the name of the file, %r, has characters that a scene cannot hold; rename it" % path)
    keys = []
    while True:
        mesh = "{file: %s, scale_m_per_unit: %r%s}" % (
            quoted(path), scale, "".join(", %s: %s" % (key, MESH_KEYS[key][0]) for key in keys))
        try:
            import tissue_contact  # needed for these files alone, and built where pybind11 is installed
            scene = tissue_contact.parse_scene("tissues: [{name: organ, mesh: %s, material: liver}]" % mesh)
            topology = tissue_contact.Simulator(scene).topology("organ")
        except ImportError as error:
            fail("reading tetrahedra takes the package's Python module, of scripts/env.bash or an install space: %s" % error)
        except ValueError as error:
            asked = [key for key in MESH_KEYS if key in str(error) and key not in keys]
            if asked:
                keys += asked
                continue
            fail(within_mesh(error))
        require_one_body(topology)
        more = "".join("      %s: %s  # %s\n" % (key, *MESH_KEYS[key]) for key in keys)
        return topology.rest_positions[topology.triangles], more


def require_one_body(topology):
    from scipy.sparse import coo_matrix  # which surfaces do without
    from scipy.sparse.csgraph import connected_components
    corners, others = topology.tetrahedra[:, [0, 0, 0]].ravel(), topology.tetrahedra[:, 1:].ravel()
    nodes = len(topology.rest_positions)
    joined = coo_matrix((numpy.ones(len(corners)), (corners, others)), shape=(nodes, nodes))
    parts, part_of = connected_components(joined, directed=False)
    if parts > 1:
        place = topology.rest_positions[part_of == part_of.max()].mean(axis=0)
        fail("it has %d separate parts, one of them around (%.3g, %.3g, %.3g) m; a tissue is one body: keep the one you want, or, if they "
             "are to hang together, give them the same nodes where they meet" %
             (parts, *place))


def read_organ(arguments):
    """Corners of the surface, m, how the scene says what cells the organ has, and cells to fill it with, m, if any."""
    ending = os.path.splitext(arguments.organ)[1].lower()
    if ending not in SURFACES + TETRAHEDRA:
        fail("%s has none of the endings %s; %s" % (arguments.organ, ", ".join(SURFACES + TETRAHEDRA), OTHERS.get(
            ending, "to convert tetrahedra of other programs: meshio convert FILE organ.vtk")))
    if ending in TETRAHEDRA:
        if arguments.cell_size:
            fail("--cell-size is for surfaces: the tetrahedra of %s are in the file" % arguments.organ)
        corners, more = read_tetrahedra(os.path.abspath(arguments.organ), arguments.scale)
        return corners, more + TETRAHEDRA_CELLS, None
    try:
        corners = read_surface(arguments.organ) * arguments.scale
    except SurfaceError as error:
        fail(str(error))
    cell = arguments.cell_size or numpy.ptp(corners.reshape(-1, 3), axis=0).max() / 25.0
    return corners, SURFACE_CELLS.format(cell=cell, fine=min(0.3 * BALL_M, 0.5 * cell)), float("%.3g" % cell)


def require_filling(path, scale, cell_m):
    """Refuses a surface that the simulator cannot fill, as a replay would; what it fills it with is kept for that.

    Corners of the filled body's surface, m: loose crumbs of the file are none of it. None where nothing here can fill it.
    """
    if not shutil.which("gmsh"):
        print("gmsh, which fills surfaces, is not installed here: apt-get install gmsh (doc/organ.md)")
        return None
    log = logging.getLogger("tissue_contact")  # what comes of the filling
    log.setLevel(logging.INFO)
    log.addHandler(logging.StreamHandler(sys.stdout))
    try:
        import tissue_contact
        mesh = "{file: %s, scale_m_per_unit: %g, cell_size_m: %r}" % (quoted(path), scale, cell_m)
        scene = tissue_contact.parse_scene("tissues: [{name: organ, mesh: %s, material: liver}]" % mesh)
        topology = tissue_contact.Simulator(scene).topology("organ")
    except ImportError:
        return None  # the replay looks
    except ValueError as error:
        fail(within_mesh(error))
    return topology.rest_positions[topology.triangles]


def require_material(name):
    if not re.fullmatch("[a-z][a-z0-9_]*", name):
        fail("--material %r is no name of a material; names: doc/organ.md" % name)
    try:
        import tissue_contact
        tissue_contact.parse_scene("tissues: [{name: organ, block: {size_m: [0.1, 0.1, 0.1], cells: [1, 1, 1]}, material: %s}]" % name)
    except ImportError:
        return  # the replay looks
    except ValueError as error:
        fail("--material: " + re.sub(r"^scene\.yaml:[0-9]+: tissues\[0\]\.material(\.preset)?: ", "", str(error)))


def keep_edited(scene, text):
    """A scene is made to be edited: what this one would replace stays beside it."""
    try:
        with open(scene, encoding="utf-8", errors="surrogateescape") as stream:
            before = stream.read()
    except OSError:
        return
    if before == text:
        return
    kept = next(name for name in (scene + ".before" + ("%d" % n if n else "") for n in itertools.count()) if not os.path.exists(name))
    shutil.copy2(scene, kept)
    print("the scene that was there differs: it is %s now" % kept)


def require_organ_size(size, scale):
    advice = "give --scale, metres per unit of the file: 0.001 for millimetres, 1 for metres"
    if not size.max() <= LONGEST_M:
        fail("with --scale %g it is %.3g m long, longer than %g m; %s" % (scale, size.max(), LONGEST_M, advice))
    if not size.max() >= SHORTEST_M:
        fail("with --scale %g it is %.3g m long, shorter than %g m; %s" % (scale, size.max(), SHORTEST_M, advice))
    if not size.min() > 1e-3 * size.max():
        fail("it is flat, %.3g m along %s: an organ is a closed surface; give it a thickness, or make a sheet of it (doc/scene.md)" %
             (size.min(), "xyz"[size.argmin()]))


def measured(corners, arguments):
    """Sides of the box around an organ, m, which is one, and bears the depth that is asked for."""
    size = numpy.ptp(corners.reshape(-1, 3), axis=0)
    require_organ_size(size, arguments.scale)
    if arguments.depth and arguments.depth > 0.5 * size[2]:
        fail("--depth %g m is more than half of the organ's height, %.3g m: press less deep, no tissue bears that" % (arguments.depth, size[2]))
    return size


def parse_arguments():
    def positive(text):
        value = float(text)
        if not (math.isfinite(value) and value > 0.0):
            raise argparse.ArgumentTypeError("%s is not above 0" % text)
        return value

    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("organ", help="closed surface: .stl, .obj or .ply; or tetrahedra: .msh (Gmsh) or .vtk (legacy)")
    parser.add_argument("--out", required=True, help="folder for the scene and the recording; made if it does not exist")
    parser.add_argument("--scale", type=positive, default=1.0, help="metres per unit of the file, default: %(default)s")
    parser.add_argument("--cell-size", type=positive, help="edge of the tetrahedra that fill a surface, m; default: a 25th of the longest side")
    parser.add_argument("--material", default="liver", help="a name of doc/organ.md, default: %(default)s")
    parser.add_argument("--depth", type=positive, help="how far the ball presses, m; default: 5 mm, a tenth of the height at most")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    require_material(arguments.material)
    corners, cells, cell_m = read_organ(arguments)
    size = measured(corners, arguments)
    filled = require_filling(os.path.abspath(arguments.organ), arguments.scale, cell_m) if cell_m else None
    if filled is not None:
        corners, size = filled, measured(filled, arguments)
    held, percent, stands = held_height(corners)
    depth = arguments.depth or min(0.005, 0.1 * size[2])
    path = drag_path(corners, depth, min(0.02, 0.2 * size[:2].max()))
    rows = timed(path)

    name = re.sub("[^a-z0-9_]", "_", os.path.splitext(os.path.basename(arguments.organ))[0].lower())[-LONGEST_NAME:]
    folder = os.path.abspath(arguments.out)
    scene, bag = os.path.join(folder, "scene.yaml"), os.path.join(folder, "probe.bag")
    text = SCENE.format(
        name=name if name[:1].isalpha() and name != "probe" else "organ_" + name, file=quoted(os.path.basename(arguments.organ)),
        quoted=quoted(os.path.abspath(arguments.organ)), scale=arguments.scale, size=size, cells=cells,
        material=arguments.material, held=held, percent=percent,
        why="its middle is over that" if stands else "it may swing: its middle is over no more of it either",
        start=path[0], clearance=1e3 * CLEARANCE_M, topic=TOPIC)
    try:
        os.makedirs(folder, exist_ok=True)
        keep_edited(scene, text)
        with whole_file(scene, [arguments.organ]) as part, open(part, "w", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        fail("cannot write %s: %s" % (scene, error.strerror))
    print("%s: the %s, pressed %.1f mm" % (scene, name, 1e3 * depth))
    write(bag, {TOPIC: list(enumerate("xyz"))}, lambda time: (position_at(rows, time), []), rows[-1][0], [arguments.organ])
    print("forces, with plots:\n  rosrun tissue_contact run_launch.py scene.launch scene:=%s bag:=%s output:=%s rate:=0.25" %
          tuple(map(shlex.quote, (scene, bag, os.path.join(folder, "plots")))))


if __name__ == "__main__":
    main()
