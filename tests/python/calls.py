#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""calls.py: the Python package by unittest, from the folder of the sources: results are those of gicrun, views are
the instance's memory, wrong calls raise exceptions that say what was expected, environments keep Gymnasium's rules."""
import copy
import csv
import gc
import math
import os
import pickle
import tempfile
import threading
import unittest

import numpy

import gicgen
from gicgen.env import VectorEnv

QUARTER, SCENE = "models/quarter_car.veh", "models/scenes/quarter_car.scene"
TIRES, COAST = "models/hmmwv_tires.veh", "models/scenes/tires_coast.scene"


def check_env(make):
    """The rules of a vector environment; make() makes one, always the same."""
    env = make()
    n = env.num_envs
    try:
        env.step(env.action_space.sample())
        raise AssertionError("a step before reset()")
    except RuntimeError:
        pass

    def trace(env, seed):
        env.action_space.seed(7)
        seen, info = env.reset(seed=seed)
        assert isinstance(info, dict) and seen.shape == env.observation_space.shape
        out, ended = [seen], 0
        for _ in range(25):
            action = env.action_space.sample()
            assert env.action_space.contains(action)
            seen, reward, terminated, truncated, info = env.step(action)
            assert env.observation_space.contains(seen) and seen.dtype == env.observation_space.dtype
            assert numpy.isfinite(seen).all() and numpy.isfinite(reward).all()
            assert reward.shape == terminated.shape == truncated.shape == (n,)
            assert terminated.dtype == truncated.dtype == bool and not (terminated & truncated).any()
            done = terminated | truncated
            assert ("final_obs" in info) == bool(done.any())
            if done.any():
                assert numpy.array_equal(info["_final_obs"], done)
                assert not numpy.array_equal(info["final_obs"][done], seen[done]), "no new episode"
                assert numpy.array_equal(info["final_obs"][~done], seen[~done])
            ended += done.sum()
            out.append(numpy.column_stack([seen, reward, terminated, truncated]))
        assert ended > 0, "no episode ended"
        return out

    def same(a, b):
        return all(numpy.array_equal(x, y) for x, y in zip(a, b))

    first = trace(env, 3)
    assert same(first, trace(env, 3)), "the same seed, another course"
    assert same(first, trace(make(), 3)), "the same seed in another environment, another course"
    assert not same(first, trace(env, 4)), "another seed, the same course"
    assert not same([first[0][:1]], [first[0][1:2]]), "vehicles begin alike"
    for bad in (numpy.zeros((n + 1, 1)), numpy.full(env.action_space.shape, math.nan)):
        try:
            env.step(bad)
            raise AssertionError("a wrong action")
        except ValueError as error:
            assert "wanted" in str(error)
    env.close()


class Calls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = gicgen.Model(QUARTER)

    def car(self):
        return self.model.instance(SCENE)

    def test_run_is_a_run_step_by_step(self):
        columns, car = gicgen.Model(QUARTER, general=True).run(SCENE), self.car()
        self.assertEqual(columns.units["carriage.z"], "m")
        for row, time in enumerate(columns["time"]):
            self.assertEqual(car.time, time)
            for name in ("carriage.z", "wheel.x", "tire.fz"):
                self.assertEqual(car.outputs[name], columns[name][row])
            car.step(0.002, 5, "rk4")

    def test_views(self):
        car = self.car()
        array = car.states.array
        self.assertEqual(car.states["bounce"], 0.05)
        car.states["bounce"] = 0.04
        self.assertEqual(array[0], 0.04)
        array[0] = 0.03
        self.assertEqual(car.states["bounce"], 0.03)
        self.assertEqual(list(car.states[["bounce", "spring"]]), [0.03, 0.26])
        car.close()
        gc.collect()
        self.assertEqual(array[0], 0.03)
        with self.assertRaisesRegex(gicgen.WrongCall, "closed"):
            car.step(0.001)
        model = gicgen.Model(QUARTER)
        other = model.instance()
        model.close()
        other.step(0.001, 3)
        with self.assertRaisesRegex(gicgen.WrongCall, "closed"):
            model.instance()
        table = gicgen.Model(QUARTER).run(SCENE)["carriage.z"]
        gc.collect()
        self.assertTrue(numpy.isfinite(table).all())
        with self.assertRaises(ValueError):
            table[0] = 1

    def test_integrator_of_ones_own(self):
        """car.rhs with the arguments of scipy's solve_ivp: RK4 by hand has the runtime's motion to rounding."""
        car, other = self.car(), self.car()
        y, h = car.states[:].copy(), 0.002
        for i in range(50):
            t = i * h
            a = other.rhs(t, y)
            b = other.rhs(t + h / 2, y + h / 2 * a)
            c = other.rhs(t + h / 2, y + h / 2 * b)
            d = other.rhs(t + h, y + h * c)
            y = y + h / 6 * (a + 2 * b + 2 * c + d)
        car.step(h, 50, "rk4")
        numpy.testing.assert_allclose(y, car.states[:], rtol=1e-11)

    def test_scipy(self):
        """Where SciPy is: its integrators, equations and least squares work on a vehicle as it is."""
        try:
            from scipy.integrate import solve_ivp
            from scipy.optimize import least_squares, root
        except ImportError:
            return
        car, other = self.car(), self.car()
        car.step(2e-5, 5000, "rk4")
        for method in ("RK45", "DOP853", "Radau", "BDF", "LSODA"):
            found = solve_ivp(other.rhs, (0, 0.1), self.car().states[:], method=method, rtol=1e-9, atol=1e-11)
            self.assertTrue(found.success)
            numpy.testing.assert_allclose(found.y[:, -1], car.states[:], atol=2e-6, err_msg=method)
        rest = root(lambda x: other.rhs(0, x), self.model.instance().states[:], tol=1e-12)
        self.assertTrue(rest.success)
        numpy.testing.assert_allclose(rest.x, self.model.equilibrium().states[:], atol=1e-9)
        with open(QUARTER) as file:
            text = file.read().replace("stiffness: 167070.9, damping: 17490.8", "stiffness: k, damping: c")
        text += "parameters:\n  k: {value: 150000, unit: N/m, tunable: true}\n"
        text += "  c: {value: 15000, unit: N s/m, tunable: true}\n"
        car = gicgen.Model(text=text, name=QUARTER).instance(SCENE)

        def motion(p):
            car.set_up(1e5 * p)
            heights = []
            for _ in range(40):
                car.step(0.002, 5, "rk4")
                heights.append(car.states["bounce"])
            return numpy.array(heights)

        true = numpy.array([1.670709, 0.174908])
        measured = motion(true)
        found = least_squares(lambda p: motion(p) - measured, [1.5, 0.15], xtol=1e-14, ftol=1e-14, gtol=1e-14)
        numpy.testing.assert_allclose(found.x, true, rtol=1e-6)

    def test_files_with_mistakes(self):
        with self.assertRaises(gicgen.Error) as caught:
            gicgen.Model("tests/data/mistakes/body_key_unknown.veh")
        error = caught.exception
        self.assertEqual((error.file, error.line, error.column), ("tests/data/mistakes/body_key_unknown.veh", 9, 9))
        self.assertIn("mass", error.remedy)
        with self.assertRaises(gicgen.Error) as caught:
            gicgen.Model(text="gicgen: 1\nmodel: a b\n", name="mine.veh")
        self.assertEqual(caught.exception.file, "mine.veh")
        with self.assertRaisesRegex(gicgen.Error, "No such file"):
            self.model.run("no.scene")
        with self.assertRaisesRegex(gicgen.Error, "a scene is wanted"):
            self.model.run(QUARTER)
        with self.assertRaisesRegex(gicgen.Error, "engine"):
            gicgen.Model(QUARTER, engine="fortran")

    def test_wrong_calls(self):
        car, batch = self.car(), self.model.batch(3, SCENE)
        for call, kind, words in (
                (lambda: car.states["bonce"], KeyError, "is 'bounce' meant"),
                (lambda: car.inputs["x"], KeyError, "there is none"),
                (lambda: self.model.run(SCENE)["carriage.zz"], KeyError, "is 'carriage.z' meant"),
                (lambda: car.states.__setitem__("bounce", math.nan), ValueError, "finite"),
                (lambda: car.states.__setitem__("bounce", "high"), TypeError, "number"),
                (lambda: car.states.__setitem__(slice(None), [1, 2]), ValueError, r"shape \(4,\) is wanted, not \(2,\)"),
                (lambda: car.rhs(0, [1, 2, 3]), ValueError, r"shape \(4,\) is wanted, not \(3,\)"),
                (lambda: car.rhs(0, [1, 2, 3, math.inf]), ValueError, "finite"),
                (lambda: car.step(math.nan), ValueError, "step: a finite number"),
                (lambda: car.step(0.001, -1), ValueError, "steps: a whole number from 0"),
                (lambda: car.step(0.001, 2**64 + 1), ValueError, "steps: a whole number from 0"),
                (lambda: car.step(0.001, 1.5), TypeError, "steps: a whole number is wanted, not 1.5"),
                (lambda: car.step(0.001, ratio=2**32 + 1), ValueError, "ratio: a whole number from 1"),
                (lambda: batch.step(0.001, 2**64), ValueError, "steps: a whole number from 0"),
                (lambda: batch.step(0.001, ratio=0), ValueError, "ratio: a whole number from 1"),
                (lambda: copy.deepcopy(car), TypeError, "can not be copied"),
                (lambda: pickle.dumps(self.model), TypeError, "can not be copied"),
                (lambda: self.model.batch(2**32 + 2), ValueError, "vehicles: a whole number from 1 to 16777216"),
                (lambda: self.model.linearize(SCENE, at=-1), gicgen.WrongCall, "at least 0"),
                (lambda: car.step(0.001, method="euler"), ValueError, "'ab3' or 'rk4'"),
                (lambda: car.step(-1), ValueError, "step: a number above 0 is wanted, not -1"),
                (lambda: batch.step(0), ValueError, "step: a number above 0 is wanted, not 0"),
                (lambda: car.step(0.001, ratio=10001), ValueError, "ratio: a whole number from 1 to 10000"),
                (lambda: batch.step(0.001, method="rk4", ratio=2), ValueError, "ratio: 1 is wanted with method 'rk4', not 2"),
                (lambda: gicgen.Model(QUARTER + "\0.nonsense"), ValueError, "without NUL"),
                (lambda: self.model.run(SCENE + "\0"), ValueError, "without NUL"),
                (lambda: car.outputs.__setitem__(0, 99), ValueError, "outputs are computed: they can not be set"),
                (lambda: batch.outputs.__setitem__("tire.fz", 1), ValueError, "outputs are computed"),
                (lambda: car.outputs.array.__setitem__(0, 99), ValueError, "read-only"),
                (lambda: car.restart(math.inf), ValueError, "time: a finite number"),
                (lambda: car.set_up([1.0]), ValueError, r"shape \(0,\)"),
                (lambda: car.set_up({"k": 1}), KeyError, "no parameter 'k'"),
                (lambda: car.restore(b"123"), gicgen.WrongCall, "bytes"),
                (lambda: batch.states.__setitem__("bounce", [1, 2]), ValueError, r"shape \(3,\) is wanted, not \(2,\)"),
                (lambda: batch.reset([1, 0]), ValueError, r"shape \(3,\)"),
                (lambda: self.model.batch(0), ValueError, "whole number from 1"),
                (lambda: self.model.linearize(at=1), TypeError, "scene"),
                (lambda: self.model.units("wheels"), KeyError, "there are states"),
                (lambda: gicgen.Model(), TypeError, "path or a text")):
            with self.assertRaisesRegex(kind, words):
                call()

    def test_messages_of_one_call(self):
        """What an earlier call said is not said again."""
        for call, words in (
                (lambda: self.model.linearize(SCENE, -1), "libgic: error: the time must be finite and at least 0"),
                (lambda: self.model.batch(4, lanes=3), "libgic: error: lanes are 1, 2, 4, 8 or 16, not 3"),
                (lambda: self.model.run(None), "libgic: error: the scene must not be NULL"),
                (lambda: self.model.write("no"), "libgic: error: there is no study 'no'"),
                (lambda: self.car().restore(b""), "libgic: error: a snapshot of this model has"),
                (lambda: gicgen.Model("-"), "libgic: error: the model must be a file")):
            for _ in range(2):
                with self.assertRaises(gicgen.Error):
                    self.model.write("modes", results="/nonexistent/x")
                with self.assertRaises(gicgen.WrongCall) as caught:
                    call()
                self.assertTrue(str(caught.exception).startswith(words), str(caught.exception))
                self.assertEqual(str(caught.exception).count("error: "), 1)

    def test_run_that_ends_early(self):
        with open("build_long.scene", "w") as file:
            file.write("gicscene: 1\nduration: 5\nstep: 0.2\n")
        with self.assertRaises(gicgen.RunError) as caught:
            self.model.run("build_long.scene")
        self.assertGreater(len(caught.exception.columns), 0)
        self.assertIn("the run ends at", str(caught.exception))

    def test_batch(self):
        batch = self.model.batch(4, SCENE)
        self.assertEqual(batch.states.array.shape, (4, 4))
        batch.states["bounce"] = [0.05, 0.04, 0.03, 0.02]
        batch.step(0.001, 100, "rk4")
        for v in range(4):
            car = self.car()
            car.states["bounce"] = [0.05, 0.04, 0.03, 0.02][v]
            car.step(0.001, 100, "rk4")
            self.assertTrue(numpy.array_equal(batch.states[v], car.states[:]))
        self.assertEqual(batch.outputs["tire.fz"].shape, (4,))
        batch.states.array[1, 0] = math.nan
        with self.assertRaisesRegex(gicgen.RunError, "vehicle 1"):
            batch.step(0.001)
        batch.step(0.001, check=False)
        self.assertEqual(list(batch.status != 0), [False, True, False, False])
        batch.reset([0, 0, 1, 0])
        self.assertEqual(list(batch.status != 0), [False, True, False, False])
        batch.reset([0, 1, 0, 0])
        self.assertEqual(list(batch.status), [0, 0, 0, 0])
        batch.step(0.001)
        self.assertEqual(batch.states[1, 0] != batch.states[0, 0], True)

    def test_batch_of_couplers(self):
        """Vehicles with a gear that follows by a formula, side by side and in lanes, have the bits that each has alone. A wheel
        of 0.2 kg m^2 turns another one of 0.05 kg m^2 by its angle and a twentieth of its square; a torque of 0.8 N m."""
        text = """gicgen: 1
