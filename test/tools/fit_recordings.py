"""What fit.py reads and refuses: tables and bags. Cases of fit_test.py, which runs them."""
import math
import os
import pathlib
import shutil
import tempfile
import tracemalloc
import unittest
from unittest import mock

import numpy

from fitting import FitError, measured


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as stream:
            stream.write(text)
        return os.path.join(self.folder, name)

    def refused(self, words, function, *arguments):
        with self.assertRaises(FitError) as caught:
            function(*arguments)
        for word in words:
            self.assertIn(word, str(caught.exception))


class TableTest(Folder):
    GOOD = ["time_s,x_m,y_m,z_m,fz_n"] + ["%g,0,0,0.01,%g" % (0.1 * i, 0.01 * i) for i in range(12)]

    def read(self, lines):
        return measured.read(self.write("m.csv", "\n".join(lines)), ["x", "y", "z"], ["/js"], "/force_sensor")

    def test_what_it_reads(self):
        recording = self.read(self.GOOD)
        self.assertEqual(recording.measured(), [2])
        self.assertAlmostEqual(recording.peak_n(), 0.11)
        self.assertIsNone(recording.joints)
        joints = self.read(["time_s,z,fz_n,fx_n"] + ["%d,0.5,%d,2" % (i, i) for i in range(12)])
        self.assertEqual(list(joints.joints), ["z"])
        self.assertEqual(joints.measured(), [0, 2])

    def test_a_quaternion_and_its_negative_are_one_rotation(self):
        signs = [1, 1, -1, -1, 1, -1, 1, 1, 1, -1, 1, 1]
        recording = self.read(["time_s,x_m,y_m,z_m,qx,qy,qz,qw,fz_n"] +
                              ["%g,0,0,0,0,0,%g,%g,%d" % (0.01 * i, 0.6 * sign, 0.8 * sign, i) for i, sign in enumerate(signs)])
        self.assertTrue((recording.quaternions == [0.0, 0.0, 0.6, 0.8]).all())

    def test_bad_tables_are_refused_by_file_line_column_value_and_range(self):
        def changed(line, text):
            return self.GOOD[:line - 1] + [text] + self.GOOD[line:]
        for lines, words in [
                ([], ["m.csv is empty", "header"]),
                (["", ""], ["m.csv:1", "there is no column time_s"]),
                (["version https://git-lfs.github.com/spec/v1", "oid sha256:0", "size 1"], ["m.csv is a git-lfs pointer", "git lfs pull"]),
                (["time_s,x_m,y_m,z_m,fz_n"] + ["%d,0,0,%g,%d" % (i, 3.5 * (i % 2), i) for i in range(12)],
                 ["'z_m' spans 3.5 m", "up to 1 m", "metres"]),
                (["time_s,x_m,y_m,z_m,fz_n"] + ["%d,0,0,0,%d" % (1000 * i, i) for i in range(12)], ["lasts 11000 s", "up to 3600 s"]),
                (["time_s,x_m,y_m,z_m,fz_n"] + ["%g,0,0,0,%d" % (0.01 * i + (i > 7), i) for i in range(12)],
                 ["nothing is recorded from 0.070 to 1.080 s", "up to 0.2 s", "cut it"]),
                (changed(5, "0.3,0,0,0.01,0." + "1" * 20000), ["m.csv:5", "more than 10000 characters"]),
                (changed(1, "time_s,x_m,y_m,z_m,fz"), ["m.csv:1", "'fz'", "did you mean", "fz_n"]),
                (changed(1, "time_s,x_m,y_m,fz_n,fz_n"), ["m.csv:1", "'fz_n' is there twice"]),
                (changed(1, "time_s,x_m,y_m,fx_n,fz_n"), ["m.csv:1", "z_m", "all are needed"]),
                (changed(1, "time_s,x,y,x_m,fz_n"), ["m.csv:1", "all are needed"]),
                (["time_s,fz_n"] + ["%d,1" % i for i in range(12)], ["m.csv:1", "either the tip's position"]),
                (["time_s,z"] + ["%d,1" % i for i in range(12)], ["there is no force"]),
                (changed(5, "0.3,0,0,ten,0.1"), ["m.csv:5", "'z_m' is 'ten'", "-10 to 10 m"]),
                (changed(5, "0.3,0,0,35.2,0.1"), ["m.csv:5", "'z_m' is '35.2'", "metres"]),
                (changed(5, "0.3,0,0,0.01,nan"), ["m.csv:5", "'fz_n' is 'nan'", "newtons"]),
                (changed(5, "0.3,0,0,0.01,1e400"), ["m.csv:5", "'fz_n'"]),
                (changed(5, "0.1,0,0,0.01,0.1"), ["m.csv:5", "'time_s' is 0.1, not after 0.2", "ascend"]),
                (changed(5, "0.3,0,0,0.01"), ["m.csv:5", "4 values under 5 columns"]),
                (self.GOOD[:6], ["5 rows", "10 or more"]),
                (["time_s,x_m,y_m,z_m,fz_n"] + ["%d,0,0,0,0" % i for i in range(12)], ["the force is the same in every row (0 N)"]),
                (["time_s,x_m,y_m,z_m,qx,qy,qz,qw,fz_n"] + ["%d,0,0,0,0,0,0,%g,1" % (i, 0.9 if i == 7 else 1) for i in range(12)],
                 ["sample 8", "0.9", "norm"])]:
            with self.subTest(words=words):
                self.refused(words, self.read, lines)
        for path, why in [(self.folder, "not a file"), ("/dev/zero", "not a file"), (os.path.join(self.folder, "none"), "No such file")]:
            self.refused([path + " cannot be read: ", why], measured.read, path, [], [], "")
        with open(os.path.join(self.folder, "b.csv"), "wb") as stream:
            stream.write(b"time_s,\xff\xfe\n")
        self.refused(["cannot be read as a table"], measured.read, os.path.join(self.folder, "b.csv"), [], [], "")

    def test_a_huge_table_is_refused_with_little_memory(self):
        path = os.path.join(self.folder, "huge.csv")
        with open(path, "wb") as stream:
            stream.write(b"time_s,z,fz_n\n" + 8 * b"1")
            stream.truncate(4000000000)  # a sparse file: one line of four gigabytes
        with mock.patch.object(measured, "MOST_ROWS", 100):
            self.refused(["m.csv:102", "more than 100 rows"], self.read, ["time_s,x_m,y_m,z_m,fz_n"] + ["%d,0,0,0,%d" % (i, i) for i in range(200)])
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        self.refused(["huge.csv:2", "more than 10000 characters"], measured.read, path, ["z"], [], "")
        self.assertLess(tracemalloc.get_traced_memory()[1], 5e6)

    def test_thin_smooth_tare(self):
        recording = self.read(["time_s,x_m,y_m,z_m,fz_n"] + ["%.3f,0,0,%.9f,%g" % (0.002 * i, 1e-4 * (0.002 * i) ** 2, 3 + i % 2) for i in range(500)])
        self.assertAlmostEqual(measured.tare(recording, 0.1).force_n[:, 2].mean(), 0.0)
        thinned = measured.thin(recording, 100.0)
        self.assertEqual(len(thinned.times_s), 100)
        self.assertAlmostEqual(thinned.times_s[3], 0.034)  # the mean of five
        self.assertLess(abs(thinned.force_n[:, 2]).max(), 0.11)
        numpy.testing.assert_allclose(measured.smooth(recording, 0.1).positions_m, recording.positions_m, atol=1e-9)  # a parabola stays
        self.refused(["longer than"], measured.smooth, recording, 2.0)
        self.refused(["leaves 5 samples"], measured.thin, recording, 5.0)
        # Nor does a sensor that is silent for a while bend it.
        kept = [i for i in range(500) if not 200 <= i < 218]
        silent = self.read(["time_s,x_m,y_m,z_m,fz_n"] + ["%.3f,0,0,%.9f,%g" % (0.002 * i, 1e-4 * (0.002 * i) ** 2, i % 2) for i in kept])
        numpy.testing.assert_allclose(measured.smooth(silent, 0.1).positions_m, silent.positions_m, atol=1e-9)
        numpy.testing.assert_allclose(measured.parabolas(silent.times_s, silent.positions_m, 51, derivative=1)[:, 2], 2e-4 * silent.times_s, atol=1e-7)

    def test_a_joint_that_goes_on_turning_is_recorded_between_half_turns(self):
        angles = [0.03 * i for i in range(200)]
        path = self.write("turn.csv", "\n".join(["time_s,yaw,fz_n"] + ["%.2f,%.9f,%g" % (0.01 * i, math.remainder(a, 2.0 * math.pi), i % 2) for i, a in enumerate(angles)]))
        numpy.testing.assert_allclose(measured.read(path, ["yaw"], [], "").joints["yaw"], angles, atol=1e-8)


