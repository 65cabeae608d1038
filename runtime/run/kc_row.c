/* SPDX-License-Identifier: MIT
 * The quantities of one position: models/KC.md defines them. NAN: has no value here. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/kc.h"

#include <math.h>
#include <string.h>

/* Numbers below this share of their unit are rounding: an angular velocity of 1 rad in so many times the radius; lines
 * that are parallel; a steer angle. */
static const double rounding = 1e-12, slight = 1e-3;

bool kc_solve(int n, double *A, double *b)
{
    for (int k = 0; k < n; ++k) {
        int pivot = k;
        for (int i = k + 1; i < n; ++i)
            pivot = fabs(A[i * n + k]) > fabs(A[pivot * n + k]) ? i : pivot;
        if (!(fabs(A[pivot * n + k]) > 0))
            return false;
        for (int j = 0; j < n && pivot != k; ++j) {
            const double kept = A[k * n + j];
            A[k * n + j] = A[pivot * n + j];
            A[pivot * n + j] = kept;
        }
        const double kept = b[k];
        b[k] = b[pivot];
        b[pivot] = pivot == k ? b[k] : kept;
        for (int i = k + 1; i < n; ++i) {
            const double share = A[i * n + k] / A[k * n + k];
            for (int j = k; j < n; ++j)
                A[i * n + j] -= share * A[k * n + j];
            b[i] -= share * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j)
            b[k] -= A[k * n + j] * b[j];
        b[k] /= A[k * n + k];
    }
    return true;
}

bool kc_along(const KcAxle *axle, const KcLook *look, bool contacts, const double *vz, double steer, double *along)
{
    const int n = axle->wheels;
    double A[KC_WHEELS * KC_WHEELS], b[KC_WHEELS];
    for (int i = 0; i < n; ++i) {
        KcPose pose, rate;
        kc_pose(&axle->wheel[i], look, &pose);
        b[i] = vz[i];
        for (int k = 0; k < look->columns; ++k) {
            double unit[KC_WHEELS + 1] = {0};
            unit[k] = 1;
            kc_rate(&axle->wheel[i], look, &pose, unit, &rate);
            const double lift = contacts ? rate.contact[2] : rate.centre[2];
            if (k < n)
                A[i * n + k] = lift;
            else
                b[i] -= lift * steer;
        }
    }
    if (!kc_solve(n, A, b))
        return false;
    memcpy(along, b, (size_t)n * sizeof *b);
    if (look->columns > n)
        along[n] = steer;
    return true;
}

/* The steering axis: of the turning of the carrier by the steering alone, all other coordinates held. */
static void steering_axis(const KcWheel *wheel, const KcPose *pose, const KcPose *rate, double *out)
{
    const double *s = pose->axis, square = dot3(rate->turn, rate->turn);
    double u[3], on[3], forward[2], left[2], ground[2], level[2];
    if (!(sqrt(square) * wheel->radius > rounding * norm3(rate->centre)) ||
        !(fabs(rate->turn[2]) > slight * sqrt(square)))
        return;
    for (int i = 0; i < 3; ++i)
        u[i] = rate->turn[i] / (rate->turn[2] < 0 ? -sqrt(square) : sqrt(square));
    cross3(rate->turn, rate->centre, on);
    for (int i = 0; i < 3; ++i)
        on[i] = pose->centre[i] + on[i] / square;
    out[KC_INCLINATION] = atan2(-wheel->side * u[1], u[2]);
    out[KC_CASTER] = atan2(-u[0], u[2]);
    const double q = hypot(s[0], s[1]);
    forward[0] = left[1] = s[1] / q;
    forward[1] = -s[0] / q;
    left[0] = s[0] / q;
    for (int i = 0; i < 2; ++i) {
        ground[i] = on[i] + u[i] * (pose->contact[2] - on[2]) / u[2] - pose->contact[i];
        level[i] = on[i] + u[i] * (pose->centre[2] - on[2]) / u[2] - pose->centre[i];
    }
    out[KC_SCRUB] = -wheel->side * (ground[0] * left[0] + ground[1] * left[1]);
    out[KC_TRAIL] = ground[0] * forward[0] + ground[1] * forward[1];
    out[KC_OFFSET] = -wheel->side * (level[0] * left[0] + level[1] * left[1]);
    out[KC_OFFSET_X] = level[0] * forward[0] + level[1] * forward[1];
}

