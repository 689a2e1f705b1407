"""All eigenvalues of brake_matrices below a frequency by SciPy: shift-and-invert Arnoldi (ARPACK).

    /usr/bin/python3 bench/brake/large_eigenvalues.py DIRECTORY HERTZ [SHIFTS [PAIRS [MU]]]

Seven shifts along the imaginary axis and 24 eigenvalues at each find all 46 pairs of a mesh of 4,429
unknowns below 16 kHz. Nothing says that they are all: stridor's count does. Prints frequency and growth of each, and the seconds of processor time that it took without reading.
"""
import os
os.environ.setdefault("OMP_NUM_THREADS", "1")
import sys
import time

import numpy as np
import scipy.io
import scipy.sparse as sp
import scipy.sparse.linalg as spl

directory = sys.argv[1]
below = 2 * np.pi * float(sys.argv[2])
num_shifts = int(sys.argv[3]) if len(sys.argv) > 3 else 7
num_pairs = int(sys.argv[4]) if len(sys.argv) > 4 else 20
mu = float(sys.argv[5]) if len(sys.argv) > 5 else 0.3

M, D, G, K, F = (sp.csc_matrix(scipy.io.mmread(f"{directory}/{name}.mtx")) for name in "MDGKF")
P = (D + G).tocsc()
Q = (K + mu * F).tocsc()
n = M.shape[0]
start = time.process_time()


def near(sigma):
    """Eigenvalues next to a shift: of (A - sigma)^-1 for the state (x, s x / scale)."""
    scale = abs(sigma)
    factor = spl.splu((sigma**2 * M + sigma * P + Q).tocsc(), permc_spec="MMD_AT_PLUS_A",
                      diag_pivot_thresh=0.01, options=dict(SymmetricMode=True))

    def apply(state):
        a, b = state[:n], scale * state[n:]
        x = -factor.solve(M @ (b + sigma * a) + P @ a)
        return np.concatenate([x, (sigma * x + a) / scale])

    operator = spl.LinearOperator((2 * n, 2 * n), matvec=apply, dtype=complex)
    values, vectors = spl.eigs(operator, k=num_pairs, which="LM", tol=1e-10)
    return sigma + 1 / values, vectors[:n]


found = []
for i in range(num_shifts):
    sigma = below * (0.005 + 1j * (i + 0.5) / num_shifts)
    values, vectors = near(sigma)
    reach = np.max(np.abs(values - sigma))
    print(f"shift {sigma.imag / 2 / np.pi:9.1f} Hz reaches {reach / 2 / np.pi:8.1f} Hz", file=sys.stderr)
    for s, x in zip(values, vectors.T):
        residual = np.linalg.norm(s**2 * (M @ x) + s * (P @ x) + Q @ x) / (
            abs(s)**2 * np.linalg.norm(M @ x) + abs(s) * np.linalg.norm(P @ x) + np.linalg.norm(Q @ x))
        if 0 < s.imag <= below and residual < 1e-6 and all(abs(s - t) > 1e-7 * abs(s) for t in found):
            found.append(s)
for s in sorted(found, key=lambda s: s.imag):
    print(f"{s.imag / 2 / np.pi:12.4f} Hz {s.real:12.4f} 1/s")
print(f"{n} unknowns, {len(found)} pairs, {time.process_time() - start:.1f} s of processor time")
