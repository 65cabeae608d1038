# SPDX-License-Identifier: MIT
"""Forces and moments of the TMeasy tire, steady state, without camber and bore slip.

Written from G. Rill, Road Vehicle Dynamics, CRC Press 2011, chapter 3: characteristics by initial slope, maximum and
sliding (3.4), lateral force distribution by the dynamic tire offset (3.5.1), generalized slip (3.6), influence of load
and friction (3.7).
"""
from math import hypot, sqrt, tan, tanh


def quadratic(y, f):
    """a force at the load f F_N of its values at F_N and 2 F_N: no force without load"""
    return f * (2 * y[0] - y[1] / 2 - (y[0] - y[1] / 2) * f)


def linear(y, f):
    """a slip or an offset"""
    return y[0] + (y[1] - y[0]) * (f - 1)


def characteristic(s, slope, peak_slip, peak, slide_slip, slide):
    """force of a generalized slip s >= 0: a rational function up to the peak, then two parabolas or a cubic"""
    slope = max(slope, 2 * peak / peak_slip)  # else the peak would not be there
    if s >= slide_slip:
        return slide
    if s < peak_slip:
        sigma = s / peak_slip
        return slope * s / (1 + sigma * (sigma + slope * peak_slip / peak - 2))
    a = (peak / peak_slip)**2 / (slope * peak_slip)
    joint = peak_slip + (peak - slide) / (a * (slide_slip - peak_slip))
    if joint <= slide_slip:
        if s <= joint:
            return peak - a * (s - peak_slip)**2
        return slide + a * (joint - peak_slip) / (slide_slip - joint) * (slide_slip - s)**2
    sigma = (s - peak_slip) / (slide_slip - peak_slip)
    return peak - (peak - slide) * sigma**2 * (3 - 2 * sigma)


def offset(s, start, first, full):
    """dynamic tire offset relative to the contact length, at a lateral slip s >= 0"""
    w = first / full
    if s <= first:
        x = s / first
        return start * ((1 - w) * (1 - x) + w * (1 - (3 - 2 * x) * x**2))
    if s < full:
        return -start * (1 - w) * (s - first) / first * ((full - s) / (full - first))**2
    return 0.0


def vertical(p, rho):
    load = p["stiffness"] * max(rho, 0.0)
    if "rim_radius" in p:
        load += 5 * p["stiffness"] * max(rho - (p["radius"] - p["rim_radius"] - 0.01), 0.0)
    return load


def forces(p, F_z, kappa, alpha, rho, mu, spin):
    """(F_x, F_y, M_x, M_y, M_z); p: data as in the model file"""
    loaded = F_z
    F_z = min(F_z, 3.5 * p["load"])  # beyond it forces are proportional to the load
    f = max(F_z / p["load"], 0.001)  # as below it
    force = {key: quadratic(p[key], f) for key in ("dfx0", "fxm", "fxs", "dfy0", "fym", "fys")}
    slip = {key: linear(p[key], f) for key in ("sxm", "sxs", "sym", "sys", "trail", "sq0", "sqe")}
    q = mu / p.get("friction", 1.0)
    for key in ("fxm", "fxs", "fym", "fys"):
        force[key] *= q
    for key in ("sxm", "sxs", "sym", "sys"):
        slip[key] *= q
    # both directions made comparable
    slips, ratios = slip["sxm"] + slip["sym"], force["fxm"] / force["dfx0"] + force["fym"] / force["dfy0"]
    hat_x = slip["sxm"] / slips + force["fxm"] / force["dfx0"] / ratios
    hat_y = slip["sym"] / slips + force["fym"] / force["dfy0"] / ratios
    s_x, s_y = kappa / hat_x, -tan(alpha) / hat_y
    s = hypot(s_x, s_y)
    F_x = F_y = 0.0
    if s > 0:
        c, n = s_x / s, s_y / s
        F = characteristic(s, hypot(force["dfx0"] * hat_x * c, force["dfy0"] * hat_y * n),
                           hypot(slip["sxm"] / hat_x * c, slip["sym"] / hat_y * n),
                           hypot(force["fxm"] * c, force["fym"] * n),
                           hypot(slip["sxs"] / hat_x * c, slip["sys"] / hat_y * n),
                           hypot(force["fxs"] * c, force["fys"] * n))
        F_x, F_y = F * c, F * n
    share = loaded / (f * p["load"])
    F_x, F_y = share * F_x, share * F_y
    length = sqrt(8 * p["radius"] * max(rho, 0.0))  # of the contact patch
    M_z = -offset(abs(tan(alpha)), slip["trail"], slip["sq0"], slip["sqe"]) * length * F_y
    M_y = -p.get("rolling_resistance", 0.0) * p["radius"] * loaded * tanh(spin)
    return F_x, F_y, 0.0, M_y, M_z
