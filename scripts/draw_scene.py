#!/usr/bin/python3
"""Draws a scene from three sides, in metres: what `tissue_contact_place picture` runs. The scene comes as JSON on standard input.

Tissue surfaces are filled, their fixed nodes dots; instruments' touching shapes are drawn as their outlines, the way of their tips
as a line from a circle to a cross.
"""
import argparse
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

VIEWS = [("from above", 0, 1), ("from the front", 0, 2), ("from the side", 1, 2)]  # title, horizontal and vertical axis
TISSUES = ["#e8998d", "#f2c57c", "#b5c99a", "#c9ada7"]
TOOLS = ["#1d3557", "#6a4c93", "#2a9d8f", "#495057"]


def hull(points):
    """Corners of the convex hull of points in a plane, one after the other (Andrew's monotone chain)."""
    points = sorted(set(map(tuple, points)))
    if len(points) < 3:
        return points

    def half(those):
        chain = []
        for x, y in those:
            while len(chain) > 1 and ((chain[-1][0] - chain[-2][0]) * (y - chain[-2][1])
                                      <= (chain[-1][1] - chain[-2][1]) * (x - chain[-2][0])):
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return half(points) + half(points[::-1])


def draw_tissue(axes, tissue, color, across, up):
    from matplotlib.collections import PolyCollection
    points = [(p[across], p[up]) for p in tissue["points"]]
    triangles = [[points[node] for node in triangle] for triangle in tissue["triangles"]]
    axes.add_collection(PolyCollection(triangles, facecolors=color, edgecolors="white", linewidths=0.3, alpha=0.55))
    axes.autoscale_view()
    fixed = [points[node] for node in tissue["fixed"]]
    if fixed:
        axes.plot(*zip(*fixed), ".", color="#6b2d2d", markersize=2.5)


def draw_instrument(axes, instrument, color, across, up):
    for shape in instrument["shapes"]:
        corners = hull([(p[across], p[up]) for p in shape])
        if len(corners) > 2:
            axes.fill(*zip(*corners), facecolor=color, edgecolor=color, alpha=0.45, linewidth=0.8)
    way = [(p[across], p[up]) for p in instrument["way"]]
    if way:
        axes.plot(*zip(*way), color=color, linewidth=0.8)
        axes.plot(*way[0], "o", color=color, fillstyle="none")
        axes.plot(*way[-1], "x", color=color)
    else:
        axes.plot(instrument["tip"][across], instrument["tip"][up], "o", color=color, fillstyle="none")


def limits(scene, axis):
    """Of the tissues and the ways of tips, with room for the instruments near them: shafts may be long."""
    values = [p[axis] for tissue in scene["tissues"] for p in tissue["points"]]
    values += [p[axis] for one in scene["instruments"] for p in one["way"] + [one["tip"]]]
    return min(values), max(values)


def draw(scene, frame):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.patches import Patch
    figure, panels = pyplot.subplots(1, 3, figsize=(15.0, 5.6), dpi=100)
    bounds = [limits(scene, axis) for axis in range(3)]
    room = 0.12 * max(high - low for low, high in bounds) + 1e-4
    for axes, (title, across, up) in zip(panels, VIEWS):
        for i, tissue in enumerate(scene["tissues"]):
            draw_tissue(axes, tissue, TISSUES[i % len(TISSUES)], across, up)
        for i, instrument in enumerate(scene["instruments"]):
            draw_instrument(axes, instrument, TOOLS[i % len(TOOLS)], across, up)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlim(bounds[across][0] - room, bounds[across][1] + room)
        axes.set_ylim(bounds[up][0] - room, bounds[up][1] + room)
        axes.set_title(title)
        axes.set_xlabel("%s (m)" % "xyz"[across])
        axes.set_ylabel("%s (m)" % "xyz"[up])
        axes.grid(True, alpha=0.3)
        axes.tick_params(axis="x", rotation=30)
    handles = [Patch(color=TISSUES[i % len(TISSUES)], label=one["name"]) for i, one in enumerate(scene["tissues"])]
    handles += [Patch(color=TOOLS[i % len(TOOLS)], label=one["name"]) for i, one in enumerate(scene["instruments"])]
    figure.legend(handles=handles, loc="lower center", ncol=max(len(handles), 1), frameon=False)
    figure.suptitle("in frame '%s'; dots: fixed nodes; circle: tip%s" % (
        frame, ", where the recording begins; cross: where it ends" if any(i["way"] for i in scene["instruments"]) else ""))
    figure.tight_layout(rect=(0.0, 0.05, 1.0, 1.0))
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", required=True, help="the picture, a PNG whatever its name")
    parser.add_argument("--frame", default="world", help="name of the frame all is in, default: %(default)s")
    arguments = parser.parse_args()
    try:
        figure = draw(json.load(sys.stdin), arguments.frame)
        with whole_file(arguments.out) as part:
            figure.savefig(part, format="png")
    except (OSError, ValueError) as error:
        sys.exit("draw_scene.py: %s: %s" % (arguments.out, getattr(error, "strerror", None) or error))


if __name__ == "__main__":
    main()
