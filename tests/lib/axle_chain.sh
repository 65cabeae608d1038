#!/bin/sh
# SPDX-License-Identifier: MIT
# axle_chain.sh BODIES: prints a vehicle model with that many bodies, a multiple of 5 from 5 on: one long chassis on
# BODIES / 5 axles, each the front axle of models/hmmwv.veh (rack, and on both sides lower arm and wheel assembly: 5
# bodies). The last axle is not steered: its tie rods stand on the chassis, which takes the place of its rack.
#
# It shows how cost grows with size. 1080 kg of chassis an axle is what the springs of hmmwv.veh carry at their
# design length, with tires deflected by some 0.02 m.
case $1 in
*[05]) ;;
*)
    echo "usage: axle_chain.sh BODIES, a multiple of 5" >&2
    exit 2
    ;;
esac
awk -v axles=$(($1 / 5)) '
    # a point of axle i, given for the front left corner of hmmwv.veh; side is 1 or -1
    function point(name, i, side, x, y, z) {
        printf "  %s_%s: [%.7f, %.7f, %.7f]\n", name, corner(i, side), x - pitch * i, side * y, z
    }
    function corner(i, side) { return i (side > 0 ? "l" : "r") }
    BEGIN {
        pitch = 1.6                                 # m from axle to axle
        middle = 1.648579 - pitch * (axles - 1) / 2 # between the wheel centres
        mass = 1080 * axles
        length2 = (pitch * axles)^2 / 12
        print "# SPDX-License-Identifier: MIT\ngicgen: 1\nmodel: axle_chain\nbase: chassis\npoints:"
        for (i = 0; i < axles; ++i)
            for (side = 1; side >= -1; side -= 2) {
                point("hinge", i, side, 1.688965, 0.307086, 0.474)
                point("ball", i, side, 1.653405, 0.786511, 0.35589)
                point("spring_c", i, side, 1.792978, 0.509778, 0.671485)
                point("spring_a", i, side, 1.7861708, 0.543179, 0.427391)
                point("upper_c", i, side, 1.593883, 0.4527638, 0.7081177)
                point("upper_u", i, side, 1.6359298, 0.715518, 0.6894936)
                point("tierod_c", i, side, 1.438648, 0.448437, 0.528229)
                point("tierod_u", i, side, 1.5131462, 0.8211058, 0.4576678)
                point("centre", i, side, 1.648579, 0.909701, 0.447711)
            }
        print "bodies:"
        printf "  chassis: {mass: %g, position: [0, 0, 0.474], com: [%.7f, 0, 0.687], inertia: [%g, %g, %g]}\n", mass,
            middle, 0.5 * mass, mass * (0.2 + length2), mass * (0.5 + length2)
        for (i = 0; i < axles; ++i) {
            if (i < axles - 1)
                printf "  rack_%d: {mass: 9.072, com: [%.7f, 0, 0.528229], inertia: [1, 1, 1]}\n", i,
                    1.438648 - pitch * i
            for (side = 1; side >= -1; side -= 2) {
                printf "  lca_%s: {mass: 23.965, com: [%.7f, %.7f, 0.414945], inertia: [0.4469, 0.4469, 0.8938], " \
                    "orientation: {x: [1, 0, 0], z: [0, %.7f, 0.479425]}}\n", corner(i, side), 1.688965 - pitch * i,
                    side * 0.5468112, side * 0.11811
                printf "  wheel_%s: {mass: 90.555, com: [%.7f, %.7f, 0.447711], " \
                    "inertia: [4.8947505, 7.58122, 4.7728205]}\n", corner(i, side), 1.648579 - pitch * i,
                    side * 0.8756173
            }
        }
        print "joints:"
        for (i = 0; i < axles; ++i) {
            rack = i < axles - 1 ? "rack_" i : "chassis"
            if (i < axles - 1)
                printf "  guide_%d: {type: prismatic, bodies: [chassis, %s], axis: [0, 1, 0]}\n", i, rack
            for (side = 1; side >= -1; side -= 2) {
                c = corner(i, side)
                print "  arm_" c ": {type: revolute, bodies: [chassis, lca_" c "], point: hinge_" c ", axis: [1, 0, 0]}"
                print "  ball_" c ": {type: spherical, bodies: [lca_" c ", wheel_" c "], point: ball_" c "}"
                printf "  upper_%s: {type: revolute_spherical, bodies: [chassis, wheel_%s], points: [upper_c_%s, " \
                    "upper_u_%s], axis: [0.2202992, %.7f, 0.0490626]}\n", c, c, c, c, -side * 0.0317754
                print "  tierod_" c ": {type: distance, bodies: [" rack ", wheel_" c "], points: [tierod_c_" c \
                    ", tierod_u_" c "]}"
            }
        }
        print "coordinates:"
        for (i = 0; i < axles; ++i) {
            for (side = 1; side >= -1; side -= 2) {
                c = corner(i, side)
                print "  spring_" c ": {type: length, bodies: [chassis, lca_" c "], points: [spring_c_" c \
                    ", spring_a_" c "], range: [0.20, 0.29]}"
            }
            if (i < axles - 1)
                print "  rack_" i ": {type: translation, bodies: [chassis, rack_" i "], axis: [0, 1, 0]}"
        }
        print "forces:"
        for (i = 0; i < axles; ++i) {
            for (side = 1; side >= -1; side -= 2) {
                c = corner(i, side)
                print "  spring_" c ": {type: spring_damper, coordinate: spring_" c \
                    ", stiffness: 167070.9, damping: 17490.8, free: 0.31907}"
            }
            if (i < axles - 1)
                print "  rack_" i ": {type: spring_damper, coordinate: rack_" i ", stiffness: 100000, damping: 12000}"
        }
        print "wheels:"
        for (i = 0; i < axles; ++i)
            for (side = 1; side >= -1; side -= 2) {
                c = corner(i, side)
                print "  w" c ": {body: wheel_" c ", center: centre_" c \
                    ", radius: 0.4699, stiffness: 283000, damping: 500}"
            }
        print "outputs:\n  chassis: {type: position, body: chassis}"
    }'
