# SPDX-License-Identifier: MIT
"""short.py FILE...: find the coefficients of the short polynomials of gic_lanes.h by Remez' exchange in 50 digits, and look
for each of them in the FILEs. Prints the largest error of each polynomial; exit status 1 where one is not there."""
import re
import sys
from decimal import Decimal, getcontext

getcontext().prec = 50
TOLERANCE = 1e-4  # of a coefficient: extrema are looked for at 400 places alone, which moves them a little
ONE = Decimal(1)


def arc(t):
    """atan t, 0 <= t <= 1, from halved angles."""
    halved = 0
    while t > ONE / 20:
        t /= 1 + (1 + t * t).sqrt()
        halved += 1
    term, total, n, z = t, t, 1, t * t
    while abs(term) > Decimal(10) ** -60:
        term *= -z
        n += 2
        total += term / n
    return total * 2**halved


PI = 4 * arc(ONE)


def series(z, first, steps):
    """Sum of (-z)^i divided by the products of steps(i), from 1 / first on."""
    term = total = ONE / first
    i = 0
    while abs(term) > Decimal(10) ** -60:
        term *= -z / steps(i)
        total += term
        i += 1
    return total


# p of z = x^2 in atan x = x + x z p, sin x = x + x z p, cos x = 1 - z / 2 + z^2 p
def of_arc(z):
    x = z.sqrt()
    return (arc(x) / x - 1) / z


def of_sine(z):
    return -series(z, 6, lambda i: (2 * i + 4) * (2 * i + 5))


def of_cosine(z):
    return series(z, 24, lambda i: (2 * i + 5) * (2 * i + 6))


def solve(rows):
    """The solution of linear equations, rows with their right-hand sides, by elimination."""
    n = len(rows)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            share = rows[i][k] / rows[k][k]
            rows[i] = [a - share * b for a, b in zip(rows[i], rows[k])]
    x = [Decimal(0)] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def exchange(function, weight, high, terms):
    """Coefficients of least largest weight(z) |p(z) - function(z)| for 0 < z <= high, and that error."""
    looks = 400
    # Chebyshev's places, near enough to start from; near 0 the weight is nothing
    grid = [high * Decimal(i) / looks for i in range(1, looks + 1)]
    exact = [function(z) for z in grid]
    at = [round((looks - 1) * (1 - float(i) / terms) ** 2) for i in range(terms, -1, -1)]
    for _ in range(12):
        rows = [
            [grid[i] ** k for k in range(terms)] + [(-1) ** n / weight(grid[i]), exact[i]]
            for n, i in enumerate(at)
        ]
        c = solve(rows)[:terms]
        error = [weight(z) * (sum(a * z**k for k, a in enumerate(c)) - f) for z, f in zip(grid, exact)]
        extrema, run = [], [0]
        for i in range(1, looks + 1):
            if i < looks and error[i] * error[run[-1]] > 0:
                run.append(i)
                continue
            extrema.append(max(run, key=lambda j: abs(error[j])))
            run = [i]
        if len(extrema) != terms + 1 or extrema == at:
            break
        at = extrema
    return c, max(map(abs, error))


def main():
    numbers = []
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            numbers.append([float(word) for word in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", file.read())])
    missing = 0
    for name, function, weight, high, terms in (
        ("arc tangent up to 1", of_arc, lambda z: z * z.sqrt(), ONE, 9),
        ("sine up to a quarter turn", of_sine, lambda z: z * z.sqrt(), (PI / 2) ** 2, 5),
        ("sine up to an eighth", of_sine, lambda z: z * z.sqrt(), (PI / 4) ** 2, 4),
        ("cosine up to an eighth", of_cosine, lambda z: z * z, (PI / 4) ** 2, 3),
    ):
        c, error = exchange(function, weight, high, terms)
        print(f"{name}: {terms} terms, error {float(error):.2e}: {', '.join(repr(float(a)) for a in c)}")
        for path, known in zip(sys.argv[1:], numbers):
            for a in c:
                if not any(abs(k - float(a)) <= TOLERANCE * abs(float(a)) for k in known):
                    print(f"FAIL {path} has no {float(a)!r}")
                    missing += 1
    return missing > 0


sys.exit(main())
