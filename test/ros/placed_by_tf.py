#!/usr/bin/python3
"""A base placed by tf: the node waits for the frame, then stands where tf says; the URDF comes from a parameter."""
import os
import sys

import rospy
import rostest
from geometry_msgs.msg import TransformStamped, WrenchStamped
from tf2_msgs.msg import TFMessage

import harness


class PlacedByTf(harness.TestCase):
    def test_same_wrenches_as_placed_by_the_scene(self):
        with open(os.path.join(harness.PACKAGE, "urdf", "probe.urdf"), encoding="utf-8") as stream:
            rospy.set_param("/robot_description", stream.read())
        scene = self.changed_scene({"urdf: package://tissue_contact/urdf/probe.urdf": "robot_description: robot_description",
                                    "position_m: [0, 0, 0.026]": "tf_frame: stage"})

        transform = TransformStamped()
        transform.header.frame_id = "world"
        transform.child_frame_id = "stage"
        transform.transform.translation.z = 0.026
        transform.transform.rotation.w = 1.0
        static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        samples = harness.press(60)
        with harness.node(scene):
            harness.wait_until(lambda: static.get_num_connections() > 0, "the node asking for tf")
            static.publish(TFMessage([transform]))
            wrenches = harness.Listener("/tissue_contact/probe/wrench", WrenchStamped)
            harness.JointSource().send_all(samples)
            got = wrenches.wait_for_stamp(samples[-1][0])
        self.assertEqual(len(got), len(samples))

        bag = self.path("press.bag")
        csv = self.path("out.csv")
        harness.write_bag(bag, samples)
        code, errors = harness.replay(harness.SCENE, bag, csv)
        self.assertEqual(code, 0, errors)
        expected = [bits for _, _, bits in harness.read_csv(csv)]
        self.assertEqual([harness.wrench_bits(w) for w in got], expected)


if __name__ == "__main__":
    rospy.init_node("placed_by_tf")
    rostest.rosrun("tissue_contact", "placed_by_tf", PlacedByTf, sys.argv)
