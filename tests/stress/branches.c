/* SPDX-License-Identifier: MIT
 * branches MODEL --count N --seed S [--recovery WAY]
 *
 * A walk of generated code through the coordinates in steps of random size, most small, some across all the range and
 * beyond. Each result must be the assembly mode that the step started from: it is where a copy arrives that goes the
 * same way in pieces so small that no pose can leap; where that way is blocked, it is where the design is found from,
 * in such pieces, on the straight way back. Refused steps leave the instance as it was. Prints how many steps were
 * tried, taken and refused, how many of those taken were blocked on both ways, how many leapt, how many refusals were
 * not without a trace, and the largest difference of poses otherwise. */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include "follow.h"

static const char usage[] = "usage: branches MODEL --count N --seed S [--recovery WAY]\n";

typedef struct Attack {
    Subject code;
    Follower follower;
    int coordinates, poses;
    double *design; /* poses there */
    Chance chance;
    long tried, taken, refused, blocked, leapt, traces;
    double largest;
} Attack;

/* Small steps mostly, and a few that lead anywhere. */
static void random_step(Attack *attack, const double *x, double *next)
{
    const gic_model *code = attack->code.code;
    Chance *chance = &attack->chance;
    const double kind = uniform(chance, 0, 1), size = pow(10, uniform(chance, -4, 0));
    for (int c = 0; c < attack->coordinates; ++c) {
        const double width = code->coordinate_high[c] - code->coordinate_low[c];
        next[c] = kind < 0.7   ? x[c] + size * width * uniform(chance, -1, 1)
                  : kind < 0.9 ? coordinate_value(chance, code, c, 0)
                               : coordinate_value(chance, code, c, kind < 0.98 ? 0.5 : 3);
    }
}

static void try_step(Attack *attack, double *x, double *pose)
{
    const gic_model *code = attack->code.code;
    gic_head *self = attack->code.self;
    const double same = 1e-6;
    double next[attack->coordinates + 1], found[attack->poses], slow[attack->poses];
    random_step(attack, x, next);
    memcpy(attack->follower.slow, self, code->size);
    ++attack->tried;
    if (place_at(code, self, next, found) != GIC_OK) {
        ++attack->refused;
        /* as if nothing had been tried */
        attack->traces += place_at(code, self, x, found) != GIC_OK || !(pose_difference(code, pose, found) < 1e-9);
        return;
    }
    ++attack->taken;
    if (!follow_straight(&attack->follower, x, next, slow)) {
        memcpy(attack->follower.slow, self, code->size);
        double design[attack->coordinates + 1];
        for (int c = 0; c < attack->coordinates; ++c)
            design[c] = code->coordinate_design[c];
        const bool back = follow_straight(&attack->follower, next, design, slow);
        attack->blocked += !back;
        attack->leapt += back && !(pose_difference(code, slow, attack->design) < same);
        memcpy(self, attack->code.fresh, code->size);
        for (int c = 0; c < attack->coordinates; ++c)
            x[c] = design[c];
        place_at(code, self, x, pose);
        return;
    }
    const double apart = pose_difference(code, found, slow);
    if (!(apart < same)) {
        ++attack->leapt;
        fprintf(stderr, "leapt by %g, step %ld:", apart, attack->tried);
        for (int c = 0; c < attack->coordinates; ++c)
            fprintf(stderr, " %.17g > %.17g", x[c], next[c]);
        fputc('\n', stderr);
        memcpy(self, attack->follower.slow, code->size);
        memcpy(found, slow, sizeof found);
    } else {
        attack->largest = fmax(attack->largest, apart);
    }
    memcpy(x, next, sizeof *x * (size_t)attack->coordinates);
    memcpy(pose, found, sizeof found);
}

int main(int argc, char **argv)
{
    const char *path = NULL;
    double count = 0, seed = 0;
    Recovery recovery = RECOVERY_AUTO;
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (argv[i][0] != '-' && !path) {
            path = argv[i];
            continue;
        }
        if (!strcmp(argv[i], "--count"))
            count = atof(value);
        else if (!strcmp(argv[i], "--seed"))
            seed = atof(value);
        else if (!strcmp(argv[i], "--recovery"))
            recovery = recovery_of(value);
        else
            path = NULL, i = argc;
        ++i;
    }
    if (!path || !(count >= 1 && count <= 1e9) || recovery == RECOVERIES) {
        fputs(usage, stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    Attack attack = {.code = subject_open(pool, "tcc", model, recovery), .chance = chance_new(seed)};
    const gic_model *code = attack.code.code;
    attack.coordinates = code->coordinate_count;
    attack.poses = 7 * code->body_count;
    attack.design = pool_alloc(pool, sizeof(double) * (size_t)attack.poses);
    /* less than the distance of modes: no two of them are nearer than the margin in which states are refused */
    attack.follower = follower_new(pool, &attack.code, 0.02);
    double x[attack.coordinates + 1], pose[attack.poses];
    for (int c = 0; c < attack.coordinates; ++c)
        x[c] = code->coordinate_design[c];
    if (place_at(code, attack.code.fresh, x, attack.design) != GIC_OK) {
        fprintf(stderr, "%s: the design is refused\n", path);
        return 1;
    }
    memcpy(pose, attack.design, sizeof pose);
    memcpy(attack.code.self, attack.code.fresh, code->size);
    while ((double)attack.tried < count)
        try_step(&attack, x, pose);
    printf("%ld %ld %ld %ld %ld %ld %.2g\n", attack.tried, attack.taken, attack.refused, attack.blocked, attack.leapt,
           attack.traces, attack.largest);
    engine_close(attack.code.engine);
    pool_free(pool);
    return 0;
}
