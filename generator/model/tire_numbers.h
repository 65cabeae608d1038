/* SPDX-License-Identifier: MIT
 * Numbers of tires, in the order of the arrays that hold them: models/TIRES.md sections 5 and 6. */
#ifndef MODEL_TIRE_NUMBERS_H
#define MODEL_TIRE_NUMBERS_H

/* clang-format off */
#define PAC_UNLIMITED 1e30 /* an absent limit of a range; it fits in a float */

/* X(name): coefficients of the Magic Formula and other numbers of a `.tir` file that a tire uses. FNOMIN and limits of
 * loads in N. */
#define PAC_LIST(X) \
    X(FNOMIN) \
    X(DREFF) X(BREFF) X(FREFF) X(LONGVL) X(KPUMIN) X(KPUMAX) X(ALPMIN) X(ALPMAX) X(CAMMIN) X(CAMMAX) X(FZMAX) X(LFZO) \
        X(LCX) X(LMUX) X(LEX) X(LKX) X(LHX) X(LVX) X(LGAX) X(LCY) X(LMUY) X(LEY) X(LKY) X(LHY) X(LVY) X(LGAY) X(LKG) \
            X(LTR) X(LRES) X(LGAZ) X(LXAL) X(LYKA) X(LVYKA) X(LS) X(LSGKP) X(LSGAL) X(LMX) X(LVMX) X(LMY) X(PCX1) \
                X(PDX1) X(PDX2) X(PDX3) X(PEX1) X(PEX2) X(PEX3) X(PEX4) X(PKX1) X(PKX2) X(PKX3) X(PHX1) X(PHX2) \
                    X(PVX1) X(PVX2) X(RBX1) X(RBX2) X(RCX1) X(REX1) X(REX2) X(RHX1) X(PTX1) X(PTX2) X(PTX3) X(QSX1) \
                        X(QSX2) X(QSX3) X(PCY1) X(PDY1) X(PDY2) X(PDY3) X(PEY1) X(PEY2) X(PEY3) X(PEY4) X(PKY1) \
                            X(PKY2) X(PKY3) X(PHY1) X(PHY2) X(PHY3) X(PVY1) X(PVY2) X(PVY3) X(PVY4) X(RBY1) X(RBY2) \
                                X(RBY3) X(RCY1) X(REY1) X(REY2) X(RHY1) X(RHY2) X(RVY1) X(RVY2) X(RVY3) X(RVY4) \
                                    X(RVY5) X(RVY6) X(PTY1) X(PTY2) X(QSY1) X(QSY2) X(QSY3) X(QSY4) X(QBZ1) X(QBZ2) \
                                        X(QBZ3) X(QBZ4) X(QBZ5) X(QBZ9) X(QBZ10) X(QCZ1) X(QDZ1) X(QDZ2) X(QDZ3) \
                                            X(QDZ4) X(QDZ6) X(QDZ7) X(QDZ8) X(QDZ9) X(QEZ1) X(QEZ2) X(QEZ3) X(QEZ4) \
                                                X(QEZ5) X(QHZ1) X(QHZ2) X(QHZ3) X(QHZ4) X(SSZ1) X(SSZ2) X(SSZ3) \
                                                    X(SSZ4)

/* X(name): one number; Y(name): two, at pn and at 2 pn. */
#define TMEASY_LIST(X, Y) \
    X(load) \
    X(friction) X(rolling_resistance) Y(dfx0) Y(fxm) Y(fxs) Y(dfy0) Y(fym) Y(fys) Y(sxm) Y(sxs) Y(sym) Y(sys) Y(trail) \
        Y(sq0) Y(sqe)

#define PAC_ENUM(name) PAC_##name,
#define TMEASY_ENUM(name) TMEASY_##name,
#define TMEASY_ENUM_TWO(name) TMEASY_##name, TMEASY_##name##_TWICE,
enum { PAC_LIST(PAC_ENUM) PAC_COUNT };
enum { TMEASY_LIST(TMEASY_ENUM, TMEASY_ENUM_TWO) TMEASY_COUNT };
#undef PAC_ENUM
#undef TMEASY_ENUM
#undef TMEASY_ENUM_TWO

#endif
