/* SPDX-License-Identifier: MIT
 * test_tire_tables.sh compiles it with rig.c, code with tires by table, and curves.inc: LOOK(a curve, what it is of x).
 *
 *     by_table curves              looks at all curves
 *     by_table FRICTION <states    the outputs at these states of `gicrun --eval`, as its results are, on such a road
 */
#include "rig.c"

#include <stdio.h>
#include <stdlib.h>

typedef gic_real (*Function)(gic_real x);

static int failed;
static gic_real friction;

static void complain(const char *what, const char *curve, gic_real x, gic_real got, gic_real want)
{
    printf("FAIL %s of %s at %.17g: %.17g, not %.17g\n", what, curve, (double)x, (double)got, (double)want);
    failed = 1;
}

static int same(gic_real a, gic_real b)
{
    return a == b || (a != a && b != b);
}

/* Near, at a border, in the middle, beyond, at 0 and where x is no number. */
static void look(const char *name, Function curve, Function exact)
{
    const gic_real bound = sizeof(gic_real) == 8 ? (gic_real)1e-7 : (gic_real)1e-6, zero = 0;
    const gic_real odd[] = {0, -zero, 64, 65, (gic_real)1e9, -64, -65, 1 / zero, -1 / zero, zero / zero};
    gic_real worst = 0;
    int i, k;
    for (i = 0; i < (int)(sizeof odd / sizeof *odd); ++i)
        if (!same(curve(odd[i]), exact(odd[i])))
            complain("value", name, odd[i], curve(odd[i]), exact(odd[i]));
    for (i = 0; i < 400000; ++i) {
        const gic_real x = (gic_real)(exp(log(1e-6) + i * (log(70.0) - log(1e-6)) / 400000));
        const gic_real off = curve(x) - exact(x), other = curve(-x), mirrored = exact(-x);
        if (!(off <= bound && -off <= bound))
            complain("value", name, x, curve(x), exact(x));
        if (!same(other, mirrored == exact(x) ? curve(x) : -curve(x)))
            complain("mirror image", name, x, other, mirrored);
        worst = GIC_MAX(worst, GIC_FABS(off));
    }
    /* as the error has no slope at a border, it is still small at a hundredth of a cell from there */
    for (k = 1; sizeof(gic_real) == 8 && k <= 32; ++k) {
        const gic_real border = (gic_real)ldexp(1 + (k - 1) % 4 / 4.0, (k - 1) / 4 - 2);
        const gic_real width = (gic_real)ldexp(0.25, (k - 1) / 4 - 2);
        for (i = -2; i <= 2; ++i) {
            const gic_real x = border + (gic_real)(i * 0.005) * (i < 0 && k % 4 == 1 ? width / 2 : width);
            if (GIC_FABS(curve(x) - exact(x)) > GIC_R(0.05) * worst)
                complain("slope", name, x, curve(x), exact(x));
        }
    }
    printf("%s within %.1e\n", name, (double)worst);
}

#define LOOK(name, of_x) \
    static gic_real exact_##name(gic_real x) \
    { \
        return of_x; \
    }
#include "curves.inc"
#undef LOOK

static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    out[0] = out[1] = out[2] = 0;
}

static gic_real friction_there(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    (void)road, (void)lane, (void)time, (void)x, (void)y;
    return friction;
}

static rig car;

/* The states that the columns are; those of the header line that are none are refused. */
static int read_header(char *line, int *place)
{
    int columns = 0, i;
    char *word;
    for (word = strtok(line, ",\r\n"); word; word = strtok(NULL, ",\r\n")) {
        for (i = 0; i < RIG_STATES && strcmp(rig_model.state[i].name, word) != 0; ++i)
            ;
        if (i == RIG_STATES)
            return 0;
        place[columns++] = i;
    }
    return columns;
}

int main(int count, char **word)
{
    static char line[1 << 16];
    static int place[RIG_STATES];
    const gic_road road = {height, friction_there};
    int columns, i, status;
    if (count == 2 && !strcmp(word[1], "curves")) {
#define LOOK(name, of_x) look(#name, name, exact_##name);
#include "curves.inc"
        return failed;
    }
    friction = (gic_real)atof(word[1]);
    if (!fgets(line, sizeof line, stdin) || !(columns = read_header(line, place)))
        return 1;
    for (i = 0; i < RIG_OUTPUTS; ++i)
        printf("output.%s,", rig_model.output[i].name);
    printf("status,message\n");
    while (fgets(line, sizeof line, stdin)) {
        char *at = line;
        rig_setup(&car);
        car.head.road = &road;
        for (i = 0; i < columns; ++i, ++at)
            car.state[place[i]] = (gic_real)strtod(at, &at);
        status = rig_outputs(&car);
        for (i = 0; i < RIG_OUTPUTS; ++i)
            printf("%.17g,", (double)car.output[i]);
        printf("%d,%s\n", status, gic_status_text(status));
    }
    return 0;
}
