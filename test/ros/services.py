#!/usr/bin/python3
"""The services of a running node: pause, one step, resume, reset; the state saved, the node killed and started again, the state loaded."""
import os
import signal

import rospy
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

import faults
import harness
from tissue_contact.msg import Status
from tissue_contact.srv import StateFile


def call(name, *arguments):
    """Answer of a service of the node."""
    kind = StateFile if arguments else Trigger
    service = harness.NODE + "/" + name
    rospy.wait_for_service(service, harness.DEADLINE_S)
    return rospy.ServiceProxy(service, kind)(*arguments)


class Services(harness.TestCase):
    def call(self, name, *arguments):
        answer = call(name, *arguments)
        self.assertTrue(answer.success, answer.message)
        return answer.message

    def refusal(self, name, *arguments):
        answer = call(name, *arguments)
        self.assertFalse(answer.success, answer.message)
        return answer.message

    def bits(self, wrenches, count):
        got = wrenches.wait(lambda all: len(all) >= count, "%d wrenches" % count)
        self.assertEqual(len(got), count)
        return [(w.header.stamp, harness.wrench_bits(w)) for w in got]

    def test_paused_it_takes_one_step_at_a_time(self):
        samples = harness.press(20)
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            diagnostics = harness.diagnostics()
            source = harness.JointSource()
            self.assertIn("call ~pause first", self.refusal("step"))
            self.assertIn("before any joint state", self.call("pause"))
            self.assertIn("no joint state waits", self.refusal("step"))
            source.send_all(samples)
            diagnostics.wait(lambda all: all and faults.figures(all[-1]).get("joint states: waiting") == "20", "20 states that wait")
            status = faults.status_named(diagnostics.messages[-1], "tissue contact")
            self.assertEqual(status.level, faults.OK)
            self.assertIn("paused", status.message)
            for stamp, _ in samples[:3]:
                self.assertIn(harness.stamp_text(stamp)[:8], self.call("step"))
            self.assertEqual([stamp for stamp, _ in self.bits(wrenches, 3)], [stamp for stamp, _ in samples[:3]])
            self.call("resume")
            stepped = self.bits(wrenches, 20)
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            harness.JointSource().send_all(samples)
            self.assertEqual(self.bits(wrenches, 20), stepped)

    def test_reset_begins_anew_at_any_time(self):
        samples = harness.press(60)
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            statuses = harness.Listener("/tissue_contact/status", Status)
            source = harness.JointSource()
            source.send_all(samples[:30])
            first = self.bits(wrenches, 30)
            self.call("reset")
            source.send_all(samples[:30])  # the same stamps: without the reset they would be refused
            self.assertEqual(self.bits(wrenches, 60), first + first)
            told = statuses.wait(lambda all: any(b.header.stamp < a.header.stamp for a, b in zip(all, all[1:])), "a status after the reset")
            self.assertEqual({status.resets for status in told}, {0})  # time did not go back, it was asked for

    def test_a_start_in_contact_is_told_once_each(self):
        """What the tool did to the tissue before is missing, and nothing said so."""
        samples = harness.press(60)[25:]
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            log = harness.Listener("/rosout", Log)

            def said():
                return [m.msg for m in log.messages if "touches tissue at its first joint state" in m.msg]
            source = harness.JointSource()
            source.send_all(samples)
            self.bits(wrenches, 35)
            log.wait(lambda _: len(said()) == 1, "the warning")
            self.call("reset")
            source.send_all(samples)
            self.bits(wrenches, 70)
            log.wait(lambda _: len(said()) == 2, "the warning after the reset")
            self.call("reset")
            source.send_all(harness.press(20))
            self.bits(wrenches, 90)
            self.assertEqual(len(said()), 2)

    def test_a_state_goes_on_in_another_process(self):
        samples = harness.press(60)
        state = self.path("press.state")
        with harness.node(harness.SCENE) as process:
            wrenches = harness.wrenches()
            source = harness.JointSource()
            source.send_all(samples[:30])
            self.bits(wrenches, 30)
            self.assertIn(state, self.call("save_state", state))
            source.send_all(samples[30:45])
            expected = self.bits(wrenches, 45)[30:]
            self.assertGreater(wrenches.messages[-1].wrench.force.z, 0.01)  # killed in contact
            process.send_signal(signal.SIGKILL)
            process.wait()
            self.assertFalse(source.is_heard(), "the next node would be taken for there")
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            source = harness.JointSource()
            self.assertIn(state, self.call("load_state", state))
            source.send_all(samples[30:45])
            self.assertEqual(self.bits(wrenches, 15), expected)

    def test_what_waits_is_not_taken_into_another_state(self):
        samples = harness.press(60)
        state = self.path("press.state")
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            diagnostics = harness.diagnostics()
            source = harness.JointSource()
            source.send_all(samples[:30])
            self.bits(wrenches, 30)
            self.call("save_state", state)
            source.send_all(samples[30:40])
            expected = self.bits(wrenches, 40)[30:]
            self.call("pause")
            source.send_all(samples[40:])
            diagnostics.wait(lambda all: all and faults.figures(all[-1]).get("joint states: waiting") == "20", "20 states that wait")
            self.call("load_state", state)
            self.call("resume")
            source.send_all(samples[30:40])
            self.assertEqual(self.bits(wrenches, 50)[40:], expected)
            told = faults.all_told(diagnostics, 70)
            self.assertEqual(told["joint states: merged"], "20")

    def test_what_is_no_state_of_this_scene_is_refused(self):
        samples = harness.press(40)
        other = self.changed_scene({"youngs_modulus_pa: 5000": "youngs_modulus_pa: 6000"})
        foreign = self.path("foreign.state")
        with harness.node(other):
            self.call("save_state", foreign)
        precious = self.write("precious.txt", "not to be lost\n")
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            source = harness.JointSource()
            source.send_all(samples[:20])
            self.bits(wrenches, 20)
            self.assertIn("material is another one", self.refusal("load_state", foreign))
            self.assertIn("no saved state", self.refusal("load_state", precious))
            self.assertIn("does not exist", self.refusal("load_state", self.path("missing")))
            self.assertIn("no file is named", self.refusal("load_state", ""))
            self.assertIn("not replaced", self.refusal("save_state", precious))
            self.assertIn("no folder", self.refusal("save_state", self.path("no folder/press.state")))
            self.refusal("save_state", "/dev/null")
            os.mkfifo(self.path("fifo"))
            self.refusal("load_state", self.path("fifo"))
            source.send_all(samples[20:])
            got = self.bits(wrenches, 40)
        with open(precious, encoding="ascii") as stream:
            self.assertEqual(stream.read(), "not to be lost\n")
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            harness.JointSource().send_all(samples)
            self.assertEqual(self.bits(wrenches, 40), got)


if __name__ == "__main__":
    harness.main(Services)
