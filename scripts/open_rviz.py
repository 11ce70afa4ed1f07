#!/usr/bin/python3
"""Opens RViz on what tissue_contact_node simulates, whatever the scene: what launch/scene.launch runs beside the node.

Waits for the node's markers, then starts RViz with config/scene.rviz, its topic, fixed frame, grid and view changed to those of the
scene: tissues, legend and, where they are near, the tips of the instruments are in the picture, upright. Ends with RViz.
With --write FILE it writes that configuration instead, to keep or to change.
"""
import argparse
import math
import os
import signal
import subprocess
import sys
import tempfile

import numpy
import rospkg
import rospy
import yaml
from visualization_msgs.msg import Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

# Of the angle RViz opens to both sides of the view, 22.5 degrees: a ball of that radius fills the height of the window at
# 2.6 radii. What is looked at is a box, and mostly lower than long.
RADII_AWAY = 2.3
PATIENCE_S = 10.0  # before it says what it waits for


def fail(message):
    sys.exit("open_rviz.py: " + message)


LETTER = 0.27  # half the width of a letter, in heights of a text


def array(points):
    return numpy.array([(p.x, p.y, p.z) for p in points])


def ends(text, right):
    """Of a text that lies along `right`, a unit vector, and has its middle at its place."""
    half = LETTER * text.scale.z * len(text.text) * right
    middle = array([text.pose.position])
    return numpy.concatenate((middle - half, middle + half))


class Picture:
    """What the markers show, by what it is."""

    def __init__(self, markers):
        tissues = {m.ns for m in markers if m.type == Marker.LINE_LIST}
        points = [array(m.points) for m in markers if m.ns in tissues and m.points]
        legend = [m for m in markers if m.ns == "legend"]
        words = [m for m in legend if m.type == Marker.TEXT_VIEW_FACING]
        bar = array(next(m for m in legend if m.type == Marker.TRIANGLE_LIST).points)
        # The node has laid the legend out upright, and to the right of the tissues as seen from where they are seen well.
        self.frame = markers[0].header.frame_id
        self.up = 1.0 if bar[-1, 2] > bar[0, 2] else -1.0
        right = array([words[0].pose.position])[0] - bar[0]
        right[2] = 0.0
        right /= numpy.linalg.norm(right)
        self.yaw = math.atan2(-right[0], self.up * right[1]) % (2.0 * math.pi)  # RViz turns the other way with z inverted
        points += [ends(m, right) for m in words]
        self.ground = self.up * min((self.up * one[:, 2]).min() for one in points)
        size = numpy.linalg.norm(numpy.ptp(numpy.concatenate(points), axis=0))
        middle = self.middle(points)
        tips = [ends(m, right) for m in markers if m.ns == "force_texts"]
        points += [tip for tip in tips if numpy.linalg.norm(tip[0] - middle) < size]
        self.focus = self.middle(points)
        self.radius = max(numpy.linalg.norm(numpy.ptp(numpy.concatenate(points), axis=0)) / 2.0, 1e-6)

    @staticmethod
    def middle(points):
        everything = numpy.concatenate(points)
        return (everything.min(axis=0) + everything.max(axis=0)) / 2.0


def configuration(markers, node):
    """The configuration of RViz as text."""
    picture = Picture(markers)
    with open(os.path.join(rospkg.RosPack().get_path("tissue_contact"), "config", "scene.rviz"), encoding="utf-8") as stream:
        config = yaml.safe_load(stream)
    manager = config["Visualization Manager"]
    manager["Global Options"]["Fixed Frame"] = picture.frame
    cell = 10.0 ** round(math.log10(picture.radius / 8.0))
    for display in manager["Displays"]:
        if display["Class"] == "rviz/MarkerArray":
            display["Marker Topic"] = node + "/markers"
        elif display["Class"] == "rviz/Grid":
            display["Name"] = "Grid (%g m)" % cell
            display["Cell Size"] = cell
            display["Plane Cell Count"] = 2 * math.ceil(1.5 * picture.radius / cell)
            corner = [cell * round(float(c) / cell) for c in picture.focus[:2]]
            display["Offset"] = dict(zip("XYZ", corner + [float(picture.ground)]))
    view = manager["Views"]["Current"]
    view["Distance"] = float(RADII_AWAY * picture.radius)
    view["Focal Point"] = dict(zip("XYZ", map(float, picture.focus)))
    view["Near Clip Distance"] = float(picture.radius / 100.0)
    view["Yaw"] = picture.yaw
    view["Invert Z Axis"] = picture.up < 0.0
    return yaml.safe_dump(config, sort_keys=False)


def markers_of(node):
    """The first markers of the node. It shows them to whoever comes, before its first joint state too."""
    rospy.init_node("open_rviz", argv=[], anonymous=True, disable_signals=True)  # not by the name that RViz is to have
    markers = None
    while markers is None:
        try:
            markers = rospy.wait_for_message(node + "/markers", MarkerArray, timeout=PATIENCE_S).markers
        except rospy.ROSInterruptException:
            raise
        except rospy.ROSException:
            print("waiting for %s/markers: the node must run, and publish.markers_rate_hz of its scene be above 0" % node, flush=True)
    rospy.signal_shutdown("has the view")
    return markers


def run_rviz(config, arguments):
    """Exit code of RViz, which is asked to end when we are."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "scene.rviz")
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(config)
        try:
            rviz = subprocess.Popen(["rviz", "-d", file] + arguments)
        except FileNotFoundError:
            fail("rviz is not installed: apt-get install rviz, or rviz:=false")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: rviz.terminate())
        code = rviz.wait()
    return 0 if code in (0, -signal.SIGTERM) else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--node", default="/tissue_contact", help="default: %(default)s")
    parser.add_argument("--write", metavar="FILE", help="writes the configuration to this file and opens nothing")
    arguments = parser.parse_args(rospy.myargv()[1:])
    config = configuration(markers_of(arguments.node), arguments.node)
    if not arguments.write:
        sys.exit(run_rviz(config, [a for a in sys.argv[1:] if ":=" in a]))
    try:
        with whole_file(arguments.write) as part:
            with open(part, "w", encoding="utf-8") as stream:
                stream.write(config)
    except OSError as error:
        fail("cannot write %s: %s" % (error.filename, error.strerror))
    print("wrote " + arguments.write)


if __name__ == "__main__":
    try:
        main()
    except (rospy.ROSException, KeyboardInterrupt):
        sys.exit(0)  # stopped while it waited
