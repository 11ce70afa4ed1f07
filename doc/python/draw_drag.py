#!/usr/bin/python3
"""A tissue at a moment of a recording: how far its surface has moved and the force on the instrument, and that force over time.

usage: draw_drag.py SCENE BAG [--at SECONDS] [--ball-m RADIUS] [--from DEGREES] [--output PICTURE]

For scenes with one tissue, and one instrument whose joint states are the bag's only ones.
"""
import argparse

import matplotlib
import numpy as np
import rosbag

import tissue_contact as tc

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402: after the choice of what draws
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402

NEAR_M = 0.022  # what the close view shows around the tip
COLOURS = plt.get_cmap("turbo" if "turbo" in plt.colormaps() else "jet")  # Matplotlib 3.1 of Ubuntu 20.04


def mesh_at(scene_file, bag_file, seconds):
    """Triangles (n, 3, 3) in m and how far each has moved, (n,) in m, after so many seconds of the recording."""
    simulator = tc.Simulator(tc.load_scene(scene_file))
    instrument, tissue = simulator.instruments[0], simulator.tissues[0]
    names = simulator.joint_names(instrument)
    before = first = None
    with rosbag.Bag(bag_file) as bag:
        for _, message, _ in bag.read_messages():
            if getattr(message, "_type", "") != "sensor_msgs/JointState":
                continue
            stamp = message.header.stamp
            joints = [message.position[message.name.index(name)] for name in names]
            if before is None:
                first = stamp
                simulator.place(instrument, joints)
            elif stamp > before:
                simulator.advance((stamp - before).to_sec(), {instrument: joints})
            before = stamp
            if (stamp - first).to_sec() >= seconds:
                break
    topology = simulator.topology(tissue)
    now = np.array(simulator.positions(tissue))
    moved = np.linalg.norm(now - topology.rest_positions, axis=1)
    return now[topology.triangles], moved[topology.triangles].mean(axis=1)


def ball(centre, radius):
    """Faces of four corners each, (n, 4, 3)."""
    u, v = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 25), np.linspace(0.0, np.pi, 13))
    points = np.asarray(centre) + radius * np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
    return np.stack([points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2).reshape(-1, 4, 3)


def draw_mesh(axes, triangles, moved, most_m, tip, ball_m, force, arrow_m, azimuth):
    faces = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    light = 0.55 + 0.45 * np.clip(faces @ np.array([0.3, -0.4, 0.87]), 0.0, 1.0)
    colours = COLOURS(moved / most_m)
    colours[:, :3] *= light[:, None]
    faces_of_ball = ball(tip, ball_m)
    grey = np.tile([0.7, 0.7, 0.7, 1.0], (len(faces_of_ball), 1))
    # One collection: its faces hide one another by their depth.
    axes.add_collection3d(Poly3DCollection([*triangles, *faces_of_ball], facecolors=np.concatenate([colours, grey]),
                                           edgecolors=(0, 0, 0, 0.25), linewidths=0.2, zorder=1))
    axes.computed_zorder = False  # the arrow is in front
    size = np.linalg.norm(force)
    end = tip + (arrow_m * force / size if size > 0.0 else 0.0)
    axes.quiver(*tip, *(end - tip), color="blue", linewidth=2.5, arrow_length_ratio=0.2, zorder=3)
    axes.text(*end, "  %.2f N" % size, color="blue", zorder=3)
    corners = np.concatenate([triangles.reshape(-1, 3), [tip, end]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    if hasattr(axes, "set_box_aspect"):  # from Matplotlib 3.3 on
        axes.set_box_aspect(high - low, zoom=1.3)
    axes.view_init(elev=18.0, azim=azimuth)
    axes.set_axis_off()


def turned(quaternion, vectors):
    """Rows of vectors, each turned by its row of (x, y, z, w)."""
    axis, w = quaternion[:, :3], quaternion[:, 3:]
    return vectors + 2.0 * np.cross(axis, np.cross(axis, vectors) + w * vectors)


def draw(arguments):
    replayed = tc.replay(arguments.scene, arguments.bag)
    instrument = replayed.instruments[0]
    times = replayed.stamps(instrument) - replayed.stamps(instrument)[0]
    poses = replayed.tip_poses(instrument)
    forces = turned(poses[:, 3:], replayed.wrenches(instrument)[:, :3])  # from the tip's axes to the world's
    sizes, errors = np.linalg.norm(forces, axis=1), replayed.of(instrument)["force_error_n"]
    seconds = times[np.argmax(sizes)] if arguments.at is None else arguments.at
    shown = min(np.searchsorted(times, seconds), len(times) - 1)
    tip = poses[shown, :3]
    triangles, moved = mesh_at(arguments.scene, arguments.bag, seconds)
    most_m = moved.max() or 1e-3  # before anything has moved
    near = np.linalg.norm(triangles.mean(axis=1) - tip, axis=1) < NEAR_M
    figure = plt.figure(figsize=(15.0, 5.0), constrained_layout=True)
    whole, close, curve = [figure.add_subplot(1, 3, 1 + k, **({"projection": "3d"} if k < 2 else {})) for k in range(3)]
    for axes, part, arrow_m in ((whole, slice(None), 0.05), (close, near, 0.5 * NEAR_M)):
        if np.any(near) or axes is whole:
            draw_mesh(axes, triangles[part], moved[part], most_m, tip, arguments.ball_m, forces[shown], arrow_m, arguments.azimuth)
    scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(0.0, 1e3 * most_m), COLOURS)
    figure.colorbar(scale, ax=whole, label="moved (mm)", location="left", shrink=0.5)
    curve.fill_between(times, sizes - errors, sizes + errors, color="0.85", label="|F|, its likely error")
    curve.plot(times, sizes, color="black", linewidth=2.0, label="|F|")
    for axis, name in enumerate("xyz"):
        curve.plot(times, forces[:, axis], linewidth=1.0, label="F" + name)
    curve.axvline(seconds, color="blue", linestyle=":")
    curve.set(xlabel="time (s)", ylabel="force on the instrument (N)", xlim=(times[0], times[-1]))
    curve.grid(alpha=0.3)
    curve.legend(loc="best")
    figure.savefig(arguments.output, dpi=100)
    print("%.3f N (%.3f N likely off) at %.2f s; the surface has moved by %.2f mm at most" % (sizes[shown], errors[shown], seconds, 1e3 * moved.max()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("bag")
    parser.add_argument("--at", type=float, help="seconds after the first joint state; default: when the force is greatest")
    parser.add_argument("--ball-m", type=float, default=0.005, help="radius of the ball drawn at the tip")
    parser.add_argument("--from", dest="azimuth", type=float, default=-60.0, help="from where it is seen, degrees about z")
    parser.add_argument("--output", default="drag.png")
    draw(parser.parse_args())


if __name__ == "__main__":
    main()
