#!/usr/bin/python3
"""Runs tissue_contact_solve as a user would: on every contact problem in a file, ours and shared ones, and on bad input.

usage: solve_test.py PROGRAM SHARED_DATA
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, DATA = "", pathlib.Path()
ONE_CONTACT = "FC3D 1\nn 1\nW dense\n.5 0 0  0 .5 0  0 0 .5\nq -1 1.2 1.6\nmu .5\n"


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=250)


def tokens(text):
    return [token for line in text.splitlines() for token in line.split("#")[0].split()]


def numbers(text, name, count):
    """What a reader of solution files reads: `count` numbers after the first `name`."""
    words = tokens(text)
    start = words.index(name) + 1
    return [float(word) for word in words[start : start + count]]


class SolveTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.file = pathlib.Path(directory.name) / "problem.txt"
        self.file.write_text(ONE_CONTACT, encoding="ascii")

    def assert_refused(self, arguments, *words):
        done = run(*arguments)
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(done.stdout, "")
        for word in words:
            self.assertIn(word, done.stderr)

    def test_text(self):
        done = run(self.file)
        self.assertEqual(done.returncode, 0, done)
        for value, expected in zip(numbers(done.stdout, "r", 3), (2, -0.6, -0.8)):
            self.assertAlmostEqual(value, expected, delta=1e-14)
        for value, expected in zip(numbers(done.stdout, "u", 3), (0, 0.9, 1.2)):
            self.assertAlmostEqual(value, expected, delta=1e-14)
        self.assertEqual(tokens(done.stdout)[-2:], ["states", "kinetic"])
        for name in ("scaled_natural_map", "penetration", "adhesion", "complementarity", "cone_violation",
                     "dissipation_defect", "friction_power", "kinetic_angle", "static_slip", "time_s", "iterations"):
            self.assertIn("# " + name, done.stdout)

    def test_json(self):
        answer = json.loads(run(self.file, "--json", "--solver", "reference").stdout)
        self.assertTrue(answer["converged"])
        self.assertEqual(answer["states"], ["kinetic"])
        self.assertAlmostEqual(answer["r"][0], 2, delta=1e-14)
        self.assertLessEqual(answer["residuals"]["scaled_natural_map"], 1e-10)

    def test_tolerance_decides_the_exit_code(self):
        self.assertEqual(run(self.file, "--solver", "polyhedral").returncode, 1)
        self.assertEqual(run(self.file, "--solver", "polyhedral", "--tolerance", "0.1").returncode, 0)
        self.assertEqual(run(self.file, "--solver", "polyhedral", "--tolerance", "0.015").returncode, 1)
        self.assertEqual(run(self.file, "--solver", "polyhedral", "--sides", "64", "--tolerance", "0.015").returncode, 0)

    def test_help(self):
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        for word in ("--solver", "--tolerance", "--iterations", "--json", "predictor_corrector", "Exit code"):
            self.assertIn(word, done.stdout)

    def test_bad_usage(self):
        self.assert_refused([], "no problem file")
        self.assert_refused([self.file, self.file], "more than one")
        self.assert_refused([self.file, "--bogus"], "--bogus")
        self.assert_refused([self.file, "--solver"], "needs a value")
        self.assert_refused([self.file, "--solver", "magic"], "magic", "predictor_corrector")
        self.assert_refused([self.file, "--solver", "impulse"], "impulse", "step")
        for value in ("0", "-1", "nan", "inf", "x", ""):
            self.assert_refused([self.file, "--tolerance", value], "tolerance")
        for value in ("0", "-5", "1.5", "99999999999999"):
            self.assert_refused([self.file, "--iterations", value], "iterations")
        for value in ("3", "5", "66"):
            self.assert_refused([self.file, "--solver", "polyhedral", "--sides", value], "sides", value)
        for solver in ([], ["--solver", "reference"], ["--solver", "cone4"]):
            self.assert_refused([self.file, "--sides", "16", *solver], "--sides does not go with --solver")

    def test_bad_files(self):
        self.assert_refused([self.file.parent / "absent.txt"], "absent.txt")
        self.assert_refused([self.file.parent], str(self.file.parent))
        self.file.write_text(ONE_CONTACT.replace("-1", "nan"), encoding="ascii")
        self.assert_refused([self.file], "line 5", "nan")
        self.file.write_bytes(bytes(range(256)))
        self.assert_refused([self.file], "problem.txt", "line 1")
        self.file.write_text("FC3D 1 n 3000 W sparse 0", encoding="ascii")
        self.assert_refused([self.file], "long enough")

    def test_problems_in_files(self):
        own = pathlib.Path(__file__).resolve().parent.parent / "data"
        problems = [path for data in (own, DATA) for path in sorted((data / "contact_problems").glob("*.txt"))
                    if ".sol." not in path.name]
        self.assertGreaterEqual(len(problems), 8)
        for problem in problems:
            for solver, tolerance in (("predictor_corrector", 1e-8), ("reference", 1e-10)):
                with self.subTest(problem=problem.name, solver=solver):
                    done = run(problem, "--solver", solver)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    reached = [line.split()[-1] for line in done.stdout.splitlines() if "scaled_natural_map" in line]
                    self.assertLessEqual(float(reached[0]), tolerance)
                    count = 3 * int(tokens(done.stdout)[1])
                    self.assertTrue(all(math.isfinite(x) for x in numbers(done.stdout, "r", count)))
                    self.accepted_by_others(problem, done.stdout)

    def accepted_by_others(self, problem, text):
        """The judge that comes with the shared data knows nothing of this package; it needs numpy."""
        judge = DATA.parent / "tools" / "check_contact_solution.py"
        if not judge.exists():
            return
        solution = self.file.parent / "solution.txt"
        solution.write_text(text, encoding="ascii")
        done = subprocess.run([sys.executable, judge, problem, solution], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    DATA = pathlib.Path(sys.argv.pop())
    PROGRAM = sys.argv.pop()
    unittest.main()
