/* SPDX-License-Identifier: MIT
 * The road as the importer gives it, a plane under each wheel: see fmu_core.h. */
#include "fmu_core.h"

#include <string.h>

static const gic_model *const model = &FMU_DESCRIPTOR;

/* The wheel whose centre is nearest: which wheel asks, a road does not know. */
static const gic_real *nearest(const fmu_ground *ground, gic_real time, gic_real x, gic_real y, gic_real from[2])
{
    const gic_real after = time - ground->time;
    gic_real least = GIC_R(0.0);
    int32_t found = 0, w;
    for (w = 0; w < FMU_WHEELS; ++w) {
        const gic_real dx = x - after * ground->velocity[0] - ground->place[w][0];
        const gic_real dy = y - after * ground->velocity[1] - ground->place[w][1], square = dx * dx + dy * dy;
        if (w == 0 || square < least) {
            least = square;
            found = w;
        }
    }
    from[0] = ground->place[found][0];
    from[1] = ground->place[found][1];
    return ground->plane[found];
}

static gic_real slope(const gic_real *plane, int32_t axis)
{
    return -plane[axis == 0 ? FMU_NORMAL_X : FMU_NORMAL_Y] / plane[FMU_NORMAL_Z];
}

static void plane_height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    gic_real from[2];
    const gic_real *plane = nearest((const fmu_ground *)(const void *)road, time, x, y, from);
    (void)lane;
    out[1] = slope(plane, 0);
    out[2] = slope(plane, 1);
    out[0] = plane[FMU_HEIGHT] + out[1] * (x - from[0]) + out[2] * (y - from[1]);
}

static gic_real plane_friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    gic_real from[2];
    (void)lane;
    return nearest((const fmu_ground *)(const void *)road, time, x, y, from)[FMU_FRICTION];
}

/* A wheel stays on its plane: no bend, no other friction beside it. */
static void plane_bend(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = out[2] = GIC_R(0.0);
}

static void plane_friction_slope(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y,
                                 gic_real out[2])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = GIC_R(0.0);
}

void fmu_ground_reset(fmu_ground *ground)
{
    int32_t w;
    memset(ground, 0, sizeof *ground);
    for (w = 0; w < FMU_WHEELS; ++w)
        ground->plane[w][FMU_NORMAL_Z] = ground->plane[w][FMU_FRICTION] = GIC_R(1.0);
}

const gic_road *fmu_ground_adopt(fmu_ground *ground)
{
    ground->head.height = plane_height;
    ground->head.friction = plane_friction;
    ground->head.bend = plane_bend;
    ground->head.friction_slope = plane_friction_slope;
    return ground->given ? &ground->head : NULL;
}

int fmu_places(FMU_TYPE *work, gic_real place[FMU_WHEELS_ROOM][2])
{
    gic_real pose[7 * FMU_BODIES];
    const int status = model->poses(work, pose);
    int32_t w;
    for (w = 0; w < FMU_WHEELS && status == GIC_OK; ++w) {
        const gic_real *r = pose + 7 * fmu_wheel_body[w], *e = r + 3, *c = fmu_wheel_center[w];
        /* t = 2 e x c; the turned c is c + e0 t + e x t */
        const gic_real t[3] = {GIC_R(2.0) * (e[2] * c[2] - e[3] * c[1]), GIC_R(2.0) * (e[3] * c[0] - e[1] * c[2]),
                               GIC_R(2.0) * (e[1] * c[1] - e[2] * c[0])};
        place[w][0] = r[0] + c[0] + e[0] * t[0] + e[2] * t[2] - e[3] * t[1];
        place[w][1] = r[1] + c[1] + e[0] * t[1] + e[3] * t[0] - e[1] * t[2];
    }
    return status;
}

void fmu_ground_stand(fmu_ground *ground, const FMU_TYPE *at, gic_real place[FMU_WHEELS_ROOM][2])
{
    memcpy(ground->place, place, sizeof ground->place);
    ground->time = gic_time(at);
    if (model->free_base) { /* its velocity, FORMAT.md section 10 */
        const gic_real *velocity = at->state + (model->slow_count - 1) / 2 + 1;
        ground->velocity[0] = velocity[0];
        ground->velocity[1] = velocity[1];
    }
}

void fmu_ground_move(fmu_ground *ground, gic_real place[FMU_WHEELS_ROOM][2])
{
    int32_t w, k;
    for (w = 0; w < FMU_WHEELS; ++w)
        for (k = 0; k < 2; ++k)
            ground->plane[w][FMU_HEIGHT] += slope(ground->plane[w], k) * (place[w][k] - ground->place[w][k]);
}
