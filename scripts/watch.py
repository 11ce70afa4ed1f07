#!/usr/bin/python3
"""Live plots of what tissue_contact_node finds: per instrument the force with its likely error, then lag and residual.

Shows the last seconds in a window that is drawn anew as messages come; --png FILE takes no display: it listens for those seconds,
or until no more comes, and writes one picture. Time is that of the messages, so that a recording played at any rate looks the same.

  force     size of ~INSTRUMENT/wrench; the band is its likely error, by mesh, step and solver, of ~status
  lag       wall time from the receipt of a joint state to its wrench, and the time a step takes, of ~status
  residual  of the momentum balance after the last sweep, of ~status
"""
import argparse
import collections
import math
import os
import sys
import threading
import time

import numpy
import rosgraph
import rospy
from geometry_msgs.msg import WrenchStamped

from tissue_contact.msg import Status

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

REDRAW_S = 0.5  # a drawing takes a tenth of a second of a core, which the node may need
QUIET_S = 5.0  # without a message for so long, after the first, a picture is not waited for any longer
MOST = 100000  # samples kept of one curve: ten seconds at ten kilohertz


def fail(message):
    sys.exit("watch.py: " + message)


class Curves:
    """Rows of numbers by name, of the last seconds of message time; the first number of a row is its time."""

    def __init__(self, seconds):
        self._seconds = seconds
        self._lock = threading.Lock()
        self._rows = {}
        self._newest = None

    def add(self, name, stamp, *values):
        now = stamp.to_sec()
        with self._lock:
            if self._newest is not None and now < self._newest - self._seconds:
                self._rows.clear()  # a recording that starts again
                self._newest = None
            self._newest = now if self._newest is None else max(now, self._newest)
            rows = self._rows.setdefault(name, collections.deque(maxlen=MOST))
            rows.append((now,) + values)
            while rows[0][0] < self._newest - self._seconds:
                rows.popleft()

    def of(self, name):
        """Array of rows, times relative to the newest of all."""
        with self._lock:
            rows = numpy.array(self._rows.get(name, []))
            newest = self._newest
        if len(rows):
            rows[:, 0] -= newest
        return rows

    def extent(self):
        """Times of the oldest and the newest sample; None before the first."""
        with self._lock:
            return self._rows and (min(rows[0][0] for rows in self._rows.values()), self._newest)


class Watch:
    """Listens to a node."""

    def __init__(self, node, seconds):
        self.curves = Curves(seconds)
        self.instruments = self._wait_for(node)
        for name in self.instruments:
            rospy.Subscriber("%s/%s/wrench" % (node, name), WrenchStamped, self._take_wrench, name, tcp_nodelay=True)
        rospy.Subscriber(node + "/status", Status, self._take_status)

    @staticmethod
    def _wait_for(node):
        """Names of the instruments, once the node is there."""
        master = rosgraph.Master(rospy.get_name())
        is_told = False
        while not rospy.is_shutdown():
            names = [topic[len(node) + 1:-len("/wrench")] for topic, kind in master.getPublishedTopics("/")
                     if topic.startswith(node + "/") and topic.endswith("/wrench") and kind == WrenchStamped._type]
            if names:
                return sorted(names)
            if not is_told:
                print("watch.py: waiting for %s/INSTRUMENT/wrench" % node, flush=True)
                is_told = True
            rospy.rostime.wallsleep(REDRAW_S)
        sys.exit(0)

    def _take_wrench(self, message, name):
        force = message.wrench.force
        self.curves.add("force of " + name, message.header.stamp, math.hypot(force.x, force.y, force.z))

    def _take_status(self, message):
        for error in message.force_errors:
            self.curves.add("error of " + error.instrument, message.header.stamp, error.force, error.error)
        self.curves.add("status", message.header.stamp, 1e3 * message.lag, 1e3 * message.step_time, message.momentum_residual)