class BagTest(Folder):
    def bag(self, states=200, force_type=None, stamps=1.0, force=lambda i: 0.02 * i):
        import genpy
        import rosbag
        from geometry_msgs.msg import WrenchStamped
        from sensor_msgs.msg import JointState
        path = os.path.join(self.folder, "m.bag")
        with rosbag.Bag(path, "w") as bag:
            for i in range(states):
                state = JointState(name=["z"], position=[1e-5 * i])
                wrench = WrenchStamped() if force_type is None else JointState(name=["z"], position=[0])
                if force_type is None:
                    wrench.wrench.force.z = force(i)
                for topic, message, at in (("/js", state, 10 + stamps * 0.01 * i), ("/force_sensor", wrench, 10.005 + 0.01 * i)):
                    message.header.stamp = genpy.Time.from_sec(at)
                    bag.write(topic, message, genpy.Time.from_sec(10 + i))
        return path

    def read(self, path, topic="/force_sensor"):
        return measured.read(path, ["z"], ["/js"], topic)

    def test_force_at_the_stamps_of_joint_states(self):
        recording = self.read(self.bag())
        self.assertEqual(len(recording.times_s), 199)  # the first state is before the first force
        numpy.testing.assert_allclose(recording.joints["z"], 1e-5 * numpy.arange(1, 200), atol=1e-12)
        numpy.testing.assert_allclose(recording.force_n[:, 2], 0.02 * (numpy.arange(199) + 0.5), atol=1e-6)

    def test_refused(self):
        self.refused(["no messages on /wrench", "/force_sensor, /js"], self.read, self.bag(), "/wrench")
        self.refused(["/force_sensor has sensor_msgs/JointState; geometry_msgs/WrenchStamped is needed"], self.read, self.bag(force_type="js"))
        self.refused(["is not after", "header.stamp"], self.read, self.bag(stamps=0.0))
        self.refused(["10 to"], self.read, self.bag(5))
        self.refused(["no joint_state_topics"], measured.read, self.bag(), ["z"], [], "/force_sensor")
        self.refused(["/js is the topic of the motion (the scene's joint_state_topics) and of the forces (--force-topic)", "give each its own"],
                     measured.read, self.bag(), ["z"], ["/other", "/js"], "/js")
        self.refused(["the force is the same in every row"], self.read, self.bag(force=lambda i: 3.0))
        self.refused(["on /force_sensor 'fz_n' is nan; a number from -1000 to 1000 N"], self.read, self.bag(force=lambda i: math.nan if i == 9 else 1.0))
        with open(self.bag(), "rb") as stream:
            content = stream.read()
        with open(os.path.join(self.folder, "cut.bag"), "wb") as stream:
            stream.write(content[:5000])
        self.refused(["cut.bag cannot be read as a bag"], self.read, os.path.join(self.folder, "cut.bag"))


