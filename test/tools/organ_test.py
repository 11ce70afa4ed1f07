#!/usr/bin/python3
"""From a surface, or tetrahedra, to forces: make_scene.py and a replay of what it writes; what it refuses.

usage: organ_test.py SOURCE_DIRECTORY PROGRAM_DIRECTORY      (in the environment of the package: PROGRAM_DIRECTORY/../../env.sh)
"""
import csv
import itertools
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

import yaml

SOURCE, PROGRAMS = "", ""
DEADLINE_S = 300.0
RADIUS_MM, RINGS = 30.0, 24


def run(*command, **more):
    return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, timeout=DEADLINE_S, check=False, **more)


def ball():
    """Vertices (mm) and outward triangles of a ball."""
    around = 2 * RINGS
    vertices = [(0.0, 0.0, RADIUS_MM), (0.0, 0.0, -RADIUS_MM)]
    for ring in range(1, RINGS):
        a = math.pi * ring / RINGS
        vertices += [(RADIUS_MM * math.sin(a) * math.cos(math.pi * i / RINGS),
                      RADIUS_MM * math.sin(a) * math.sin(math.pi * i / RINGS), RADIUS_MM * math.cos(a)) for i in range(around)]

    def at(ring, i):
        return 2 + (ring - 1) * around + i % around

    triangles = []
    for i in range(around):
        triangles += [(0, at(1, i), at(1, i + 1)), (at(RINGS - 1, i), 1, at(RINGS - 1, i + 1))]
        for ring in range(1, RINGS - 1):
            triangles += [(at(ring, i), at(ring + 1, i), at(ring, i + 1)), (at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1))]
    return vertices, triangles


def stl(vertices, triangles):
    facets = [struct.pack("<12fH", 0, 0, 0, *(x for v in t for x in vertices[v]), 0) for t in triangles]
    return b" " * 80 + struct.pack("<I", len(facets)) + b"".join(facets)


def obj(vertices, triangles):
    lines = ["v %r %r %r" % v for v in vertices] + ["f %d//1 %d//1 %d//1" % tuple(i + 1 for i in t) for t in triangles]
    return "\n".join(lines).encode()


def ply(vertices, triangles):
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
              "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(vertices), len(triangles)))
    return (header.encode() + b"".join(struct.pack("<3f", *v) for v in vertices) +
            b"".join(struct.pack("<B3i", 3, *t) for t in triangles))


def tetrahedra(extra_nodes=(), twice=False, ascending=False):
    """A legacy VTK file, mm: a block of 80 x 80 x 40 mm in cells of 20 mm, six tetrahedra each. Twice: a second one above it.
    Ascending: nodes of tetrahedra in that order, whichever way round they are then."""
    cells = (4, 4, 2)
    nodes = [(20.0 * i, 20.0 * j, 20.0 * k) for k in range(cells[2] + 1) for j in range(cells[1] + 1) for i in range(cells[0] + 1)]
    nodes += extra_nodes

    def at(corner):
        return corner[0] + (cells[0] + 1) * (corner[1] + (cells[1] + 1) * corner[2])

    found = []
    for cell in itertools.product(*map(range, cells)):
        for axes in itertools.permutations(range(3)):  # from a corner to the one opposite, along an axis after the other
            way = [list(cell)]
            for axis in axes:
                way.append([c + (k == axis) for k, c in enumerate(way[-1])])
            a, b, c, d = map(at, way)
            found.append((a, b, c, d) if axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else (a, c, b, d))
    if ascending:
        found = [tuple(sorted(tet)) for tet in found]
    if twice:
        found += [tuple(node + len(nodes) for node in tet) for tet in found]
        nodes += [(x, y, z + 100.0) for x, y, z in nodes]
    lines = ["# vtk DataFile Version 3.0", "block", "ASCII", "DATASET UNSTRUCTURED_GRID", "POINTS %d double" % len(nodes)]
    lines += ["%g %g %g" % node for node in nodes] + ["CELLS %d %d" % (len(found), 5 * len(found))]
    lines += ["4 %d %d %d %d" % tet for tet in found] + ["CELL_TYPES %d" % len(found)] + ["10"] * len(found)
    return "\n".join(lines + [""]).encode()


