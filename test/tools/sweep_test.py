#!/usr/bin/python3
"""Sweeps: that a killed or shuffled sweep has the same answers, and that only what is new is run. Their parts alone: sweep_parts_test.py.

usage: sweep_test.py SOURCE_DIRECTORY PROGRAM_DIRECTORY      (in the environment of the package: PROGRAM_DIRECTORY/../../env.sh)
"""
import csv
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

SOURCE, PROGRAMS = "", ""
DEADLINE_S = 600.0  # for a machine that has more to do
TIMES = ["cpu_time_s"]  # of a table: what is not the same each time


def good_study(**more):
    return dict({"bags": ["press.bag"], "scenes": ["press.yaml"]}, **more)


class SweepTest(unittest.TestCase):
    """Of whole sweeps of a small press, as users run them."""

    GRID = {"tissues.block.material.youngs_modulus_pa": [3000, 5000, 8000, 12000], "friction.0.static": {"from": 0.45, "to": 0.9, "count": 3}}

    def setUp(self):
        sys.path.insert(0, os.path.join(SOURCE, "test", "ros"))
        import harness  # needs the package's environment
        self.directory = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.directory)
        harness.write_bag(self.path("press.bag"), harness.press(20))
        shutil.copy(harness.SCENE, self.path("press.yaml"))

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def write_study(self, **study):
        import yaml
        with open(self.path("study.yaml"), "w", encoding="utf-8") as stream:
            yaml.safe_dump(good_study(**study), stream, sort_keys=False)

    def start(self, *arguments, path=None):
        """path: a folder in which Python looks first."""
        environment = dict(os.environ, TISSUE_CONTACT_REPLAY=os.path.join(PROGRAMS, "tissue_contact_replay"))
        if path:
            environment["PYTHONPATH"] = os.pathsep.join([path, environment.get("PYTHONPATH", "")])
        return subprocess.Popen(["/usr/bin/python3", os.path.join(SOURCE, "sweep", "sweep.py"), self.path("study.yaml"), *arguments], env=environment,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)

    def sweep(self, *arguments, code=0, path=None):
        process = self.start(*arguments, path=path)
        output = process.communicate(timeout=DEADLINE_S)[0]
        self.assertEqual(process.returncode, code, output)
        return output

    def table(self, folder="study"):
        with open(self.path(folder, "table.csv"), newline="", encoding="utf-8") as stream:
            return [{name: value for name, value in row.items() if name not in TIMES} for row in csv.DictReader(stream)]

    def test_workers_and_order_change_nothing(self):
        self.write_study(grid=self.GRID)
        self.sweep("--jobs=1")
        rows = self.table()
        self.assertEqual(len(rows), 12)
        self.assertEqual(len({row["sha256"] for row in rows}), 12)
        stiffer = [float(row["peak_force_n"]) for row in rows if row["friction.0.static"] == "0.45"]
        self.assertEqual(stiffer, sorted(stiffer))
        for arguments in [["--jobs=2", "--out", self.path("two")], ["--jobs=2", "--shuffle=3", "--out", self.path("shuffled")]]:
            self.sweep(*arguments)
            self.assertEqual(self.table(os.path.basename(arguments[-1])), rows)
        self.assertTrue(os.path.getsize(self.path("study", "table.png")) > 10000)
        bare = [os.path.join(PROGRAMS, "tissue_contact_replay"), "--scene", self.path("press.yaml"), "--bag", self.path("press.bag"),
                "--set", "tissues.block.material.youngs_modulus_pa=8000", "--set", "friction.0.static=0.9", "--csv", self.path("bare.csv")]
        subprocess.run(bare, check=True, stderr=subprocess.DEVNULL, timeout=DEADLINE_S)
        with open(self.path("bare.csv"), "rb") as stream:
            expected = hashlib.sha256(stream.read()).hexdigest()
        self.assertEqual([expected], [row["sha256"] for row in rows if row["tissues.block.material.youngs_modulus_pa"] == "8000" and
                                      row["friction.0.static"] == "0.9"])

    def start_and_wait(self, until=15):
        """A sweep of 120 variants, of which some are done."""
        grid = dict(self.GRID, **{"friction.0.static": {"from": 0.45, "to": 0.9, "count": 30}})
        self.write_study(grid=grid, variants_per_job=40)
        process = self.start("--jobs=2")
        self.wait_until(lambda: self.finished() >= until or process.poll() is not None)
        self.assertIsNone(process.poll(), "ended before it was killed")
        return process

    def wait_until(self, condition):
        deadline = time.monotonic() + DEADLINE_S
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def goes_on(self):
        """The same command does what is left, once, to the table of a sweep that nobody killed."""
        before = self.finished()
        self.assertTrue(15 <= before < 120, before)
        self.assertRegex(self.sweep("--jobs=2"), "120 variants, [1-9][0-9]+ of them done before")
        self.assertEqual(self.finished(), 120)  # none was run twice
        rows = self.table()
        self.sweep("--jobs=1", "--out", self.path("whole"))
        self.assertEqual(self.table("whole"), rows)

    def test_a_killed_sweep_goes_on_where_it_was(self):
        process = self.start_and_wait()
        process.send_signal(signal.SIGTERM)
        self.assertIn("the same command goes on", process.communicate(timeout=DEADLINE_S)[0])
        self.goes_on()

    @staticmethod
    def engine_of(process):
        """Snakemake's process, which leads a group with all jobs and replays."""
        return int(subprocess.run(["ps", "-o", "pid=", "--ppid", str(process.pid)], check=True, stdout=subprocess.PIPE, timeout=DEADLINE_S).stdout)

    def test_all_of_it_killed_at_once(self):
        """By SIGKILL, which nobody can answer."""
        process = self.start_and_wait()
        engine = self.engine_of(process)
        process.kill()
        os.killpg(engine, signal.SIGKILL)
        process.communicate(timeout=DEADLINE_S)
        self.assertFalse(os.path.exists(self.path("study", "table.csv")))
        self.goes_on()

    def test_what_a_killed_sweep_leaves_running_is_waited_for(self):
        process = self.start_and_wait()
        engine = self.engine_of(process)
        os.killpg(engine, signal.SIGSTOP)  # so that it does not end before we look
        self.addCleanup(self.end_group, engine)
        process.kill()
        process.communicate(timeout=DEADLINE_S)
        self.assertIn("another sweep still runs in", self.sweep(code=1))
        os.killpg(engine, signal.SIGCONT)
        self.wait_until(lambda: self.finished() == 120)
        self.wait_until(lambda: "another sweep still runs in" not in self.start("--dry-run").communicate(timeout=DEADLINE_S)[0])
        self.assertIn("120 variants, 120 of them done before", self.sweep())
        self.assertEqual(len(self.table()), 120)

    @staticmethod
    def end_group(group):
        try:
            os.killpg(group, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def test_jobs_whose_engine_was_killed_go_on_beside_the_next_sweep(self):
        """Twice done is done: the same results."""
        process = self.start_and_wait()
        os.kill(self.engine_of(process), signal.SIGKILL)
        self.assertIn("The same command tries them again", process.communicate(timeout=DEADLINE_S)[0])
        self.sweep("--jobs=2")
        rows = self.table()
        self.sweep("--jobs=1", "--out", self.path("whole"))
        self.assertEqual(self.table("whole"), rows)

    def test_csv_files_are_kept_of_what_was_done_before_as_well(self):
        self.write_study(grid={"friction.0.kinetic": [0.2, 0.3, 5.0]})
        self.sweep()
        rows = self.table()
        self.assertEqual(os.listdir(self.path("study", "csv")), [])
        self.write_study(grid={"friction.0.kinetic": [0.2, 0.3, 5.0]}, keep_csv=True)
        self.assertIn("3 variants, 2 to be run", self.sweep("--dry-run"))
        self.assertIn("3 variants, 1 of them done before", self.sweep())  # a refused one has no CSV
        self.assertEqual(self.table(), rows)
        for row in rows[:2]:
            with open(self.path("study", "csv", row["key"] + ".csv"), "rb") as stream:
                self.assertEqual(hashlib.sha256(stream.read()).hexdigest(), row["sha256"])
        self.assertIn("3 variants, 3 of them done before", self.sweep())

    def finished(self):
        """Lines of results."""
        folder = self.path("study", "results")
        count = 0
        for name in os.listdir(folder) if os.path.isdir(folder) else []:
            if name.endswith((".jsonl", ".part")):
                try:
                    with open(os.path.join(folder, name), "rb") as stream:
                        count += stream.read().count(b"\n")
                except FileNotFoundError:  # given its name meanwhile
                    pass
        return count

    def test_only_what_is_new_is_run(self):
        self.write_study(grid=dict(self.GRID))
        self.sweep()
        first = self.table()
        self.assertIn("12 variants, 12 of them done before", self.sweep())
        self.assertEqual(self.finished(), 12)
        self.write_study(grid=dict(self.GRID, **{"tissues.block.material.youngs_modulus_pa": [3000, 4000, 8000]}))
        self.assertIn("9 variants, 6 of them done before", self.sweep())
        self.assertEqual(self.finished(), 15)
        self.assertEqual([row["sha256"] for row in self.table() if row["tissues.block.material.youngs_modulus_pa"] == "8000"],
                         [row["sha256"] for row in first if row["tissues.block.material.youngs_modulus_pa"] == "8000"])
        with open(self.path("press.yaml"), "a", encoding="utf-8") as stream:
            stream.write("# changed\n")
        self.assertIn("9 variants, 0 of them done before", self.sweep())

    def test_a_part_of_a_recording_may_begin_between_its_joint_states(self):
        self.write_study(replay={"from_s": 0.015, "duration_s": 0.1})
        self.sweep()
        row, = self.table()
        self.assertGreater(float(row["contact_time_s"]), 0.0)
        self.assertEqual(row["error"], "")
        self.write_study(replay={"from_s": 1000})
        self.assertIn("1 variants were refused, the first: --from 1000", self.sweep())

    def test_a_first_joint_state_of_another_robot_ends_no_sweep(self):
        import harness
        other = harness.joint_state(harness.rospy.Time(harness.START_S - 1), [0.0], ["gripper"])
        samples = [(harness.TOPIC, harness.joint_state(*sample), sample[0]) for sample in harness.press(20)]
        harness.write_messages(self.path("press.bag"), [(harness.TOPIC, other, other.header.stamp)] + samples)
        self.write_study()
        self.sweep()
        self.assertGreater(float(self.table()[0]["contact_time_s"]), 0.0)
        harness.write_messages(self.path("press.bag"), [(harness.TOPIC, other, other.header.stamp)])
        self.assertIn("no joint state of bag '%s' was accepted" % self.path("press.bag"), self.sweep(code=1))

    def test_a_bag_that_cannot_be_read_is_for_the_table_wherever_it_stands(self):
        with open(self.path("press.bag"), "rb") as stream:
            content = stream.read()
        with open(self.path("cut.bag"), "wb") as stream:
            stream.write(content[:len(content) // 2])
        for bags in (["cut.bag", "press.bag"], ["press.bag", "cut.bag"]):
            self.write_study(bags=bags)
            self.assertIn("1 variants were refused, the first: bag '%s': " % self.path("cut.bag"), self.sweep())
            self.assertEqual([row["error"] == "" for row in self.table()], [bag == "press.bag" for bag in bags])
        self.write_study(bags=["cut.bag"])
        self.assertIn("sweep: %s: bag '%s': " % (self.path("study.yaml"), self.path("cut.bag")), self.sweep(code=1))

    def test_without_pyarrow_there_is_a_line_and_the_same_table(self):
        self.write_study(grid={"friction.0.kinetic": [0.2, 0.3]})
        os.mkdir(self.path("without"))
        with open(self.path("without", "pyarrow.py"), "w", encoding="utf-8") as stream:
            stream.write("raise ImportError('it was left out')\n")
        os.mkdir(self.path("study"))
        with open(self.path("study", "table.parquet"), "w", encoding="utf-8") as stream:
            stream.write("of an older table")
        output = self.sweep(path=self.path("without"))
        self.assertEqual(output.count("pyarrow"), 1, output)
        self.assertIn("sweep: no table.parquet, which takes pyarrow: it was left out", output)
        self.assertEqual(len(self.table()), 2)
        self.assertFalse(os.path.exists(self.path("study", "table.parquet")))

    def test_with_pyarrow_the_table_is_there_as_parquet(self):
        try:
            from pyarrow import parquet
        except ImportError as error:
            self.skipTest("Python has no pyarrow: %s" % error)
        self.write_study(grid={"friction.0.kinetic": [0.2, 0.3, 5.0]})
        self.sweep()
        with open(self.path("study", "table.csv"), newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        table = parquet.read_table(self.path("study", "table.parquet")).to_pydict()
        self.assertEqual(list(table), list(rows[0]))
        for name in ("key", "sha256", "error"):
            self.assertEqual(table[name], [row[name] for row in rows])
        for name in ("friction.0.kinetic", "peak_force_n"):
            self.assertEqual(table[name], [float(row[name]) if row[name] else None for row in rows])

    @unittest.skipUnless(shutil.which("gmsh"), "the program gmsh is not installed")
    def test_another_gmsh_makes_other_meshes(self):
        from organ_test import ball, stl
        with open(self.path("ball.stl"), "wb") as stream:
            stream.write(stl(*ball()))  # of 30 mm
        with open(self.path("press.yaml"), encoding="utf-8") as stream:
            text = stream.read()
        block = "block: {size_m: [0.06, 0.06, 0.02], cells: [6, 6, 2]}"
        self.assertIn(block, text)
        with open(self.path("press.yaml"), "w", encoding="utf-8") as stream:
            stream.write(text.replace(block, "mesh: {file: ball.stl, scale_m_per_unit: 0.001, cell_size_m: 0.02}\n    pose: {position_m: [0, 0, -0.01]}"))
        self.write_study()
        self.sweep()
        self.assertIn("1 variants, 1 of them done before", self.sweep())
        os.mkdir(self.path("bin"))
        with open(self.path("bin", "gmsh"), "w", encoding="utf-8") as stream:
            stream.write('#!/bin/sh\n[ "$1" = --version ] && echo 99.0.1 || exec %s "$@"\n' % shutil.which("gmsh"))
        os.chmod(self.path("bin", "gmsh"), 0o755)
        with mock.patch.dict(os.environ, PATH=self.path("bin") + os.pathsep + os.environ["PATH"]):
            self.assertIn("1 variants, 0 of them done before", self.sweep())

    def test_verify_finds_another_answer(self):
        self.write_study(grid=dict(self.GRID))
        self.assertIn("nothing to verify", self.sweep("--verify", code=1))
        self.sweep()
        self.assertIn("1 of 12 variants repeated: the same hashes", self.sweep("--verify"))
        for name in os.listdir(self.path("study", "results")):
            file = self.path("study", "results", name)
            with open(file, encoding="utf-8") as stream:
                text = stream.read()
            with open(file, "w", encoding="utf-8") as stream:
                stream.write(text.replace('"sha256": "', '"sha256": "0'))
        self.assertIn("1 of 12 variants repeated: 1 differ", self.sweep("--verify=5", code=1))

    def test_refused_variants_are_told_and_wrong_keys_end_the_sweep(self):
        self.write_study(grid={"friction.0.kinetic": [0.3, 5.0]}, keep_csv=True)
        self.assertIn("1 variants were refused, the first: ", self.sweep())
        good, bad = self.table()
        self.assertEqual((good["error"], bad["sha256"], bad["peak_force_n"]), ("", "", ""))
        self.assertIn("--set friction.0.kinetic=5.0", bad["error"])
        self.assertEqual(os.listdir(self.path("study", "csv")), [good["key"] + ".csv"])
        self.write_study(grid={"friction.0.kinetics": [0.3, 0.4]})
        self.assertIn('unknown key; did you mean "kinetic"?', self.sweep(code=1))


if __name__ == "__main__":
    SOURCE, PROGRAMS = sys.argv[1:3]
    sys.path.insert(0, os.path.join(SOURCE, "sweep"))
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
