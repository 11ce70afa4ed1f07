#!/usr/bin/python3
"""Prints the forces of doc/notes/method.md ("Crossing edges of two tissues", "Sheets that are squeezed"): a ball held on a layer that lies on a bed, boxes
that close on a sheet, and on a gut, an open ring pressed onto itself, jaws of a PSM on flaps. Mean and RMS about it of what the last .2 s hold, N. Two or
three minutes.

usage, after `source scripts/env.bash`: benchmark/drivers/touching_tissues.py [--only WORD] [--step S] [--iterations N] [--tolerance T] [--relaxation R] [--compare]
"""
import argparse
import math
import os
import tempfile

import numpy as np
import tissue_contact as tc

BALL = "<link name='tip'><collision><geometry><sphere radius='0.005'/></geometry></collision></link>"
BOX = "<link name='%s'><collision><geometry><box size='%g 0.002 %g'/></geometry></collision></link>"
JOINT = ("<joint name='%s_joint' type='prismatic'><parent link='base'/><child link='%s'/><origin xyz='0 %g 0'/><axis xyz='%s'/>"
         "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>")
PROBE = "<robot name='r'><link name='base'/>" + BALL + JOINT % ("tip", "tip", 0, "0 0 1") + "</robot>"
SETTINGS = {"step.max_step_s": 0.001}  # of all scenes
EXACT = {"solver.relaxation": "cholesky", "solver.tolerance": 1e-7, "solver.iterations": 500}
DATA = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../../shared/data")
PSM = os.path.join(DATA, "dvrk_psm", "psm2_caudier.urdf")
TOOL = "PSM2_tool_wrist_caudier"


def jaws(width_m, length_m):
    """Two boxes whose faces are at +-q for positions q of both joints."""
    links = "".join(BOX % (name, width_m, length_m) for name in ("a", "b"))
    return ("<robot name='r'><link name='base'/>" + links + JOINT % ("a", "a", 0.001, "0 1 0") + JOINT % ("b", "b", -0.001, "0 -1 0") + "</robot>")


def material(young_pa, nu=0.4, mass_per_s=20):
    return ("    material: {youngs_modulus_pa: %g, poissons_ratio: %g, density_kg_per_m3: 1000}\n"
            "    damping: {stiffness_s: 0.003, mass_per_s: %g}\n" % (young_pa, nu, mass_per_s))


def build(text, urdf=None):
    return tc.Simulator(tc.parse_scene(text, set=SETTINGS), urdf=urdf)


def simulator(tissues, urdf, links, tissue, base_m, more="", friction="", pair=(), x_m=0.0):
    instrument = ("  - {name: tool, robot_description: tool, tip_link: base, contact_links: [%s], joint_state_topics: [/js], "
                  "base_pose: {position_m: [%g, 0, %g]}%s}\n" % (links, x_m, base_m, more))
    pairs = "tissue_pairs: [{tissue: %s, other: %s}]\n" % pair if pair else ""
    text = ("gravity_m_per_s2: [0, 0, %g]\ntissues:\n" % (-9.81 if "name: bed" in tissues else 0) + tissues + "instruments:\n" + instrument + pairs +
            "friction:\n" + friction + "  - {instrument: tool, tissue: %s, static: 0.5, kinetic: 0.4}\n" % tissue)
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(urdf)
        file.flush()
        return build(text, file.name)


def held(model, start, end, move_s, rest_s, force):
    """`force` at the end of each step, and how many of them were not converged; the joints go from start to end in move_s."""
    step_s = SETTINGS["step.max_step_s"]
    model.place("tool", start)
    found, missed = [], 0
    for k in range(1, round((move_s + rest_s) / step_s) + 1):
        share = min(k * step_s / move_s, 1.0)
        model.advance(step_s, {"tool": [a + (b - a) * share for a, b in zip(start, end)]})
        missed += not model.report().converged
        found.append(force(model))
    return np.array(found), missed


