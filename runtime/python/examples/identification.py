# SPDX-License-Identifier: MIT
"""Identification: stiffness and damping of a spring from a measured motion, by least squares (Gauss and Newton).
scipy.optimize.least_squares(residual, start) does the same where SciPy is installed."""
import numpy

import gicgen

with open("models/quarter_car.veh") as file:
    text = file.read()
# the two numbers become parameters that may change at any time
text = text.replace("stiffness: 167070.9, damping: 17490.8", "stiffness: k, damping: c")
text += """
parameters:
  k: {value: 150000, unit: N/m, tunable: true}
  c: {value: 15000, unit: N s/m, tunable: true}
"""
model = gicgen.Model(text=text, name="models/quarter_car.veh")
car = model.instance("models/scenes/quarter_car.scene")


def motion(k, c):
    """The height of the carriage at 150 times."""
    car.set_up({"k": k, "c": c})
    heights = numpy.empty(150)
    for i in range(len(heights)):
        car.step(0.002, 5, "rk4")
        heights[i] = car.states["bounce"]
    return heights


true = numpy.array([167070.9, 17490.8])
noise = numpy.random.default_rng(1).normal(0, 1e-5, 150)  # m
measured = motion(*true) + noise


def residual(p):
    return motion(*p) - measured


p = numpy.array([150000.0, 15000.0])
for _ in range(8):
    r = residual(p)
    J = numpy.stack([(residual(p + d) - residual(p - d)) / (2 * d.sum()) for d in numpy.diag(1e-4 * p)], axis=1)
    p = p - numpy.linalg.lstsq(J, r, rcond=None)[0]
deviation = numpy.sqrt(numpy.diag(numpy.linalg.inv(J.T @ J))) * 1e-5
print(f"k = {p[0]:.0f} +- {deviation[0]:.0f} N/m, c = {p[1]:.1f} +- {deviation[1]:.1f} N s/m")
assert (abs(p - true) < 4 * deviation).all()
