# SPDX-License-Identifier: MIT
"""Linear analysis: poles, a frequency response and a step response of the linear model, which a run confirms.
`control.ss(*linear.matrices, **linear.labels)` hands it to python-control."""
import numpy

import gicgen

model = gicgen.Model("models/quarter_car.veh")
linear = model.linearize()
A, B, C, D = linear.matrices
poles = numpy.linalg.eigvals(A)
modes = model.modes()
for real, imaginary, frequency in zip(modes["real"], modes["imaginary"], modes["frequency"]):
    assert min(abs(poles - complex(real, imaginary))) < 1e-6 * abs(complex(real, imaginary))
    print(f"{frequency:.4f} Hz, {real:.4f} +- {imaginary:.4f}i 1/s")

# a small push, of the linear model and of the vehicle itself
rest = model.equilibrium()
car = model.instance()
push = numpy.array([1e-4, 0, 0, 0])
car.states[:] = rest.states[:] + push
time, step, z = 0.4, 0.001, push
car.step(step, round(time / step), "rk4")
values, vectors = numpy.linalg.eig(A)
expected = (vectors @ numpy.diag(numpy.exp(values * time)) @ numpy.linalg.solve(vectors, push)).real
moved = car.states[:] - rest.states[:]
print("moved", moved, "expected", expected)
assert numpy.allclose(moved, expected, atol=2e-3 * abs(push).max())

# how heights follow a force along the first coordinate: (i w - A)^-1, at its poles
for frequency in modes["frequency"]:
    w = 2j * numpy.pi * frequency
    answer = C[linear.outputs.index("carriage.z")] @ numpy.linalg.solve(w * numpy.eye(len(A)) - A, numpy.eye(len(A))[2])
    print(f"{frequency:.3f} Hz: |z / a| = {abs(answer):.3e} s^2")
