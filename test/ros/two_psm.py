#!/usr/bin/python3
"""Two PSMs on one flap: the same bits from the replay twice and from the node, pulls that are equal and opposite, and every wrench also in
the sign and frames of CRTK; the launch file draws plots."""
import math
import os

import rosbag
import roslaunch.substitution_args
import rospy
from geometry_msgs.msg import WrenchStamped

import harness

SCENE = os.path.join(harness.PACKAGE, "config", "two_psm.yaml")
BAG = roslaunch.substitution_args.resolve_args("$(find tissue_contact)/config/two_psm.bag")
JOINT_STATES = 2301  # of each arm: 4.6 s at 500 Hz
ARMS = ["PSM1", "PSM2"]
TOPICS = ["/%s/%s" % (arm, topic) for arm in ARMS for topic in ["measured_js", "jaw/measured_js"]]
ROLL = {"PSM1": 0.4, "PSM2": -0.4}  # of the bases about the world's x axis, rad
BASE = {"PSM1": (0.0, -0.05609, 0.14025), "PSM2": (0.0, 0.05609, 0.14025)}
STRETCHED = slice(1650, 1900)  # 3.3 to 3.8 s: held still


def turned(q, v):
    """v turned by the quaternion (x, y, z, w): v + 2 w (u x v) + 2 u x (u x v)."""
    u, w = q[:3], q[3]
    t = [2 * c for c in cross(u, v)]
    return [a + w * b + c for a, b, c in zip(v, t, cross(u, t))]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def numbers(row, *columns):
    return [float(row[column]) for column in columns]


