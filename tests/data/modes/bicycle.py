# SPDX-License-Identifier: MIT
# bicycle.py DUMP EVAL MODES SPEED: yaw and sideslip of a vehicle as a bicycle model has them, against MODES
# of `gicrun --modes -o` at SPEED, m/s.
#
# EVAL has two rows of `gicrun --eval` that differ in the slip of tires alone, whose outputs are slip_f_l and slip_r_l:
# cornering stiffnesses of axles are twice the differences, and rates of slips tell how fast tires follow. DUMP has
# masses and yaw inertia, EVAL where axles are. Compared are real part and size of the pair of eigenvalues in which y
# and yaw have the largest share: within 5 % and 10 %, for a bicycle knows nothing of roll and of what suspensions steer.
import csv
import json
import math
import sys


def rows(path):
    with open(path) as file:
        return [{name.split(" ")[0]: value for name, value in row.items()} for row in csv.DictReader(file)]


dump, states, modes = json.load(open(sys.argv[1])), rows(sys.argv[2]), rows(sys.argv[3])
speed = float(sys.argv[4])


def difference(name):
    return float(states[1][name]) - float(states[0][name])


bodies = dump["bodies"]
mass = sum(body["mass"] for body in bodies)
place = [[body["position"][i] + body["com"][i] for i in range(2)] for body in bodies]  # bodies hardly turn
center = [sum(body["mass"] * at[i] for body, at in zip(bodies, place)) / mass for i in range(2)]
inertia = sum(body["inertia"][2] + body["mass"] * sum((at[i] - center[i]) ** 2 for i in range(2))
              for body, at in zip(bodies, place))

axles = []
for axle in "fr":
    slip = difference(f"output.slip_{axle}_l.alpha")
    stiffness = -2 * difference(f"output.slip_{axle}_l.fy") / slip
    follows = -difference(f"tire_{axle}_l.slip_y.rate") / slip
    axles.append((stiffness, float(states[0][f"output.contact_{axle}_l.x"]) - center[0], follows))

# lateral velocity and yaw rate: (z + A[0]) v + (V + A[1]) r = 0, B[0] v + (z + B[1]) r = 0, where what tires do lags
# behind by 1 / (1 + z / follows), z of the mean of both
mean = 0
for _ in range(50):
    force = [(stiffness * follows / (follows + mean) / speed, arm) for stiffness, arm, follows in axles]
    A = [sum(f * arm ** n for f, arm in force) / mass for n in range(2)]
    B = [sum(f * arm ** n for f, arm in force) / inertia for n in range(1, 3)]
    mean = -(A[0] + B[1]) / 2
size = math.sqrt(A[0] * B[1] - (speed + A[1]) * B[0])

best = max((row for row in modes if row["share.y"]), key=lambda row: float(row["share.y"]) + float(row["share.yaw"])
           if float(row["real"]) else 0)
found = float(best["real"]), math.hypot(float(best["real"]), float(best["imaginary"]))
print("axles", *(f"{c:.5g} N/rad at {arm:.4g} m, {f:.4g} 1/s;" for c, arm, f in axles), f"{mass:.5g} kg, {inertia:.5g}")
print(f"real part: bicycle {mean:.4f}, modes {found[0]:.4f} 1/s; size: {size:.4f}, {found[1]:.4f} 1/s")
sys.exit(not (abs(found[0] / mean - 1) < 0.05 and abs(found[1] / size - 1) < 0.1))