def has_simulator():
    try:
        import tissue_contact
        return bool(tissue_contact.Simulator)
    except ImportError:
        return False


class OrganTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as stream:
            stream.write(content)
        return self.path(name)

    def make(self, surface, *more):
        return run(sys.executable, os.path.join(SOURCE, "scripts", "make_scene.py"), surface, "--out", self.path("made"), *more,
                   env=dict(os.environ, XDG_CACHE_HOME=self.folder))

    def replay(self, *more):
        """Forces (N), and what was said."""
        result = run(os.path.join(PROGRAMS, "tissue_contact_replay"), "--scene", self.path("made/scene.yaml"), "--bag",
                     self.path("made/probe.bag"), "--csv", self.path("out.csv"), *more, env=dict(os.environ, XDG_CACHE_HOME=self.folder))
        self.assertEqual(result.returncode, 0, result.stdout)
        with open(self.path("out.csv"), newline="") as stream:
            return [math.hypot(*(float(row["force_%s_n" % axis]) for axis in "xyz")) for row in csv.DictReader(stream)], result.stdout

    @unittest.skipUnless(shutil.which("gmsh"), "the program gmsh is not installed")
    def test_a_ball_of_every_format_gives_about_hertz_force(self):
        # Hertz: 4/3 E/(1 - nu^2) sqrt(R) d^1.5, the ball of 5 mm on one of 30 mm, which yields as a whole too.
        depth, radius = 0.003, 1.0 / (1.0 / 0.005 + 1.0 / 0.030)
        hertz = 4.0 / 3.0 * 5400.0 / (1.0 - 0.45 ** 2) * math.sqrt(radius) * depth ** 1.5
        for name, content in (("my organ #1: left.stl", stl), ("b.obj", obj), ("c.ply", ply)):  # names as people give them
            with self.subTest(name):
                made = self.make(self.write(name, content(*ball())), "--scale", 0.001, "--cell-size", 0.008, "--depth", depth)
                self.assertEqual(made.returncode, 0, made.stdout)
                self.assertIn("rosrun tissue_contact run_launch.py scene.launch", made.stdout)
                forces, said = self.replay()
                self.assertIn("tetrahedra", said)
                self.assertEqual(forces[0], 0.0)
                self.assertGreater(max(forces), 0.4 * hertz)
                self.assertLess(max(forces), 1.3 * hertz)
                self.assertEqual(forces[-1], 0.0, "lifted")

    @unittest.skipUnless(shutil.which("gmsh"), "the program gmsh is not installed")
    def test_the_two_commands_of_the_page(self):
        """As doc/organ.md gives them, but for the surface and the pace."""
        with open(os.path.join(SOURCE, "doc", "organ.md"), encoding="utf-8") as stream:
            commands = [line.strip() for line in stream if line.startswith("    rosrun ")]
        self.assertEqual(len(commands), 2, commands)
        self.write("Liver.stl", stl(*ball()))
        self.assertIn("rate:=0.25", commands[1])
        commands[1] = commands[1].replace("rate:=0.25", "rate:=1 rviz:=false")
        environment = dict(os.environ, XDG_CACHE_HOME=self.folder, ROS_HOME=self.folder, ROS_HOSTNAME="localhost")
        for command in commands:
            done = run("/bin/sh", "-c", command, cwd=self.folder, env=environment)
            self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(sorted(os.listdir(self.path("liver/plots"))), ["probe_force.png", "probe_friction.png"])
        forces = re.findall(r"^t .* force probe ([\d.]+) N", done.stdout, re.MULTILINE)  # one for each second
        self.assertGreater(max(map(float, forces), default=0.0), 0.0, done.stdout)

    @unittest.skipUnless(shutil.which("gmsh"), "the program gmsh is not installed")
    def test_a_manifest_has_every_mesh_and_what_filled_them(self):
        surface = self.write("a.stl", stl(*ball()))
        self.write("tool.stl", stl(*ball()))
        self.assertEqual(self.make(surface, "--scale", 0.001, "--cell-size", 0.008).returncode, 0)
        tool = "[{link: tip, shapes: [{mesh: {file: %s, scale: 1e-4}}]}]" % self.path("tool.stl")
        self.replay("--set", "instruments.probe.contact_links=" + tool, "--manifest", self.path("made.yaml"))
        with open(self.path("made.yaml"), encoding="utf-8") as stream:
            manifest = yaml.safe_load(stream)
        self.assertEqual(manifest["versions"]["gmsh"], run("gmsh", "--version").stdout.strip())
        files = {one["role"]: one["file"] for one in manifest["inputs"]}
        self.assertEqual((files["the scene's tissue mesh"], files["the scene's shape"]), (surface, self.path("tool.stl")))
        check = [sys.executable, os.path.join(SOURCE, "scripts", "check_manifest.py"), self.path("made.yaml")]
        self.assertIn("all as they were", run(*check).stdout)
        for name in ("a.stl", "tool.stl"):
            self.write(name, obj(*ball()))
        self.assertEqual(run(*check).stdout.count(".stl: has another content"), 2)

    @unittest.skipUnless(has_simulator(), "the package's Python module is not built")
    def test_tetrahedra_are_taken_as_they_are(self):
        hertz = 4.0 / 3.0 * 5400.0 / (1.0 - 0.45 ** 2) * math.sqrt(0.005) * 0.003 ** 1.5
        made = self.make(self.write("block.vtk", tetrahedra()), "--scale", 0.001, "--depth", 0.003)
        self.assertEqual(made.returncode, 0, made.stdout)
        with open(self.path("made/scene.yaml"), encoding="utf-8") as stream:
            tissue, = yaml.safe_load(stream)["tissues"]
        self.assertEqual(tissue["mesh"], {"file": self.path("block.vtk"), "scale_m_per_unit": 0.001})
        self.assertEqual(tissue["refinement"], "auto")
        self.assertEqual(tissue["fixed"], [{"plane": {"point_m": [0, 0, 0.006], "normal": [0, 0, 1]}}])
        forces, _ = self.replay()
        self.assertGreater(max(forces), 0.7 * hertz)  # at its rim half of the block is missing
        self.assertLess(max(forces), 1.3 * hertz)
        self.assertEqual(forces[-1], 0.0, "lifted")
        self.write("block.vtk", tetrahedra(ascending=True))  # as FEniCS numbers them
        again, said = self.replay()
        self.assertIn("96 of 192 tetrahedra are numbered the other way round, and turned", said)
        self.assertLess(max(abs(a - b) for a, b in zip(again, forces)), 0.02 * max(forces))

    @unittest.skipUnless(has_simulator(), "the package's Python module is not built")
    def test_an_organ_on_a_stalk_is_held_by_as_much_as_it_stands_on(self):
        # Leaning by .3 of its height, to either side: its middle is over none of its lowest 15 %. Upright it stands on them.
        def leaning(by, bent_over_mm=0.0):
            lines = tetrahedra().decode().splitlines()
            first = lines.index("CELLS 192 960") - 75
            for i in range(first, first + 75):
                x, y, z = map(float, lines[i].split())
                lines[i] = "%g %g %g" % (0.25 * x + by * 4.0 * z + (bent_over_mm if z > 30.0 else 0.0), 0.5 * y, 4.0 * z)
            return "\n".join(lines + [""]).encode()
        parts = {}
        for by in (0.0, 0.3, -0.3):
            self.assertEqual(self.make(self.write("leaning.vtk", leaning(by)), "--scale", 0.001).returncode, 0)
            with open(self.path("made/scene.yaml"), encoding="utf-8") as stream:
                tissue, = yaml.safe_load(stream)["tissues"]
            parts[by] = round(tissue["fixed"][0]["plane"]["point_m"][2] / 0.160, 3)
        self.assertEqual(parts, {0.0: 0.15, 0.3: 0.5, -0.3: 0.5})
        self.assertEqual(self.make(self.write("leaning.vtk", leaning(0.0, 200.0)), "--scale", 0.001).returncode, 0)
        with open(self.path("made/scene.yaml"), encoding="utf-8") as stream:
            self.assertIn("the lowest 60 % of its height: it may swing", stream.read())

    @unittest.skipUnless(has_simulator(), "the package's Python module is not built")
    def test_nodes_without_tetrahedra_are_left_out_and_said(self):
        made = self.make(self.write("block.vtk", tetrahedra([(0.0, 0.0, 500.0)])), "--scale", 0.001)
        self.assertEqual(made.returncode, 0, made.stdout)
        with open(self.path("made/scene.yaml"), encoding="utf-8") as stream:
            text = stream.read()
        self.assertIs(yaml.safe_load(text)["tissues"][0]["mesh"]["remove_unreferenced_nodes"], True)
        self.assertIn("it then is 0.08 x 0.08 x 0.04 m", text)

    @unittest.skipUnless(has_simulator(), "the package's Python module is not built")
    def test_what_holds_no_tetrahedra_is_refused_in_a_line(self):
        good = tetrahedra().decode()
        cases = {"cut.vtk": (good[:len(good) // 2], "cut.vtk"), "none.msh": ("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "none.msh"),
                 "other.msh": ("(1 \"of another program\")\n", "meshio convert FILE organ.vtk"),
                 "other.vtu": ("<VTKFile/>", "meshio convert FILE organ.vtk")}
        for name, (content, words) in cases.items():
            with self.subTest(name):
                made = self.make(self.write(name, content.encode()), "--scale", 0.001)
                self.assertEqual(made.returncode, 1, made.stdout)
                self.assertIn(name, made.stdout)
                self.assertIn(words, made.stdout)
                self.assertEqual(made.stdout.count("\n"), 1, made.stdout)
        made = self.make(self.write("two.vtk", tetrahedra(twice=True)), "--scale", 0.001)
        self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
        self.assertIn("2 separate parts, one of them around (0.04, 0.04, 0.12) m", made.stdout)
        made = self.make(self.write("new\nline.vtk", tetrahedra()), "--scale", 0.001)
        self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
        self.assertIn("rename it", made.stdout)
        made = run(sys.executable, os.path.join(SOURCE, "scripts", "make_scene.py"), self.write("block.vtk", tetrahedra()), "--out",
                   self.path("made"), env={key: value for key, value in os.environ.items() if key != "PYTHONPATH"})
        self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
        self.assertIn("scripts/env.bash", made.stdout)
        made = self.make(self.path("block.vtk"), "--scale", 1e9)
        self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
        self.assertNotIn("scene.yaml", made.stdout)
        made = self.make(self.write("block.vtk", tetrahedra()), "--scale", 0.001, "--cell-size", 0.01)
        self.assertIn("--cell-size is for surfaces", made.stdout)
        self.assertIn("is no file", self.make(self.path("nowhere.vtk")).stdout)

    @unittest.skipUnless(shutil.which("meshio") and has_simulator(), "meshio, or the package's Python module, is not installed")
    def test_tetrahedra_of_other_programs_are_converted_by_what_is_advised(self):
        self.write("block.vtk", tetrahedra())
        forces = {}
        for ending in ("vtu", "inp", "vtk"):
            if ending != "vtk":
                for command in ("block.vtk other." + ending, "other.%s organ.vtk" % ending):
                    done = run("/bin/sh", "-c", "meshio convert " + command, cwd=self.folder)
                    self.assertEqual(done.returncode, 0, done.stdout)
            made = self.make(self.path("block.vtk" if ending == "vtk" else "organ.vtk"), "--scale", 0.001)
            self.assertEqual(made.returncode, 0, made.stdout)
            forces[ending], _ = self.replay("--set", "tissues.0.refinement=never")
        self.assertGreater(max(forces["vtk"]), 0.0)
        self.assertEqual(forces["vtu"], forces["vtk"])
        self.assertEqual(forces["inp"], forces["vtk"])

    def test_units_are_asked_for(self):
        surface = self.write("a.stl", stl(*ball()))
        for scale in (1, 1e-6):
            made = self.make(surface, "--scale", scale)
            self.assertEqual(made.returncode, 1, made.stdout)
            self.assertIn("0.001 for millimetres", made.stdout)
        self.assertFalse(os.path.exists(self.path("made")))

    def test_what_is_no_surface_is_refused_in_a_line(self):
        vertices, triangles = ball()
        cases = {"no.stl": (b"", "no triangles"), "cut.stl": (stl(vertices, triangles)[:-70], "damaged"),
                 "pointer.stl": (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n", "git lfs pull"),
                 "empty.obj": (b"# nothing\n", "no triangles"), "far.obj": (b"v 0 0 0\nf 1 2 3\n", "not there"),
                 "cut.obj": (b"\n".join(obj(vertices, triangles).splitlines()[:-3] + [b"f 3"]),
                             "line %d has 1 numbers" % (len(vertices) + len(triangles) - 2)),
                 "half.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", "line 3 has 2 numbers"),
                 "words.obj": (b"v 0 0 0\nv one 0 0\n", "line 2: "),
                 "nan.obj": (b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
                 "cut.ply": (ply(vertices, triangles)[:-70], "damaged"),
                 "plain.ply": (b"ply\nelement vertex 0\nend_header\n", "no line 'format'"),
                 "far.ply": (b"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 1 1e30\n", "damaged"),
                 "long.ply": (b"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\ninf 0 1 2\n", "damaged"),
                 # Counted through, for as many seconds as there are ten millions.
                 "many.ply": (b"ply\nformat ascii 1.0\nelement edge 900000000000\nend_header\n", "it may be 0 to 58"),
                 "less.ply": (b"ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", "damaged"),
                 "other.vtp": (b"x", "endings")}
        for name, (content, words) in cases.items():
            with self.subTest(name):
                made = self.make(self.write(name, content), "--scale", 0.001)
                self.assertEqual(made.returncode, 1, made.stdout)
                self.assertIn(name, made.stdout)
                self.assertIn(words, made.stdout)
                self.assertEqual(made.stdout.count("\n"), 1, made.stdout)

    @unittest.skipUnless(shutil.which("gmsh"), "the program gmsh is not installed")
    def test_surfaces_as_some_programs_write_them(self):
        vertices, triangles = ball()
        text = "solid Leber gr\u00f6\u00dfe\n" + "".join(
            "facet normal 0 0 0\nouter loop\n%sendloop\nendfacet\n" % "".join("vertex %.9g %.9g %.9g\n" % vertices[v] for v in triangle)
            for triangle in triangles) + "endsolid\n"
        indefinite = text.replace("normal 0 0 0", "normal -1.#IND -nan(ind) 1.#QNAN")  # as Microsoft's compiler writes what is no number
        named = "\n \n" + text.replace("Leber", 2000 * "n")
        wavefront = obj(vertices, triangles)
        forces = []
        for name, content in {"a.stl": stl(vertices, triangles), "latin1.stl": text.encode("latin-1"), "utf8.stl": text.encode(), "capitals.stl": text.upper().encode(), "indefinite.stl": indefinite.encode(), "named.stl": named.encode(),
                              "comments.obj": wavefront.replace(b"\n", b" 0.1 0.2 0.3 1 # rgba\n", len(vertices)).replace(b"//1\n", b"//1 # comment\n"),
                              "more.stl": stl(vertices, triangles) + b"written by a program", "bom.obj": b"\xef\xbb\xbf# gr\xf6\xdfe\n" + wavefront,
                              "blank.obj": b"# with blank lines\n\n" + wavefront.replace(b"\nf", b"\n\nf", 1),
                              "probe.ply": ply(vertices, triangles), "1.3.6." + 20 * "12345." + "stl": stl(vertices, triangles)}.items():
            with self.subTest(name):
                made = self.make(self.write(name, content), "--scale", 0.001, "--cell-size", 0.012)
                self.assertEqual(made.returncode, 0, made.stdout)
                forces.append(max(self.replay("--duration", 0.8, "--set", "tissues.0.refinement=never")[0]))
                self.assertGreater(forces[-1], 0.0)
                self.assertAlmostEqual(forces[-1], forces[0], delta=0.01 * forces[0])  # coordinates in single precision or not
        made = self.make(self.path("a.stl"), "--scale", 4e-5, "--cell-size", 9e-5)  # which YAML 1.1 takes for a word
        self.assertEqual(made.returncode, 0, made.stdout)
        made = self.make(self.write("brain.obj", b"P 0.3 0.3 0.4 10 1 4\n0 0 0\n"), "--scale", 0.001)
        self.assertIn("MNI", made.stdout)
        made = self.make(self.write("organ.glb", b"glTF"), "--scale", 0.001)
        self.assertIn("as .stl", made.stdout)

    @unittest.skipUnless(shutil.which("gmsh") and has_simulator(), "gmsh, or the package's Python module, is not installed")
    def test_what_cannot_be_filled_is_refused_at_once(self):
        vertices, triangles = ball()
        made = self.make(self.write("open.stl", stl(vertices, triangles[:len(triangles) // 2])), "--scale", 0.001)
        self.assertEqual(made.returncode, 1, made.stdout)
        self.assertRegex(made.stdout, r"make_scene\.py: mesh file '.*open\.stl': it is open: ")
        self.assertFalse(os.path.exists(self.path("made/scene.yaml")))
        made = self.make(self.write("ball.stl", stl(vertices, triangles)), "--scale", 0.001)
        self.assertEqual(made.returncode, 0, made.stdout)
        self.assertIn("that mesh was kept as", self.replay("--duration", 0.1)[1])

    # Measured with the crumb, the ball started 41 mm higher and never came to the organ; or, with one below, nothing of it was held.
    @unittest.skipUnless(shutil.which("gmsh") and has_simulator(), "gmsh, or the package's Python module, is not installed")
    def test_crumbs_that_the_filling_drops_are_not_measured(self):
        vertices, triangles = ball()
        scenes = []
        for height in (None, 70.0, -90.0):
            crumb = [] if height is None else [(3.0 + x, y, height + z) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
            faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)] if crumb else []
            surface = obj(vertices + crumb, triangles + [tuple(len(vertices) + i for i in face) for face in faces])
            made = self.make(self.write("a.obj", surface), "--scale", 0.001, "--cell-size", 0.012)
            self.assertEqual(made.returncode, 0, made.stdout)
            self.assertEqual("dropped 1 loose part" in made.stdout, bool(crumb), made.stdout)
            with open(self.path("made/scene.yaml"), encoding="utf-8") as stream:
                scenes.append(yaml.safe_load(stream))
        for scene in scenes:
            self.assertAlmostEqual(scene["instruments"][0]["base_pose"]["position_m"][2], 0.040, delta=0.001)
            self.assertAlmostEqual(scene["tissues"][0]["fixed"][0]["plane"]["point_m"][2], -0.030 + 0.15 * 0.060, delta=0.001)

    def test_what_is_flat_is_no_organ(self):
        made = self.make(self.write("flat.obj", b"v 0 0 5\nv 90 0 5\nv 0 90 5\nf 1 2 3\n"), "--scale", 0.001)
        self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
        self.assertIn("flat, 0 m along z", made.stdout)

    # Written, exit code 0, and refused by the replay before; 200 mm deep into a ball of 60 mm.
    def test_material_and_depth_are_looked_at(self):
        surface = self.write("a.stl", stl(*ball()))
        for option, value, said in (("--material", "livre", '"livre"'), ("--depth", 0.2, "more than half of the organ's height, 0.06 m")):
            made = self.make(surface, "--scale", 0.001, option, value)
            self.assertEqual((made.returncode, made.stdout.count("\n")), (1, 1), made.stdout)
            self.assertIn(said, made.stdout)
        self.assertFalse(os.path.exists(self.path("made")))

    def test_an_edited_scene_is_kept(self):
        surface = self.write("a.stl", stl(*ball()))
        self.assertEqual(self.make(surface, "--scale", 0.001).returncode, 0)
        again = self.make(surface, "--scale", 0.001)
        self.assertNotIn(".before", again.stdout)
        with open(self.path("made/scene.yaml"), "a") as stream:
            stream.write("# mine\n")
        again = self.make(surface, "--scale", 0.001)
        self.assertIn("scene.yaml.before", again.stdout)
        with open(self.path("made/scene.yaml.before")) as stream:
            self.assertTrue(stream.read().endswith("# mine\n"))
        self.assertIn("scene.yaml.before1", self.make(surface, "--scale", 0.001, "--material", "kidney").stdout)
        with open(self.path("made/scene.yaml.before")) as stream:
            self.assertTrue(stream.read().endswith("# mine\n"))

    def test_no_folder_to_write_to(self):
        self.write("made", b"a file")
        made = self.make(self.write("a.stl", stl(*ball())), "--scale", 0.001)
        self.assertEqual(made.returncode, 1)
        self.assertIn("cannot write", made.stdout)


if __name__ == "__main__":
    SOURCE, PROGRAMS = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
