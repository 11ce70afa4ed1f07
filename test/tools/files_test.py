#!/usr/bin/python3
"""What the command-line tools do to files: results are whole or absent, nothing else is touched, inputs are plain files.

usage: files_test.py SOURCE_DIRECTORY PROGRAM_DIRECTORY      (in the environment of the package: PROGRAM_DIRECTORY/../../env.sh)
"""
import math
import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE, PROGRAMS = "", ""
DEADLINE_S = 100.0
BEFORE = b"what was there before\n"


def program(name):
    return os.path.join(PROGRAMS, name)


def run(command, **more):
    return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, timeout=DEADLINE_S, check=False, **more)


def limit_file_size():
    """Every file that the program writes is full after 4096 bytes: write() then says what it says of a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


class FilesTest(unittest.TestCase):
    bag = long_bag = ""

    @classmethod
    def setUpClass(cls):
        sys.path.insert(0, os.path.join(SOURCE, "test", "ros"))
        import harness  # needs the package's environment, which --help does not have
        cls.recordings = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.recordings)
        cls.bag = os.path.join(cls.recordings, "press.bag")
        harness.write_bag(cls.bag, harness.press(40))
        cls.long_bag = os.path.join(cls.recordings, "long.bag")
        harness.write_bag(cls.long_bag, harness.press(6000, depth_m=0.002))
        cls.scene = harness.SCENE

    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.directory)
        self.csv = self.path("out.csv")

    def path(self, name):
        return os.path.join(self.directory, name)

    def write(self, name, content=BEFORE):
        with open(self.path(name), "wb") as stream:
            stream.write(content)
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as stream:
            return stream.read()

    def copy(self, file, name):
        shutil.copyfile(file, self.path(name))
        return self.path(name)

    def scene_of_own_urdf(self):
        """A scene with a URDF of its own beside it."""
        self.copy(os.path.join(SOURCE, "urdf", "probe.urdf"), "robot.urdf")
        with open(self.scene, encoding="utf-8") as stream:
            text = stream.read()
        old = "package://tissue_contact/urdf/probe.urdf"
        self.assertEqual(text.count(old), 1)
        return self.write("scene.yaml", text.replace(old, "robot.urdf").encode())

    def replay(self, *more, csv=None, bag=None, scene=None, **options):
        return run([program("tissue_contact_replay"), "--scene", scene or self.scene, "--bag", bag or self.bag, "--csv",
                    csv or self.csv, *more], **options)

    def assert_refused(self, done, *words):
        """One line that says all, before anything else is said."""
        self.assert_failed(done, *words)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def assert_failed(self, done, *words):
        self.assertEqual(done.returncode, 1, done)
        for word in words:
            self.assertIn(word, done.stderr.splitlines()[-1])

    # ------------------------------------------------------------------ results never replace what is no result

    def test_a_result_is_no_input(self):
        bag, urdf = self.copy(self.bag, "in.bag"), self.copy(os.path.join(SOURCE, "urdf", "probe.urdf"), "in.urdf")
        scene = self.scene_of_own_urdf()
        os.link(bag, self.path("hard.bag"))
        inputs = {name: self.read(name) for name in os.listdir(self.directory)}
        for name, option in [("in.bag", "--bag"), ("hard.bag", "--bag"), ("scene.yaml", "--scene"), ("in.urdf", "--urdf"),
                             ("robot.urdf", "scene")]:
            with self.subTest(csv=name):
                done = self.replay("--urdf", urdf, csv=self.path(name), bag=bag, scene=scene)
                self.assert_refused(done, "--csv", self.path(name), option)
            with self.subTest(dump=name):
                done = self.replay("--urdf", urdf, "--dump-step", "3", "--dump-file", self.path(name), bag=bag, scene=scene)
                self.assert_refused(done, "--dump-file", self.path(name), option)
        self.assertEqual({name: self.read(name) for name in os.listdir(self.directory)}, inputs)

    def test_two_results_are_two_files(self):
        os.mkdir(self.path("a"))
        other_name = self.path("a/../out.csv")
        for option, more in [("--timing", []), ("--dump-file", ["--dump-step", "3"])]:
            with self.subTest(option=option):
                self.assert_refused(self.replay(option, other_name, *more), "--csv", option, other_name)
        self.assertEqual(os.listdir(self.directory), ["a"])
        self.write("out.csv")
        os.link(self.csv, self.path("hard.csv"))
        self.assert_refused(self.replay("--timing", self.path("hard.csv")), "--csv", "--timing")
        self.assertEqual(self.read("out.csv"), BEFORE)

    def test_results_are_plain_files(self):
        os.mkfifo(self.path("fifo"))
        self.write("victim")
        os.symlink("victim", self.path("link"))
        # What else is none: unit/core/whole_file_test.cpp.
        for name, what in [("fifo", "FIFO"), ("link", "symbolic link to 'victim'"), ("none/out.csv", "No such file or directory")]:
            for option in ["--csv", "--timing", "--dump-file"]:
                with self.subTest(name=name, option=option):
                    more = {"--csv": [], "--timing": ["--timing", self.path(name)],
                            "--dump-file": ["--dump-step", "3", "--dump-file", self.path(name)]}[option]
                    done = self.replay(*more, csv=self.path(name) if option == "--csv" else None)
                    self.assert_refused(done, what, self.path(name))
        self.assertEqual(sorted(os.listdir(self.directory)), ["fifo", "link", "victim"])
        self.assertEqual(self.read("victim"), BEFORE)
        self.assert_refused(self.replay(csv="/dev/stdout"), "/dev/stdout", "symbolic link")
        self.assert_refused(self.replay(csv="-"), "'-'", "file")

    # ------------------------------------------------------------------ whole or absent

    def test_files_of_others_are_not_touched(self):
        self.write("victim")
        self.write("out.csv.part", b"somebody's")
        os.symlink("victim", self.path("times.csv.part"))
        done = self.replay("--timing", self.path("times.csv"), "--dump-step", "25", "--dump-file", self.path("p.txt"))
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(self.read("victim"), BEFORE)
        self.assertEqual(self.read("out.csv.part"), b"somebody's")
        self.assertEqual(sorted(os.listdir(self.directory)),
                         ["out.csv", "out.csv.part", "p.txt", "times.csv", "times.csv.part", "victim"])
        done = run([program("tissue_contact_solve"), self.path("p.txt")])
        self.assertEqual(done.returncode, 0, done)

    def test_dump_beside_the_table(self):
        """A name that the table's own unfinished file once had."""
        done = self.replay("--dump-step", "3", "--dump-file", self.csv + ".part")
        self.assertEqual(done.returncode, 0, done)
        self.assertTrue(self.read("out.csv").startswith(b"stamp_s,"))
        self.assertEqual(self.read("out.csv").count(b"\n"), 41)
        self.assertTrue(self.read("out.csv.part").startswith(b"FC3D"))
        self.assertIn("--dump-step 3: nothing touches in that step", done.stderr)

    def test_permissions(self):
        old = os.umask(0o027)
        try:
            self.write("out.csv")
            os.chmod(self.csv, 0o600)
            done = self.replay("--timing", self.path("times.csv"))
        finally:
            os.umask(old)
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(stat.S_IMODE(os.stat(self.csv).st_mode), 0o600)
        self.assertEqual(stat.S_IMODE(os.stat(self.path("times.csv")).st_mode), 0o640)

    def test_full_disk(self):
        for option in ["--csv", "--timing", "--dump-file"]:
            with self.subTest(option=option):
                for name in ["out.csv", "times.csv", "p.txt"]:
                    self.write(name)
                more = {"--csv": [], "--timing": ["--timing", self.path("times.csv")],
                        "--dump-file": ["--dump-step", "50", "--dump-file", self.path("p.txt")]}[option]
                # The longer recording, so that the times alone are more than may be written.
                done = self.replay(*more, bag=self.long_bag if option == "--timing" else self.bag,
                                   preexec_fn=limit_file_size)
                self.assert_failed(done, "cannot write '" + self.directory, "File too large")
                for name in ["out.csv", "times.csv", "p.txt"]:
                    self.assertEqual(self.read(name), BEFORE)
                self.assertEqual(sorted(os.listdir(self.directory)), ["out.csv", "p.txt", "times.csv"])

    def test_two_replays_into_one_file(self):
        done = self.replay(csv=self.path("expected.csv"))
        self.assertEqual(done.returncode, 0, done)
        for _ in range(3):
            command = [program("tissue_contact_replay"), "--scene", self.scene, "--bag", self.bag, "--csv", self.csv]
            both = [subprocess.Popen(command, stderr=subprocess.DEVNULL) for _ in range(2)]
            self.assertEqual([one.wait(DEADLINE_S) for one in both], [0, 0])
            self.assertEqual(self.read("out.csv"), self.read("expected.csv"))
        self.assertEqual(sorted(os.listdir(self.directory)), ["expected.csv", "out.csv"])

    def test_ended_in_mid_replay(self):
        for number in [signal.SIGINT, signal.SIGTERM, signal.SIGKILL]:
            with self.subTest(signal=number):
                for name in ["made.yaml", "out.csv"]:
                    self.write(name)
                dump = self.path("p.txt")
                child = subprocess.Popen([program("tissue_contact_replay"), "--scene", self.scene, "--bag", self.long_bag,
                                          "--csv", self.csv, "--out", self.path("out.bag"), "--manifest", self.path("made.yaml"), "--dump-step", "5", "--dump-file", dump],
                                         stderr=subprocess.DEVNULL)
                self.addCleanup(child.kill)
                end = time.monotonic() + DEADLINE_S
                while not os.path.exists(dump) and time.monotonic() < end:  # written while the table is open
                    time.sleep(0.001)
                child.send_signal(number)
                self.assertNotEqual(child.wait(DEADLINE_S), 0)
                for name in ["made.yaml", "out.csv"]:
                    self.assertEqual(self.read(name), BEFORE)
                os.remove(dump)
                part = [] if number == signal.SIGKILL else ["out.bag.partial"]  # so called, since it is one
                self.assertEqual(sorted(os.listdir(self.directory)), ["made.yaml", *part, "out.csv"])
                for name in part:
                    os.remove(self.path(name))

    def test_json_of_validation(self):
        validate = [program("tissue_contact_validate"), "--case", "one-contact", "--json"]
        done = run(validate + [self.directory])
        self.assertEqual(done.returncode, 2, done)
        self.assertIn("directory", done.stderr)
        self.assertEqual(done.stdout, "")
        self.write("out.json")
        done = run(validate + [self.path("out.json")],
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)))
        self.assertEqual(done.returncode, 2, done)
        self.assertIn("File too large", done.stderr)
        self.assertEqual(self.read("out.json"), BEFORE)
        self.assertEqual(os.listdir(self.directory), ["out.json"])
        done = run(validate + [self.path("out.json")])
        self.assertEqual(done.returncode, 0, done)
        self.assertTrue(self.read("out.json").startswith(b"{"))

    def test_tables_of_the_benchmark(self):
        """Refused before the run, not after it."""
        self.write("victim")
        os.symlink("victim", self.path("press-drag.csv"))
        quick = [program("tissue_contact_benchmark"), "--quick", "--only", "press-drag", "--out"]
        for out, words in [(self.directory, ["press-drag.csv", "symbolic link to 'victim'"]),
                           (self.path("victim"), ["victim", "Not a directory"])]:
            done = run(quick + [out])
            self.assertEqual(done.returncode, 1, done)
            for word in words:
                self.assertIn(word, done.stderr)
        self.assertEqual(self.read("victim"), BEFORE)
        self.assertEqual(sorted(os.listdir(self.directory)), ["press-drag.csv", "victim"])

    def test_text_that_cannot_be_written(self):
        """What goes to stdout is a result as well."""
        for command in [[program("tissue_contact_validate"), "--case", "one-contact"],
                        [program("tissue_contact_validate"), "--list"],
                        [program("tissue_contact_replay"), "--help"], [program("tissue_contact_benchmark"), "--help"]]:
            with self.subTest(command=command), open("/dev/full", "w", encoding="ascii") as full:
                done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, universal_newlines=True,
                                      timeout=DEADLINE_S, check=False)
                self.assertNotEqual(done.returncode, 0)
                # The standard library forgets the reason of a write before the last.
                self.assertRegex(done.stderr, "cannot write to standard output: (No space left on device|an earlier write)")

    # ------------------------------------------------------------------ the scripts

    def make_bag(self, output, table=None, *options):
        table = table or os.path.join(SOURCE, "config", "grasp_path.csv")
        return run([sys.executable, os.path.join(SOURCE, "scripts", "make_joint_bag.py"), table, output, "--topic", "/a", *options])

    def test_a_joint_that_goes_on_turning_does_so(self):
        import rosbag
        angles = [0.04 * i for i in range(150)]
        self.write("turn.csv", ("time_s,x\n" + "".join("%g,%.9f\n" % (0.01 * i, math.remainder(a, 2.0 * math.pi)) for i, a in enumerate(angles))).encode())
        done = self.make_bag(self.path("turn.bag"), self.path("turn.csv"))
        self.assertEqual(done.returncode, 0, done)
        self.assertIn("go on turning", done.stdout)
        with rosbag.Bag(self.path("turn.bag")) as bag:
            got = [message.position[0] for _, message, _ in bag.read_messages()]
        self.assertLess(max(abs(b - a) for a, b in zip(got, got[1:])), 0.01)
        self.assertAlmostEqual(got[-1], angles[-1], delta=1e-6)

    def test_a_sampled_motion_keeps_its_speed(self):
        """It came to rest at every row: of 10 mm/s became 0 to 15 mm/s, twenty times a second."""
        import rosbag
        rows = {0.05: "sampled.csv", 0.5: "corners.csv"}
        for apart, name in rows.items():
            self.write(name, ("time_s,x\n" + "".join("%g,%.9g\n" % (apart * i, 0.01 * apart * i) for i in range(5))).encode())
        for name, options, straight in [("sampled.csv", [], True), ("sampled.csv", ["--smooth"], False), ("corners.csv", [], False),
                                        ("corners.csv", ["--linear"], True)]:
            with self.subTest(name=name, options=options):
                done = self.make_bag(self.path("speed.bag"), self.path(name), *options)
                self.assertEqual(done.returncode, 0, done)
                self.assertEqual("straight from row to row" in done.stdout, straight and not options)
                with rosbag.Bag(self.path("speed.bag")) as bag:
                    states = [message for _, message, _ in bag.read_messages()]
                x, velocities = [state.position[0] for state in states], [state.velocity for state in states]
                self.assertEqual({len(velocity) for velocity in velocities}, {0 if straight else 1})
                if not straight:  # against central differences, off by h^2 / 6 of the cubic's third derivative, but at its ends
                    off = [abs(250 * (c - a) - v[0]) for a, v, c in zip(x, velocities[1:], x[2:])]
                    self.assertLess(sorted(off)[-8], 1.001 * 2e-6 / 3.0 * 12 * 0.01 / (0.05 if name == "sampled.csv" else 0.5) ** 2)
                speeds = [500 * (b - a) for a, b in zip(x, x[1:])]
                self.assertAlmostEqual(sum(speeds) / len(speeds), 0.01, delta=1e-9)
                self.assertAlmostEqual(max(speeds), 0.01 if straight else 0.015, delta=1e-4)
                self.assertAlmostEqual(min(speeds), 0.01 if straight else 0.0, delta=2e-3)

    def test_scripts_write_whole_files(self):
        bag = self.write("out.bag")
        os.chmod(bag, 0o600)
        self.write("victim")
        os.symlink("victim", bag + ".part")
        done = self.make_bag(bag)
        self.assertEqual(done.returncode, 0, done)
        self.assertEqual(stat.S_IMODE(os.stat(bag).st_mode), 0o600)
        self.assertTrue(self.read("out.bag").startswith(b"#ROSBAG"))
        self.assertEqual(self.read("victim"), BEFORE)
        self.assertEqual(sorted(os.listdir(self.directory)), ["out.bag", "out.bag.part", "victim"])

    def test_scripts_refuse_what_is_no_result(self):
        table = self.copy(os.path.join(SOURCE, "config", "grasp_path.csv"), "table.csv")
        os.symlink("table.csv", self.path("link"))
        os.mkfifo(self.path("fifo"))
        before = self.read("table.csv")
        for name, what in [("table.csv", "the same file as the input"), ("link", "the same file as the input"),
                           ("fifo", "FIFO"), ("", "directory"), ("none/x.bag", "No such file or directory")]:
            with self.subTest(name=name):
                done = self.make_bag(self.path(name), table)
                self.assertEqual(done.returncode, 1, done)
                self.assertIn(what, done.stderr)
        self.assertEqual(self.read("table.csv"), before)
        self.assertEqual(sorted(os.listdir(self.directory)), ["fifo", "link", "table.csv"])

    # ------------------------------------------------------------------ inputs are plain files

    def test_inputs_are_plain_files(self):
        os.mkfifo(self.path("fifo"))
        os.mkfifo(self.path("fifo.yaml"))
        with open(self.scene, encoding="utf-8") as stream:
            text = stream.read().replace("urdf: package://tissue_contact/urdf/probe.urdf", "robot_description: robot")
        scene = self.write("scene.yaml", text.encode())
        for name, what in [(self.path("fifo"), "FIFO"), ("/dev/zero", "device"), (self.directory, "directory"),
                           (self.path("none"), "does not exist")]:
            with self.subTest(file=name):
                self.assert_refused(self.replay(bag=name), "bag '%s'" % name, what)
                self.assert_refused(self.replay(scene=name), "scene file '%s'" % name, what)
                self.assert_refused(self.replay("--urdf", name, scene=scene), "URDF file '%s'" % name, what)
                done = run([program("tissue_contact_solve"), name])
                self.assertEqual(done.returncode, 2, done)
                self.assertIn(what, done.stderr)
                for option in ["--bag", "--scene", "--urdf"]:
                    files = {"--bag": self.bag, "--scene": scene, "--urdf": os.path.join(SOURCE, "urdf", "probe.urdf")}
                    files[option] = name
                    done = run([program("tissue_contact_benchmark")] + [word for pair in files.items() for word in pair])
                    self.assertEqual(done.returncode, 1, done)
                    self.assertIn(what, done.stderr)
                done = run([program("tissue_contact_benchmark"), "--quick", "--only", "robot", "--robot-bag", name, "--out",
                            self.path("folder")])
                self.assertEqual(done.returncode, 1, done)
                self.assertIn(what, done.stderr)

    # ------------------------------------------------------------------ arguments

    def test_arguments_that_mean_nothing(self):
        for more, word in [(["_sceen:=x.yaml"], "'_sceen:=x.yaml'"), (["other.bag"], "'other.bag'"), (["--sceen=x"], "--sceen"),
                           (["--timing", "--urdf"], "--timing"), (["--urdf", "x.urdf"], "--urdf would change nothing"), (["--bag", self.bag], "twice")]:
            with self.subTest(more=more):
                self.assert_refused(self.replay(*more), word)
        self.assertEqual(os.listdir(self.directory), [])
        for command, word in [
                ([program("tissue_contact_validate"), "incline"], "'incline'"),
                ([program("tissue_contact_validate"), "--json", "a", "--json", "b"], "twice"),
                ([program("tissue_contact_validate"), "--json", "--list"], "--json"),
                ([program("tissue_contact_validate"), "--json", "a", "--list"], "--json does not go with --list"),
                ([program("tissue_contact_benchmark"), "--scene", os.path.join(SOURCE, "config", "press_drag.yaml"), "--bag",
                  self.bag, "--urdf", "x.urdf"], "--urdf would change nothing"),
                ([program("tissue_contact_solve"), "a", "_x:=3"], "'_x:=3'"),
                ([program("tissue_contact_solve"), "a", "--tolerance", "1e-3", "--tolerance", "1e-4"], "twice"),
                ([program("tissue_contact_benchmark"), "--quick", "x.bag"], "'x.bag'"),
                ([program("tissue_contact_benchmark"), "--out", "--quick"], "--out"),
                ([program("tissue_contact_benchmark"), "_quick:=1"], "'_quick:=1'")]:
            with self.subTest(command=command):
                done = run(command, cwd=self.directory)
                self.assertEqual(done.returncode, 2, done)
                self.assertIn(word, done.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    SOURCE, PROGRAMS = sys.argv[1:3]
    del sys.argv[1:3]
    unittest.main(verbosity=2)
