#!/usr/bin/python3
"""Draws what `moving_mesh --surfaces FILE` wrote: the block from above at six moments, coloured by how deep its surface is pressed.
usage: plot_moving_mesh.py FILE PICTURE.png      (Debian: python3-matplotlib, python3-numpy)
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HEIGHT_M = 0.04


def moments(name):
    """(x, y of the ball, nodes, triangles x 9) of each."""
    found = []
    with open(name, encoding="utf-8") as stream:
        for line in stream:
            words = line.strip().strip(",").split(",")
            if words[0] == "ball":
                found.append((float(words[1]), float(words[2]), int(words[3]), []))
            else:
                found[-1][3].append([float(word) for word in words])
    return [(x, y, nodes, np.array(rows)) for x, y, nodes, rows in found]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    shown = moments(sys.argv[1])
    figure, axes = plt.subplots(1, len(shown), figsize=(2.6 * len(shown), 3.0), constrained_layout=True)
    for axis, (x, y, nodes, rows) in zip(axes, shown):
        upper = rows[(rows[:, 2::3] > 0.75 * HEIGHT_M).all(axis=1)]
        points = 1e3 * upper.reshape(-1, 3)
        triangles = np.arange(len(points)).reshape(-1, 3)
        depth = (1e3 * HEIGHT_M - points[:, 2]).reshape(-1, 3).mean(axis=1)
        drawn = axis.tripcolor(points[:, 0], points[:, 1], triangles, facecolors=depth, cmap="viridis_r", vmin=0.0, vmax=2.0,
                               edgecolors="k", linewidth=0.15)
        axis.add_patch(plt.Circle((1e3 * x, 1e3 * y), 5.0, fill=False, color="tab:red", linewidth=1.2))
        axis.set_title("%d nodes" % nodes, fontsize=9)
        axis.set_aspect("equal")
        axis.set_xticks([])
        axis.set_yticks([])
    figure.colorbar(drawn, ax=axes, shrink=0.8, label="pressed in, mm")
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