/* sign a / b where b is more than rounding, else infinite: to either side, which has no sign. */
static double arm_of(double sign, double a, double b, double radius)
{
    return fabs(b) * radius > rounding * fabs(a) ? sign * (a / b) : INFINITY;
}

/* Swing arms of a wheel in a motion of travel. */
static void swing_arms(const KcAxle *axle, const KcWheel *wheel, const KcPose *rate, double *out)
{
    out[KC_FRONT_ARM] = arm_of(wheel->side, rate->contact[2], rate->turn[0], wheel->radius);
    out[KC_FRONT_ANGLE] = wheel->side * atan(rate->contact[1] / rate->contact[2]);
    out[KC_SIDE_ARM] = arm_of(-axle->ahead, rate->locked[2], rate->turn[1], wheel->radius);
    out[KC_SIDE_ANGLE] = out[KC_BRAKE_ANGLE] = axle->ahead * atan(rate->locked[0] / rate->locked[2]);
    out[KC_DRIVE_ANGLE] =
        axle->ahead * atan(wheel->shaft ? rate->centre[0] / rate->centre[2] : rate->locked[0] / rate->locked[2]);
}

static void of_wheel(const KcAxle *axle, KcMotion motion, const KcLook *look, const double *zero, const double *along,
                     const double *travel, int i, double *out)
{
    const KcWheel *wheel = &axle->wheel[i];
    KcPose pose, rate, moved;
    kc_pose(wheel, look, &pose);
    kc_rate(wheel, look, &pose, along, &rate);
    kc_rate(wheel, look, &pose, travel, &moved);
    const double own = motion == KC_STEER ? 1 : rate.centre[2];
    out[KC_CAMBER] = kc_camber(wheel, &pose);
    out[KC_STEER_ANGLE] = kc_steer(&pose);
    out[KC_TOE] = -wheel->side * kc_steer(&pose);
    out[KC_CAMBER_RATE] = kc_camber_rate(wheel, &pose, &rate) / own;
    out[KC_TOE_RATE] = -wheel->side * kc_steer_rate(&pose, &rate) / own;
    out[KC_TRAVEL] = pose.centre[2] - zero[wheel->centre + 2];
    out[KC_CENTRE_X] = pose.centre[0] - zero[wheel->centre];
    out[KC_CENTRE_Y] = pose.centre[1] - zero[wheel->centre + 1];
    copy3(pose.contact, out + KC_CONTACT_X);
    swing_arms(axle, wheel, &moved, out);
    if (axle->steer >= 0) {
        double unit[KC_WHEELS + 1] = {0};
        unit[axle->wheels] = 1;
        kc_rate(wheel, look, &pose, unit, &rate);
        steering_axis(wheel, &pose, &rate, out);
    }
}

/* Motion ratios: each wheel's travel alone. */
static bool ratios(const Kc *kc, const KcAxle *axle, const KcLook *look, double *out)
{
    for (int i = 0; i < axle->wheels; ++i) {
        double vz[KC_WHEELS] = {0}, along[KC_WHEELS + 1];
        vz[i] = 1;
        if (!kc_along(axle, look, false, vz, 0, along))
            return false;
        for (int e = 0; e < kc->elements; ++e) {
            const KcElement *element = &kc->element[e];
            double sum = 0;
            for (int k = 0; k < look->columns; ++k)
                sum += along[k] * kc_element_slope(element, look, k);
            out[i * kc->elements + e] = sum;
        }
    }
    return true;
}

/* Track, roll centres: `left` and `right` are the first wheel of each side. roll: motion in which contacts rise with y
 * times the unit of the roll angle. */
