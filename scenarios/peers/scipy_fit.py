#!/usr/bin/python3
"""The fit of `teleop bench diagnose`, as a researcher would write it with scipy.

scipy_fit.py PROBLEM.json: the arm's lumped constants, commands, readings and the gains that hold the
simulation to them; finds the logarithms of three viscous coefficients. Prints one line of JSON:
seconds, coefficients, simulations.
"""
import json
import sys
import time
from math import cos, sin

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

with open(sys.argv[1]) as file:
    problem = json.load(file)
K, S0, S2, S3, M22, M33, N2, N3 = (problem["lumped"][name]
                                   for name in ("K", "S0", "S2", "S3", "M22", "M33", "N2", "N3"))
h = problem["period_s"]
tau, q_read = np.array(problem["tau"]), np.array(problem["q"])
gains = {name: np.array(problem[name]).reshape(-1, 3, 3)
         for name in ("position", "velocity", "disturbance", "whitening")}
memory = np.array(problem["memory"])
settling = problem["settling"]
simulations = 0


def accelerations(t, x, torque, coefficient):
    """State (q, q'); M q'' + C q' + N = torque - coefficient * q'."""
    c2, s2, c3, s3 = cos(x[1]), sin(x[1]), cos(x[2]), sin(x[2])
    M11 = S0 + S2 * (c2 * c2 - s2 * s2) - S3 * (c3 * c3 - s3 * s3) + K * c2 * s3
    M23 = -K / 2 * (s2 * c3 - c2 * s3)
    a = -s2 * (2 * S2 * c2 + K / 2 * s3)
    b = c3 * (2 * S3 * s3 + K / 2 * c2)
    g = K / 2 * (c2 * c3 + s2 * s3)
    v1, v2, v3 = x[3], x[4], x[5]
    n1 = torque[0] - coefficient[0] * v1 - 2 * v1 * (a * v2 + b * v3)
    n2 = torque[1] - coefficient[1] * v2 - (-a * v1 * v1 + g * v3 * v3 + N2 * c2)
    n3 = torque[2] - coefficient[2] * v3 - (-b * v1 * v1 - g * v2 * v2 + N3 * s3)
    determinant = M22 * M33 - M23 * M23
    return (v1, v2, v3, n1 / M11, (M33 * n2 - M23 * n3) / determinant,
            (M22 * n3 - M23 * n2) / determinant)


def errors(logarithms):
    """Whitened innovations."""
    global simulations
    simulations += 1
    coefficient = np.exp(logarithms)
    x = np.concatenate((q_read[0], np.zeros(3)))  # the gains find the speed
    d = np.zeros(3)
    out = np.empty_like(q_read)
    for k in range(len(tau)):
        e = q_read[k] - x[:3]
        out[k] = gains["whitening"][k] @ e
        x[:3] += gains["position"][k] @ e
        x[3:] += gains["velocity"][k] @ e
        d = d + gains["disturbance"][k] @ e
        x = solve_ivp(accelerations, (0.0, h), x, args=(tau[k] + d, coefficient),
                      rtol=1e-8, atol=1e-10).y[:, -1]
        d = memory * d
    return out[settling:].ravel()


begin = time.monotonic()
found = least_squares(errors, np.log(problem["start"]), method="lm", diff_step=1e-3)
print(json.dumps({"seconds": time.monotonic() - begin, "coefficients": np.exp(found.x).tolist(),
                  "simulations": simulations}))
