#!/usr/bin/python3
"""Replay onto a disk that is full: an exit code, a message that names file and reason, and the target as it was."""
import os
import resource
import signal
import subprocess
import sys

import rospy
import rostest

import harness

LIMIT_BYTES = 16384  # holds a part of the table
BEFORE = "what was there before"


def limit_file_size():
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT_BYTES, LIMIT_BYTES))


class FaultsDisk(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.bag = self.path("press.bag")
        harness.write_bag(self.bag, harness.press(300))
        self.good = self.path("good.csv")

    def replay(self, csv_file, *more, before=None):
        command = [harness.program("tissue_contact_replay"), "--scene", harness.SCENE, "--bag", self.bag, "--csv", csv_file]
        return subprocess.run(command + list(more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              timeout=harness.DEADLINE_S, preexec_fn=before, check=False)

    def assert_refused(self, done, target, why, files):
        self.assertGreater(done.returncode, 0, done)  # an exit code, not a signal
        self.assertIn(target, done.stderr)
        self.assertIn(why, done.stderr)
        with open(target, encoding="ascii") as stream:
            self.assertEqual(stream.read(), BEFORE)
        self.assertEqual(sorted(os.listdir(os.path.dirname(target))), files)

    def test_disk_full_within_the_table(self):
        """By a limit on the size of files, which needs no rights."""
        self.assertEqual(self.replay(self.good).returncode, 0)
        self.assertGreater(os.path.getsize(self.good), LIMIT_BYTES)
        directory = self.path("limited")
        os.mkdir(directory)
        target = os.path.join(directory, "out.csv")
        with open(target, "w", encoding="ascii") as stream:
            stream.write(BEFORE)
        self.assert_refused(self.replay(target, before=limit_file_size), target, "File too large", ["out.csv"])

    def test_disk_full(self):
        disk = self.path("disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], stderr=subprocess.DEVNULL,
                          check=False).returncode:
            self.skipTest("no right to mount a small tmpfs")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        target = os.path.join(disk, "out")
        with open(target, "w", encoding="ascii") as stream:
            stream.write(BEFORE)
        with self.assertRaises(OSError), open(os.path.join(disk, "filler"), "wb", buffering=0) as filler:
            while True:
                filler.write(4096 * b"x")
        for options in [[target], [self.good, "--timing", target], [self.good, "--dump-step", "150", "--dump-file", target]]:
            with self.subTest(options=options):
                self.assert_refused(self.replay(*options), target, "No space left on device", ["filler", "out"])


if __name__ == "__main__":
    rospy.init_node("faults_disk")
    rostest.rosrun("tissue_contact", "faults_disk", FaultsDisk, sys.argv)