static void of_sides(const KcAxle *axle, const KcLook *look, const double *along, const double *roll, int left,
                     int right, double *out)
{
    KcPose pose[2], rate[2], rolled[2];
    double slope[2], sideways = 0;
    for (int i = 0; i < 2; ++i) {
        const KcWheel *wheel = &axle->wheel[i ? right : left];
        kc_pose(wheel, look, &pose[i]);
        kc_rate(wheel, look, &pose[i], along, &rate[i]);
        kc_rate(wheel, look, &pose[i], roll, &rolled[i]);
        slope[i] = rolled[i].contact[1] / rolled[i].contact[2];
    }
    for (int i = 0; i < axle->wheels; ++i) {
        KcPose one, way;
        kc_pose(&axle->wheel[i], look, &one);
        kc_rate(&axle->wheel[i], look, &one, roll, &way);
        sideways += way.contact[1] / axle->wheels;
    }
    const double *l = pose[0].contact, *r = pose[1].contact, ground = (l[2] + r[2]) / 2;
    /* the normals of both contacts' velocities: z = z_i - slope_i (y - y_i) */
    const double apart = (l[2] + slope[0] * l[1]) - (r[2] + slope[1] * r[1]), between = slope[0] - slope[1];
    out[KC_TRACK] = l[1] - r[1];
    out[KC_TRACK_RATE] = rate[0].contact[1] - rate[1].contact[1];
    out[KC_FORCE_HEIGHT] = sideways;
    if (fabs(between) > rounding) {
        out[KC_CENTRE_SIDE] = apart / between;
        out[KC_CENTRE_HEIGHT] = l[2] - slope[0] * (out[KC_CENTRE_SIDE] - l[1]) - ground;
    } else if (fabs(apart) <= rounding * (l[1] - r[1])) { /* one line */
        out[KC_CENTRE_SIDE] = (l[1] + r[1]) / 2;
        out[KC_CENTRE_HEIGHT] = l[2] - slope[0] * (out[KC_CENTRE_SIDE] - l[1]) - ground;
    } else {
        out[KC_CENTRE_SIDE] = INFINITY;
        out[KC_CENTRE_HEIGHT] = fabs(slope[0]) > rounding ? INFINITY : 0;
    }
}

/* The steer angles of both sides against those of a rolling curve about a centre on the line of the fixed axles. A
 * single wheel is left and right: no angle of it is another one's. */
static void ackermann(const Kc *kc, const KcAxle *axle, const KcLook *look, const double *along, int left, int right,
                      double *out)
{
    KcPose pose[2], rate;
    double angle[2], change = 0;
    for (int i = 0; i < 2; ++i) {
        kc_pose(&axle->wheel[i ? right : left], look, &pose[i]);
        kc_rate(&axle->wheel[i ? right : left], look, &pose[i], along, &rate);
        angle[i] = kc_steer(&pose[i]);
        change += kc_steer_rate(&pose[i], &rate) / 2;
    }
    const double mean = (angle[0] + angle[1]) / 2;
    out[KC_MEAN_STEER] = mean;
    if (change != 0)
        out[KC_RATIO] = 1 / change;
    const double before = (pose[0].contact[0] + pose[1].contact[0]) / 2 - kc->fixed_x;
    const int inner = mean * before > 0 ? 0 : 1; /* wheels behind turn the vehicle the other way */
    const double *o = pose[1 - inner].contact, *in = pose[inner].contact, turn = angle[1 - inner];
    if (!kc->turns || axle->unit || fabs(mean) < slight || fabs(turn) < slight || turn * mean < 0)
        return;
    /* the outer wheel's axis meets the line x = fixed_x at `middle`, for the inner one maybe beyond a quarter turn */
    const double ahead = o[0] - kc->fixed_x, middle = o[1] + ahead / tan(turn);
    const double ideal = atan2(fabs(in[0] - kc->fixed_x), (inner ? -1 : 1) * (middle - in[1]));
    out[KC_RADIUS] = fabs(ahead / sin(turn));
    if (left == right)
        return;
    out[KC_ACKERMANN_ERROR] = fabs(angle[inner]) - ideal;
    if (ideal - fabs(turn) > rounding)
        out[KC_ACKERMANN] = (fabs(angle[inner]) - fabs(turn)) / (ideal - fabs(turn));
}

static int first_of(const KcAxle *axle, double side)
{
    for (int i = 0; i < axle->wheels; ++i)
        if (axle->wheel[i].side == side)
            return i;
    return -1;
}

