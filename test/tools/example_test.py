#!/usr/bin/python3
"""What `make install` leaves: doc/example and doc/controller_test as other packages build them against it, and Python.

usage: example_test.py SOURCE_DIRECTORY BUILD_DIRECTORY
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

SOURCE, BUILD = pathlib.Path(), pathlib.Path()
# Nothing of the workspace this was built in.
ENVIRONMENT = {name: value for name, value in os.environ.items()
               if not re.match("ROS_|CMAKE_PREFIX_PATH|LD_LIBRARY_PATH|PYTHONPATH|PKG_CONFIG_PATH|CATKIN_", name)}


def run(*command, **environment):
    return subprocess.run(list(map(str, command)), env={**ENVIRONMENT, **environment}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=500)


class ExamplePackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        # Not --prefix: catkin installs its setup files by absolute paths.
        cache = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
        prefix = re.search("^CMAKE_INSTALL_PREFIX:PATH=/(.*)$", cache, re.MULTILINE).group(1)
        cls.prefix = pathlib.Path(cls.folder.name) / prefix
        done = run("cmake", "--install", BUILD, DESTDIR=cls.folder.name)
        assert done.returncode == 0, done.stdout
        cls.doc = cls.prefix / "share/tissue_contact/doc"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def configure(self, source, build, *options):
        return run("cmake", "-S", source, "-B", build, "-DCMAKE_PREFIX_PATH=%s" % self.prefix,
                   "-DPYTHON_EXECUTABLE=" + sys.executable, *options)

    def test_builds_and_prints_a_force(self):
        build = pathlib.Path(self.folder.name) / "build"
        # Every public header beside those that the example includes: all of them must be there, and what they include.
        headers = sorted(self.prefix.glob("include/tissue_contact/*/*.h"))
        self.assertGreater(len(headers), 20)
        everything = build.parent / "everything.h"
        everything.write_text("".join('#include "%s"\n' % header for header in headers), encoding="utf-8")
        options = build.parent / "options.cmake"
        options.write_text("add_compile_options(-include %s)\n" % everything, encoding="utf-8")
        done = self.configure(self.doc / "example", build, "-DCMAKE_PROJECT_tissue_contact_example_INCLUDE=%s" % options)
        self.assertEqual(done.returncode, 0, done.stdout)
        done = run("cmake", "--build", build)
        self.assertEqual(done.returncode, 0, done.stdout)

        press = next(build.rglob("press"))
        self.assertIn(str(self.prefix / "lib/libtissue_contact_core.so"), run("ldd", press).stdout)
        done = run(press, ROS_PACKAGE_PATH=str(self.prefix / "share"))
        self.assertEqual(done.returncode, 0, done.stdout)
        version = xml.etree.ElementTree.parse(SOURCE / "package.xml").findtext("version")
        self.assertIn("tissue_contact %s," % version, done.stdout)
        forces = re.findall(r"^(.*): force on the probe (\S+) (\S+) (\S+) N$", done.stdout, re.MULTILINE)
        self.assertEqual([force[0] for force in forces], ["joint states", "advance"], done.stdout)
        self.assertEqual(forces[0][1:], forces[1][1:])  # the same motion
        self.assertGreater(float(forces[0][3]), 0.1)  # N, upwards: the block pushes back

    def digest_of(self, build, pattern):
        """What a test of the package has noted in its results."""
        results = next(build.rglob(pattern)).read_text(encoding="utf-8")
        return re.search('name="digest" value="(\\d+)"', results).group(1)

    def test_a_controller_is_tested_by_gtest_rostest_and_pytest(self):
        build = pathlib.Path(self.folder.name) / "controller_build"
        source = pathlib.Path(self.folder.name) / "controller"  # pytest leaves its cache beside its tests
        shutil.copytree(self.doc / "controller_test", source)
        done = self.configure(source, build)
        self.assertEqual(done.returncode, 0, done.stdout)
        done = run("cmake", "--build", build, "--target", "tests")
        self.assertEqual(done.returncode, 0, done.stdout)
        home = {"ROS_HOSTNAME": "localhost", "ROS_HOME": self.folder.name + "/ros_home"}
        done = run("ctest", "--test-dir", build, "--no-tests=error", "--output-on-failure", **home)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("100% tests passed, 0 tests failed out of 3", done.stdout)
        # In one process and over ROS: the same bits.
        self.assertEqual(self.digest_of(build, "gtest-in_process_test.xml"), self.digest_of(build, "pytest-press.xml"))

        # A controller that presses too hard.
        inside = [build / "devel/env.sh"]
        gtest = run(*inside, next(build.rglob("in_process_test")), TARGET_FORCE_N="2", **home)
        self.assertIn('(tissue.peakForce("probe")) < (0.6), actual: ', gtest.stdout)
        self.assertIn("[  FAILED  ] 1 test", gtest.stdout)
        rostest = run(*inside, "rostest", source / "test/press.test", "target_force_n:=2", **home)
        self.assertIn("FAILURES: 2", rostest.stdout)
        pytest = run(*inside, sys.executable, "-m", "pytest", source / "test/test_press.py", TARGET_FORCE_N="2", **home)
        self.assertIn("2 failed, 1 passed", pytest.stdout)
        for done in [gtest, rostest, pytest]:
            self.assertNotEqual(done.returncode, 0, done.stdout)

    def in_a_shell(self, command):
        """Of a user who has sourced setup.bash, and nothing else."""
        setup = self.prefix / "setup.bash"
        return subprocess.run(["/bin/bash", "-c", "source %s && %s" % (setup, command)], cwd="/", stdin=subprocess.DEVNULL,
                              env={"HOME": self.folder.name, "PATH": "/usr/bin:/bin"}, capture_output=True, text=True, timeout=100)

    def test_python(self):
        messages = self.in_a_shell("%s -B -c 'from tissue_contact.msg import Status; print(Status.__module__)'" % sys.executable)
        self.assertEqual((messages.stdout, messages.stderr), ("tissue_contact.msg._Status\n", ""))
        helped = self.in_a_shell("rosrun tissue_contact fit --help")
        self.assertIn("--held-out", helped.stdout, helped.stderr)
        modules = sorted(self.prefix.glob("lib/python3/dist-packages/tissue_contact/*.so"))
        if not modules:
            self.skipTest("built without pybind11: no simulator in Python")
        code = ("import tissue_contact as tc; s = tc.Simulator(tc.load_scene(\"package://tissue_contact/config/press_drag.yaml\")); "
                "print(tc.__file__, s.instruments, tc.replay.__name__)")
        simulator = self.in_a_shell("%s -B -c '%s'" % (sys.executable, code))
        self.assertEqual((simulator.stdout, simulator.stderr), ("%s ['probe'] replay\n" % (modules[0].parent / "__init__.py"), ""))
        for module in modules:  # without setup.bash as well
            self.assertIn("libtissue_contact_core.so => " + str(modules[0].parent), run("ldd", module).stdout)

    def test_pages_link_to_what_is_there(self):
        checked = 0
        for page in self.doc.rglob("*.md"):
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
                place = pathlib.Path(os.path.normpath(page.parent / target))
                if self.doc in place.parents:  # not into the source tree
                    checked += 1
                    self.assertTrue(place.exists(), "%s: %s" % (page, target))
        self.assertGreater(checked, 100)

    def test_packages_to_copy_are_no_packages_of_the_install_space(self):
        self.assertEqual(self.in_a_shell("rospack list-names | grep ^tissue_contact").stdout, "tissue_contact\n")

    def test_a_later_version_is_refused(self):
        copy = pathlib.Path(self.folder.name) / "later"
        copy.mkdir()
        for file in (self.doc / "example").iterdir():
            text = file.read_text(encoding="utf-8")
            (copy / file.name).write_text(text.replace("tissue_contact 0.1 ", "tissue_contact 99 "), encoding="utf-8")
        done = self.configure(copy, copy / "build")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("compatible", done.stdout)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    BUILD = pathlib.Path(sys.argv.pop())
    SOURCE = pathlib.Path(sys.argv.pop())
    unittest.main()
