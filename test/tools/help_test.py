#!/usr/bin/python3
"""--help of every executable and script of the package: a usage on stdout and exit code 0, without master or display.

usage: help_test.py SOURCE_DIRECTORY PROGRAM...
"""
import glob
import os
import subprocess
import sys
import unittest

SOURCE, PROGRAMS = "", []


class HelpTest(unittest.TestCase):
    def check(self, program):
        # Nothing listens on port 1: who looks for a master does not come back.
        environment = dict(os.environ, ROS_MASTER_URI="http://localhost:1")
        environment.pop("DISPLAY", None)
        for key in ["--help", "-h"]:
            with self.subTest(program=program, key=key):
                done = subprocess.run([program, key], env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                                      text=True, timeout=60)
                self.assertEqual(done.returncode, 0, done)
                self.assertIn("usage", done.stdout.lower())
                self.assertEqual(done.stderr, "")

    def test_programs(self):
        self.assertGreaterEqual(len(PROGRAMS), 5)
        for program in PROGRAMS:
            self.check(program)

    def test_scripts(self):
        scripts = sorted(file for file in glob.glob(os.path.join(SOURCE, "scripts", "*"))
                         if os.access(file, os.X_OK) and os.path.isfile(file))
        self.assertGreaterEqual(len(scripts), 10)
        for script in scripts:
            self.check(script)

    def test_node_names_what_it_needs(self):
        node = [program for program in PROGRAMS if program.endswith("tissue_contact_node")][0]
        text = subprocess.run([node, "__name:=other", "--help", "_scene:=x.yaml"], capture_output=True, text=True,
                              timeout=60).stdout
        for word in ["~scene", "~tf_timeout_s", "~robot_description", "/wrench", "/diagnostics", "_scene:="]:
            self.assertIn(word, text)


if __name__ == "__main__":
    SOURCE, PROGRAMS = sys.argv[1], sys.argv[2:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
