/* SPDX-License-Identifier: MIT
 * Response to steering at a frequency: about straight motion at a speed, dz/dt = A z + B u with u the steering
 * coordinate, its rate and its acceleration, and the speed held. */
#include "gic_runtime.h"
#include "run/sheet.h"
#include "tape/engine_tape.h"

#include <string.h>

enum { X = 0, Y = 1, YAW = 5, OF_INPUT = SHEET_STEERING };

struct SheetMotion {
    const Sheet *sheet;
    int n, *kept;       /* motions but places along which nothing changes, and the speed */
    double *A, *B;      /* [n][n], [OF_INPUT][n] */
    double *C, *D;      /* of outputs: [n][outputs], [OF_INPUT][outputs] */
    double *work, *rhs; /* [2 n][2 n], [2 n] */
};

const SheetMotion *sheet_motion(const Sheet *sheet, int steer, double speed)
{
    const Linear *linear = sheet->found->linear;
    const gic_model *code = sheet->found->engine->code;
    const int all = linear->count;
    const size_t size = (size_t)all * sizeof(double);
    Instance *self = (Instance *)(void *)instance_new(sheet->pool, sheet->found->engine);
    const int outputs = sheet->model->output_components;
    double *f = pool_alloc(sheet->pool, size), *A = pool_alloc(sheet->pool, (size_t)all * size), *b[OF_INPUT];
    SheetMotion *motion = pool_alloc(sheet->pool, sizeof *motion);
    *motion = (SheetMotion){.sheet = sheet, .kept = pool_alloc(sheet->pool, (size_t)all * sizeof *motion->kept)};
    memcpy(self, sheet->found->self, code->size);
    int status = sheet_set_in_motion(sheet, self, speed);
    if (status == GIC_OK)
        status = linearize(linear, self, f, A);
    motion->C = pool_alloc(sheet->pool, (size_t)outputs * (size + sizeof(double)));
    motion->D = pool_alloc(sheet->pool, (OF_INPUT * (size_t)outputs + 1) * sizeof *motion->D);
    bool jump;
    for (int k = 0; k < OF_INPUT && status == GIC_OK; ++k) {
        b[k] = pool_alloc(sheet->pool, size);
        status = linear_column(linear, self, LINEAR_INPUT, code->coordinate_input[steer] + k, b[k], outputs,
                               motion->D + k * outputs, &jump);
    }
    for (int i = 0; i < all; ++i)
        if (i != X && i != Y && i != YAW && i != linear->places + X)
            motion->kept[motion->n++] = i;
    for (int j = 0; j < motion->n && status == GIC_OK; ++j)
        status =
            linear_column(linear, self, LINEAR_MOTION, motion->kept[j], f, outputs, motion->C + j * outputs, &jump);
    if (status != GIC_OK)
        return NULL;
    const size_t n = (size_t)motion->n;
    motion->A = pool_alloc(sheet->pool, n * n * sizeof *motion->A);
    motion->B = pool_alloc(sheet->pool, OF_INPUT * n * sizeof *motion->B);
    motion->work = pool_alloc(sheet->pool, 4 * n * n * sizeof *motion->work);
    motion->rhs = pool_alloc(sheet->pool, 2 * n * sizeof *motion->rhs);
    for (int i = 0; i < motion->n; ++i) {
        for (int j = 0; j < motion->n; ++j)
            motion->A[i * motion->n + j] = A[motion->kept[i] * all + motion->kept[j]];
        for (int k = 0; k < OF_INPUT; ++k)
            motion->B[k * motion->n + i] = b[k][motion->kept[i]];
    }
    return motion;
}

bool sheet_path(const Sheet *sheet, int steer, double speed, SheetPath *path)
{
    const Linear *linear = sheet->found->linear;
    const gic_model *code = sheet->found->engine->code;
    const int all = linear->count;
    const size_t size = (size_t)all * sizeof(double);
    Instance *self = (Instance *)(void *)instance_new(sheet->pool, sheet->found->engine);
    double *f = pool_alloc(sheet->pool, size);
    bool jump;
    *path = (SheetPath){.n = all,
                        .y = Y,
                        .yaw = YAW,
                        .yaw_rate = linear->places + YAW,
                        .A = pool_alloc(sheet->pool, (size_t)all * size),
                        .B = pool_alloc(sheet->pool, OF_INPUT * size)};
    memcpy(self, sheet->found->self, code->size);
    int status = sheet_set_in_motion(sheet, self, speed);
    if (status == GIC_OK)
        status = linearize(linear, self, f, path->A);
    for (int k = 0; k < OF_INPUT && status == GIC_OK; ++k)
        status = linear_column(linear, self, LINEAR_INPUT, code->coordinate_input[steer] + k, path->B + k * all, 0,
                               NULL, &jump);
    for (int i = 0; i < all; ++i) { /* along x nothing changes, and the speed is held */
        path->A[X * all + i] = path->A[i * all + X] = 0;
        path->A[(linear->places + X) * all + i] = path->A[i * all + linear->places + X] = 0;
    }
    for (int k = 0; k < OF_INPUT; ++k)
        path->B[k * all + X] = path->B[k * all + linear->places + X] = 0;
    return status == GIC_OK && gic_finite(path->A, all * all) && gic_finite(path->B, OF_INPUT * all);
}

bool sheet_motion_at(const SheetMotion *motion, double omega, double *re, double *im)
{
    const int n = motion->n, all = motion->sheet->found->linear->count;
    double *M = motion->work, *b = motion->rhs;
    /* (i omega - A) z = (B_0 + i omega B_1 - omega^2 B_2): its real part above the imaginary one */
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const double a = -motion->A[i * n + j], turn = i == j ? omega : 0;
            M[i * 2 * n + j] = M[(n + i) * 2 * n + n + j] = a;
            M[i * 2 * n + n + j] = -turn;
            M[(n + i) * 2 * n + j] = turn;
        }
        b[i] = motion->B[i] - omega * omega * motion->B[2 * n + i];
        b[n + i] = omega * motion->B[n + i];
    }
    if (!kc_solve(2 * n, M, b) || !gic_finite(b, 2 * n))
        return false;
    memset(re, 0, (size_t)all * sizeof *re);
    memset(im, 0, (size_t)all * sizeof *im);
    for (int i = 0; i < n; ++i) {
        re[motion->kept[i]] = b[i];
        im[motion->kept[i]] = b[n + i];
    }
    return true;
}

void sheet_motion_output(const SheetMotion *motion, int output, double omega, const double *re, const double *im,
                         double out[2])
{
    const int outputs = motion->sheet->model->output_components;
    out[0] = motion->D[output] - omega * omega * motion->D[2 * outputs + output];
    out[1] = omega * motion->D[outputs + output];
    for (int j = 0; j < motion->n; ++j) {
        out[0] += motion->C[j * outputs + output] * re[motion->kept[j]];
        out[1] += motion->C[j * outputs + output] * im[motion->kept[j]];
    }
}
