"""A synthetic laboratory for the fitting studies: what a tool really does to a phantom, by a mesh finer and steps shorter than those of the fit,
and what a force sensor and a tracker would record of it. In the package's environment (source scripts/env.bash)."""
import dataclasses
import os
import sys
import tempfile

import numpy

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
sys.path.insert(0, os.path.join(SOURCE, "scripts"))

import make_ring  # noqa: E402 (the path comes first)
from fitting import forward, measured, parameters, run  # noqa: E402

SCENE = os.path.join(SOURCE, "config", "calibration", "phantom.yaml")
TOOL = "indenter"
RING, PLATE, RING_M = os.path.join(SOURCE, "config", "calibration", "ring.yaml"), "plate", 0.0185  # the ring's mean radius
RATE_HZ = 500
ROUNDING_S = 0.06  # of corners of the motion: an arm has mass
BALL_M = 0.012
SMOOTH_S = {"press": 0.2, "drag": 0.2}  # slow: what trembles there is noise, which would tell the fit that there is no damping

def _mesh(cells, growth, step_s):
    block = "tissues.phantom.block."
    settings = {block + "grading.%s.growth" % axis: value for axis, value in zip("xyz", growth)}
    return dict(settings, **{block + "cells": cells, "step.max_step_s": step_s})


# What the fit is corrected by (fit.py --finer), and the truth, which is finer still and in shorter steps: what mesh and step do to the
# estimates is part of their error here. Fitting with the model that made the data would hide it.
FINER = _mesh([16, 16, 9], [1.15, 1.15, 1.2], 0.0025)
TRUTH = _mesh([20, 20, 11], [1.12, 1.12, 1.15], 0.002)
RING_FINER, RING_TRUTH = ([72, 3, 3], 0.005), ([96, 4, 4], 0.002)  # of ring_mesh()


@dataclasses.dataclass
class Noise:
    """Of the measurement; force as a share of the recording's peak, each axis and sample for itself."""
    force_share: float = 0.05
    offset_m: float = 1e-4      # standard deviation of what all poses of a session are off by, each axis
    pose_m: float = 1e-4        # ... and of what each sample is off by besides


def path(knots):
    """(times (s), positions of the ball's centre (m)) at RATE_HZ from knots (s, x (mm), depth (mm)); y = 0, and depth 0 is first touch."""
    knots = numpy.array(knots, float)
    times = numpy.arange(int(round(knots[-1, 0] * RATE_HZ)) + 1) / RATE_HZ
    x, depth = (numpy.interp(times, knots[:, 0], knots[:, i]) for i in (1, 2))
    return times, _positions(_rounded(x), _rounded(depth))