def on_layer(shape, top_m, young_pa, bed_pa, depth_m, bed_cells="[8, 8, 5]", friction=""):
    tissues = ("  - name: bed\n    block: {size_m: [0.04, 0.04, 0.02], cells: %s}\n" % bed_cells + material(bed_pa, mass_per_s=5) +
               "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n  - name: layer\n    " + shape + material(young_pa, mass_per_s=5))
    start = [top_m + 0.005 - 0.03]
    return held(simulator(tissues, PROBE, "tip", "layer", 0.03, friction=friction, pair=("bed", "layer")), start, [start[0] - depth_m], 0.2, 0.4,
                lambda model: model.wrench("tool", frame="world")[2])


def pressed(model):
    contacts = model.contacts()
    of_one = contacts[(contacts["instrument"] == 0) & (contacts["link"] == 0)]
    return np.abs((of_one["force"] * of_one["normal"]).sum(axis=1)).sum()


def squeeze(model):
    contacts = model.contacts()
    return -contacts["force"][(contacts["instrument"] == 0) & (contacts["link"] == 0)][:, 1].sum()


def on_sheet(cells, distance_m, young_pa=5e4, more=""):
    tissues = ("  - name: sheet\n    sheet: {size_m: [0.02, 0.02], cells: [%d, %d], thickness_m: 0.001}\n" % (cells, cells) +
               "    pose: {position_m: [0, 0, 0], rpy_rad: [%.17g, 0, 0]}\n" % (0.5 * math.pi) + material(young_pa) +
               "    fixed: [{plane: {point_m: [0, -0.01, 0], normal: [0, 1, 0]}}]\n")
    return held(simulator(tissues, jaws(0.006, 0.008), "a, b", "sheet", 0.004, more), [0.003] * 2, [0.5 * distance_m] * 2, 0.3, 0.5, squeeze)


def tube(file, radius_m=0.006, length_m=0.05, around=24, along=30):
    angle = lambda i, j: 2.0 * math.pi * (j + 0.5 * (i % 2)) / around
    with open(file, "w", encoding="utf-8") as stream:
        for i in range(along + 1):
            for j in range(around):
                stream.write("v %.17g %.17g %.17g\n" % (length_m * (i / along - 0.5), radius_m * math.cos(angle(i, j)), radius_m * math.sin(angle(i, j))))
        for i in range(along):
            for j in range(around):
                a, b = i * around + j + 1, i * around + (j + 1) % around + 1
                c, d = a + around, b + around
                for nodes in [(a, b, c), (b, d, c)] if i % 2 == 0 else [(a, d, c), (a, b, d)]:
                    stream.write("f %d %d %d\n" % nodes)


def on_gut(file, distance_m, more=""):
    tissues = ("  - name: gut\n    shell: {file: %s, thickness_m: 0.0015}\n" % file + material(5e4, 0.45) +
               "    fixed: [{plane: {point_m: [-0.0249, 0, 0], normal: [1, 0, 0]}}, {plane: {point_m: [0.0249, 0, 0], normal: [-1, 0, 0]}}]\n")
    return held(simulator(tissues, jaws(0.006, 0.02), "a, b", "gut", 0.0, more, pair=("gut", "gut")), [0.008] * 2, [0.5 * distance_m] * 2, 0.6, 0.6, squeeze)


