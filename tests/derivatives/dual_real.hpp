/* SPDX-License-Identifier: MIT
 * A number type for generated code compiled as C++: a value and its derivative along one direction. Written from the
 * rules of differentiation, it shares nothing with the generator. */
#ifndef DUAL_REAL_HPP
#define DUAL_REAL_HPP

#include <cmath>

struct Differential {
    double v, d;
    Differential() = default;
    constexpr Differential(double value) : v(value), d(0) {}
    constexpr Differential(double value, double slope) : v(value), d(slope) {}
    explicit operator int() const { return (int)v; }
    explicit operator float() const { return (float)v; }
    Differential &operator+=(Differential b) { return v += b.v, d += b.d, *this; }
    Differential &operator-=(Differential b) { return v -= b.v, d -= b.d, *this; }
    Differential &operator*=(Differential b) { return d = d * b.v + v * b.d, v *= b.v, *this; }
};

inline Differential operator-(Differential a) { return Differential(-a.v, -a.d); }
inline Differential operator+(Differential a, Differential b) { return Differential(a.v + b.v, a.d + b.d); }
inline Differential operator-(Differential a, Differential b) { return Differential(a.v - b.v, a.d - b.d); }
inline Differential operator*(Differential a, Differential b) { return Differential(a.v * b.v, a.d * b.v + a.v * b.d); }
inline Differential operator/(Differential a, Differential b) { return Differential(a.v / b.v, (a.d - a.v / b.v * b.d) / b.v); }
inline bool operator<(Differential a, Differential b) { return a.v < b.v; }
inline bool operator>(Differential a, Differential b) { return a.v > b.v; }
inline bool operator<=(Differential a, Differential b) { return a.v <= b.v; }
inline bool operator>=(Differential a, Differential b) { return a.v >= b.v; }
inline bool operator==(Differential a, Differential b) { return a.v == b.v; }
inline bool operator!=(Differential a, Differential b) { return a.v != b.v; }

/* f(a) with the slope of f there; nothing changes where a does not */
inline Differential along(Differential a, double value, double slope) { return Differential(value, a.d == 0 ? 0 : slope * a.d); }
inline Differential sqrt(Differential a) { return along(a, std::sqrt(a.v), 0.5 / std::sqrt(a.v)); }
inline Differential fabs(Differential a) { return along(a, std::fabs(a.v), (a.v > 0) - (a.v < 0)); }
inline Differential sin(Differential a) { return along(a, std::sin(a.v), std::cos(a.v)); }
inline Differential cos(Differential a) { return along(a, std::cos(a.v), -std::sin(a.v)); }
inline Differential tan(Differential a) { return along(a, std::tan(a.v), 1 / (std::cos(a.v) * std::cos(a.v))); }
inline Differential asin(Differential a) { return along(a, std::asin(a.v), 1 / std::sqrt(1 - a.v * a.v)); }
inline Differential acos(Differential a) { return along(a, std::acos(a.v), -1 / std::sqrt(1 - a.v * a.v)); }
inline Differential atan(Differential a) { return along(a, std::atan(a.v), 1 / (1 + a.v * a.v)); }
inline Differential exp(Differential a) { return along(a, std::exp(a.v), std::exp(a.v)); }
inline Differential log(Differential a) { return along(a, std::log(a.v), 1 / a.v); }
inline Differential tanh(Differential a) { return along(a, std::tanh(a.v), 1 / (std::cosh(a.v) * std::cosh(a.v))); }
inline Differential floor(Differential a) { return Differential(std::floor(a.v)); }
inline Differential ceil(Differential a) { return Differential(std::ceil(a.v)); }
inline Differential round(Differential a) { return Differential(std::round(a.v)); }
inline Differential pow(Differential a, Differential b)
{
    const double value = std::pow(a.v, b.v);
    return Differential(value, (a.d == 0 ? 0 : b.v * std::pow(a.v, b.v - 1) * a.d) + (b.d == 0 ? 0 : value * std::log(a.v) * b.d));
}
inline Differential atan2(Differential a, Differential b)
{
    const double square = a.v * a.v + b.v * b.v;
    return Differential(std::atan2(a.v, b.v), square > 0 ? (b.v * a.d - a.v * b.d) / square : 0);
}

#endif
