# SPDX-License-Identifier: MIT
"""Forces and moments of a PAC2002 tire, steady state, no turn slip.

Written from H. B. Pacejka, Tyre and Vehicle Dynamics, second edition (2006), section 4.3.2, whose equation numbers
stand beside the lines, and from the description of PAC2002 where that differs from the book: camber enters to the
first and second power (1 - p gamma^2) instead of 1 / (1 + p gamma^2), the cornering stiffness has the fixed factor 2
in front of its arctangent, loads of moments are related to the unscaled nominal load. Axes of ISO 8855: F_y < 0 for
alpha > 0. Shares nothing with the generator, not even the reader of the file.
"""
from math import atan, cos, exp, pi, sin, sqrt, tan, tanh

LENGTH = {"meter": 1.0, "mm": 1e-3, "cm": 1e-2, "inch": 0.0254}
FORCE = {"newton": 1.0, "kn": 1e3, "n": 1.0}
ANGLE = {"radians": 1.0, "radian": 1.0, "rad": 1.0, "degrees": pi / 180, "degree": pi / 180, "deg": pi / 180}
TIME = {"second": 1.0, "sec": 1.0, "millisecond": 1e-3}


class Tire:
    """Numbers of a property file, in SI units; `tire.PCX1` is 0 where the file has none."""

    def __init__(self, path):
        self.text, self.number = {}, {}
        with open(path, encoding="ascii") as file:
            for line in file:
                line = line.split("$")[0].split("!")[0].strip()
                if "=" not in line:
                    continue
                key, value = (part.strip() for part in line.split("=", 1))
                if value.startswith("'"):
                    self.text[key.upper()] = value.strip("'").lower()
                else:
                    self.number[key.upper()] = float(value)
        length, force = LENGTH[self.text["LENGTH"]], FORCE[self.text["FORCE"]]
        angle, time = ANGLE[self.text["ANGLE"]], TIME[self.text["TIME"]]
        unit = {"UNLOADED_RADIUS": length, "RIM_RADIUS": length, "BOTTOM_OFFST": length, "FNOMIN": force,
                "VERTICAL_STIFFNESS": force / length, "BOTTOM_STIFF": force / length,
                "VERTICAL_DAMPING": force * time / length, "FZMAX": force, "LONGVL": length / time,
                "VXLOW": length / time, "ALPMIN": angle, "ALPMAX": angle, "CAMMIN": angle, "CAMMAX": angle}
        for key, factor in unit.items():
            if key in self.number:
                self.number[key] *= factor
        self.mode = int(self.number.get("USE_MODE", 4)) % 10

    def __getattr__(self, name):
        if name.startswith("L") and name != "LONGVL":
            return self.number.get(name, 1.0)  # scaling factors
        ranges = {"KPUMIN": -1e30, "KPUMAX": 1e30, "ALPMIN": -1e30, "ALPMAX": 1e30, "CAMMIN": -1e30,
                  "CAMMAX": 1e30, "FZMAX": 1e30}
        return self.number.get(name, ranges.get(name, 0.0))


def sign(x):
    return (x > 0) - (x < 0)


def magic(B, C, E, x):
    """argument of the sine or cosine of a Magic Formula"""
    return C * atan(B * x - E * (B * x - atan(B * x)))


def vertical(p, rho):
    """load of a deflection at rest"""
    load = p.VERTICAL_STIFFNESS * p.LCZ * max(rho, 0.0)
    if p.BOTTOM_STIFF:
        load += p.BOTTOM_STIFF * max(rho - (p.UNLOADED_RADIUS - p.RIM_RADIUS - p.BOTTOM_OFFST), 0.0)
    return load


