#!/usr/bin/python3
"""Replay onto a disk that is full: an exit code, a message that names file and reason, and the target as it was."""
import os
import subprocess

import harness

BEFORE = "what was there before"


class FaultsDisk(harness.TestCase):
    def test_disk_full(self):
        bag, good, disk = self.bag_of("press.bag", harness.press(300)), self.path("good.csv"), self.path("disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], stderr=subprocess.DEVNULL,
                          check=False).returncode:
            self.skipTest("no right to mount a small tmpfs")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        target = self.write("disk/out", BEFORE)
        with self.assertRaises(OSError), open(os.path.join(disk, "filler"), "wb", buffering=0) as filler:
            while True:
                filler.write(4096 * b"x")
        for options in [[target], [good, "--timing", target], [good, "--out", target], [good, "--dump-step", "150", "--dump-file", target]]:
            with self.subTest(options=options):
                code, errors = harness.replay(harness.SCENE, bag, *options)
                self.assertGreater(code, 0, errors)  # an exit code, not a signal
                self.assertIn(target, errors)
                self.assertIn("No space left on device", errors)
                with open(target, encoding="ascii") as stream:
                    self.assertEqual(stream.read(), BEFORE)
                self.assertEqual(sorted(os.listdir(disk)), ["filler", "out"])


if __name__ == "__main__":
    harness.main(FaultsDisk)
