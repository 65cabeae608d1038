/* SPDX-License-Identifier: MIT
 * Directional derivatives: exact ones of the model's code at the present state; differences where the road of the
 * importer or initialization is between knowns and unknowns. See fmu_core.h. */
#include "fmu_core.h"

#include <math.h>
#include <string.h>

static int32_t kind_of(uint32_t reference)
{
    return (int32_t)(reference / FMU_KIND);
}

static int32_t index_of(uint32_t reference)
{
    return (int32_t)(reference % FMU_KIND);
}

static int is_below(uint32_t reference, int32_t kind, int32_t count)
{
    return kind_of(reference) == kind && index_of(reference) < count;
}

/* References and seeds, before anything is computed. */
static fmu_result check(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                        size_t knowns, const double *seed)
{
    const int starting = instance->data.mode == FMU_INITIALIZATION;
    size_t i;
    for (i = 0; i < unknowns; ++i)
        if (!is_below(unknown[i], FMU_DERIVATIVE, FMU_STATES) && !is_below(unknown[i], FMU_OUTPUT, FMU_OUTPUTS) &&
            !is_below(unknown[i], FMU_PLACE, 2 * FMU_WHEELS) && !is_below(unknown[i], FMU_INDICATOR, FMU_INDICATORS) &&
            !(starting && is_below(unknown[i], FMU_STATE, FMU_STATES)))
            return fmu_say(instance, FMU_ERROR, "value reference %u is no unknown that has derivatives here",
                           (unsigned)unknown[i]);
    for (i = 0; i < knowns; ++i) {
        if (!is_below(known[i], FMU_STATE, FMU_STATES) && !is_below(known[i], FMU_INPUT, FMU_INPUTS) &&
            !is_below(known[i], FMU_PORT, FMU_PORTS) && !is_below(known[i], FMU_PARAMETER, FMU_PARAMETERS) &&
            !is_below(known[i], FMU_ROAD, FMU_PLANE * FMU_WHEELS))
            return fmu_say(instance, FMU_ERROR, "value reference %u is no known that there are derivatives by",
                           (unsigned)known[i]);
        if (!isfinite(seed[i]))
            return fmu_say(instance, FMU_DISCARD, "a seed is not a finite number");
    }
    return FMU_OK;
}

/* ---- exact ---------------------------------------------------------------------------------------------------- */

static void set_direction(FMU_DIRECTION *along, const uint32_t *known, size_t knowns, const double *seed)
{
    size_t i;
    memset(along, 0, sizeof *along);
    for (i = 0; i < knowns; ++i) {
        const int32_t k = index_of(known[i]);
        switch (kind_of(known[i])) {
        case FMU_STATE: along->state[k] += (gic_real)seed[i]; break;
        case FMU_INPUT: along->input[k] += (gic_real)seed[i]; break;
        case FMU_PORT: along->port[k] += (gic_real)seed[i]; break;
        case FMU_PARAMETER: along->parameter[k] += (gic_real)seed[i]; break;
        default: break; /* a road that nobody gave, with seeds of 0 */
        }
    }
}

/* place = r + R c: its derivative by those of r and of the Euler parameters. */
static void place_slope(const gic_real *pose, const gic_real *dpose, const gic_real *c, gic_real out[2])
{
    const gic_real *e = pose + 3, *de = dpose + 3, two = GIC_R(2.0);
    const gic_real t[3] = {two * (e[2] * c[2] - e[3] * c[1]), two * (e[3] * c[0] - e[1] * c[2]),
                           two * (e[1] * c[1] - e[2] * c[0])};
    const gic_real dt[3] = {two * (de[2] * c[2] - de[3] * c[1]), two * (de[3] * c[0] - de[1] * c[2]),
                            two * (de[1] * c[1] - de[2] * c[0])};
    out[0] = dpose[0] + de[0] * t[0] + e[0] * dt[0] + de[2] * t[2] + e[2] * dt[2] - de[3] * t[1] - e[3] * dt[1];
    out[1] = dpose[1] + de[0] * t[1] + e[0] * dt[1] + de[3] * t[0] + e[3] * dt[0] - de[1] * t[2] - e[1] * dt[2];
}

static int place_slopes(FMU_TYPE *work, FMU_DIRECTION *along, gic_real slope[FMU_WHEELS_ROOM][2])
{
    gic_real pose[7 * FMU_BODIES], dpose[7 * FMU_BODIES];
    int32_t w;
    int status = FMU_DESCRIPTOR.poses(work, pose);
    if (status == GIC_OK)
        status = FMU_TANGENT_POSES(work, along, dpose);
    for (w = 0; w < FMU_WHEELS && status == GIC_OK; ++w)
        place_slope(pose + 7 * fmu_wheel_body[w], dpose + 7 * fmu_wheel_body[w], fmu_wheel_center[w], slope[w]);
    return status;
}

