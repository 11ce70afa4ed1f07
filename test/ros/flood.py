#!/usr/bin/python3
"""Far more joint states than the node can step through or even hold: what became of each is counted, and the node ends
within a second."""
import io
import time

import rospy
from sensor_msgs.msg import JointState

import faults
import harness

COUNT = 200000
RATE_HZ = 25000.0


class Packed(JointState):
    """Serialized beforehand, since Python takes longer for that than the flood may; its publisher leaves header.seq alone."""
    _has_header = False

    def __init__(self, raw=b""):
        super().__init__()
        self.raw = raw

    def serialize(self, buff):
        buff.write(self.raw)


def pack(number):
    message = JointState(name=["x", "y", "z"], position=[0.0, 0.0, -0.001])
    message.header.seq = number
    # So far apart that a hundred, which leave at once, are more than MAX_LAG_S.
    message.header.stamp = rospy.Time(harness.START_S) + rospy.Duration.from_sec(0.001) * number
    stream = io.BytesIO()
    message.serialize(stream)
    return Packed(stream.getvalue())


class Flood(harness.TestCase):
    def scene(self):
        """One whose steps take many times as long as the flood leaves them on any machine."""
        return self.changed_scene({"MAX_STEP_S": 0.001, "MAX_LAG_S": 0.02, "[14, 10, 5]": "[36, 28, 14]"}, source="live.yaml")

    def test_what_was_sent_is_received_or_known_to_be_missing(self):
        messages = [pack(i) for i in range(COUNT)]
        with harness.node(self.scene()) as process:
            diagnostics = harness.diagnostics()
            publisher = rospy.Publisher(harness.TOPIC, Packed, queue_size=COUNT, tcp_nodelay=True)
            harness.wait_until(lambda: publisher.get_num_connections() > 0, "a subscriber")
            start = time.monotonic()
            for i, message in enumerate(messages):
                if i % 100 == 0:
                    time.sleep(max(0.0, start + i / RATE_HZ - time.monotonic()))
                publisher.publish(message)
            took = time.monotonic() - start

            def complete(told):
                values = faults.figures(told[-1]) if told else {}
                return "joint states: received" in values and COUNT == (
                    int(values["joint states: received"]) + int(values["joint states: missing by header.seq"]))
            values = faults.figures(diagnostics.wait(complete, "all of the flood")[-1])
            counts = faults.counts_at_the_end(process)
        print("%d sent in %.1f s: %s; missing %s" % (COUNT, took, counts, values["joint states: missing by header.seq"]))
        self.assertEqual(values["joint states: missing by header.seq"], "0")  # the connection holds what the node has no time for
        self.assertEqual(counts["received"], COUNT)
        self.assertGreater(counts["accepted"], 0)
        self.assertGreater(counts["dropped"], 0)  # it was a flood


if __name__ == "__main__":
    harness.main(Flood)
