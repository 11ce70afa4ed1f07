#!/usr/bin/python3
"""Opens RViz on what tissue_contact_node simulates, whatever the scene: what launch/scene.launch runs beside the node.

Waits for the node's markers, then starts RViz with config/scene.rviz, its topic, fixed frame, grid and view changed to those of the
scene: tissues, legend and, where they are near, the tips of the instruments are in the picture, upright. The view follows a
tip that leaves it, and among the saved views (panel Views) is one close to each tip that moves with it. Ends with RViz.
With --write FILE it writes a configuration instead, to keep or to change, whose view stays where it is.
"""
import argparse
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import numpy
import rospkg
import rospy
import yaml
from geometry_msgs.msg import TransformStamped, Vector3
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

# Of the angle RViz opens to both sides of the view, 22.5 degrees: a ball of that radius fills the height of the window at
# 2.6 radii. What is looked at is a box, and mostly lower than long.
RADII_AWAY = 2.3  # or farther, where what stands high would be cut off
PITCH = 0.45
EDGE = 0.93 * math.tan(math.pi / 8.0)  # of a square picture, over the distance; 7 % inside, for letters have a height as well
TIP_AWAY = 0.6  # a tip that is farther from the middle, and than it was at first, takes the view along; in radii
CLOSE = 3.0  # times nearer than all: the view of one tip
TIP = "/tip"  # ends the names of markers at tips
VIEW = "tissue_contact_view"  # tf frames of our own: in the middle of the view, and VIEW/INSTRUMENT at each tip
RATE_HZ = 5.0  # of the views' frames, at most
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
        texts = [ends(m, right) for m in markers if m.ns == "force_texts"]
        points += [text for text in texts if numpy.linalg.norm(text[0] - middle) < size]
        self.focus = self.middle(points)
        self.radius = max(numpy.linalg.norm(numpy.ptp(numpy.concatenate(points), axis=0)) / 2.0, 1e-6)
        self.distance = max(RADII_AWAY * self.radius, self.distance_for(numpy.concatenate(points) - self.focus))

        nearest = min((numpy.linalg.norm(tip - self.focus) for tip in tips_of(markers).values()), default=0.0)
        self.reach = max(TIP_AWAY * self.radius, nearest if nearest < self.radius else 0.0)

    def distance_for(self, points):
        """From how far the view has all these in it; relative to its focus."""
        back = numpy.array([math.cos(self.yaw) * math.cos(PITCH), self.up * math.sin(self.yaw) * math.cos(PITCH), self.up * math.sin(PITCH)])
        right = numpy.cross([0.0, 0.0, self.up], back) / math.cos(PITCH)
        aside = numpy.abs(points @ numpy.stack((right, numpy.cross(back, right)), axis=1)).max(axis=1)
        return (aside / EDGE + points @ back).max()

    def follow(self, tips):
        """Where the middle of the view is to be: that of the scene, or so far from there that the nearest tip is in the picture."""
        way = min((tip - self.focus for tip in tips), key=numpy.linalg.norm, default=numpy.zeros(3))
        length = numpy.linalg.norm(way)
        return self.focus + way * max(0.0, 1.0 - self.reach / max(length, 1e-12))

    @staticmethod
    def middle(points):
        everything = numpy.concatenate(points)
        return (everything.min(axis=0) + everything.max(axis=0)) / 2.0


def tips_of(markers):
    """{instrument: place of its tip}"""
    return {m.ns[:-len(TIP)]: array([m.pose.position])[0] for m in markers if m.ns.endswith(TIP)}


def view_at(name, frame, distance, picture, focus=(0.0, 0.0, 0.0)):
    return {"Class": "rviz/Orbit", "Name": name, "Distance": float(distance), "Focal Point": dict(zip("XYZ", map(float, focus))),
            "Near Clip Distance": float(picture.radius / 100.0), "Pitch": PITCH, "Yaw": picture.yaw, "Invert Z Axis": picture.up < 0.0,
            "Target Frame": frame, "Value": "Orbit (rviz)"}


def configuration(picture, tips, node, follows):
    """The configuration of RViz as text. It `follows` where a Follower runs beside it."""
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
    away = picture.distance
    manager["Views"] = {"Current": view_at("All", "<Fixed Frame>", away, picture, picture.focus)}
    if follows:
        manager["Views"] = {"Current": view_at("All", VIEW, away, picture),
                            "Saved": [view_at("All", VIEW, away, picture)] +
                                     [view_at("Tip of " + name, VIEW + "/" + name, away / CLOSE, picture) for name in tips]}
    return yaml.safe_dump(config, sort_keys=False)


def markers_of(node):
    """The first markers of the node. It shows them to whoever comes, before its first joint state too."""
    markers = None
    while markers is None:
        try:
            markers = rospy.wait_for_message(node + "/markers", MarkerArray, timeout=PATIENCE_S).markers
        except rospy.ROSInterruptException:
            raise
        except rospy.ROSException:
            print("waiting for %s/markers: the node must run, and publish.markers_rate_hz of its scene be above 0" % node, flush=True)
    return markers


class Follower:
    """Tells tf where the views are, by the newest markers of the node, and so to whoever comes to tf later: RViz shows nothing without.

    Markers are read at RATE_HZ at most: those of an organ are megabytes, and reading them takes a core from the node."""

    def __init__(self, picture, node, markers):
        self._picture = picture
        self._tf = rospy.Publisher("/tf", TFMessage, queue_size=10, latch=True)
        self._told = None
        self._tell(markers)
        self._newest = None
        self._came = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()
        rospy.Subscriber(node + "/markers", rospy.AnyMsg, self._take, queue_size=1, buff_size=1 << 24)

    def _take(self, message):
        self._newest = message._buff  # as it came, see AnyMsg
        self._came.set()

    def _run(self):
        while True:
            self._came.wait()
            self._came.clear()
            try:
                self._tell(MarkerArray().deserialize(self._newest).markers)
            except Exception as error:  # of markers of another version, or none: the next ones may be better
                rospy.logwarn_throttle(10.0, "the view does not follow: %s" % error)
            time.sleep(1.0 / RATE_HZ)

    def _tell(self, markers):
        tips = tips_of(markers)
        places = {VIEW: self._picture.follow(tips.values()), **{VIEW + "/" + name: tip for name, tip in tips.items()}}
        told = TFMessage([self._transform(markers[0].header, *one) for one in places.items()])
        if told != self._told:  # tf complains of what it has
            self._tf.publish(told)
        self._told = told

    @staticmethod
    def _transform(header, frame, place):
        transform = TransformStamped(header=header, child_frame_id=frame)
        transform.transform.translation = Vector3(*place)
        transform.transform.rotation.w = 1.0
        return transform


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
    rospy.init_node("open_rviz", argv=[], anonymous=True, disable_signals=True)  # not by the name that RViz is to have
    arguments.node = rospy.resolve_name(arguments.node)
    markers = markers_of(arguments.node)
    picture = Picture(markers)
    config = configuration(picture, tips_of(markers), arguments.node, follows=not arguments.write)
    if not arguments.write:
        Follower(picture, arguments.node, markers)  # rospy keeps it
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