class JointBagTest(Folder):
    """Joints of which not every message has all, or that have a topic of their own."""

    def bag(self, jaw, topic="/jaw", late_s=0.0):
        """Two seconds of z; jaw: its position at a count of samples, or None."""
        import genpy
        import rosbag
        from geometry_msgs.msg import WrenchStamped
        from sensor_msgs.msg import JointState
        path = os.path.join(self.folder, "m.bag")
        with rosbag.Bag(path, "w") as bag:
            for i in range(200):
                state, wrench, other = JointState(name=["z"], position=[1e-5 * i]), WrenchStamped(), jaw(i)
                wrench.wrench.force.z = 0.02 * i
                messages = [("/js", state, 0.0), ("/force_sensor", wrench, 0.0)]
                if other is not None and topic == "/js":
                    state.name.append("jaw")
                    state.position.append(other)
                elif other is not None:
                    messages.append((topic, JointState(name=["jaw"], position=[other]), 0.003 + late_s))
                for name, message, after in messages:
                    message.header.stamp = genpy.Time.from_sec(1.7e9 + 0.01 * i + after)
                    bag.write(name, message, genpy.Time.from_sec(1.7e9 + 0.01 * i))
        return path

    @staticmethod
    def read(path):
        return measured.read(path, ["z", "jaw"], ["/js", "/jaw"], "/force_sensor")

    def test_a_joint_between_its_own_samples(self):
        for topic, first, early in (("/js", 0, 0.0), ("/jaw", 1, 0.3)):  # those of /jaw come 3 ms later, the first after the first state
            recording = self.read(self.bag(lambda i: 0.01 * i if i % 6 == 0 else None, topic))
            numpy.testing.assert_allclose(recording.joints["jaw"], 0.01 * (numpy.arange(first, 199) - early), atol=1e-6)

    def test_one_that_nobody_recorded_stays(self):
        self.assertEqual(list(self.read(self.bag(lambda i: None)).joints), ["z"])

    def test_refused(self):
        for topic, late_s, jaw, words in [
                ("/jaw", 0.0, lambda i: 0.1 if i < 100 else None, ["nothing is recorded on /jaw (joint 'jaw') from 1700000000.993 to 1700000001.990 s"]),
                ("/jaw", 0.0, lambda i: 0.1 if i > 100 else None, ["nothing is recorded on /jaw (joint 'jaw') from 1700000000.000 to 1700000001.013 s"]),
                ("/js", 0.0, lambda i: None if 80 < i < 140 else 0.1, ["nothing is recorded on /js (joint 'jaw') from 1700000000.800 to 1700000001.400 s"]),
                ("/js", 0.0, lambda i: 0.1 if i in (0, 199) else None, ["2 messages of /js (joint 'jaw')", "10 or more"]),
                ("/jaw", 0.0, lambda i: math.nan if i == 9 else 0.1, ["on /jaw (joint 'jaw') 'jaw' is nan"]),
                ("/jaw", 0.5, lambda i: 0.1, ["the clocks of /jaw and /force_sensor differ", "up to 0.2 s"])]:
            with self.subTest(words=words):
                self.refused(words, self.read, self.bag(jaw, topic, late_s))


