#!/usr/bin/python3
"""Force of a rigid, smooth sphere pressed a little into a linear elastic block on a rigid base: form H, at any Poisson's ratio.

usage: sphere_on_block.py [--poissons-ratio NU] [--elements N]        (Debian: python3-numpy, python3-scipy)

An answer independent of tissue_contact, to some hundredths of a per cent. The displacement is that of a half space (Hertz;
singular only at the contact's edge, in closed form) plus what base and sides of the block add, which is smooth: it is solved
with quadratic hexahedra on a quarter of the block, loaded by Boussinesq's displacement on the base and his traction on the
free sides, both with the sign turned. Over the contact it is P (c0 + c2 r^2), so the contact stays Hertz's with

    1 / (2 R') = 1 / (2 R) + P c2,    delta' = delta - P c0 + P (1 - 2 nu) / (4 pi G R),    P = 4/3 E* sqrt(R') delta'^1.5

The last term of delta' is the sphere's geometry to first order in a / R, which Hertz leaves out and a simulator has: points
move inwards by u_r to where the sphere is lower, (r / R) u_r, and the pressure along the sphere's normal pushes them
outwards with q = p r / R. Boussinesq gives -(1 - 2 nu) / (2 G R) times the integral of p s over s < r for the first and over
s > r for the second: a constant in all. To second order, P falls by (a / R)^2 / 10, since a sphere lies above its parabola,
and by (a / R)^2 / 5, since q moves points outwards to where it is higher (both by the pressure of a flat punch, Hankel
transforms). Left out: higher orders, (a / R)^3 and (a / L)^4 or so, 0.1 to 0.2 % here.
"""
import argparse

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

SIZE_M = (0.06, 0.06, 0.03)
E_PA, RADIUS_M, DEPTH_M = 1e4, 0.04, 0.000625


def half_space(points, nu, shear, radius):
    """Displacement and stress per newton of Hertz pressure over a disc of this radius; z down from the loaded face."""
    s, weight = np.polynomial.legendre.leggauss(6)
    s, weight = 0.5 * (s + 1.0), 0.5 * weight  # 1 - (r/a)^2 = s^2: p r dr goes with s^2 ds
    u, sigma = np.zeros((len(points), 3)), np.zeros((len(points), 3, 3))
    for ring, share in zip(radius * np.sqrt(1.0 - s * s), 3.0 * s * s * weight):
        for angle in (np.arange(16) + 0.5) * (2.0 * np.pi / 16):
            one = boussinesq(points - ring * np.array([np.cos(angle), np.sin(angle), 0.0]), nu, shear)
            u, sigma = u + share / 16.0 * one[0], sigma + share / 16.0 * one[1]
    return u, sigma


def boussinesq(points, nu, shear):
    x, y, z = points.T
    r, rho = np.hypot(x, y), np.sqrt(x * x + y * y + z * z)
    cos, sin = np.where(r > 0, x / np.maximum(r, 1e-12), 1.0), np.where(r > 0, y / np.maximum(r, 1e-12), 0.0)
    radial = (r * z / rho**3 - (1 - 2 * nu) * r / (rho * (rho + z))) / (4 * np.pi * shear)
    down = (z * z / rho**3 + 2 * (1 - nu) / rho) / (4 * np.pi * shear)
    rr = ((1 - 2 * nu) / (rho * (rho + z)) - 3 * r * r * z / rho**5) / (2 * np.pi)
    tt = (1 - 2 * nu) / (2 * np.pi) * (z / rho**3 - 1 / (rho * (rho + z)))
    zz, rz = -3 * z**3 / (2 * np.pi * rho**5), -3 * r * z * z / (2 * np.pi * rho**5)
    sigma = np.empty((len(points), 3, 3))
    sigma[:, 0, 0], sigma[:, 1, 1], sigma[:, 2, 2] = rr * cos**2 + tt * sin**2, rr * sin**2 + tt * cos**2, zz
    sigma[:, 0, 1] = sigma[:, 1, 0] = (rr - tt) * cos * sin
    sigma[:, 0, 2] = sigma[:, 2, 0] = rz * cos
    sigma[:, 1, 2] = sigma[:, 2, 1] = rz * sin
    return np.stack([radial * cos, radial * sin, down], axis=1), sigma


def lagrange(t):
    """Quadratic shape functions on -1, 0, 1 and their derivatives."""
    return np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5])


GAUSS = [(-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9)]