def draw(watch, axes, seconds):
    for name, plot in zip(watch.instruments, axes):
        draw_force(plot, name, watch.curves.of("force of " + name), watch.curves.of("error of " + name))
    status = watch.curves.of("status")
    lag, residual = axes[-2:]
    for plot, label in ((lag, "ms"), (residual, "momentum residual (-)")):
        plot.clear()
        plot.set_ylabel(label)
    if len(status):
        lag.plot(status[:, 0], status[:, 1], "tab:purple", label="lag")
        lag.plot(status[:, 0], status[:, 2], "tab:gray", label="one step")
        lag.legend(loc="upper left", fontsize=8)
        if (status[:, 3] > 0.0).any():
            residual.semilogy(status[:, 0], numpy.where(status[:, 3] > 0.0, status[:, 3], numpy.nan), "tab:green", marker=".")
    lag.set_ylim(bottom=0.0)
    for plot in axes:
        plot.set_xlim(-seconds, 0.0)
        plot.grid(True, alpha=0.3)
    residual.set_xlabel("time before the newest message (s)")


def draw_force(plot, name, force, error):
    plot.clear()
    plot.set_ylabel("force on %s (N)" % name)
    if len(error):
        plot.fill_between(error[:, 0], numpy.maximum(error[:, 1] - error[:, 2], 0.0), error[:, 1] + error[:, 2], color="tab:blue",
                          alpha=0.15, linewidth=0.0, label="its likely error")
    if len(force):
        plot.plot(force[:, 0], force[:, 1], "tab:blue", linewidth=1.5,
                  label="%.3g N" % force[-1, 1] + (" ± %.2g N" % error[-1, 2] if len(error) else ""))
        plot.legend(loc="upper left", fontsize=8)
    plot.set_ylim(bottom=0.0)


def new_axes(pyplot, instruments):
    figure, axes = pyplot.subplots(instruments + 2, 1, sharex=True, figsize=(8.0, 2.2 * (instruments + 2)), dpi=110)
    figure.subplots_adjust(left=0.12, right=0.97, top=0.97, bottom=0.22 / (instruments + 2), hspace=0.15)
    figure.canvas.manager.set_window_title("tissue_contact")
    return figure, axes


def write_picture(watch, seconds, file):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    before, since = None, time.monotonic()
    while not rospy.is_shutdown():
        extent = watch.curves.extent() or None
        if extent != before:
            before, since = extent, time.monotonic()
        if extent and (extent[1] - extent[0] > 0.99 * seconds or time.monotonic() - since > QUIET_S):
            break
        rospy.rostime.wallsleep(REDRAW_S)
    if not before:
        fail("stopped before the first message")
    figure, axes = new_axes(pyplot, len(watch.instruments))
    draw(watch, axes, seconds)
    try:
        with whole_file(file) as part:
            figure.savefig(part, format="png")
    except OSError as error:
        fail("cannot write %s: %s" % (error.filename, error.strerror))
    print("wrote " + file, flush=True)


def show(watch, seconds):
    from matplotlib import pyplot
    try:
        pyplot.switch_backend("TkAgg")
        figure, axes = new_axes(pyplot, len(watch.instruments))
    except (ImportError, RuntimeError):  # no tk, no display
        fail("no window: apt-get install python3-tk, set DISPLAY, or give --png FILE")
    is_open = [True]
    figure.canvas.mpl_connect("close_event", lambda _: is_open.clear())
    while is_open and not rospy.is_shutdown():
        began = time.monotonic()
        draw(watch, axes, seconds)
        figure.canvas.draw_idle()
        pyplot.pause(max(REDRAW_S - (time.monotonic() - began), 0.01))


def seconds_of(text):
    value = float(text)
    if not 0.1 <= value <= 600.0:
        raise argparse.ArgumentTypeError("%s is not from 0.1 to 600 s" % text)
    return value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--node", default="/tissue_contact", help="default: %(default)s")
    parser.add_argument("--seconds", type=seconds_of, default=10.0, help="how much is shown, default: %(default)g")
    parser.add_argument("--png", metavar="FILE", help="write one picture of the next seconds and end")
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("watch", anonymous=True)
    arguments.node = rospy.resolve_name(arguments.node)
    watch = Watch(arguments.node, arguments.seconds)
    if arguments.png:
        write_picture(watch, arguments.seconds, arguments.png)
    else:
        show(watch, arguments.seconds)


if __name__ == "__main__":
    main()