class PoseBagTest(Folder):
    """Bags with poses of the tip in place of joint states."""

    def bag(self, **changes):
        """Two seconds of a tool that goes down and turns. changes: of each message, by its topic, a function of it and its number."""
        import genpy
        import rosbag
        from geometry_msgs.msg import PoseStamped, WrenchStamped
        path = os.path.join(self.folder, "m.bag")
        with rosbag.Bag(path, "w") as bag:
            for i in range(200):
                at, angle = 1.7e9 + 0.01 * i, 0.005 * i
                pose, wrench = PoseStamped(), WrenchStamped()
                pose.header.frame_id = "room"
                pose.pose.position.x, pose.pose.position.z = 0.02, -1e-5 * i
                pose.pose.orientation.x, pose.pose.orientation.w = math.sin(0.5 * angle), math.cos(0.5 * angle)
                wrench.wrench.force.z = 0.02 * i
                for topic, message in (("cp", pose), ("force", wrench)):
                    message.header.stamp = genpy.Time.from_sec(at)
                    message = changes.get(topic, lambda message, number: message)(message, i)
                    if message:
                        bag.write("/" + topic, message, genpy.Time.from_sec(at))
        return path

    @staticmethod
    def read(path, pose_topic="/cp", force_topic="/force"):
        return measured.read(path, ["z"], ["/js"], force_topic, pose_topic)

    @staticmethod
    def poses(change):
        """Changes of a bag: of its poses, in place."""
        def changed(message, number):
            change(message, number)
            return message
        return {"cp": changed}

    @staticmethod
    def as_transform(message, _):
        from geometry_msgs.msg import TransformStamped
        transform = TransformStamped(header=message.header)
        for name in "xyz":
            setattr(transform.transform.translation, name, getattr(message.pose.position, name))
        transform.transform.rotation = message.pose.orientation
        return transform

    def test_poses_and_transforms_are_the_same_motion(self):
        count = numpy.arange(200)
        for path in (self.bag(), self.bag(cp=self.as_transform)):
            recording = self.read(path)
            self.assertIsNone(recording.joints)
            self.assertEqual(recording.pose_frame, "room")
            numpy.testing.assert_allclose(recording.positions_m, numpy.stack([0.02 + 0 * count, 0 * count, -1e-5 * count], axis=1), atol=1e-12)
            numpy.testing.assert_allclose(recording.quaternions[:, 0], numpy.sin(0.0025 * count), atol=1e-12)
            numpy.testing.assert_allclose(recording.force_n[:, 2], 0.02 * count, atol=1e-6)

    def test_a_rotation_that_nobody_measured_is_none(self):
        def zero(message, _):
            message.pose.orientation.x = message.pose.orientation.w = 0.0
        self.assertIsNone(self.read(self.bag(**self.poses(zero))).quaternions)

    def test_what_is_before_and_after_the_motion_does_no_harm(self):
        def force(message, number):
            """From half a second before the poses to half a second after them, with a hiccup in each."""
            message.wrench.force.x = math.nan if number in (20, 180) else 0.0
            return None if 20 < number < 45 or 155 < number < 180 else message

        def pose(message, number):
            return message if 50 <= number < 150 else None
        recording = self.read(self.bag(force=force, cp=pose))
        numpy.testing.assert_allclose(recording.force_n[:, 2], 0.02 * numpy.arange(50, 150), atol=1e-6)

        def earlier(message, number):
            """Poses in another frame, and one that is none, while no force is recorded yet."""
            message.header.frame_id = "camera" if number < 50 else "room"
            message.pose.position.x = math.nan if number == 10 else 0.02
            return message
        recording = self.read(self.bag(cp=earlier, force=lambda message, number: message if number >= 50 else None))
        self.assertEqual((len(recording.times_s), recording.pose_frame), (150, "room"))

    def test_refused(self):
        def moved(change):
            return lambda message, number: change(message.pose.position, number)

        def turned(message, number):
            message.pose.orientation.w *= 0.5 if number == 7 else 1.0

        def framed(message, number):
            message.header.frame_id = "camera" if number == 3 else "room"

        def child(message, number):
            transform = self.as_transform(message, number)
            transform.child_frame_id = "left" if number % 2 else "right"
            return transform

        def late(message, _):
            message.header.stamp.secs += 3
            return message

        def gone(message, number):
            return None if 80 < number < 140 else message

        for changes, words in [
                (self.poses(moved(lambda position, i: setattr(position, "z", 145.0 if i == 9 else 0.0))), ["on /cp 'z_m' is 145", "-10 to 10 m", "metres"]),
                (self.poses(moved(lambda position, i: setattr(position, "z", 3.5 * (i % 2)))), ["'z_m' spans 3.5 m", "up to 1 m", "metres"]),
                (self.poses(moved(lambda position, i: setattr(position, "y", math.nan if i == 9 else 0.0))), ["on /cp 'y_m' is nan"]),
                (self.poses(turned), ["sample 8", "norm"]),
                (self.poses(framed), ["/cp has poses in several frames ('camera', 'room')", "one tool in one frame"]),
                ({"cp": child}, ["/cp has poses of several tools ('left', 'right')"]),
                ({"force": late}, ["the clocks of /cp and /force differ", "-3 s", "up to 0.2 s", "header.stamp"]),
                ({"force": gone}, ["nothing is recorded on /force from 1700000000.800 to 1700000001.400 s", "up to 0.2 s"]),
                ({"force": lambda *_: None}, ["no messages on /force", "/cp; none of them has geometry_msgs/WrenchStamped, which --force-topic takes"])]:
            with self.subTest(words=words):
                self.refused(words, self.read, self.bag(**changes))
        self.refused(["no messages on /tip", "--pose-topic takes: /cp"], self.read, self.bag(), "/tip")
        self.refused(["no messages on /js", "--pose-topic takes: /cp"], self.read, self.bag(), None)
        self.refused(["no messages on /sensor", "--force-topic takes: /force"], self.read, self.bag(), "/cp", "/sensor")
        self.refused(["/cp is the topic of the motion (--pose-topic) and of the forces (--force-topic)"], self.read, self.bag(), "/cp", "/cp")
        self.refused(["/force is the topic of the motion"], self.read, self.bag(), "/force")
        self.refused(["/force has geometry_msgs/WrenchStamped; geometry_msgs/PoseStamped or geometry_msgs/TransformStamped is needed"],
                     self.read, self.bag(), "/force", "/other")


