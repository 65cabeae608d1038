# SPDX-License-Identifier: MIT
"""First steps: a scene, then a vehicle of one's own. From the folder of the sources: PYTHONPATH=runtime/python."""
import numpy

import gicgen

model = gicgen.Model("models/hmmwv_vehicle.veh")

# a scene as gicrun runs it, with the same bits: columns with names and units
columns = model.run("models/scenes/step_steer.scene")
turning = columns["chassis_angular_velocity.z"]
print(f"{len(columns)} rows; fastest turn {abs(turning).max():.4f} {columns.units['chassis_angular_velocity.z']}")
# pandas.DataFrame(dict(columns)) and xarray.Dataset({n: ("time", columns[n]) for n in columns}) take it as it is

# a vehicle of one's own: the scene's road and initial state; inputs are ours
car = model.instance("models/scenes/straight.scene")
for _ in range(100):
    speed = car.outputs["chassis_velocity.x"]
    car.inputs["accelerator"] = min(1.0, max(0.0, 0.5 * (12 - speed)))
    car.step(0.006, ratio=6)
print(f"t = {car.time:.3f} s: {car.outputs['chassis_velocity.x']:.4f} m/s, gear {car.outputs['drive.gear']:.0f}")

# a snapshot is all of it: what comes after it comes again
before = car.snapshot()
car.step(0.006, 50, ratio=6)
once = car.states[:].copy()
car.restore(before)
car.step(0.006, 50, ratio=6)
assert numpy.array_equal(once, car.states[:])

# mistakes are exceptions that say where and what to write
try:
    car.inputs["acelerator"] = 1
except KeyError as error:
    print(error)
