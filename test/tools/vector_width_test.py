#!/usr/bin/python3
"""The same bits with every vector width: replays with the kernels that this processor gets, and with narrower ones.

usage: vector_width_test.py SOURCE_DIRECTORY REPLAY CORE_LIBRARY PLAIN_KERNELS AVX2_KERNELS
PLAIN_KERNELS, AVX2_KERNELS: the kernels' sources compiled without TISSUE_CONTACT_CLONES, and without AVX-512; the dynamic linker puts
one before the core library.
"""
import itertools
import os
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = REPLAY = CORE = PLAIN = AVX2 = ""
DEADLINE_S = 300.0

# A stiffer part of the block, so that elements bring their own numbers.
REGION = "tissues.block.regions=[{name: stiff, where: [sphere: {center_m: [0, 0, 0.03], radius_m: 0.02}], " \
         "material: {youngs_modulus_pa: 8000}}]"
MATERIAL = "tissues.block.material."
PRONY = MATERIAL + "prony_series=[{modulus_ratio: 0.5, time_s: 0.1}]"
PATCH = MATERIAL + "dilatation=patch"
TIP = "instruments.probe.contact_links=[{link: tip, shapes: [{%s}]}]"


def run(command, **variables):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=DEADLINE_S, check=False, env={**os.environ, **variables})
    assert done.returncode == 0, done.stderr
    return done.stdout


def functions(library):
    """Names that a library gives to others: of functions, and of those among them that are chosen when it is loaded."""
    rows = [line.split() for line in run(["readelf", "--wide", "--dyn-syms", library]).splitlines()]
    rows = [row for row in rows if len(row) >= 8 and row[6] != "UND"]
    return {row[7] for row in rows if row[3] in ("FUNC", "IFUNC")}, {row[7] for row in rows if row[3] == "IFUNC"}


class VectorWidthTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def replay(self, name, arguments, **variables):
        """@return what the replay wrote."""
        csv = os.path.join(self.directory, name)
        run([REPLAY, *arguments, "--csv", csv], **variables)
        with open(csv, "rb") as stream:
            return stream.read()

    def octahedron(self, radius_m):
        """@return an STL file."""
        file = os.path.join(self.directory, "octahedron.stl")
        with open(file, "w", encoding="ascii") as stream:
            stream.write("solid octahedron\n")
            for x, y, z in itertools.product((-radius_m, radius_m), repeat=3):
                corners = [(x, 0, 0), (0, y, 0), (0, 0, z)]
                if x * y * z < 0:  # normals outwards
                    corners.reverse()
                stream.write("facet normal 0 0 0\nouter loop\n")
                stream.writelines("vertex %g %g %g\n" % corner for corner in corners)
                stream.write("endloop\nendfacet\n")
            stream.write("endsolid octahedron\n")
        return file

    def features(self):
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as stream:
            return set(stream.read().split())

    def bound(self):
        """(from, to, function) as the dynamic linker found each function when it was first called."""
        pattern = re.compile(r"binding file (\S+) \[\d+\] to (\S+) \[\d+\]: normal symbol `(\w+)'")
        found = set()
        for name in os.listdir(self.directory):
            if name.startswith("bindings."):
                with open(os.path.join(self.directory, name), encoding="utf-8", errors="replace") as stream:
                    found |= {tuple(map(os.path.basename, match.groups())) for match in map(pattern.search, stream) if match}
        return found

    def test_the_same_bits_with_plain_kernels(self):
        if "avx2" not in self.features():
            self.skipTest("this processor has no AVX2: both replays would run the same kernels")
        self.assertFalse(functions(PLAIN)[1])
        self.compare(PLAIN)

    def test_the_same_bits_without_avx512(self):
        if not {"avx512vl", "avx512_vbmi2"} <= self.features():
            self.skipTest("this processor has no AVX-512: both replays would run the same kernels")
        self.assertEqual(functions(AVX2)[1], functions(CORE)[1])
        self.compare(AVX2)

    def compare(self, library):
        chosen = functions(CORE)[1]
        narrower = functions(library)[0]
        self.assertTrue(chosen)
        self.assertLessEqual(chosen, narrower)

        demo = ["--scene", SOURCE + "/config/press_drag.yaml", "--bag", SOURCE + "/config/press_drag.bag"]
        press = [*demo, "--from", "0.5", "--duration", "0.5"]
        replays = {
            "demo": demo,
            "averaged": [*press, "--set", PATCH],
            "regions": [*press, "--set", REGION, "--set", PATCH],
            "neo-Hookean": [*press, "--set", MATERIAL + "model=neo_hookean", "--set", PATCH],
            "neo-Hookean patches": [*press, "--set", MATERIAL + "model=neo_hookean", "--set", MATERIAL + "distortion=auto"],
            "neo-Hookean regions": [*press, "--set", MATERIAL + "model=neo_hookean", "--set", REGION],
            "linear": [*press, "--set", MATERIAL + "model=linear"],
            "linear regions": [*press, "--set", MATERIAL + "model=linear", "--set", REGION],
            "viscoelastic": [*press, "--set", PRONY],
            "viscoelastic regions": [*press, "--set", PRONY, "--set", REGION],
            "refined": [*press, "--set", "tissues.block.refinement=auto"],
            "slow": [*press, "--set", MATERIAL + "poissons_ratio=0.499", "--set", "solver.tolerance=1e-6", "--set", "solver.iterations=60"],
            "box": [*press, "--set", TIP % "box: {size_m: [0.008, 0.008, 0.01]}"],
            "mesh": [*press, "--set", TIP % "mesh: {file: %s}" % self.octahedron(0.005)],
        }
        results = set()
        for name, arguments in replays.items():
            expected = self.replay(name + ".csv", arguments)
            results.add(expected)
            with self.subTest(replay=name):
                self.assertTrue(self.replay(name + " narrower.csv", arguments, LD_PRELOAD=library, LD_DEBUG="bindings",
                                            LD_DEBUG_OUTPUT=os.path.join(self.directory, "bindings")) == expected)
        self.assertEqual(len(results), len(replays), "each goes another way, so that all of them touch")
        core, kernels = os.path.basename(CORE), os.path.basename(library)
        bound = self.bound()
        called = {function for start, end, function in bound if start in (core, kernels) and end == kernels}
        self.assertEqual(chosen - called, set(), "kernels that no replay ran")
        for room in ("BodySweep", "CoarseMotions"):
            self.assertTrue([name for name in called if room in name], "its kernels are called by itself alone")
        self.assertEqual({function for _, end, function in bound if end == core and function in narrower}, set())


if __name__ == "__main__":
    SOURCE, REPLAY, CORE, PLAIN, AVX2 = sys.argv[1:6]
    unittest.main(argv=sys.argv[:1], verbosity=2)
