# SPDX-License-Identifier: MIT
"""A controller around the vehicle: brakes that let go where a wheel slips too far, against locked wheels."""
import gicgen

STEP, RATIO, SLIP = 0.004, 4, -0.1
WHEELS = ["f_l", "f_r", "r_l", "r_r"]
SLIPS = [f"slip_{wheel}.kappa" for wheel in WHEELS]

model = gicgen.Model("models/hmmwv_tires.veh")


def stop(controlled):
    """The way, m, and the time, s, from 20 m/s to 2 m/s, and the longest time, s, in which a front wheel stood."""
    car = model.instance("models/scenes/tires_brake.scene")
    demand, stood, longest = 1.0, 0.0, 0.0
    seen = car.outputs
    begin = seen["chassis.x"]
    while seen["chassis_velocity.x"] > 2 and car.time < 10:
        if controlled:
            # one pressure for all wheels: down while one slips too far, up else
            worst = min(seen[name] for name in SLIPS)
            demand = max(0.0, demand - 0.03) if worst < SLIP else min(1.0, demand + 0.03)
        car.inputs["brake"] = demand
        car.step(STEP, ratio=RATIO)
        seen = car.outputs
        stood = stood + STEP if abs(seen["slip_f_l.spin"]) < 0.5 else 0.0
        longest = max(longest, stood)
    return seen["chassis.x"] - begin, car.time, longest


locked, controlled = stop(False), stop(True)
for name, (way, time, stood) in (("full brakes", locked), ("with ABS", controlled)):
    print(f"{name}: {way:.2f} m, {time:.2f} s, a front wheel stood for {stood:.2f} s")
assert locked[2] > 1 and controlled[2] < 0.3, "the wheels should lock without the controller, and turn with it"