model: gears
base: ground
bodies:
  one: {mass: 2, com: [0, 0, 0], inertia: [0.1, 0.1, 0.2]}
  two: {mass: 3, com: [1, 0, 0], inertia: [0.1, 0.1, 0.05]}
joints:
  a: {type: revolute, bodies: [ground, one], point: [0, 0, 0], axis: [0, 0, 1]}
  b: {type: revolute, bodies: [ground, two], point: [1, 0, 0], axis: [0, 0, 1]}
  teeth: {type: gear, bodies: [ground, two], axis: [0, 0, 1], value: "turn + 0.05 * turn^2"}
coordinates: {turn: {type: angle, bodies: [ground, one], axis: [0, 0, 1], range: [-14, 14]}}
forces: {push: {type: force, coordinate: turn, value: 0.8}}
outputs: {turn: {type: coordinate, coordinate: turn}}
"""
        start = [0, 0.5, -1, 1, 0.3, 2, -0.5]
        model = gicgen.Model(text=text)
        for lanes in (1, 2, 4):
            batch = model.batch(len(start), lanes=lanes)
            batch.states["turn"] = start
            batch.step(0.001, 500, "rk4")
            for v, turn in enumerate(start):
                car = model.instance()
                car.states["turn"] = turn
                car.step(0.001, 500, "rk4")
                self.assertTrue(numpy.array_equal(batch.states[v], car.states[:]))
                # energy: the torque's work
                ratio = 1 + 0.1 * car.states["turn"]
                energy = (0.2 + 0.05 * ratio**2) * car.states["turn.rate"] ** 2 / 2
                self.assertAlmostEqual(energy, 0.8 * (car.states["turn"] - turn), delta=1e-10)

    def test_lanes(self):
        """Vehicles in lanes: names, places, bits of those one after another, which are gicrun's."""
        batches = [self.model.batch(7, SCENE, lanes=lanes) for lanes in (1, 2, 4)]
        for lanes, batch in zip((1, 2, 4), batches):
            if lanes > 1:
                self.assertEqual(batch.states.array.shape, (-(-7 // lanes), lanes, 4))
            self.assertEqual(batch.states["bounce"].shape, (7,))
            self.assertEqual(numpy.asarray(batch.states).shape, (7, 4))
            batch.states["bounce"] = 0.05 - 0.003 * numpy.arange(7)
            batch.states[1:3, 2] = 0.01
            batch.step(0.001, 100, "rk4")
            batch.step(0.001, 50)
            batch.reset([0, 0, 1, 0, 0, 0, 1])
            batch.step(0.001, 50, check=False)
            self.assertTrue((batch.status == 0).all())
        for batch in batches[1:]:
            for kind in ("states", "outputs", "inputs", "parameters", "rates"):
                mine, theirs = getattr(batch, kind), getattr(batches[0], kind)
                if kind != "rates":
                    self.assertTrue(numpy.array_equal(mine[:], theirs[:]), kind)
                self.assertEqual(mine[:].shape, theirs[:].shape)
            self.assertEqual(batch.states[3, 1], batches[0].states[3, 1])
            two = ["bounce", "spring"]
            self.assertTrue(numpy.array_equal(batch.states[two], batches[0].states[two]))
        columns, batch = gicgen.Model(QUARTER, general=True).run(SCENE), self.model.batch(5, SCENE, lanes=4)
        for row in range(40):
            self.assertTrue((batch.outputs["carriage.z"] == columns["carriage.z"][row]).all())
            batch.step(0.002, 5, "rk4")
        batch.states[4, 0] = 1e9
        with self.assertRaisesRegex(gicgen.RunError, "vehicle 4"):
            batch.step(0.001)
        for call, kind, words in (
                (lambda: self.model.batch(3, lanes=3), gicgen.WrongCall, "lanes are 1, 2, 4, 8 or 16, not 3"),
                (lambda: self.model.batch(3, lanes=0), ValueError, "lanes: a whole number from 1 to 16"),
                (lambda: batch.outputs.__setitem__(slice(None), 0), ValueError, "outputs are computed"),
                (lambda: batch.states["bonce"], KeyError, "is 'bounce' meant"),
                (lambda: batch.states.__setitem__("bounce", [1, 2]), ValueError, r"shape \(5,\) is wanted, not \(2,\)"),
                (lambda: batch.states.__setitem__("bounce", math.nan), ValueError, "finite")):
            with self.assertRaisesRegex(kind, words):
                call()

    def test_lanes_of_tires(self):
        """With tires, whose functions are libm's in lanes too."""
        model = gicgen.Model(TIRES)
        alone, lanes = model.batch(2, COAST), model.batch(2, COAST, lanes=2)
        for batch in (alone, lanes):
            batch.states["omega.z"] = [0.1, -0.02]
            batch.step(0.001, 2, "rk4")
            batch.step(0.004, 50, ratio=4)
        self.assertTrue(numpy.array_equal(alone.states[:], lanes.states[:]))
        self.assertTrue(numpy.array_equal(alone.outputs[:], lanes.outputs[:]))

    def test_implicit_ratio(self):
        """Fast steps within implicit ones, one vehicle and a batch alike; not in lanes."""
        model = gicgen.Model(TIRES, integrator="ros2")
        car, batch, lanes = model.instance(COAST), model.batch(2, COAST), model.batch(2, COAST, lanes=2)
        one = model.instance(COAST)
        one.step(0.004, 50, "ros2")
        car.step(0.004, 50, "ros2", ratio=4)
        batch.step(0.004, 50, "ros2", ratio=4)
        for vehicle in range(2):
            self.assertTrue(numpy.array_equal(car.states[:], batch.states[:][vehicle]))
        self.assertFalse(numpy.array_equal(car.states[:], one.states[:]))
        short = model.instance(COAST)
        short.step(0.0002, 1000, "rk4")
        self.assertLess(numpy.abs(car.states[:] - short.states[:]).max(), 1e-4)  # order 2 at 4 ms of motions of some 10 rad/s
        with self.assertRaisesRegex(gicgen.WrongCall, "fast steps with ab3 alone"):
            lanes.step(0.004, 1, "ros2", ratio=4)

    def test_stiff_states_alone(self):
        """`implicit: stiff` of a scene: an instance that is made for it has run()'s digits, which are others without."""
        model = gicgen.Model(TIRES, integrator="imex")
        ends = {}
        with tempfile.TemporaryDirectory() as folder:
            for which in ("stiff", "all"):
                path = os.path.join(folder, which + ".scene")
                with open(path, "w", encoding="utf-8") as file:
                    file.write("gicscene: 1\nduration: 0.4\nstep: 0.004\noutput_step: 0.4\nintegrator: imex\n"
                               f"implicit: {which}\ninitial: {{velocity: [10, 0, 0]}}\n")
                rows, car = model.run(path), model.instance(path)
                car.step(0.004, 100, "imex")
                ends[which] = [car.outputs[name] for name in ("chassis.x", "chassis.z")]
                self.assertEqual(ends[which], [rows[name][-1] for name in ("chassis.x", "chassis.z")])
        self.assertNotEqual(ends["stiff"], ends["all"])
        self.assertLess(abs(ends["stiff"][1] - ends["all"][1]), 1e-4)  # both are of order 2 at 4 ms

    def test_linear(self):
        linear, modes = self.model.linearize(), self.model.modes()
        self.assertEqual(linear.A.shape, (4, 4))
        self.assertEqual(len(linear.states), 4)
        self.assertEqual(linear.C.shape, (len(linear.outputs), 4))
        poles = numpy.sort(numpy.linalg.eigvals(linear.A).real)
        numpy.testing.assert_allclose(numpy.unique(poles.round(6)), numpy.sort(modes["real"]).round(6))
        rest = self.model.equilibrium()
        numpy.testing.assert_allclose(self.model.instance().rhs(0, rest.states[:]), 0, atol=1e-8)

    def test_write(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "run.csv")
            self.assertEqual(self.model.write("run", SCENE, results=path), "")
            with open(path, encoding="ascii") as file:
                rows = list(csv.reader(file))
            columns = self.model.run(SCENE)
            self.assertEqual([name.split(" [")[0] for name in rows[0]], list(columns))
            self.assertEqual([float(row[1]) for row in rows[1:]], list(columns[list(columns)[1]]))
            table = self.model.write("modes", results=os.path.join(folder, "modes.csv"))
            self.assertIn("eigenvalue [1/s]", table)
            self.assertEqual(sorted(os.listdir(folder)), ["modes.csv", "run.csv"])
            text = gicgen.Model(TIRES).write("kc", axle="front", travel=0.02)
            self.assertTrue(text.startswith("kinematics of hmmwv_tires"))
            self.model.write("linearize", SCENE, at=0.1, results=os.path.join(folder, "a.npz"))
            with numpy.load(os.path.join(folder, "a.npz")) as arrays:
                self.assertTrue(numpy.array_equal(arrays["A"], self.model.linearize(SCENE, 0.1).A))
            with self.assertRaisesRegex(gicgen.WrongCall, "no study 'mode'"):
                self.model.write("mode")
            with self.assertRaisesRegex(gicgen.WrongCall, "modes takes no 'axle'"):
                self.model.write("modes", axle="front")
            with self.assertRaisesRegex(gicgen.WrongCall, "one of steady-speed"):
                self.model.write("manoeuvre", manoeuvre="steady", keys={"speed": 3})
            with self.assertRaisesRegex(gicgen.Error, "can't"):
                self.model.write("modes", results=os.path.join(folder, "no", "modes.csv"))

    def test_sweep(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sweep.csv")
            table = self.model.sweep(SCENE, {"bounce": (0.01, 0.05, 3)}, path, alone=True)
            self.assertEqual(list(table["bounce"]), [0.01, 0.03, 0.05])
            self.assertEqual(list(table["status"]), [0, 0, 0])
            self.assertEqual(table["carriage.z.end"][2], self.model.run(SCENE)["carriage.z"][-1])
            with open(path, encoding="ascii") as file:
                rows = list(csv.reader(file))[1:]
            self.assertEqual([[float(x) for x in row] for row in rows], [list(row) for row in zip(*(table[name] for name in table))])
            self.assertEqual(os.listdir(folder), ["sweep.csv"])
            some = self.model.sweep(SCENE, {"bounce": (0.01, 0.05)}, path, latin=4, seed=3, alone=True)
            self.assertEqual(sorted((some["bounce"] - 0.01) // 0.01), [0, 1, 2, 3])
            with self.assertRaisesRegex(gicgen.Error, "nothing that can be varied is called 'bouce'"):
                self.model.sweep(SCENE, {"bouce": (0, 1, 2)}, path)
            with self.assertRaisesRegex(gicgen.WrongCall, "needs a count"):
                self.model.sweep(SCENE, {"bounce": (0, 1)}, path, alone=True)
            with self.assertRaises(ValueError):
                self.model.sweep(SCENE, {"bounce": (0, math.nan, 2)}, path)

    def test_threads(self):
        def work(out):
            model = gicgen.Model(QUARTER)
            out.append(model.run(SCENE)["carriage.z"].sum())
            for _ in range(5):
                try:
                    gicgen.Model("no.veh")
                except gicgen.Error as error:
                    assert error.file == "no.veh"
                else:
                    raise AssertionError
        out = []
        threads = [threading.Thread(target=work, args=(out,)) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(out), 8)
        self.assertEqual(len(set(out)), 1)

    def test_env(self):
        model = gicgen.Model(TIRES)
        check_env(lambda: VectorEnv(
            model, 3, scene=COAST, actions={"rack": (-0.02, 0.02)}, observations=["chassis.y", "chassis_attitude.yaw"],
            reward=lambda seen, action: -seen[:, 0] ** 2, terminated=lambda seen, action: abs(seen[:, 0]) > 0.8,
            step=0.004, ratio=4, substeps=5, horizon=10, scatter={"r.y": 0.5}))

    def test_env_refuses(self):
        model, made = gicgen.Model(TIRES), {"actions": {"rack": (-0.02, 0.02)}, "observations": ["chassis.y"],
                                            "reward": lambda seen, action: -seen[:, 0] ** 2, "scene": COAST}

        def env(**changes):
            return VectorEnv(model, 2, **{**made, **changes})

        zeros = numpy.zeros((2, 1))
        for call, kind, words in (
                (lambda: env(actions={"rak": (0, 1)}), KeyError, "is 'rack' meant"),
                (lambda: env(actions=["rack"]), TypeError, "actions: a dictionary is wanted"),
                (lambda: env(actions={"rack": 1}), TypeError, r"'rack': a pair of bounds \(low, high\) is wanted"),
                (lambda: env(actions={"rack": (1, 0)}), ValueError, "action 'rack': a least and a greatest number"),
                (lambda: env(actions={"rack": (0, math.nan)}), ValueError, "'rack': a least and a greatest number"),
                (lambda: env(actions={"rack": ("a", "b")}), ValueError, "action 'rack': numbers"),
                (lambda: env(observations="chassis.y"), TypeError, "observations: a list of names"),
                (lambda: env(observations=["chassis.yy"]), KeyError, "is 'chassis.y' meant"),
                (lambda: env(reward=None), TypeError, "reward: a function"),
                (lambda: env(terminated=1), TypeError, "terminated: a function"),
                (lambda: env(step=0), ValueError, "step: a number above 0"),
                (lambda: env(step=math.nan), ValueError, "step: a finite number"),
                (lambda: env(substeps=0), ValueError, "substeps: a whole number from 1"),
                (lambda: env(horizon=1.5), TypeError, "horizon: a whole number is wanted, not 1.5"),
                (lambda: env(method="euler"), ValueError, "'ab3' or 'rk4'"),
                (lambda: env(ratio=0), ValueError, "ratio: a whole number from 1"),
                (lambda: env(method="ros3"), gicgen.WrongCall, "its code has no implicit steps"),
                (lambda: env(scatter={"r.y": -1}), ValueError, "scatter of 'r.y': half a width"),
                (lambda: env(scatter={"r.yy": 1}), KeyError, "no state 'r.yy'"),
                (lambda: env(scatter=[1]), TypeError, "scatter: a dictionary"),
                (lambda: env().reset(seed=-1), ValueError, "seed: a whole number from 0"),
                (lambda: env().reset(seed=1.5), TypeError, "seed: a whole number is wanted, not 1.5"),
                (lambda: env().reset(seed=[1, 2, 3]), ValueError, "seed: a number or 2 of them"),
                (lambda: env().reset(seed=[1, -2]), ValueError, "seed: a whole number from 0"),
                (lambda: env().reset(seed="ab"), TypeError, "seed: a whole number is wanted, not 'ab'"),
                (lambda: env().reset(options={"reset_mask": [1, 0]}), ValueError, "options: this one has none")):
            with self.assertRaisesRegex(kind, words):
                call()
        self.assertEqual(env().reset(seed=numpy.int64(3))[0].shape, (2, 1))
        again = [env(scatter={"r.y": 1.0}).reset(seed=[5, 6])[0] for _ in range(2)]
        self.assertTrue(numpy.array_equal(*again) and again[0][0] != again[0][1])
        for reward, words in ((lambda seen, action: seen, r"reward gives: shape \(2,\) is wanted, not \(2, 1\)"),
                              (lambda seen, action: seen[:, 0] * math.nan, "reward gives: finite"),
                              (lambda seen, action: ["a", "b"], "reward gives: numbers")):
            wrong = env(reward=reward)
            wrong.reset(seed=1)
            with self.assertRaisesRegex((ValueError, TypeError), words):
                wrong.step(zeros)
        wrong = env()
        wrong.reset(seed=1)
        with self.assertRaisesRegex(TypeError, "actions: an array of numbers"):
            wrong.step([["a"], ["b"]])

    def test_env_start_refused(self):
        """No observation of a vehicle whose start the model refuses: the library's message, at reset() and when an
        episode begins anew; reset() mends it."""
        model = gicgen.Model(QUARTER)
        env = VectorEnv(model, 3, scene=SCENE, actions={}, observations=["carriage.z"], step=0.001, horizon=2,
                        reward=lambda seen, action: seen[:, 0], scatter={"bounce": 0.001})
        env.reset(seed=1)
        env._scatter[0] = (env._scatter[0][0], 1e308)
        with self.assertRaisesRegex(gicgen.RunError, "^libgic: error: vehicle [0-2] at t = 0 s: "):
            env.reset(seed=1)
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(numpy.zeros((3, 0)))
        env._scatter[0] = (env._scatter[0][0], 0.001)
        first, _ = env.reset(seed=1)
        self.assertTrue((first != 0).all())
        env._scatter[0] = (env._scatter[0][0], 1e308)
        env.step(numpy.zeros((3, 0)))
        with self.assertRaisesRegex(gicgen.RunError, "vehicle [0-2] at t = 0 s: "):
            env.step(numpy.zeros((3, 0)))
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(numpy.zeros((3, 0)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