def on_flaps(model, law, count, half_angle_rad, limit_n_m=0.0):
    """The jaws of a PSM on flaps of 4 mm in all that lie side by side: pressed by one jaw, N."""
    names, thickness_m = "ab"[:count], 0.004 / count
    tissues = "".join(
        "  - name: %s\n    block: {size_m: [%g, 0.01, 0.03], cells: [%d, 8, 12]}\n    pose: {position_m: [%g, 0, 0]}\n    refinement: never\n"
        "    material: {model: %s, youngs_modulus_pa: 2.0e+4, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
        "    damping: {stiffness_s: 0.003, mass_per_s: 20}\n    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n" %
        (name, thickness_m, 4 // count, thickness_m * (k + 0.5) - 0.002, law) for k, name in enumerate(names))
    compliance = ", compliant_joints: [{joint: jaw, stiffness_n_m_per_rad: 0.5, torque_limit_n_m: %g}]" % limit_n_m if limit_n_m else ""
    psm = ("  - {name: tool, urdf: %s, base_pose: {position_m: [-0.25, 0, -0.311]}, joint_state_topics: [/js], tip_link: %s_ee_link, "
           "contact_links: [%s_link_2_left, %s_link_2_right]%s}\n" % (model, TOOL, TOOL, TOOL, compliance))
    text = "gravity_m_per_s2: [0, 0, 0]\ntissues:\n" + tissues + "instruments:\n" + psm
    text += "tissue_pairs: [{tissue: a, other: b}]\n" if count == 2 else ""
    text += "friction:\n" + "".join("  - {instrument: tool, tissue: %s, static: 0.6, kinetic: 0.4}\n" % name for name in names)
    text += "  - {tissue: a, other_tissue: b, static: 0.4, kinetic: 0.3}\n" if count == 2 else ""
    joints = [[0, 0, 0.15, 0, 0, 0, 2.0 * half_rad] for half_rad in (0.25, half_angle_rad)]
    return held(build(text), *joints, 0.5, 0.5, pressed)


def open_ring(file, outer_m=0.012, wall_m=0.004, width_m=0.008, opening_rad=0.35, cells=(36, 3, 4)):
    """A ring of hexahedra about the y axis, open towards +x."""
    around, across, wide = cells
    number = lambda i, r, j: (i * (across + 1) + r) * (wide + 1) + j + 1
    with open(file, "w", encoding="utf-8") as stream:
        stream.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % ((around + 1) * (across + 1) * (wide + 1)))
        for i in range(around + 1):
            angle = opening_rad + 2.0 * (math.pi - opening_rad) * i / around
            for r in range(across + 1):
                radius = outer_m - wall_m * (1.0 - r / across)
                for j in range(wide + 1):
                    stream.write("%d %.17g %.17g %.17g\n" % (number(i, r, j), radius * math.cos(angle), width_m * (j / wide - 0.5), radius * math.sin(angle)))
        stream.write("$EndNodes\n$Elements\n%d\n" % (around * across * wide))
        for i in range(around):
            for r in range(across):
                for j in range(wide):
                    face = [(i, r), (i, r + 1), (i + 1, r + 1), (i + 1, r)]
                    corners = [number(a, b, j + 1) for a, b in face] + [number(a, b, j) for a, b in face]
                    stream.write("%d 5 2 1 1 %s\n" % ((i * across + r) * wide + j + 1, " ".join(map(str, corners))))
        stream.write("$EndElements\n")


def on_ring(file, down_m):
    """A ball bends the upper end of the ring onto the lower one, N."""
    tissues = ("  - name: ring\n    mesh: {file: %s}\n" % file + material(1e4, 0.45, mass_per_s=5) +
               "    fixed: [{plane: {point_m: [0, 0, -0.0105], normal: [0, 0, 1]}}]\n")
    start = [0.0175]
    return held(simulator(tissues, PROBE, "tip", "ring", 0.0, pair=("ring", "ring"), x_m=0.004), start, [start[0] - 0.0005 - down_m], 0.4, 0.4,
                lambda model: model.wrench("tool", frame="world")[2])


def compliant(limit_n):
    return ", compliant_joints: [%s]" % ", ".join("{joint: %s_joint, stiffness_n_per_m: 1000, force_limit_n: %g}" % (name, limit_n) for name in "ab")


def rows():
    """Name, and what held() gives, of each scene."""
    sheet = "sheet: {size_m: [0.03, 0.03], cells: [%d, %d], thickness_m: %g}\n    pose: {position_m: [0, 0, 0.0202]}\n"
    block = "block: {size_m: [0.03, 0.03, 0.003], cells: [%d, %d, %d]}\n    pose: {position_m: [0, 0, 0.02]}\n"
    stuck = "  - {tissue: bed, other_tissue: layer, static: 0.4, kinetic: 0.3}\n"
    for name, row in [("sheet of 1 mm, 100 kPa, on 5 kPa", (sheet % (8, 8, 1e-3), 0.0202, 1e5, 5e3, 3e-3)),
                      ("1 MPa", (sheet % (8, 8, 1e-3), 0.0202, 1e6, 5e3, 3e-3)),
                      ("100 kPa, 16 x 16 cells on 16 x 16 x 8", (sheet % (16, 16, 1e-3), 0.0202, 1e5, 5e3, 3e-3, "[16, 16, 8]")),
                      (".5 mm, 20 kPa, 12 x 12 on 10 x 10 x 5", (sheet % (12, 12, 5e-4), 0.0202, 2e4, 5e3, 3e-3, "[10, 10, 5]")),
                      ("block 10 x 10 x 1, 5 kPa, on 5 kPa", (block % (10, 10, 1), 0.023, 5e3, 5e3, 3e-3)),
                      ("8 x 8 x 1, stuck, on 5 kPa", (block % (8, 8, 1), 0.023, 5e3, 5e3, 4e-3, "[8, 8, 5]", stuck)),
                      ("8 x 8 x 1, stuck, on 50 kPa", (block % (8, 8, 1), 0.023, 5e3, 5e4, 4e-3, "[8, 8, 5]", stuck)),
                      ("8 x 8 x 2, on 50 kPa", (block % (8, 8, 2), 0.023, 5e3, 5e4, 4e-3))]:
        yield name, lambda row=row: on_layer(*row)
    for cells, distance in [(8, 9e-4), (8, 7e-4), (8, 5e-4), (20, 7e-4)]:
        yield "boxes on a sheet, %d cells, to %g mm" % (cells, 1e3 * distance), lambda cells=cells, distance=distance: on_sheet(cells, distance)
    for young, distance in [(5e4, -0.001), (1e6, 0.0)]:
        yield "compliant, %g kPa, limit .5 N" % (young / 1e3), lambda young=young, distance=distance: on_sheet(8, distance, young, compliant(0.5))
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "gut.obj")
        tube(file)
        for distance in (0.0035, 0.0028, 0.002):
            yield "boxes on a gut, to %g mm" % (1e3 * distance), lambda distance=distance: on_gut(file, distance)
        yield "compliant, limit .5 N", lambda: on_gut(file, 0.0, compliant(0.5))
        ring = os.path.join(folder, "ring.msh")
        open_ring(ring)
        for down in (0.007, 0.009):
            yield "open ring, pressed by %g mm" % (1e3 * down), lambda down=down: on_ring(ring, down)
    if not os.path.isfile(PSM):
        print("no %s: its jaws are left out (TISSUE_CONTACT_SHARED_DATA)" % PSM)
        return
    for law in ("corotational", "neo_hookean"):
        for count in (1, 2):
            for half_angle_rad, limit_n_m in [(0.05, 0.0), (0.04, 0.0), (0.03, 0.0), (-0.2, 0.008)]:
                closed = "limit %g N m" % limit_n_m if limit_n_m else "to %g rad" % half_angle_rad
                yield ("jaws, %d flap(s), %s, %s" % (count, law, closed),
                       lambda law=law, count=count, half=half_angle_rad, limit=limit_n_m: on_flaps(PSM, law, count, half, limit))