def element_stiffness(h, lam, shear):
    """27 nodes, edges h."""
    stiffness = np.zeros((81, 81))
    D = np.zeros((6, 6))
    D[:3, :3] = lam
    D[range(3), range(3)] += 2 * shear
    D[range(3, 6), range(3, 6)] = shear
    for a, wa in GAUSS:
        for b, wb in GAUSS:
            for c, wc in GAUSS:
                (na, da), (nb, db), (nc, dc) = lagrange(a), lagrange(b), lagrange(c)
                g = [np.einsum("i,j,k->ijk", *f).ravel() * 2 / h[k]
                     for k, f in enumerate(((da, nb, nc), (na, db, nc), (na, nb, dc)))]
                B = np.zeros((6, 81))
                for k in range(3):
                    B[k, k::3] = g[k]
                for row, (i, j) in enumerate(((0, 1), (1, 2), (0, 2)), 3):
                    B[row, i::3], B[row, j::3] = g[j], g[i]
                stiffness += wa * wb * wc * np.prod(h) / 8 * B.T @ D @ B
    return stiffness


def correction(nu, elements, radius):
    """(c0, c2) per newton: what base and sides add to the displacement (m, down) of the loaded face, c0 + c2 r^2."""
    shear, lam = E_PA / (2 * (1 + nu)), E_PA * nu / ((1 + nu) * (1 - 2 * nu))
    lengths = np.array([SIZE_M[0] / 2, SIZE_M[1] / 2, SIZE_M[2]])
    n = 2 * elements + 1
    axes = [np.linspace(0.0, length, n) for length in lengths]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(n**3).reshape(n, n, n)
    h = lengths / elements
    rows, columns, values = [], [], []
    one = element_stiffness(h, lam, shear).ravel()
    for i in range(0, n - 1, 2):
        for j in range(0, n - 1, 2):
            for k in range(0, n - 1, 2):
                dof = (3 * number[i:i + 3, j:j + 3, k:k + 3].ravel()[:, None] + np.arange(3)).ravel()
                rows.append(np.repeat(dof, 81))
                columns.append(np.tile(dof, 81))
                values.append(one)
    K = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsr()
    load = np.zeros(3 * n**3)
    for side in (0, 1):  # the free faces x = L/2 and y = L/2
        across = 1 - side
        for j in range(0, n - 1, 2):
            for k in range(0, n - 1, 2):
                ids = (number[n - 1, j:j + 3, k:k + 3] if side == 0 else number[j:j + 3, n - 1, k:k + 3]).ravel()
                for b, wb in GAUSS:
                    for c, wc in GAUSS:
                        shape = np.einsum("i,j->ij", lagrange(b)[0], lagrange(c)[0]).ravel()
                        sigma = half_space((shape @ nodes[ids])[None], nu, shear, radius)[1][0]
                        traction = -sigma[:, side] * wb * wc * h[across] * h[2] / 4
                        load.reshape(-1, 3)[ids] += shape[:, None] * traction
    held, value = np.zeros(3 * n**3, bool), np.zeros(3 * n**3)
    base = number[:, :, n - 1].ravel()
    held.reshape(-1, 3)[base] = True
    value.reshape(-1, 3)[base] = -half_space(nodes[base], nu, shear, radius)[0]
    held.reshape(-1, 3)[number[0].ravel(), 0] = True
    held.reshape(-1, 3)[number[:, 0].ravel(), 1] = True
    value.reshape(-1, 3)[number[0].ravel(), 0] = value.reshape(-1, 3)[number[:, 0].ravel(), 1] = 0.0
    free = ~held
    u = value.copy()
    u[free] = spsolve(K[free][:, free].tocsc(), load[free] - K[free] @ value, permc_spec="MMD_AT_PLUS_A")
    top = u.reshape(n, n, n, 3)[:3, 0, 0, 2]  # along x, in the element at the axis
    return top[0], (lagrange(2 * radius / h[0] - 1)[0] @ top - top[0]) / radius**2


def press_force(nu, c0, c2, geometry=True):
    shear, modulus = E_PA / (2 * (1 + nu)), E_PA / (1 - nu * nu)
    force = 0.05
    for _ in range(200):
        radius = 1.0 / (1.0 / RADIUS_M + 2.0 * force * c2)
        depth = DEPTH_M - force * c0
        if geometry:
            depth += force * (1 - 2 * nu) / (4 * np.pi * shear * RADIUS_M)
        flat = 4.0 / 3.0 * modulus * np.sqrt(radius) * depth**1.5
        force = flat * (1.0 - 0.3 * radius * depth / RADIUS_M**2 if geometry else 1.0)
    return force


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--poissons-ratio", type=float, nargs="*", default=[0.3, 0.45])
    parser.add_argument("--elements", type=int, nargs="*", default=[3, 4])
    arguments = parser.parse_args()
    for nu in arguments.poissons_ratio:
        for elements in arguments.elements:
            c0, c2 = correction(nu, elements, 0.005)
            half = 4.0 / 3.0 * E_PA / (1 - nu * nu) * np.sqrt(RADIUS_M) * DEPTH_M**1.5
            print("nu %g, %d elements: c0 %.6f m/N, c2 %.4f 1/(N m); P %.6f N flat, %.6f N with the sphere's geometry "
                  "(half space %.6f)" % (nu, elements, c0, c2, press_force(nu, c0, c2, False), press_force(nu, c0, c2), half),
                  flush=True)


if __name__ == "__main__":
    main()
