#!/usr/bin/python3
"""A base placed by tf: the node waits for the frame, then stands where tf says, and tells when that moves; the URDF comes from a parameter."""
import os

import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from tf2_msgs.msg import TFMessage

import harness


class PlacedByTf(harness.TestCase):
    @staticmethod
    def frames_level(arrays):
        """Of the last diagnostics about tf frames; None before."""
        levels = [status.level for array in arrays for status in array.status if status.name.endswith("tf frames")]
        return levels[-1] if levels else None

    def test_same_wrenches_as_placed_by_the_scene(self):
        with open(os.path.join(harness.PACKAGE, "urdf", "probe.urdf"), encoding="utf-8") as stream:
            rospy.set_param("/robot_description", stream.read())
        scene = self.changed_scene({"urdf: package://tissue_contact/urdf/probe.urdf": "robot_description: robot_description",
                                    "position_m: [0, 0, 0.026]": "tf_frame: stage"})

        static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        moving = rospy.Publisher("/tf", TFMessage, queue_size=2)
        far = harness.stage_at(1.0)  # by stamps that ros::Time cannot add to
        far.transforms[0].child_frame_id = "far"
        far.transforms[0].header.stamp = rospy.Time(4294967295, 999999999)
        samples = harness.press(60)
        with harness.node(scene):
            harness.wait_until(lambda: static.get_num_connections() > 0, "the node asking for tf")
            harness.wait_until(lambda: moving.get_num_connections() > 0, "the node asking for tf that moves")
            for _ in range(2):
                moving.publish(far)
            static.publish(harness.stage_at(0.026))
            wrenches = harness.wrenches()
            harness.JointSource().send_all(samples)
            got = wrenches.wait_for_stamp(samples[-1][0])
            told = harness.diagnostics()
            told.wait(lambda all: self.frames_level(all) == DiagnosticStatus.OK, "a base that stands still")
            static.publish(harness.stage_at(0.028))
            told.wait(lambda all: self.frames_level(all) == DiagnosticStatus.WARN, "a base that has moved by 2 mm")
        self.assertEqual(len(got), len(samples))

        csv = self.path("out.csv")
        self.replayed(harness.SCENE, self.bag_of("press.bag", samples), csv)
        expected = [bits for _, _, bits in harness.read_csv(csv)]
        self.assertEqual([harness.wrench_bits(w) for w in got], expected)


if __name__ == "__main__":
    harness.main(PlacedByTf)