def _rounded(values):
    count = int(ROUNDING_S * RATE_HZ) // 2 * 2 + 1
    padded = numpy.pad(values, count // 2, mode="edge")
    return numpy.convolve(padded, numpy.full(count, 1.0 / count), mode="valid")


def _positions(x_mm, depth_mm):
    return 1e-3 * numpy.stack([x_mm, numpy.zeros_like(x_mm), 1e3 * BALL_M - depth_mm], axis=1)


def press(depth_mm=3.0, speed_mm_per_s=6.0, hold_s=0.3):
    down = 0.1 + (depth_mm + 0.5) / speed_mm_per_s
    return path([(0, 0, -0.5), (0.1, 0, -0.5), (down, 0, depth_mm), (down + hold_s, 0, depth_mm),
                 (down + hold_s + (depth_mm + 0.5) / 10.0, 0, -0.5)])


def swing(middle_mm=1.8, amplitude_mm=1.2, rate_hz=5.0, cycles=8):
    times, positions = path([(0, 0, -0.5), (0.4, 0, middle_mm), (0.5 + cycles / rate_hz, 0, middle_mm)])
    swinging = numpy.clip(times - 0.45, 0.0, cycles / rate_hz)
    positions[:, 2] -= 1e-3 * amplitude_mm * numpy.sin(2.0 * numpy.pi * rate_hz * swinging)
    return times, positions


def drag(depth_mm=2.0, way_mm=5.0, speed_mm_per_s=5.0):
    there = 0.6 + way_mm / speed_mm_per_s
    back = there + 0.1 + way_mm / speed_mm_per_s
    return path([(0, -0.5 * way_mm, -0.5), (0.5, -0.5 * way_mm, depth_mm), (0.6, -0.5 * way_mm, depth_mm), (there, 0.5 * way_mm, depth_mm),
                 (there + 0.1, 0.5 * way_mm, depth_mm), (back, -0.5 * way_mm, depth_mm)])


def twist(count=8, depth_mm=0.3, first_mm=3.0, way_mm=0.5, speed_mm_per_s=0.2, rest_s=1.0):
    """(times (s), z (m), yaw (rad)) of the plate on the ring: one turn that makes all of it slide, then slow ones, each from rest."""
    knots = [(0, 0, -0.3), (0.3, 0, depth_mm), (0.4, 0, depth_mm), (1.4, first_mm, depth_mm), (1.4 + rest_s, first_mm, depth_mm)]
    for _ in range(count):
        time, way, _ = knots[-1]
        there = time + way_mm / speed_mm_per_s
        knots += [(there, way + way_mm, depth_mm), (there + rest_s, way + way_mm, depth_mm)]
    times, positions = path(knots)
    return times, positions[:, 2] - BALL_M, positions[:, 0] / RING_M


PROTOCOL = {"press": press, "swing": swing, "drag": drag}
MOTIONS = dict(PROTOCOL, deeper=lambda: press(4.0, 8.0))


def truth_keys(youngs_modulus_pa, stiffness_s, static, kinetic):
    return {"tissues.phantom.material.youngs_modulus_pa": youngs_modulus_pa, "tissues.phantom.damping.stiffness_s": stiffness_s,
            "friction.0.static": static, "friction.0.kinetic": kinetic}


def true_forces(settings, motion, scene=SCENE):
    """At the motion's samples."""
    times, positions = motion
    done = forward.forces(scene, settings, TOOL, times, numpy.hstack([positions, numpy.zeros((len(times), 3))]))
    if done.doubts:
        sys.exit("the truth itself is in doubt: %s" % dict(done.doubts))
    return done.force_n


def ring_mesh(cells, step_s):
    """Settings of the ring's scene with a mesh of so many cells around, across, in height, a file that the caller removes."""
    handle, path_of_it = tempfile.mkstemp(suffix=".msh")
    os.close(handle)
    make_ring.write(path_of_it, *make_ring.ring(0.017, 0.020, 0.004, cells))
    return {"tissues.ring.mesh.file": path_of_it, "step.max_step_s": step_s}


def ring_keys(youngs_modulus_pa, stiffness_s, **friction):
    keys = {"tissues.ring.material.youngs_modulus_pa": youngs_modulus_pa, "tissues.ring.damping.stiffness_s": stiffness_s}
    return dict(keys, **{"friction.0." + name: value for name, value in friction.items()})


def record_twist(settings, motion, noise, generator, scene=RING):
    """What a rheometer, or a robot with a sensor of force and torque, would record of it; noise of the turn as of a position at the ring."""
    times, z, yaw = motion
    joints = numpy.zeros((len(times), 6))
    joints[:, 2], joints[:, 3] = z, yaw
    done = forward.forces(scene, settings, PLATE, times, joints)
    if done.doubts:
        sys.exit("the truth itself is in doubt: %s" % dict(done.doubts))

    def noisy(values):
        return values + noise.force_share * numpy.linalg.norm(values, axis=1).max() * generator.standard_normal(values.shape)

    return measured.Recording(
        name="twist", times_s=times, force_n=noisy(done.force_n), torque_nm=noisy(done.torque_nm),
        joints={"z": z + noise.offset_m * generator.standard_normal() + noise.pose_m * generator.standard_normal(len(z)),
                "yaw": yaw + noise.pose_m / RING_M * generator.standard_normal(len(yaw))})


def record(name, motion, force, noise, offset_m, generator):
    """What is written down: the tool is really deeper by offset_m[2] than that."""
    times, positions = motion
    peak = numpy.linalg.norm(force, axis=1).max()
    return measured.Recording(
        name=name, times_s=times, force_n=force + noise.force_share * peak * generator.standard_normal(force.shape),
        positions_m=positions + offset_m + noise.pose_m * generator.standard_normal(positions.shape))


def as_fit_sees(recording, rate_hz=100.0):
    """As fit.py --smooth 0.06 --smooth press=0.2 --smooth drag=0.2 --rate 100."""
    return measured.thin(measured.smooth(recording, SMOOTH_S.get(recording.name, 0.06)), rate_hz)


def setup(fits, workers, scene=SCENE, **more):
    keys = parameters.SceneKeys(scene)
    return run.Setup(scene, keys, forward.Tool(scene, TOOL, {}), parameters.parse_fits(fits, keys), numpy.array([0.0, 0.0, -1.0]),
                     workers, **more)


def write_table(file, recording):
    with open(file, "w", encoding="utf-8") as stream:
        stream.write("time_s,x_m,y_m,z_m,fx_n,fy_n,fz_n\n")
        for row in numpy.hstack([recording.times_s[:, None], recording.positions_m, recording.force_n]):
            stream.write("%.3f,%.6f,%.6f,%.6f,%.5f,%.5f,%.5f\n" % tuple(row))


def write_twist(file, recording):
    with open(file, "w", encoding="utf-8") as stream:
        stream.write("time_s,z,yaw,fz_n,tz_nm\n")
        columns = [recording.times_s, recording.joints["z"], recording.joints["yaw"], recording.force_n[:, 2], recording.torque_nm[:, 2]]
        for row in numpy.stack(columns, axis=1):
            stream.write("%.3f,%.6f,%.6f,%.5f,%.7f\n" % tuple(row))
