#!/usr/bin/python3
"""static_friction.py: what it reads and refuses; that it finds what is there.

usage: breakaway_test.py SOURCE_DIRECTORY      (in the environment of the package: PROGRAM_DIRECTORY/../../env.sh)
"""
import dataclasses
import os
import subprocess
import sys
import unittest

import numpy
import tissue_contact

SOURCE = sys.argv[1]
for folder in (os.path.join(SOURCE, "scripts"), os.path.join(SOURCE, "benchmark", "fitting")):
    sys.path.insert(0, folder)

import phantom_study as study  # noqa: E402 (the paths come first)
from fit_recordings import Folder  # noqa: E402
from fitting import FitError, breakaway, fitted_scene, measured  # noqa: E402

try:
    tissue_contact.Simulator  # noqa: B018 (loads it)
    WITHOUT = ""
except ImportError as error:
    WITHOUT = str(error)
DEADLINE_S = 600.0
JOINTS = ["x", "y", "z", "yaw", "pitch", "roll"]


class BreakawayTest(unittest.TestCase):
    def test_starts_are_seen_through_noise(self):
        times, _, yaw = study.twist(count=5)
        found = breakaway.starts(times, yaw + 1e-4 / study.RING_M * numpy.random.default_rng(1).standard_normal(len(yaw)))
        self.assertEqual(len(found), 5)  # the first turn is none
        numpy.testing.assert_allclose(found, [(2.4 + 3.5 * i, 4.9 + 3.5 * i) for i in range(5)], atol=0.35)
        self.assertEqual(breakaway.starts(times[:50], yaw[:50]), [])

    def test_rests_may_be_longer_than_turns(self):
        times = numpy.arange(0.0, 60.0, 0.01)
        turned = numpy.clip(times % 10.0 - 7.5, 0.0, 2.5) + 2.5 * numpy.floor(times / 10.0)  # six, from 7.5 s on, 10 s apart
        yaw = 0.05 * turned + 3e-6 / study.RING_M * numpy.random.default_rng(1).standard_normal(len(times))
        numpy.testing.assert_allclose(breakaway.starts(times, yaw), [(17.5 + 10.0 * i, 20.0 + 10.0 * i) for i in range(5)], atol=0.35)

    def test_peak_and_level(self):
        """A rise that ends anywhere, and a torque that falls within some 20 ms: what the ring shows is not what smoothing leaves of it."""
        times, generator = numpy.arange(280) / 100.0, numpy.random.default_rng(1)
        for rises_s in (0.2, 0.5, 1.0):
            clean = 0.4 + 0.1 * numpy.clip((times - 0.3) / rises_s, 0.0, 1.0)
            clean[times > 0.3 + rises_s] = 0.4 + 0.1 * numpy.exp(-(times[times > 0.3 + rises_s] - 0.3 - rises_s) / 0.01)
            numpy.testing.assert_allclose(breakaway.peak_and_level(times, clean), (0.5, 0.4), atol=0.004)
            found = numpy.array([breakaway.peak_and_level(times, clean + 0.01 * generator.standard_normal(280)) for _ in range(20)])
            numpy.testing.assert_allclose(found.mean(axis=0), (0.5, 0.4), atol=0.005)
            self.assertLess(found.std(axis=0).max(), 0.012)

    def test_a_torque_that_never_rises_is_refused(self):
        with self.assertRaisesRegex(FitError, "does not rise"):
            breakaway.peak_and_level(numpy.arange(100) / 100.0, numpy.linspace(1.0, 0.0, 100))

    def test_the_example_is_read(self):
        twist = measured.read_twist(os.path.join(os.path.dirname(study.RING), "twist.csv"), JOINTS)
        self.assertEqual(len(breakaway.starts(twist.times_s, twist.joints["yaw"])), 6)


def made_up(peak=0.5, noise=0.01, seed=1, slower=1.0):
    """Of torque over normal force (m) that rises to a peak above 0.4 and falls to it in each start, as a rheometer might record it."""
    generator = numpy.random.default_rng(seed)
    times, z, yaw = study.twist()
    times = times * slower
    arm = numpy.full(len(times), 0.4)
    for begin, _ in breakaway.starts(times, yaw):
        since = times - begin
        arm = numpy.where((since > 0.0) & (since < 1.0), 0.4 + (peak - 0.4) * since, arm)
    force, torque = numpy.zeros((len(times), 3)), numpy.zeros((len(times), 3))
    force[:, 2], torque[:, 2] = 1.0, -arm - noise * generator.standard_normal(len(times))
    return measured.Recording("made up", times, force, joints={"z": z, "yaw": yaw}, torque_nm=torque)