class TwoPsm(harness.TestCase):
    def replay_rows(self, name):
        self.replayed(SCENE, BAG, self.path(name))
        return {arm: [row for row in harness.read_table(self.path(name)) if row["instrument"] == arm] for arm in ARMS}

    def node_messages(self):
        """{topic below the arm: {arm: messages}} of the node, the bag played at twice its pace."""
        kinds = ["wrench", "body/measured_cf", "spatial/measured_cf"]
        with harness.node(SCENE):
            heard = {kind: {arm: harness.Listener("%s/%s/%s" % (harness.NODE, arm, kind), WrenchStamped) for arm in ARMS} for kind in kinds}
            with harness.running([harness.program_of("rosbag", "play"), "--quiet", "--wait-for-subscribers", "--queue", "100000",
                                  "--rate", "2", BAG, "--topics"] + TOPICS) as player:
                harness.wait_until(lambda: player.poll() is not None, "the end of the bag")
                self.assertEqual(player.returncode, 0)
            return {kind: {arm: heard[kind][arm].wait(lambda all: len(all) >= JOINT_STATES, "every wrench") for arm in ARMS}
                    for kind in kinds}

    def test_same_bits_equal_and_opposite_and_crtk(self):
        rows = self.replay_rows("first.csv")
        self.assertEqual([len(rows[arm]) for arm in ARMS], [JOINT_STATES] * 2)
        self.assertEqual(self.replay_rows("second.csv"), rows)
        self.check_pulls(rows)
        messages = self.node_messages()
        for arm in ARMS:
            expected = [row[::2] for row in harness.read_csv(self.path("first.csv")) if row[1] == arm]
            got = [(harness.stamp_text(w.header.stamp), harness.wrench_bits(w)) for w in messages["wrench"][arm]]
            self.assertEqual(got, expected)
            self.check_crtk(arm, rows[arm], {kind: messages[kind][arm] for kind in messages})

    def check_pulls(self, rows):
        """Held still between mirror images the flap pulls both arms inwards, equally, and nearly alone."""
        for first, second in zip(*[rows[arm][STRETCHED] for arm in ARMS]):
            pulls = [turned(numbers(row, "tip_qx", "tip_qy", "tip_qz", "tip_qw"), numbers(row, "force_x_n", "force_y_n", "force_z_n"))
                     for row in [first, second]]
            self.assertGreater(pulls[0][1], 0.05)  # N, towards the middle
            self.assertAlmostEqual(pulls[0][1], -pulls[1][1], delta=0.02 * pulls[0][1])
            # What the fixed foot of the flap adds, and the mirror image says the same of.
            self.assertAlmostEqual(pulls[0][2], pulls[1][2], delta=0.02 * pulls[0][1])
            self.assertAlmostEqual(pulls[0][0] + pulls[1][0], 0.0, delta=0.02 * pulls[0][1])
        for arm in ARMS:
            self.assertEqual(rows[arm][-1]["force_x_n"], "0")  # both have let go

    def check_crtk(self, arm, rows, messages):
        """Against the replay's pose of the tip and the base of the scene file."""
        half = ROLL[arm] / 2
        to_base = [-math.sin(half), 0.0, 0.0, math.cos(half)]
        for row, wrench, body, spatial in list(zip(rows, messages["wrench"], messages["body/measured_cf"], messages["spatial/measured_cf"]))[::50]:
            self.assertEqual((body.header.frame_id, spatial.header.frame_id), (arm + "/tip", arm + "/psm_base"))
            self.assertEqual([body.header.stamp, spatial.header.stamp], [wrench.header.stamp] * 2)
            exerted = [-number for number in harness.wrench_of(wrench)]
            self.assertEqual(harness.wrench_of(body), exerted)
            tip = numbers(row, "tip_qx", "tip_qy", "tip_qz", "tip_qw")
            arm_m = turned(to_base, [p - b for p, b in zip(numbers(row, "tip_x_m", "tip_y_m", "tip_z_m"), BASE[arm])])
            force, torque = [turned(to_base, turned(tip, part)) for part in [exerted[:3], exerted[3:]]]
            torque = [a + b for a, b in zip(torque, cross(arm_m, force))]
            for got, expected in zip(harness.wrench_of(spatial), force + torque):
                self.assertAlmostEqual(got, expected, delta=1e-12)

    def test_launch_file(self):
        plots = self.path("plots")
        code, output = harness.launch("two_psm.launch", "output:=" + plots, "rate:=2")
        self.assertEqual(code, 0, output)
        self.assertEqual(sorted(os.listdir(plots)), ["PSM1_force.png", "PSM1_friction.png", "PSM2_force.png", "PSM2_friction.png"])

    def test_crtk_is_not_there_unless_asked_for(self):
        with harness.node(harness.SCENE):
            harness.wrenches()
            topics = [topic for topic, _ in rospy.get_published_topics(harness.NODE)]
        self.assertIn(harness.NODE + "/probe/wrench", topics)
        self.assertFalse([topic for topic in topics if "measured_cf" in topic])

    def test_table_whose_columns_name_no_topic(self):
        bag = self.path("path.bag")
        for columns in ["time_s,jaw", "time_s,/PSM1/measured_js:"]:
            code, output = harness.run([harness.program("make_joint_bag.py"), self.write("path.csv", columns + "\n0,0\n1,1\n"), bag])
            self.assertEqual(code, 1)
            self.assertIn("write /TOPIC:JOINT, or give --topic", output)

    def test_table_of_a_spreadsheet_whose_joints_have_colons(self):
        bag = self.path("path.bag")
        table = self.write("path.csv", "\ufefftime_s, robot0:shoulder, jaw\r\n0, 0, 0\r\n1, 1, 0.5\r\n")
        code, output = harness.run([harness.program("make_joint_bag.py"), table, bag, "--topic", "/js"])
        self.assertEqual(code, 0, output)
        with rosbag.Bag(bag) as made:
            self.assertEqual({(topic, tuple(message.name)) for topic, message, _ in made.read_messages()},
                             {("/js", ("robot0:shoulder", "jaw"))})
        code, output = harness.run([harness.program("make_joint_bag.py"), table, bag, "--topic", "js"])
        self.assertEqual(code, 1, output)
        self.assertIn("must begin with /", output)


if __name__ == "__main__":
    harness.main(TwoPsm)
