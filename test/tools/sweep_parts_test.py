#!/usr/bin/python3
"""Parts of sweeps, without replays: what a study may say, what is measured, how variants become jobs.

usage: sweep_parts_test.py SOURCE_DIRECTORY
"""
import math
import os
import shutil
import sys
import tempfile
import unittest
from unittest import mock


class StudyTest(unittest.TestCase):
    """Study files without replays."""

    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.directory)
        for name in ["a.bag", "b.bag", "s.yaml"]:
            self.write(name, "x")

    def write(self, name, text):
        file = os.path.join(self.directory, name)
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(text)
        return file

    def study(self, text):
        from study import Study
        return Study(self.write("study.yaml", text if text.startswith("!") else "bags: [a.bag]\nscenes: [s.yaml]\n" + text))

    def test_variants_are_all_combinations_in_order(self):
        study = self.study("set: {world_frame: room}\ncases: [{step.max_step_s: 0.001}, {step.max_step_s: 2e-3}]\n"
                           "grid:\n  a.b: {from: 1, to: 100, count: 3, spacing: log}\n  a.c: [[1, 2], linear, true]\n")
        self.assertEqual(study.count(), 18)
        self.assertEqual(study.keys(), ["step.max_step_s", "a.b", "a.c"])
        variants = [one.arguments() for one in study.variants()]
        self.assertEqual(len(variants), 18)
        self.assertEqual(variants[0], ["--set=world_frame=room", "--set=step.max_step_s=0.001", "--set=a.b=1.0", "--set=a.c=[1, 2]"])
        self.assertEqual(variants[-1], ["--set=world_frame=room", "--set=step.max_step_s=2e-3", "--set=a.b=100.0", "--set=a.c=true"])
        self.assertAlmostEqual(float(variants[3][2].rpartition("=")[2]), 10.0, delta=1e-12)

    def test_patterns_choose_bags(self):
        study = self.study("").__class__(self.write("p.yaml", "bags: ['*.bag']\nscenes: [s.yaml, package://p/s.yaml]\n"))
        self.assertEqual([os.path.basename(bag) for bag in study.bags], ["a.bag", "b.bag"])
        self.assertEqual(study.count(), 4)
        uri = "package://tissue_contact/urdf/probe.urdf"
        self.assertEqual(self.study("replay: {urdf: '%s'}\n" % uri).options, ["--urdf=" + uri])

    def test_a_latin_hypercube_has_one_sample_in_each_part_of_each_range(self):
        text = "latin_hypercube: {samples: 20, seed: %d, ranges: {a: {from: 1, to: 3}, b: {from: 1, to: 1e4, spacing: log}}}\n"
        points = [[float(value) for _, value in one.settings] for one in self.study(text % 7).variants()]
        self.assertEqual(sorted(int((a - 1) / 2 * 20) for a, _ in points), list(range(20)))
        self.assertEqual(sorted(int(math.log10(b) / 4 * 20) for _, b in points), list(range(20)))
        self.assertEqual(points, [[float(value) for _, value in one.settings] for one in self.study(text % 7).variants()])
        self.assertNotEqual(points, [[float(value) for _, value in one.settings] for one in self.study(text % 8).variants()])

    def test_what_is_wrong_is_named(self):
        from study import StudyError
        for text, problem in [
                ("grids: {}", 'grids: unknown key; did you mean "grid"? allowed here: bags, '), ("grid: {a: 3}", "grid.a: is 3; it must be a list"),
                ("grid: {a: {from: 1, to: 0, count: 3}}", 'grid.a: "from" is 1 and "to" is 0'), ("grid: {a: {from: 1, to: 2}}", 'grid.a: required key "count"'),
                ("grid: {a: {from: 0, to: 2, count: 2, spacing: log}}", "grid.a.from: is 0; it must be above 0"),
                ("grid: {a: {from: 1, to: 2, count: 2.5}}", "grid.a.count: is 2.5; it must be a whole number from 2 to"),
                ("grid: {a: [.nan]}", "grid.a[0]: is NaN"), ("grid: {a: [1]}\nset: {a: 1}", "a: is in two of set, cases, grid"),
                ("grid: {a: {from: 1, to: 2, count: 2000}, b: {from: 1, to: 2, count: 2000}}", "has 4000000 variants; at most 1000000"),
                ("latin_hypercube: {samples: 3, ranges: {}}", 'latin_hypercube: required key "seed" is missing'),
                ("latin_hypercube: {samples: 0, seed: 1, ranges: {}}", "latin_hypercube.samples: is 0; it must be a whole number from 1"),
                ("replay: {duration: 3}", 'replay.duration: unknown key; did you mean "duration_s"?'), ("replay: {from_s: -1}", "replay.from_s: is -1; it"),
                ("keep_csv: 3", "keep_csv: is 3"), ("set: {'': 1}", "it must be one of a scene"), ("set: {a: 1, a: 2}", "the key a is given twice"),
                ("set: &s {a: *s}", "aliases (*name) are not allowed"), ("set: [", "is no YAML"), ("bags: [none.bag]", "the key bags is given twice"),
                ("set: " + "[" * 3000, "is no YAML"), ("cases: [{a: null}]", "cases[0].a: is null"), ("set: {a: 2020-01-01}", "write dates and the like")]:
            with self.assertRaises(StudyError, msg=text) as caught:
                self.study(text)
            self.assertIn("study.yaml: ", str(caught.exception))
            self.assertIn(problem, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        for text, problem in [("[]", "it must be a map"), ("bags: [a.bag]", 'required key "scenes"'), ("bags: [no.bag]\nscenes: [s.yaml]", "there is no such file"),
                              ("bags: [.]\nscenes: [s.yaml]", "is no regular file"), ("x" * (1 << 20) + "x", "has more than")]:
            with self.assertRaises(StudyError, msg=text[:50]) as caught:
                self.study("").__class__(self.write("bad.yaml", text))
            self.assertIn(problem, str(caught.exception))


class MeasuresTest(unittest.TestCase):
    HEAD = ("stamp_s,instrument,force_x_n,force_y_n,force_z_n,torque_x_nm,torque_y_nm,torque_z_nm,static_contacts,kinetic_contacts,discarded,jumped,"
            "implausible_load,inverted_elements,force_error_n,solver_error_n,simulated_s")

    def test_of_a_force_that_is_known(self):
        from replays import measured
        lines = [self.HEAD]
        states = [(0, 0), (2, 0), (1, 1), (0, 2), (0, 2), (1, 0), (0, 1), (0, 0)]  # slips where none holds any more: twice
        for i, (held, sliding) in enumerate(states):
            force = 5.0 if held or sliding else 0.0
            stamp = 1700000000 + 0.1 * i + (3600 if i > 3 else 0)  # a pause, which is simulated as .1 s
            lines.append("%.9f,probe,%g,%g,0,0,0,%g,%d,%d,0,0,0,0,0.2,0.1,%.17g" % (stamp, 0.6 * force, 0.8 * force, 0.01 * force, held, sliding, 0.1 * i))
        result = measured("\n".join(lines) + "\n")["probe"]
        for name, value in {"peak_force_n": 5.0, "mean_force_n": 5.0, "impulse_n_s": 3.0, "peak_torque_nm": 0.05, "angular_impulse_nm_s": 0.03,
                            "contact_time_s": 0.6, "slips": 2, "likely_error_n": 0.2, "solver_error_n": 0.1, "discarded": 0}.items():
            self.assertAlmostEqual(result[name], value, delta=1e-9, msg=name)

    def test_forces_that_are_not_to_be_trusted_are_told(self):
        """The table had nothing of 85 intervals with forces that no tissue bears."""
        from replays import MEASURES, measured
        from table import doubts_text
        lines = [self.HEAD]
        # Without a step (the same time) a row repeats what was told.
        for simulated_s, doubts in [(0, "0,0,0,0"), (1, "0,1,1,12"), (1, "0,0,1,12"), (2, "0,0,1,0"), (3, "1,0,1,3"), (4, "0,0,0,0")]:
            lines.append("%d,probe,0,0,0,0,0,0,0,1,%s,0,0,%d" % (simulated_s, doubts, simulated_s))
        bad = measured("\n".join(lines) + "\n")
        for name, value in {"discarded": 1, "jumped": 1, "implausible_load": 3, "inverted_elements": 2}.items():
            self.assertEqual(bad["probe"][name], value, name)
            self.assertIn(name, MEASURES)
        good = measured("\n".join([self.HEAD, lines[1], lines[-1]]) + "\n")
        keyed = [("a", None), ("b", None), ("c", None), ("b", None)]
        results = {"a": {"instruments": good}, "b": {"instruments": bad}, "c": {"error": "no such bag"}}
        self.assertIn("2 of 4 variants have forces that are not to be trusted", doubts_text(keyed, results))
        self.assertIn("the first: variant 1;", doubts_text(keyed, results))
        self.assertEqual(doubts_text(keyed[:1] + keyed[2:3], results), "")


class ReplayerTest(unittest.TestCase):
    def test_what_could_not_be_written_is_tried_again(self):
        from replays import Replayer, result_of
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(folder, "replay")
            with open(program, "w", encoding="utf-8") as stream:
                stream.write("#!/bin/sh\nread -r line; printf 'broken\\t0.1\\tno space\\n'; read -r line; printf 'failed\\t0.1\\tno such scene\\n'\n")
            os.chmod(program, 0o755)
            with Replayer(program) as replayer:
                self.assertEqual(result_of(replayer, [], os.path.join(folder, "a.csv")), {"crashed": "no space"})
                self.assertEqual(result_of(replayer, [], os.path.join(folder, "b.csv")), {"error": "no such scene", "cpu_time_s": 0.1})


class JobsTest(unittest.TestCase):
    def test_results_that_a_job_gives_their_name_meanwhile(self):
        """As they are about to be opened, after a look whether they are there."""
        from replays import read_results
        with tempfile.TemporaryDirectory() as folder, mock.patch("os.path.exists", return_value=True):
            file = os.path.join(folder, "0001-00000.jsonl")
            with open(file, "w", encoding="utf-8") as stream:
                stream.write('{"key": "a"}\n{"key": "b')
            self.assertEqual(read_results(file + ".part"), {"a": {"key": "a"}})

    def test_no_study_becomes_more_jobs_than_a_cluster_takes(self):
        from sweep import per_job
        for variants in (1, 9, 1000, 100000, 1000000):
            for wanted in (None, 1, 7, 2000):
                each = per_job(variants, wanted)
                self.assertLessEqual(math.ceil(variants / each), 4000)
                self.assertTrue(wanted is None or each >= wanted)
        self.assertEqual(math.ceil(100000 / per_job(100000, None)), 100)


if __name__ == "__main__":
    sys.path.insert(0, os.path.join(sys.argv[1], "sweep"))
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