class MadeUpTest(unittest.TestCase):
    @staticmethod
    def see(recording):
        return breakaway.see_measured("made up", measured.thin(recording, breakaway.RATE_HZ), breakaway.starts(recording.times_s, recording.joints["yaw"]))

    def test_it_is_seen_whichever_way_it_turns(self):
        there, back = made_up(), made_up()
        back.joints["yaw"], back.torque_nm = -back.joints["yaw"], -back.torque_nm
        for recording in (there, back):
            found = self.see(recording)
            self.assertAlmostEqual(found.peak_m.mean(), 0.5, delta=0.01)
            self.assertAlmostEqual(found.level_m.mean(), 0.4, delta=0.005)

    def test_torque_along_the_turn_is_refused(self):
        recording = made_up()
        recording.torque_nm = -recording.torque_nm
        with self.assertRaisesRegex(FitError, r"is -4\d\d ± .* mm; it must be above 0.*on the tool, against its turn"):
            self.see(recording)

    def test_noise_tells_nothing(self):
        for seed in range(5):
            recording, generator = made_up(), numpy.random.default_rng(seed)
            recording.torque_nm = 0.1 * generator.standard_normal(recording.torque_nm.shape)
            with self.subTest(seed=seed), self.assertRaisesRegex(FitError, "must be above 0, and known to a quarter"):
                self.see(recording)

    def test_equal_coefficients_are_not_told_apart(self):
        for seed in range(5):
            with self.subTest(seed=seed), self.assertRaisesRegex(FitError, "static friction is not told from kinetic friction"):
                self.see(made_up(peak=0.4, noise=0.04, seed=seed))

    def test_starts_that_are_too_long_or_too_early(self):
        for recording, words in [(made_up(slower=10.0), r"lasts 2\d\.\d s; up to 20 s"),
                                 (self.cut(made_up(), 1.2), r"the second turn begins 1\.\d\d s after")]:
            with self.subTest(words=words), self.assertRaisesRegex(FitError, words):
                breakaway.find(study.RING, (), None, recording, (0.5, 0.4))

    @staticmethod
    def cut(recording, from_s):
        rows = recording.times_s >= from_s
        return dataclasses.replace(recording, times_s=recording.times_s[rows] - from_s, force_n=recording.force_n[rows], torque_nm=recording.torque_nm[rows],
                                   joints={name: values[rows] for name, values in recording.joints.items()})


class TwistTableTest(Folder):
    def setUp(self):
        super().setUp()
        with open(os.path.join(os.path.dirname(study.RING), "twist.csv"), encoding="utf-8") as stream:
            self.lines = stream.read().splitlines()

    def read(self, change, every=1):
        rows = [change([float(one) for one in line.split(",")]) for line in self.lines[1::every]]
        text = "\n".join([self.lines[0]] + [",".join("%.13g" % one for one in row) for row in rows]) + "\n"
        return measured.read_twist(self.write("twist.csv", text), JOINTS)

    def test_times_may_begin_anywhere(self):
        at_0 = self.read(lambda row: row)
        self.assertEqual(at_0.times_s[0], 0.0)
        for shift_s in (1.7e9, -30.0, 1000.0):
            numpy.testing.assert_allclose(self.read(lambda row, by=shift_s: [row[0] + by] + row[1:]).times_s, at_0.times_s, atol=1e-3)

    def test_refused(self):
        for change, every, words in [(lambda row: row, 5, ["it has 10 rows a second", "20 or more"]),
                                     (lambda row: [row[0], 1e3 * row[1]] + row[2:], 1, ["'z' is up to 0.4", "joints are in rad / m"]),
                                     (lambda row: row[:2] + [numpy.degrees(row[2])] + row[3:], 1, ["'yaw' spans 18.9", "joints are in rad / m"])]:
            with self.subTest(words=words):
                self.refused(words, self.read, change, every)


@unittest.skipIf(WITHOUT, WITHOUT)
class StaticFrictionTest(Folder):
    """By the command, on a ring as the one that is shipped; the recording is of another mesh, shorter steps, other E and damping."""

    @classmethod
    def setUpClass(cls):
        generator = numpy.random.default_rng(1)
        cls.recording = study.record_twist(dict(study.ring_keys(7000.0, 0.014, static=0.55, kinetic=0.4), **{"step.max_step_s": 0.005}),
                                           study.twist(count=5), study.Noise(), generator)

    def setUp(self):
        super().setUp()
        mesh = os.path.join(self.folder, "ring.msh")
        subprocess.run([sys.executable, os.path.join(SOURCE, "scripts", "make_ring.py"), mesh], check=True, timeout=DEADLINE_S)
        self.scene = self.write("ring.yaml", fitted_scene.fitted_text(study.RING, {"tissues.ring.mesh.file": mesh}, self.folder, []))
        self.table = os.path.join(self.folder, "twist.csv")
        study.write_twist(self.table, self.recording)

    def find(self, *arguments):
        command = [sys.executable, os.path.join(SOURCE, "scripts", "static_friction.py"), "--scene", self.scene, "--measured", self.table]
        return subprocess.run(command + list(arguments), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                              timeout=DEADLINE_S, check=False)

    def test_it_finds_what_is_there(self):
        done = self.find("--finer", "step.max_step_s=0.005")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertRegex(done.stdout, r"\nstatic +0\.\d+ +95 %: ")
        self.assertIn("twist: 5 starts", done.stdout)
        found = {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith(("static  ", "kinetic "))}
        self.assertLess(abs(found["static"] - 0.55), 0.02, done.stdout)  # the peak itself is .51
        self.assertLess(abs(found["kinetic"] - 0.4), 0.005, done.stdout)

    def test_without_finer_there_is_no_interval(self):
        done = self.find()
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(done.stdout.count("mesh and step not known: give --finer"), 2, done.stdout)
        self.assertNotIn("95 %", done.stdout)

    def test_refused(self):
        with self.assertRaisesRegex(FitError, "no joint 'yaw'"):
            measured.read_twist(self.table, ["x", "y", "z"])
        with open(self.table, encoding="utf-8") as stream:
            lines = stream.read().splitlines()
        for text, words in [("\n".join(lines).replace("tz_nm", "fx_n"), "column 'fx_n' is not known"),
                            ("\n".join(line.rsplit(",", 1)[0] for line in lines), "there is no column tz_nm"),
                            ("\n".join(lines[:2500]), "turns begin from rest after the first one; 4 or more are needed"),
                            ("\n".join(lines[:1] + [",".join([*line.split(",")[:3], "-" + line.split(",")[3], line.split(",")[4]]).replace("--", "")
                                                    for line in lines[1:]]), "forces are those on the tool")]:
            with self.subTest(words=words):
                self.table = self.write("bad.csv", text + "\n")
                done = self.find()
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn(words, done.stdout)
                self.assertNotIn("Traceback", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
