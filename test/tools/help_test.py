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

    def run_tool(self, name, *arguments):
        program = [program for program in PROGRAMS if program.endswith("tissue_contact_" + name)][0]
        return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60)

    def test_unknown_arguments_are_named_with_the_nearest_known(self):
        for name, wrong, near in [("replay", "--cvs", "--csv"), ("solve", "--solvr", "--solver"),
                                  ("validate", "--jsn", "--json"), ("benchmark", "--qick", "--quick")]:
            for arguments in [[wrong, "x"], [wrong + "=x"]]:
                with self.subTest(arguments=arguments):
                    done = self.run_tool(name, *arguments)
                    self.assertIn(done.returncode, [1, 2])
                    self.assertIn("unknown argument '" + arguments[0] + "'; did you mean \"" + near + "\"? known are ", done.stderr)
        done = self.run_tool("node", "--scene=x.yaml")  # and does not wait for a master
        self.assertEqual(done.returncode, 1, done)
        self.assertIn("unknown argument '--scene=x.yaml'", done.stderr + done.stdout)
        self.assertIn("_scene:=", done.stderr + done.stdout)

    def test_both_forms_are_the_same_everywhere(self):
        replay = ["--scene", "s", "--bag=b", "--csv", "c", "--dump-file=p"]
        for name, before, key, bad in [("replay", replay, "--dump-step", "0"), ("solve", ["p.txt"], "--sides", "3"),
                                       ("validate", [], "--case", "none"), ("benchmark", [], "--only", "none")]:
            with self.subTest(tool=name):
                first, second = self.run_tool(name, *before, key, bad), self.run_tool(name, *before, key + "=" + bad)
                self.assertIn(first.returncode, [1, 2])
                self.assertIn("'" + bad + "'", first.stderr)
                self.assertEqual((first.returncode, first.stderr), (second.returncode, second.stderr))

    def require_build(self):
        build = subprocess.run([SOURCE + "/scripts/build", "--where"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True,
                               timeout=60).stdout.strip()
        if not os.path.isfile(os.path.join(build, "devel", "setup.bash")):
            self.skipTest(build + " is not where this was built")

    def test_the_environment_may_be_sourced_by_a_script_with_arguments(self):
        self.require_build()
        script = ". '%s/scripts/env.bash'; echo \"$*\"; command -v rospack" % SOURCE
        done = subprocess.run(["/bin/bash", "-c", script, "script", "--help", "--extend"], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.splitlines()[0], "--help --extend")

    def test_the_environment_keeps_packages_that_were_named_before(self):
        self.require_build()
        source = ". '%s/scripts/env.bash'; echo \"$ROS_PACKAGE_PATH\"; " % SOURCE
        script = "set -e; export ROS_PACKAGE_PATH=/opt/mine:/opt/yours; " + source + source + "unset ROS_PACKAGE_PATH; " + source
        done = subprocess.run(["/bin/bash", "-c", script], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        first, second, own = done.stdout.splitlines()
        self.assertEqual(first, own + ":/opt/mine:/opt/yours")
        self.assertEqual(second, first)

    def test_node_names_what_it_needs(self):
        text = self.run_tool("node", "__name:=other", "--help", "_scene:=x.yaml").stdout
        for word in ["~scene", "~tf_timeout_s", "~robot_description", "/wrench", "/diagnostics", "_scene:="]:
            self.assertIn(word, text)

    def test_build_directories_that_rosrun_would_search_are_refused(self):
        checkout = os.path.realpath(SOURCE)
        for place in [checkout + "/build.refused", checkout + "-build.refused", checkout + "/../" + os.path.basename(checkout) + ".refused"]:
            with self.subTest(place=place):
                done = subprocess.run([os.path.join(SOURCE, "scripts", "build"), "--packages"], stdin=subprocess.DEVNULL, capture_output=True,
                                      text=True, timeout=60, env=dict(os.environ, TISSUE_CONTACT_BUILD=place, SANITIZE=""))
                self.assertEqual(done.returncode, 1, done)
                self.assertIn("TISSUE_CONTACT_BUILD=%s begins like the checkout" % os.path.realpath(place), done.stderr)
                self.assertFalse(os.path.exists(place))


if __name__ == "__main__":
    SOURCE, PROGRAMS = sys.argv[1], sys.argv[2:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
