#!/usr/bin/python3
"""The controller against tissue, by rostest: press.test has started both."""
import unittest

import rospy
import rostest
from tissue_contact_testing import TissueFixture

STATES = 150


class Press(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.runs = [TissueFixture("/first/tissue_contact", ["probe"]), TissueFixture("/second/tissue_contact", ["probe"])]
        for run, topic in zip(cls.runs, ["/first/start", "/second/start"]):
            run.tell_to_start(topic)
        for run in cls.runs:
            run.wait_for(STATES)

    def test_nothing_went_wrong(self):
        for run in self.runs:
            self.assertEqual(run.complaints(), [])

    def test_presses_gently_and_holds(self):
        self.assertLess(self.runs[0].peak_force_n("probe"), 0.6)
        self.assertAlmostEqual(self.runs[0].forces_n("probe")[-1], 0.5, delta=0.02)

    def test_the_same_bits_again(self):
        self.assertEqual(self.runs[0].digest(), self.runs[1].digest())


if __name__ == "__main__":
    rospy.init_node("press")
    rostest.rosrun("tissue_contact_controller_test", "press", Press)