int kc_row(const Kc *kc, const KcAxle *axle, KcMotion motion, const double *w, KcLook *look, const double *along,
           KcRow *row)
{
    const int left = first_of(axle, 1), right = first_of(axle, -1), n = axle->wheels;
    double vz[KC_WHEELS], y[KC_WHEELS], travel[KC_WHEELS + 1], roll[KC_WHEELS + 1], force[KC_WHEELS], rate[KC_WHEELS];
    KcLook *zero = kc_look_new(kc, &(KcAxle){.steer = -1});
    for (int k = 0; k < KC_AXLE_ROOM; ++k)
        row->axle[k] = NAN;
    for (int i = 0; i < n; ++i) {
        KcPose pose;
        kc_pose(&axle->wheel[i], look, &pose);
        y[i] = pose.contact[1] - kc->middle;
        vz[i] = motion == KC_OPPOSITE ? axle->wheel[i].side : 1;
        for (int k = 0; k < KC_WHEEL_ROOM; ++k)
            row->wheel[i][k] = NAN;
    }
    int status = kc_look(kc, kc->initial, zero);
    if (status == GIC_OK)
        status = kc_forces(kc, axle, w, look, along, force, rate);
    if (status != GIC_OK || !kc_along(axle, look, false, vz, 0, travel) || !ratios(kc, axle, look, row->ratio))
        return status != GIC_OK ? status : GIC_ERROR_SINGULAR;
    for (int i = 0; i < n; ++i) {
        KcPose pose, moved;
        of_wheel(axle, motion, look, zero->value, along, travel, i, row->wheel[i]);
        kc_pose(&axle->wheel[i], look, &pose);
        kc_rate(&axle->wheel[i], look, &pose, along, &moved);
        row->wheel[i][KC_FORCE] = force[i];
        if (motion != KC_STEER)
            row->wheel[i][KC_RATE] = rate[i] / moved.contact[2];
    }
    if (kc->wheelbase > 0 && kc->height > 0 && !kc->units) {
        double brake = 0, drive = 0;
        for (int i = 0; i < n; ++i) {
            brake += tan(row->wheel[i][KC_BRAKE_ANGLE]) / n;
            drive += tan(row->wheel[i][KC_DRIVE_ANGLE]) / n;
        }
        row->axle[KC_ANTI_BRAKE] = brake * kc->wheelbase / kc->height;
        row->axle[KC_ANTI_DRIVE] = drive * kc->wheelbase / kc->height;
    }
    if (motion == KC_STEER && n == 1)
        ackermann(kc, axle, look, along, 0, 0, row->axle);
    if (left < 0 || right < 0)
        return GIC_OK;
    if (!kc_along(axle, look, true, y, 0, roll))
        return GIC_ERROR_SINGULAR;
    of_sides(axle, look, along, roll, left, right, row->axle);
    status = kc_forces(kc, axle, w, look, roll, force, rate);
    row->axle[KC_ROLL_RATE] = 0;
    for (int i = 0; i < n && status == GIC_OK; ++i)
        row->axle[KC_ROLL_RATE] += y[i] * rate[i];
    if (motion == KC_STEER)
        ackermann(kc, axle, look, along, left, right, row->axle);
    return status;
}

int kc_position(const Kc *kc, const KcAxle *axle, const double *w, KcRow *row)
{
    KcLook *look = kc_look_new(kc, axle);
    double vz[KC_WHEELS], along[KC_WHEELS + 1];
    *row =
        (KcRow){.wheel = pool_alloc(kc->pool, (size_t)axle->wheels * sizeof *row->wheel),
                .ratio = pool_alloc(kc->pool, ((size_t)axle->wheels * (size_t)kc->elements + 1) * sizeof *row->ratio)};
    for (int i = 0; i < axle->wheels; ++i)
        vz[i] = 1;
    const int status = kc_look(kc, w, look);
    if (status != GIC_OK)
        return status;
    if (!kc_along(axle, look, false, vz, 0, along))
        return GIC_ERROR_SINGULAR;
    return kc_row(kc, axle, KC_PARALLEL, w, look, along, row);
}