def forces(p, F_z, kappa, alpha, gamma, mu, V_x, spin):
    """(F_x, F_y, M_x, M_y, M_z) of the tire on its own side; mu: friction of the road, a factor of both peaks"""
    # beyond its data the tire is as at their end, and forces are proportional to the load
    F_zo = p.FNOMIN
    F_zos = p.LFZO * F_zo
    load = min(max(F_z, F_zos / 1000), max(p.FZMAX, F_zos / 1000))
    share, F_z = F_z / load, load
    kappa = min(max(kappa, p.KPUMIN), p.KPUMAX)
    alpha = min(max(alpha, p.ALPMIN), p.ALPMAX)
    gamma = min(max(gamma, p.CAMMIN), p.CAMMAX)
    lmux, lmuy = p.LMUX * mu, p.LMUY * mu
    R_o = p.UNLOADED_RADIUS
    df = (F_z - F_zos) / F_zos  # 4.E2

    # longitudinal force, pure slip
    S_Hx = (p.PHX1 + p.PHX2 * df) * p.LHX  # 4.E17
    kappa_x = kappa + S_Hx  # 4.E10
    gamma_x = gamma * p.LGAX
    C_x = p.PCX1 * p.LCX  # 4.E11
    mu_x = (p.PDX1 + p.PDX2 * df) * (1 - p.PDX3 * gamma_x**2) * lmux  # 4.E13
    D_x = mu_x * F_z  # 4.E12
    E_x = min((p.PEX1 + p.PEX2 * df + p.PEX3 * df**2) * (1 - p.PEX4 * sign(kappa_x)) * p.LEX, 1)  # 4.E14
    K_x = F_z * (p.PKX1 + p.PKX2 * df) * exp(p.PKX3 * df) * p.LKX  # 4.E15
    B_x = K_x / (C_x * D_x)  # 4.E16
    S_Vx = F_z * (p.PVX1 + p.PVX2 * df) * p.LVX * lmux  # 4.E18
    F_xo = D_x * sin(magic(B_x, C_x, E_x, kappa_x)) + S_Vx  # 4.E9

    # lateral force, pure slip
    gamma_y = gamma * p.LGAY
    K_y = (p.PKY1 * F_zo * sin(2 * atan(F_z / (p.PKY2 * F_zos))) * (1 - p.PKY3 * abs(gamma_y))
           * p.LFZO * p.LKY)  # 4.E25
    S_Vy = F_z * ((p.PVY1 + p.PVY2 * df) * p.LVY + (p.PVY3 + p.PVY4 * df) * gamma_y * p.LKG) * lmuy  # 4.E29
    S_Hy = (p.PHY1 + p.PHY2 * df) * p.LHY + p.PHY3 * gamma_y * p.LKG  # 4.E27
    alpha_y = alpha + S_Hy  # 4.E20
    C_y = p.PCY1 * p.LCY  # 4.E21
    mu_y = (p.PDY1 + p.PDY2 * df) * (1 - p.PDY3 * gamma_y**2) * lmuy  # 4.E23
    D_y = mu_y * F_z  # 4.E22
    E_y = min((p.PEY1 + p.PEY2 * df) * (1 - (p.PEY3 + p.PEY4 * gamma_y) * sign(alpha_y)) * p.LEY, 1)  # 4.E24
    B_y = K_y / (C_y * D_y)  # 4.E26
    F_yo = D_y * sin(magic(B_y, C_y, E_y, alpha_y)) + S_Vy  # 4.E19

    combined = p.mode == 4
    # combined slip: weighting functions
    G_x = G_y = 1.0
    S_Vyk = 0.0
    if combined:
        B_xa = p.RBX1 * cos(atan(p.RBX2 * kappa)) * p.LXAL  # 4.E54
        C_xa = p.RCX1
        E_xa = min(p.REX1 + p.REX2 * df, 1)  # 4.E56
        S_Hxa = p.RHX1
        G_x = cos(magic(B_xa, C_xa, E_xa, alpha + S_Hxa)) / cos(magic(B_xa, C_xa, E_xa, S_Hxa))  # 4.E51
        B_yk = p.RBY1 * cos(atan(p.RBY2 * (alpha - p.RBY3))) * p.LYKA  # 4.E62
        C_yk = p.RCY1
        E_yk = min(p.REY1 + p.REY2 * df, 1)  # 4.E64
        S_Hyk = p.RHY1 + p.RHY2 * df  # 4.E65
        G_y = cos(magic(B_yk, C_yk, E_yk, kappa + S_Hyk)) / cos(magic(B_yk, C_yk, E_yk, S_Hyk))  # 4.E59
        D_Vyk = mu_y * F_z * (p.RVY1 + p.RVY2 * df + p.RVY3 * gamma) * cos(atan(p.RVY4 * alpha))  # 4.E67
        S_Vyk = D_Vyk * sin(p.RVY5 * atan(p.RVY6 * kappa)) * p.LVYKA  # 4.E66
    F_x = G_x * F_xo  # 4.E50
    F_y = G_y * F_yo + S_Vyk  # 4.E58
    if p.mode in (0, 2):
        F_x = 0.0
    if p.mode in (0, 1):
        F_y = 0.0

    # overturning couple, rolling resistance
    M_x = R_o * F_z * (p.QSX1 * p.LVMX + (-p.QSX2 * gamma + p.QSX3 * F_y / F_zo) * p.LMX)  # 4.E69
    speed = V_x / p.LONGVL if p.LONGVL else 0.0
    M_y = -R_o * F_z * (p.QSY1 + p.QSY2 * F_x / F_zo + p.QSY3 * abs(speed) + p.QSY4 * speed**4) * p.LMY  # 4.E70
    M_y *= tanh(spin)  # no jump at standstill

    # aligning moment: trail and residual moment
    gamma_z = gamma * p.LGAZ
    S_Ht = p.QHZ1 + p.QHZ2 * df + (p.QHZ3 + p.QHZ4 * df) * gamma_z  # 4.E35
    S_Hf = S_Hy + S_Vy / K_y  # 4.E38
    alpha_t, alpha_r = alpha + S_Ht, alpha + S_Hf  # 4.E34, 4.E37
    B_t = ((p.QBZ1 + p.QBZ2 * df + p.QBZ3 * df**2) * (1 + p.QBZ4 * gamma_z + p.QBZ5 * abs(gamma_z))
           * p.LKY / lmuy)  # 4.E40
    C_t = p.QCZ1
    D_t = (F_z * (p.QDZ1 + p.QDZ2 * df) * (1 + p.QDZ3 * gamma_z + p.QDZ4 * gamma_z**2) * R_o / F_zo
           * p.LTR)  # 4.E43
    E_t = min((p.QEZ1 + p.QEZ2 * df + p.QEZ3 * df**2)
              * (1 + (p.QEZ4 + p.QEZ5 * gamma_z) * 2 / pi * atan(B_t * C_t * alpha_t)), 1)  # 4.E44
    B_r = p.QBZ9 * p.LKY / lmuy + p.QBZ10 * B_y * C_y  # 4.E45
    D_r = F_z * ((p.QDZ6 + p.QDZ7 * df) * p.LRES + (p.QDZ8 + p.QDZ9 * df) * gamma_z) * R_o * lmuy  # 4.E47
    if combined:  # 4.E77, 4.E78
        stretch = K_x / K_y * kappa
        alpha_t = atan(sqrt(tan(alpha_t)**2 + stretch**2)) * sign(alpha_t)
        alpha_r = atan(sqrt(tan(alpha_r)**2 + stretch**2)) * sign(alpha_r)
    t = D_t * cos(magic(B_t, C_t, E_t, alpha_t)) * cos(alpha)  # 4.E33, 4.E73
    M_zr = D_r * cos(atan(B_r * alpha_r)) * cos(alpha)  # 4.E36, 4.E75
    M_z = -t * (F_y - S_Vyk) + M_zr  # 4.E31, 4.E71
    if combined:
        arm = R_o * (p.SSZ1 + p.SSZ2 * F_y / F_zo + (p.SSZ3 + p.SSZ4 * df) * gamma) * p.LS  # 4.E76
        M_z += arm * F_x
    if p.mode in (0, 1):
        M_x = M_z = 0.0
    if p.mode == 2:
        M_y = 0.0
    return tuple(share * x for x in (F_x, F_y, M_x, M_y, M_z))
