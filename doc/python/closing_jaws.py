#!/usr/bin/python3
"""Jaws that close on a flap to where they would pass through each other, as recorded without it, and lift: as they are, and with a drive of so much
torque; with a picture.

usage: closing_jaws.py [--output PICTURE] [TORQUE_LIMIT_N_M ...]
"""
import argparse

import matplotlib
import numpy as np

import tissue_contact as tc

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402: after the choice of what draws

SCENE = "package://tissue_contact/config/grasp.yaml"
OPEN_RAD, CLOSED_RAD = 0.9, -0.3
INSERTION_M, LIFT_M = 0.12, 0.002
STEP_S = 0.01


def close_and_lift(compliant_joints):
    """Time (s), squeeze of a jaw (N), force along the lift (N): closed within a second, lifted within the next, held for a third."""
    scene = tc.load_scene(SCENE, set={"instruments.psm.compliant_joints": compliant_joints} if compliant_joints else {})
    simulator = tc.Simulator(scene)
    names = simulator.joint_names("psm")
    joints = np.zeros(len(names))
    jaw, insertion = names.index("jaw"), names.index("insertion")
    joints[jaw], joints[insertion] = OPEN_RAD, INSERTION_M
    simulator.place("psm", joints)
    rows = []
    for k in range(1, 301):
        t = k * STEP_S
        joints[jaw] = OPEN_RAD + (CLOSED_RAD - OPEN_RAD) * min(1.0, t)
        joints[insertion] = INSERTION_M - LIFT_M * np.clip(t - 1.0, 0.0, 1.0)
        simulator.advance(STEP_S, {"psm": joints})
        contacts = simulator.contacts()
        squeeze = 0.5 * np.abs((contacts["force"] * contacts["normal"]).sum(axis=1)).sum()
        rows.append((t, squeeze, -simulator.wrench("psm", frame="world")[2]))
    return np.array(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("limits", type=float, nargs="*", default=[0.001, 0.002])
    parser.add_argument("--output", default="closing_jaws.png")
    arguments = parser.parse_args()
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(6.4, 5.0), constrained_layout=True)
    runs = [("as recorded", None)] + [
        ("torque_limit_n_m: %g" % limit, [{"joint": "jaw", "stiffness_n_m_per_rad": 0.5, "torque_limit_n_m": limit}])
        for limit in arguments.limits
    ]
    for label, compliant_joints in runs:
        t, squeeze, lift = close_and_lift(compliant_joints).T
        above.plot(t, squeeze, label=label)
        below.plot(t, lift)
        print("%s: squeezed with %.3f N at the end, %.3f N at most; lifts %.4f N" % (label, squeeze[-1], squeeze.max(), lift[-1]))
    above.set(ylabel="squeeze of a jaw (N)", ylim=(0.0, 0.6))
    above.legend(loc="upper left")
    below.set(xlabel="time (s): jaws close, lift, hold", ylabel="force on the arm, down (N)", xlim=(0.0, 3.0), ylim=(-0.02, 0.05))
    figure.savefig(arguments.output, dpi=120)


if __name__ == "__main__":
    main()
