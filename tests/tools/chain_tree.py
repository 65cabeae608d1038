# SPDX-License-Identifier: MIT
"""chain_tree.py SEED BODIES: prints a random tree of bodies on hinges, guides and sleeves, on the ground or on a free body,
with numbers that people write. Some hinges are driven. Outputs are the reactions of all joints and drives."""
import random
import sys


def main():
    pick = random.Random(int(sys.argv[1]))
    base = pick.choice(["root", "ground"])
    bodies, joints, coordinates, forces, outputs, at = [], [], [], [], [], []
    if base == "root":
        bodies.append("  root: {mass: 5, position: [0, 0, 0], com: [0.1, 0, 0], inertia: [2, 2, 3]}")
    for i in range(int(sys.argv[2])):
        before = -1 if i == 0 or pick.random() < 0.1 else pick.randrange(max(0, i - 3), i)
        place = [0, 0, 0] if before < 0 else [x + pick.choice([0, 1, -1, 0.5]) for x in at[before]]
        at.append(place)
        com = [x + pick.choice([0, 0.5, -0.5, 0.25]) for x in place]
        bodies.append(f"  b{i}: {{mass: {pick.choice([1, 2, 0.5])}, com: {com}, "
                      f"inertia: [{pick.choice([0.1, 0.2, 0.4])}, 0.2, 0.25]}}")
        axis = pick.choice([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8]])
        ends = f"bodies: [{base if before < 0 else 'b%d' % before}, b{i}]"
        kind = pick.choice(["revolute", "revolute", "prismatic", "cylindrical"])
        point = "" if kind == "prismatic" else f"point: {place}, "
        joints.append(f"  j{i}: {{type: {kind}, {ends}, {point}axis: {axis}}}")
        outputs.append(f"  j{i}: {{type: reaction, joint: j{i}}}")
        driven = kind == "revolute" and pick.random() < 0.15
        if driven:
            outputs.append(f"  drive_q{i}: {{type: drive_force, coordinate: q{i}}}")
        moves = {"revolute": "q", "prismatic": "s", "cylindrical": "qs"}[kind]
        for move in moves:
            word, most = ("angle", 1) if move == "q" else ("translation", 0.5)
            coordinates.append(f"  {move}{i}: {{type: {word}, {ends}, axis: {axis}, range: [-{most}, {most}]"
                               f"{', driven: true' if driven else ''}}}")
            if not driven and pick.random() < 0.5:
                forces.append(f"  f{move}{i}: {{type: spring_damper, coordinate: {move}{i}, stiffness: 10, damping: 1}}")
    print(f"gicgen: 1\nmodel: tree\nbase: {base}")
    for name, entries in (("bodies", bodies), ("joints", joints), ("coordinates", coordinates), ("forces", forces),
                          ("outputs", outputs)):
        if entries:
            print(name + ":\n" + "\n".join(entries))


main()
