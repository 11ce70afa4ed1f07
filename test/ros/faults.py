"""Shared by live.py, flood.py and the faults_*.py: what the node says it did with every joint state, and its end."""
import re
import signal
import threading
import time

import rospy

import harness

OK, WARN, ERROR = 0, 1, 2


def values_of(status):
    return {v.key: v.value for v in status.values}


def status_named(diagnostics, name):
    """The node's status of this name in a DiagnosticArray, or None."""
    return next((s for s in diagnostics.status if s.name.endswith(": " + name)), None)


def figures(diagnostics):
    """The node's counts in a DiagnosticArray as a dictionary of texts; empty at the start-up."""
    status = status_named(diagnostics, "tissue contact")
    return values_of(status) if status else {}


def all_told(diagnostics, sent):
    """The counts, once they tell of every joint state that was sent and none waits."""
    def complete(messages):
        values = figures(messages[-1]) if messages else {}
        return values.get("joint states: received") == str(sent) and values["joint states: waiting"] == "0"
    return figures(diagnostics.wait(complete, "%d joint states received and played" % sent)[-1])


class Driver:
    """Sends joint states at a rate, stamped with the present, from a thread of its own until stopped."""

    def __init__(self, rate_hz, path):
        self.stamps = []
        self._source = harness.JointSource()
        self._period = 1.0 / rate_hz
        self._path = path
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        start = time.monotonic()
        while not self._stop.is_set():
            due = start + len(self.stamps) * self._period
            time.sleep(max(0.0, due - time.monotonic()))
            stamp = rospy.Time.from_sec(time.time())
            if self.stamps and stamp <= self.stamps[-1]:
                continue  # two in a microsecond
            self.stamps.append(stamp)
            self._source.send(stamp, self._path(time.monotonic() - start))

    def stop(self):
        self._stop.set()
        self._thread.join()
        return len(self.stamps)


def counts_at_the_end(process, number=signal.SIGINT):
    """Sends the signal; the node ends within a second, with exit code 0, and its counts add up. Returns them and its lag."""
    start = time.monotonic()
    process.send_signal(number)
    code = process.wait(harness.DEADLINE_S)
    took = time.monotonic() - start
    output = harness.output_of(process)
    assert code == 0, output
    assert took < harness.SLOWNESS, "took %.2f s to end: %s" % (took, output)
    lines = [line for line in output.splitlines() if line.startswith("joint states: ")]
    assert len(lines) == 1, output
    counts = {word: int(number) for number, word in
              re.findall(r"(\d+) (received|accepted|merged|dropped|refused|waiting|wrenches)", lines[0])}
    assert counts["received"] == sum(counts[part] for part in
                                     ["accepted", "merged", "dropped", "refused", "waiting"]), lines[0]
    counts["lag"] = float(re.search(r"largest lag ([\d.e+-]+) s", lines[0]).group(1))
    return counts