def shared(name):
    """A file of the data that are not in the repository, or the test is skipped."""
    folder = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or pathlib.Path(__file__).resolve().parents[2] / ".." / "shared" / "data"
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        raise unittest.SkipTest("no recording at %s (TISSUE_CONTACT_SHARED_DATA)" % path)
    return path


class RobotBagTest(Folder):
    """A dVRK's own recording: joint states and poses, no forces."""

    def test_it_has_poses_and_no_forces(self):
        robot = shared("dvrk/psm2_classic_motion.bag")
        self.refused(["no messages on /force_sensor", "none of them has geometry_msgs/WrenchStamped"], measured.read, robot, [], [], "/force_sensor",
                     "/PSM2/measured_cp")
        self.refused(["no messages on /js", "--pose-topic takes: /PSM2/measured_cp, /PSM2/setpoint_cp"], measured.read, robot, ["yaw"], ["/js"],
                     "/force_sensor")

    def test_its_poses_with_forces_beside_them(self):
        import genpy
        import rosbag
        from geometry_msgs.msg import WrenchStamped
        path, poses = os.path.join(self.folder, "robot.bag"), []
        shutil.copy(shared("dvrk/psm2_classic_motion.bag"), path)
        with rosbag.Bag(path, "a") as bag:
            for _, message, recorded in bag.read_messages("/PSM2/measured_cp"):
                poses.append(message.pose)
                wrench = WrenchStamped()
                wrench.header.stamp, wrench.wrench.force.z = message.header.stamp + genpy.Duration.from_sec(0.001), 1e-3 * len(poses)
                bag.write("/force_sensor", wrench, recorded)
        recording = measured.read(path, [], [], "/force_sensor", "/PSM2/measured_cp")
        self.assertEqual((len(recording.times_s), recording.pose_frame), (len(poses) - 1, "ECM"))  # the first pose is before the first force
        numpy.testing.assert_array_equal(recording.positions_m, [[one.position.x, one.position.y, one.position.z] for one in poses[1:]])
        numpy.testing.assert_allclose(numpy.abs(recording.quaternions[:, 3]), [abs(one.orientation.w) for one in poses[1:]])