def line(scene, compare):
    found, missed = scene()
    last = found[-round(0.2 / SETTINGS["step.max_step_s"]):]
    text = "%9.4f +- %.4f   %4d steps of %d not converged" % (last.mean(), last.std(), missed, len(found))
    if not compare:
        return text
    own = dict(SETTINGS)
    SETTINGS.update(EXACT)
    exact, left = scene()
    SETTINGS.clear()
    SETTINGS.update(own)
    return text + "   off by %.2g %% (%d)" % (100.0 * np.linalg.norm(found - exact) / np.linalg.norm(exact), left)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0], formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("--compare", action="store_true", help="how far off forces are in all steps, RMS over RMS, from those of steps solved to 1e-7 "
                        "by Cholesky (how many of these were not)")
    parser.add_argument("--step", type=float, default=0.001, help="s")
    for key in ("iterations", "tolerance", "relaxation"):
        parser.add_argument("--" + key, help="solver." + key + " of the scenes")
    arguments = parser.parse_args()
    SETTINGS["step.max_step_s"] = arguments.step
    SETTINGS.update({"solver." + key: vars(arguments)[key] for key in ("iterations", "tolerance", "relaxation") if vars(arguments)[key]})
    for name, scene in rows():
        if arguments.only in name:
            print("%-40s %s" % (name, line(scene, arguments.compare)), flush=True)


if __name__ == "__main__":
    main()