static fmu_result exact(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                        size_t knowns, const double *seed, double *out)
{
    fmu_data *data = &instance->data;
    FMU_DIRECTION *along = &instance->along;
    gic_real slope[FMU_WHEELS_ROOM][2] = {{GIC_R(0.0)}};
    int status, places = 0;
    size_t i;
    const fmu_result result = fmu_initialize(instance);
    if (result != FMU_OK)
        return result;
    data->shown = data->self; /* looking leaves no trace */
    data->seen = 0;
    set_direction(along, known, knowns, seed);
    status = FMU_TANGENT(&data->shown, along);
    for (i = 0; i < unknowns; ++i)
        places |= kind_of(unknown[i]) == FMU_PLACE;
    if (status == GIC_OK && places)
        status = place_slopes(&data->shown, along, slope);
    if (status != GIC_OK)
        return fmu_say(instance, FMU_DISCARD, "no derivatives at t = %.9g s: %s", fmu_time(instance),
                       gic_status_text(status));
    for (i = 0; i < unknowns; ++i) {
        const int32_t k = index_of(unknown[i]);
        out[i] = kind_of(unknown[i]) == FMU_DERIVATIVE ? (double)along->rate[k]
                 : kind_of(unknown[i]) == FMU_OUTPUT   ? (double)along->output[k]
                 : kind_of(unknown[i]) == FMU_PLACE    ? (double)slope[k / 2][k % 2]
                                                       : 0.0; /* whether a gear is due jumps */
    }
    return FMU_OK;
}

/* ---- by differences ---------------------------------------------------------------------------------------------- */

/* All unknowns with the knowns moved by `step` times their seeds; everything is then as before. */
static fmu_result moved(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                        size_t knowns, const double *seed, double step, double factor, double *sum)
{
    fmu_data *data = &instance->data;
    fmu_result result = FMU_OK;
    double value;
    size_t i;
    instance->kept = *data;
    for (i = 0; i < knowns && result == FMU_OK; ++i) {
        /* what an importer may not set now */
        if (data->mode != FMU_INITIALIZATION &&
            (kind_of(known[i]) == FMU_STATE || kind_of(known[i]) == FMU_PARAMETER)) {
            const int32_t k = index_of(known[i]);
            *(kind_of(known[i]) == FMU_STATE ? &data->self.state[k] : &data->self.parameter[k]) += (gic_real)(step * seed[i]);
            data->rated = data->seen = data->located = 0;
            continue;
        }
        if (seed[i] == 0)
            continue;
        result = fmu_get_real(instance, known[i], &value);
        if (result == FMU_OK)
            result = fmu_set_real(instance, known[i], value + step * seed[i]);
    }
    for (i = 0; i < unknowns && result == FMU_OK; ++i) {
        result = fmu_get_real(instance, unknown[i], &value);
        sum[i] += factor * value;
    }
    *data = instance->kept;
    return result;
}

/* Central, of fourth order, with steps of 1e-5 along the largest seed. Summed so that what does not change gives 0. */
static fmu_result differences(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                              size_t knowns, const double *seed, double *out)
{
    static const double factor[4] = {-8, 8, 1, -1}, place[4] = {-1, 1, -2, 2};
    double largest = 0, step;
    fmu_result result = FMU_OK;
    size_t i;
    int k;
    for (i = 0; i < knowns; ++i)
        largest = fabs(seed[i]) > largest ? fabs(seed[i]) : largest;
    step = 1e-5 / (largest > 0 ? largest : 1);
    for (i = 0; i < unknowns; ++i)
        out[i] = 0;
    for (k = 0; k < 4 && result == FMU_OK && largest > 0; ++k)
        result = moved(instance, unknown, unknowns, known, knowns, seed, place[k] * step, factor[k], out);
    for (i = 0; i < unknowns; ++i)
        out[i] /= 12 * step;
    return result;
}

fmu_result fmu_directional(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                           size_t knowns, const double *seed, double *out)
{
    int inexact = instance->data.ground.given || instance->data.mode == FMU_INITIALIZATION;
    const fmu_result result = check(instance, unknown, unknowns, known, knowns, seed);
    size_t i;
    if (result != FMU_OK)
        return result;
    for (i = 0; i < knowns; ++i)
        inexact |= kind_of(known[i]) == FMU_ROAD && seed[i] != 0;
    for (i = 0; i < knowns && instance->data.ground.given && instance->data.mode != FMU_INITIALIZATION; ++i)
        if (kind_of(known[i]) == FMU_PARAMETER && FMU_DESCRIPTOR.parameter_geometric[index_of(known[i])] && seed[i] != 0)
            return fmu_say(instance, FMU_ERROR,
                           "where the importer gives the road there are no derivatives by value reference %u, which changes "
                           "the geometry, after initialization",
                           (unsigned)known[i]);
    for (i = 0; i < unknowns; ++i) /* of contacts */
        inexact |= kind_of(unknown[i]) == FMU_INDICATOR && index_of(unknown[i]) >= FMU_INDICATORS - FMU_CONTACTS;
    return (inexact ? differences : exact)(instance, unknown, unknowns, known, knowns, seed, out);
}

fmu_result fmu_adjoint(fmu_instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                       size_t knowns, const double *seed, double *out)
{
    fmu_result result = FMU_OK;
    enum { AT_ONCE = 64 };
    const double one = 1;
    double slope[AT_ONCE];
    size_t i, k, first;
    for (i = 0; i < unknowns; ++i)
        if (!isfinite(seed[i]))
            return fmu_say(instance, FMU_DISCARD, "a seed is not a finite number");
    for (k = 0; k < knowns && result == FMU_OK; ++k) {
        out[k] = 0;
        for (first = 0; first < unknowns && result == FMU_OK; first += AT_ONCE) {
            const size_t count = unknowns - first < AT_ONCE ? unknowns - first : AT_ONCE;
            result = fmu_directional(instance, unknown + first, count, known + k, 1, &one, slope);
            for (i = 0; i < count && result == FMU_OK; ++i)
                out[k] += seed[first + i] * slope[i];
        }
    }
    return result;
}
