#!/usr/bin/python3
"""Plots the forces of a bag that holds what tissue_contact_node published, or tissue_contact_replay --out wrote.

Writes into the output folder
  <instrument>_force.png     force on the instrument over time, in its tip frame, and how wrong it likely is
  <instrument>_friction.png  tangential over normal contact force (sums over contacts) over time
"""
import argparse
import os
import sys
from urllib.parse import unquote

import numpy
import rosbag
import rospkg
import yaml

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file


def fail(message):
    sys.exit("plot_forces.py: " + message)


def vector(v):
    return numpy.array([v.x, v.y, v.z])


class Forces:
    """What is plotted, from messages in the order of their time, which is the messages' own."""

    def __init__(self):
        self.wrenches = {}  # instrument -> list of (time, force in the tip frame)
        self.errors = {}  # instrument -> list of (time, size of the force, its likely error)
        self.ratios = {}  # instrument -> list of (time, sum |Ft|, sum Fn)

    def take_wrench(self, instrument, message):
        self.wrenches.setdefault(instrument, []).append((message.header.stamp.to_sec(), vector(message.wrench.force)))

    def take_status(self, message):
        for error in message.force_errors:
            self.errors.setdefault(error.instrument, []).append((message.header.stamp.to_sec(), error.force, error.error))

    def take_contacts(self, message):
        sums = {}
        for contact in message.contacts:
            force = vector(contact.force)
            normal = vector(contact.normal)
            along = force.dot(normal)
            tangential, pressing = sums.get(contact.instrument, (0.0, 0.0))
            sums[contact.instrument] = (tangential + numpy.linalg.norm(force - along * normal), pressing + along)
        for instrument, (tangential, pressing) in sums.items():
            self.ratios.setdefault(instrument, []).append((message.header.stamp.to_sec(), tangential, pressing))


def plot(forces, friction, folder):
    """Writes the pictures; returns their paths."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    os.makedirs(folder, exist_ok=True)
    written = []
    for instrument, samples in sorted(forces.wrenches.items()):
        begin = samples[0][0]
        figure, axes = new_figure(pyplot, "%s: force of the tissue on the instrument" % instrument)
        times = numpy.array([t for t, _ in samples]) - begin
        force = numpy.array([f for _, f in samples])
        axes.plot(times, numpy.linalg.norm(force, axis=1), "k", linewidth=1.5, label="|F|")
        errors = numpy.array(forces.errors.get(instrument, []))
        if len(errors):
            axes.fill_between(errors[:, 0] - begin, numpy.maximum(errors[:, 1] - errors[:, 2], 0.0), errors[:, 1] + errors[:, 2],
                              color="k", alpha=0.12, linewidth=0.0, label="|F|, its likely error")
        for axis, name in enumerate("xyz"):
            axes.plot(times, force[:, axis], linewidth=1.0, label="F%s (tip frame)" % name)
        axes.set_ylabel("force (N)")
        written.append(finish(pyplot, figure, axes, times[-1], os.path.join(folder, instrument + "_force.png")))

        ratios = numpy.array(forces.ratios.get(instrument, []))
        if not len(ratios) or not ratios[:, 2].max() > 0.0:
            continue
        pressed = ratios[:, 2] > 0.01 * ratios[:, 2].max()  # a ratio of two near-zeros says nothing
        figure, axes = new_figure(pyplot, "%s: friction used by the contacts" % instrument)
        axes.plot(ratios[pressed, 0] - begin, ratios[pressed, 1] / ratios[pressed, 2], ".", markersize=4,
                  label="Σ|Ft| / ΣFn")
        for tissue, static, kinetic in friction.get(instrument, []):
            axes.axhline(static, color="tab:red", linestyle="--", linewidth=1.0, label="μ static (%s)" % tissue)
            axes.axhline(kinetic, color="tab:green", linestyle=":", linewidth=1.5, label="μ kinetic (%s)" % tissue)
        axes.set_ylabel("tangential / normal force (-)")
        axes.set_ylim(bottom=0.0)
        written.append(finish(pyplot, figure, axes, times[-1], os.path.join(folder, instrument + "_friction.png")))
    return written


def new_figure(pyplot, title):
    figure, axes = pyplot.subplots(figsize=(9.0, 4.5), dpi=120)
    axes.set_title(title)
    axes.set_xlabel("time since the first joint state (s)")
    axes.grid(True, alpha=0.3)
    return figure, axes


def finish(pyplot, figure, axes, end, path):
    axes.set_xlim(0.0, max(end, 1e-3))
    axes.legend(loc="best", fontsize=9)
    figure.tight_layout()
    with whole_file(path) as part:
        figure.savefig(part)
    pyplot.close(figure)
    return path


def friction_of(scene_file):
    """instrument -> [(tissue, static, kinetic)] as the scene says it; only for lines in the plot, which is drawn without where they are not to be had."""
    table = {}
    try:
        if scene_file.startswith("package://"):
            package, _, rest = unquote(scene_file[len("package://"):]).partition("/")
            scene_file = os.path.join(rospkg.RosPack().get_path(package), rest)
        elif scene_file.startswith("file://"):
            scene_file = unquote(scene_file[len("file://"):])
        with open(scene_file, encoding="utf-8") as stream:
            pairs = (yaml.safe_load(stream) or {}).get("friction") or []
    except (OSError, UnicodeDecodeError, yaml.YAMLError, rospkg.ResourceNotFound) as error:  # the simulator reads more than PyYAML
        print("plot: without the lines of friction: %s: %s" % (scene_file, " ".join(str(error).split())), file=sys.stderr)
        return table
    for pair in pairs:
        coefficients = [pair.get("static"), pair.get("kinetic")]
        if "instrument" in pair and all(isinstance(c, (int, float)) for c in coefficients):  # else a law without one line
            table.setdefault(pair["instrument"], []).append((pair["tissue"], *coefficients))
    return table


def forces_of(file, node):
    """Of the node's topics in a bag."""
    forces = Forces()
    with rosbag.Bag(file) as bag:
        topics = [topic for topic in bag.get_type_and_topic_info().topics if topic.startswith(node + "/")]
        wanted = [topic for topic in topics if topic.endswith("/wrench") or topic in (node + "/status", node + "/contacts")]
        for topic, message, _ in bag.read_messages(wanted) if wanted else ():
            if topic == node + "/status":
                forces.take_status(message)
            elif topic == node + "/contacts":
                forces.take_contacts(message)
            else:
                forces.take_wrench(topic[len(node) + 1:-len("/wrench")], message)
    return forces


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--bag", required=True)
    parser.add_argument("--output", required=True, help="folder for the plots; made if it does not exist")
    parser.add_argument("--scene", help="scene file, for lines at its coefficients of friction")
    parser.add_argument("--node", default="/tissue_contact", help="whose topics, default: %(default)s")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        forces = forces_of(arguments.bag, arguments.node)
    except (OSError, rosbag.ROSBagException) as error:
        fail("bag %s cannot be read: %s" % (arguments.bag, error))
    if not forces.wrenches:
        fail("%s has no wrench on topics of %s; see --node" % (arguments.bag, arguments.node))
    try:
        friction = friction_of(arguments.scene) if arguments.scene else {}
        for path in plot(forces, friction, arguments.output):
            print("wrote " + path, flush=True)
    except OSError as error:
        fail("%s: %s" % (error.filename, error.strerror))


if __name__ == "__main__":
    main()
