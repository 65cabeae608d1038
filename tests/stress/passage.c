/* SPDX-License-Identifier: MIT
 * passage --count N --seed S [--recovery WAY]
 *
 * An arm that turns freely, and fast, through the place where the length from the ground to its tip is longest and
 * stops being a coordinate: beyond it the same lengths belong to the other assembly mode. With steps in which it turns
 * by up to a third of a radian, and by as little as a ten thousandth, every run must end in a status before it is
 * there: a step that passes would let the length shrink again while the arm turned back. Prints how many runs were
 * tried, how many ended as they should and how many passed, and the largest angle that was left, in steps. */
#include "attack.h"
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "host/host.h"
#include "model/model.h"
#include "read/read.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include <unistd.h>

static const char text[] =
    "gicgen: 1\n"
    "model: passage\n"
    "gravity: [0, 0, 0]\n"
    "base: ground\n"
    "bodies:\n"
    "  arm: {mass: 1, position: [0, 0, 0], com: [0.3, 0, 0.1], inertia: [0.1, 0.2, 0.2]}\n"
    "joints:\n"
    "  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, -1, 0]}\n"
    "coordinates:\n"
    "  length: {type: length, bodies: [ground, arm], points: [[1, 0, 0], [0.24, 0, 0.32]], range: [0.65, 1.39]}\n";

static const double away = 1, reach = 0.4; /* m, of the length's ends from the hinge */

static int run(Subject *subject, Chance *chance, double *left)
{
    const gic_model *code = subject->code;
    const double speed = pow(10, uniform(chance, -1, 2)), angle = uniform(chance, 0.9, 2);
    const double turn = pow(10, uniform(chance, -4, -0.5)), step = turn / speed;
    const double length = sqrt(away * away + reach * reach - 2 * away * reach * cos(angle));
    double *state = instance_array(subject->self, code->state_offset);
    int status = GIC_OK;
    memcpy(subject->self, subject->fresh, code->size);
    state[0] = length;
    state[1] = away * reach * sin(angle) / length * speed;
    const int32_t method = uniform(chance, 0, 1) < 0.5 ? GIC_AB3 : GIC_RK4;
    for (long steps = 0; status == GIC_OK && steps < 100000; ++steps) {
        /* nearest to 0 where the arm is stretched */
        *left = (3.14159265358979 - angle - (double)steps * turn) / turn;
        if (*left < -0.5)
            return GIC_OK;
        status = gic_step(code, subject->self, step, method);
    }
    return status;
}

int main(int argc, char **argv)
{
    double count = 0, seed = 0, most = 0;
    long ended = 0, passed = 0;
    Recovery recovery = RECOVERY_AUTO;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (!strcmp(argv[i], "--count"))
            count = atof(argv[i + 1]);
        else if (!strcmp(argv[i], "--seed"))
            seed = atof(argv[i + 1]);
        else if (!strcmp(argv[i], "--recovery"))
            recovery = recovery_of(argv[i + 1]);
    }
    if (!(count >= 1) || recovery == RECOVERIES) {
        fputs("usage: passage --count N --seed S [--recovery WAY]\n", stderr);
        return 2;
    }
    Pool *pool = pool_new();
    char *path = pool_print(pool, "%s/passage-XXXXXX", temporary_folder());
    const int file = mkstemp(path);
    if (file < 0 || write(file, text, sizeof text - 1) != (ssize_t)(sizeof text - 1)) {
        perror(path);
        return 1;
    }
    close(file);
    const Model *model = model_read(pool, path);
    unlink(path);
    Subject subject = subject_open(pool, "tcc", model, recovery);
    Chance chance = chance_new(seed);
    for (long i = 0; (double)i < count; ++i) {
        double left;
        const int status = run(&subject, &chance, &left);
        ended += status != GIC_OK;
        passed += status == GIC_OK;
        if (status != GIC_OK)
            most = fmax(most, left);
    }
    printf("%ld %ld %ld %.2g\n", ended + passed, ended, passed, most);
    engine_close(subject.engine);
    pool_free(pool);
    return 0;
}
