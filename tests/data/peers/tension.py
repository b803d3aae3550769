"""The tension strip of this folder by FElupe, timed: `python tension.py NX NY NZ pardiso|superlu`.

A yardstick to run beside `fct simulate` on one machine (docs/performance.md), on one thread:
OMP_NUM_THREADS=1 MKL_NUM_THREADS=1. Needs `pip install felupe==11.3.0 pypardiso`; nothing of the project does.
"""

import csv
import pathlib
import sys
import time

import felupe as fem
import numpy as np
from numpy import einsum

NX, NY, NZ = map(int, sys.argv[1:4])
solver = sys.argv[4]
mu, k1, k2, gam, kap, K = 0.0051, 0.9388, 20.09, np.radians(38.53), 0.23, 1.0
dirs = [np.array([np.sin(s * gam), np.cos(s * gam), 0]) for s in (1, -1)]


class HGO:
    def __init__(self):
        self.x = [np.eye(3), np.zeros(0)]

    def inv(self, F):
        J = fem.math.det(F)
        T = fem.math.transpose(fem.math.inv(F))
        j = J ** (-2 / 3)
        return J, T, j

    def first(self, F, T, j, I, dI):
        return j * (dI - 2 / 3 * I * T)

    def parts(self, F):
        J, T, j = self.inv(F)
        I1 = einsum("ij...,ij...->...", F, F)
        D1 = self.first(F, T, j, I1, 2 * F)
        b1 = j * I1
        out = [(b1, I1, 2 * F, D1, None)]
        for a in dirs:
            Fa = einsum("ij...,j->i...", F, a)
            I4 = einsum("i...,i...->...", Fa, Fa)
            dI = 2 * einsum("i...,j->ij...", Fa, a)
            out.append((j * I4, I4, dI, self.first(F, T, j, I4, dI), a))
        return J, T, j, out

    def coeff(self, E):
        on = E > 0
        e = np.exp(k2 * E * E) * on
        return k1 * E * e, k1 * (1 + 2 * k2 * E * E) * e

    def gradient(self, x):
        F, z = x[0], x[-1]
        J, T, j, p = self.parts(F)
        P = mu / 2 * p[0][3] + K / 2 * (J * J - 1) * T
        for q in p[1:]:
            E = kap * (p[0][0] - 3) + (1 - 3 * kap) * (q[0] - 1)
            g, _ = self.coeff(E)
            P = P + g * (kap * p[0][3] + (1 - 3 * kap) * q[3])
        return [P, z]

    def second(self, F, T, j, q):
        b, I, dI, D, a = q
        M = np.eye(3) if a is None else np.outer(a, a)
        h = einsum("ik,jl->ijkl", np.eye(3), 2 * M)[..., None, None] * j
        TT = einsum("ij...,kl...->ijkl...", T, T)
        X = einsum("il...,kj...->ijkl...", T, T)
        dT = einsum("ij...,kl...->ijkl...", dI, T)
        return h - 2 / 3 * j * (dT + einsum("ijkl...->klij...", dT)) + 4 / 9 * j * I * TT + 2 / 3 * j * I * X

    def hessian(self, x):
        F = x[0]
        J, T, j, p = self.parts(F)
        TT = einsum("ij...,kl...->ijkl...", T, T)
        X = einsum("il...,kj...->ijkl...", T, T)
        H1 = self.second(F, T, j, p[0])
        A = mu / 2 * H1 + K * J * J * TT - K / 2 * (J * J - 1) * X
        for q in p[1:]:
            E = kap * (p[0][0] - 3) + (1 - 3 * kap) * (q[0] - 1)
            g, h = self.coeff(E)
            n = kap * p[0][3] + (1 - 3 * kap) * q[3]
            A = (
                A
                + h * einsum("ij...,kl...->ijkl...", n, n)
                + g * (kap * H1 + (1 - 3 * kap) * self.second(F, T, j, q))
            )
        return [A]


t0 = time.process_time()
mesh = fem.Cube(b=(4, 10, 1), n=(NX + 1, NY + 1, NZ + 1))
region = fem.RegionHexahedron(mesh)
field = fem.FieldsMixed(region, n=3)
y = mesh.points[:, 1]
top = y > 10 - 1e-9
b = {
    "fix": fem.Boundary(field[0], fy=0),
    "side": fem.Boundary(field[0], fy=10, skip=(0, 1, 0)),
    "move": fem.Boundary(field[0], fy=10, skip=(1, 0, 1)),
}
solid = fem.SolidBody(fem.ThreeFieldVariation(HGO()), field)
if solver == "pardiso":
    import pypardiso

    solve = pypardiso.spsolve
else:
    from scipy.sparse.linalg import spsolve as solve
ref = [r for r in csv.reader(open(pathlib.Path(__file__).with_name(f"tension_{NX}x{NY}x{NZ}_K1.csv")))]
its = 0
for n, u in enumerate(np.arange(1, 11) * 0.2):
    b["move"].value = u
    dof0, dof1 = fem.dof.partition(field, b)
    ext0 = fem.dof.apply(field, b, dof0)
    r = fem.newtonrhapson(items=[solid], dof0=dof0, dof1=dof1, ext0=ext0, solver=solve, tol=1e-9, verbose=0)
    its += r.iterations
    f = fem.tools.force(field, r.fun, b["move"])[1]
    print(f"{u:.1f} mm  {f:.10f} N  file {ref[n+2][2]}  iterations {r.iterations}", flush=True)
print("iterations", its, "cpu s", time.process_time() - t0)
