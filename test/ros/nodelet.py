#!/usr/bin/python3
"""The node as a nodelet: alone and in a manager, unloaded and loaded again; the same wrenches as the node's, bit for bit."""
import rosgraph
import rospy
from rosgraph_msgs.msg import Log

import harness

TYPE = "tissue_contact/TissueContact"


def nodelet(*arguments):
    return harness.running([harness.program_of("nodelet", "nodelet")] + list(arguments))


def has_service(name):
    return name in [service for service, _ in rosgraph.Master("/test").getSystemState()[2]]


class Nodelet(harness.TestCase):
    samples = harness.press(40)

    def press(self):
        wrenches = harness.wrenches()
        self.source = harness.JointSource()
        self.source.send_all(self.samples)
        got = wrenches.wait(lambda all: len(all) >= 40, "40 wrenches")
        wrenches.close()
        return [(w.header.stamp, harness.wrench_bits(w)) for w in got]

    def test_it_does_as_the_node(self):
        with harness.node(harness.SCENE):
            expected = self.press()
        self.assertTrue(any(any(bits) for _, bits in expected))
        with nodelet("standalone", TYPE, "__name:=tissue_contact", "_scene:=" + harness.SCENE):
            self.assertEqual(self.press(), expected)
        rospy.set_param(harness.NODE + "/scene", harness.SCENE)
        log = harness.Listener("/rosout", Log, connect=False)
        with nodelet("manager", "__name:=manager"):
            for _ in range(2):
                with nodelet("load", TYPE, "manager", "__name:=tissue_contact"):
                    self.assertEqual(self.press(), expected)
                    log.wait(lambda all: any(m.name == "/manager" for m in all), "the log of the manager")  # from the next load on, all of it
                harness.wait_until(lambda: not self.source.is_heard(), "the end of its connection")  # or the next one's would be taken for there
                harness.wait_until(lambda: not has_service(harness.NODE + "/reset"), "its end in the manager")  # which loads no second one of the name

        advice = [m for m in log.wait(lambda all: any("all other pairs" in m.msg for m in all), "the advice, to its last line")
                  if m.msg.startswith("advisor: ")]
        # Cells of 10 mm under a ball of 5 mm: a warning. What was chosen is none.
        self.assertEqual({m.level for m in advice if "mesh of tissue 'block'" in m.msg}, {Log.WARN})
        self.assertEqual({m.level for m in advice if "mesh of" not in m.msg}, {Log.INFO})
        # Once a press, when the strain under the ball first is too much for the law.
        law = [m for m in log.wait(lambda all: any("beyond the range" in m.msg for m in all), "a warning of the law's range")
               if "beyond the range" in m.msg]
        self.assertLessEqual(len(law), 2)
        for m in law:
            self.assertEqual(m.level, Log.WARN)
            self.assertRegex(m.msg, r"^1000\.1[12]\d* s: tissue 'block' is strained by 0\.1\d under 'probe', beyond the range of the "
                                    r"corotational law: .* % too small")

    def test_a_bad_scene_is_told(self):
        with nodelet("standalone", TYPE, "__name:=tissue_contact", "_scene:=/missing.yaml") as process:
            harness.wait_until(lambda: "missing.yaml" in harness.output_of(process), "a message about the scene")


if __name__ == "__main__":
    harness.main(Nodelet)
