#!/usr/bin/python3
"""Force over depth of a ball pressed into tissue of several stiffnesses, with a picture.

usage: press_curve.py [--scene FILE] [--output PICTURE] [YOUNGS_MODULUS_PA ...]
"""
import argparse

import matplotlib
import numpy as np

import tissue_contact as tc

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402: after the choice of what draws

ABOVE_M = 0.01  # the ball is so far above the block at joints 0
DEPTHS_M = np.arange(0.0, 0.0041, 0.00025)


def press(scene_file, youngs_modulus_pa):
    """Normal force (N) and its likely error (N) at each depth, pressed slowly."""
    scene = tc.load_scene(scene_file, set={"tissues.block.material.youngs_modulus_pa": youngs_modulus_pa})
    simulator = tc.Simulator(scene)
    simulator.place("probe", [0.0, 0.0, -ABOVE_M])
    forces, errors = [], []
    for depth in DEPTHS_M:
        simulator.advance(0.05, {"probe": [0.0, 0.0, -ABOVE_M - depth]})
        forces.append(simulator.wrench("probe", frame="world")[2])
        errors.append(simulator.force_errors()["total_n"][0])
    return np.array(forces), np.array(errors)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("moduli", type=float, nargs="*", default=[2500.0, 5000.0, 10000.0])
    parser.add_argument("--scene", default="package://tissue_contact/config/press_drag.yaml")
    parser.add_argument("--output", default="press_curve.png")
    arguments = parser.parse_args()
    figure, axes = plt.subplots(figsize=(6.4, 4.0), constrained_layout=True)
    for modulus in arguments.moduli:
        forces, errors = press(arguments.scene, modulus)
        line, = axes.plot(1e3 * DEPTHS_M, forces, label="E = %g Pa" % modulus)
        axes.fill_between(1e3 * DEPTHS_M, forces - errors, forces + errors, color=line.get_color(), alpha=0.2, linewidth=0)
        print("E = %g Pa: %.3f N at %.1f mm" % (modulus, forces[-1], 1e3 * DEPTHS_M[-1]))
    axes.set(xlabel="depth (mm)", ylabel="normal force (N); band: its likely error", xlim=(0.0, 1e3 * DEPTHS_M[-1]))
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper left")
    figure.savefig(arguments.output, dpi=120)


if __name__ == "__main__":
    main()
