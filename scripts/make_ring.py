#!/usr/bin/python3
"""Writes a ring of tetrahedra as a mesh file (Gmsh 2.2, metres), its upper face on z = 0: the specimen whose static friction is measured by
twisting a plate on it (doc/calibration.md).

  make_ring.py ring.msh                       34 and 40 mm wide, 4 mm high, 48 x 2 x 2 cells, as config/calibration has it
  make_ring.py finer.msh --cells 72 3 3       around, across, in height
"""
import argparse
import itertools
import os
import sys

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file


def ring(inner_m, outer_m, height_m, cells):
    """(nodes (m), tetrahedra): each cell six tetrahedra along the paths from its first corner to its last, so that neighbours' faces match and
    every contact has neighbours alike."""
    around, across, up = cells
    angles, radii = 2.0 * numpy.pi * numpy.arange(around) / around, numpy.linspace(inner_m, outer_m, across + 1)
    nodes = [(radius * numpy.cos(angle), radius * numpy.sin(angle), z)
             for angle in angles for radius in radii for z in numpy.linspace(-height_m, 0.0, up + 1)]
    tetrahedra = []
    for cell in itertools.product(range(around), range(across), range(up)):
        for order in itertools.permutations(range(3)):
            corner, path = list(cell), [tuple(cell)]
            for axis in order:
                corner[axis] += 1
                path.append(tuple(corner))
            odd = sum(order[i] > order[j] for i in range(3) for j in range(i + 1, 3)) % 2
            if not odd:  # angle, radius, height is a left-handed order
                path[0], path[1] = path[1], path[0]
            tetrahedra.append([((a % around) * (across + 1) + r) * (up + 1) + z for a, r, z in path])
    return numpy.array(nodes), numpy.array(tetrahedra)


def write(path, nodes, tetrahedra):
    with open(path, "w", encoding="ascii") as stream:
        stream.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % len(nodes))
        for i, node in enumerate(nodes, 1):
            stream.write("%d %.6g %.6g %.6g\n" % (i, *(node + 0.0)))
        stream.write("$EndNodes\n$Elements\n%d\n" % len(tetrahedra))
        for i, corners in enumerate(tetrahedra + 1, 1):
            stream.write("%d 4 2 1 1 %d %d %d %d\n" % (i, *corners))
        stream.write("$EndElements\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--inner", type=float, default=0.017, help="radius, m; default: %(default)s")
    parser.add_argument("--outer", type=float, default=0.020, help="radius, m; default: %(default)s")
    parser.add_argument("--height", type=float, default=0.004, help="m; default: %(default)s")
    parser.add_argument("--cells", type=int, nargs=3, default=[48, 2, 2], help="around, across, in height; default: 48 2 2")
    arguments = parser.parse_args()
    around, across, up = arguments.cells
    if not (8 <= around <= 1000 and 1 <= across <= 50 and 1 <= up <= 50):
        sys.exit("make_ring.py: --cells %d %d %d; from 8 1 1 to 1000 50 50 are allowed" % (around, across, up))
    if not (0.0 < arguments.inner < arguments.outer <= 1.0 and 0.0 < arguments.height <= 1.0):
        sys.exit("make_ring.py: --inner %g --outer %g --height %g; above 0, inner below outer, up to 1 m are allowed" %
                 (arguments.inner, arguments.outer, arguments.height))
    try:
        with whole_file(arguments.file) as name:
            write(name, *ring(arguments.inner, arguments.outer, arguments.height, arguments.cells))
    except OSError as error:
        sys.exit("make_ring.py: cannot write %s: %s" % (arguments.file, error.strerror))


if __name__ == "__main__":
    main()
