/* SPDX-License-Identifier: MIT
 * near_singular MODEL --count N --seed S --keep K -o FILE [--recovery WAY]
 *
 * Random states inside the coordinates' ranges and far beyond, evaluated from the design by generated code and by the
 * interpreted engine gic. From every twentieth that generated code refuses a walk begins that creeps towards limits: to
 * the last state that is taken, by bisection, and on from there in another direction. After each refusal the instance
 * is asked for the last state that was taken, and must go on from there. FILE.states and FILE.results, as `gicrun
 * --eval` reads and writes them: the K states with the largest differences, and of those that gic refuses K / 2 at
 * which bodies move most with the coordinates. Each of them must be the assembly mode that its way leads to: the legs
 * of that are gone again from the design, by generated code and by gic, in pieces so small that no pose can leap.
 *
 * Prints how many states were tried, taken and refused, how many were taken that gic refuses, the largest relative
 * difference of accelerations; results that are no numbers, refusals after which the last state is not found again;
 * kept states that small pieces lead away from, as generated code and as gic go, and those that either does not reach.
 */
#include "base/pool.h"
#include "engine/engine.h"
#include "gic_runtime.h"
#include "model/model.h"
#include "read/read.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"

#include "follow.h"

static const char usage[] = "usage: near_singular MODEL --count N --seed S --keep K -o FILE [--recovery WAY]\n";

enum { LEGS = 3 };

/* A state with the inputs that go with it, what became of it, and the ways to it. */
typedef struct Trial {
    double score;
    double *number; /* [states + inputs], then rate [states] and pose [7 bodies] */
    double *corner; /* [LEGS - 1][coordinates] where the way from the design turns */
    int corners;
} Trial;

typedef struct List {
    int count, room;
    Trial *trial;
} List;

typedef struct Attack {
    Subject code, other;
    gic_head *left;                     /* the instance that a refusal left */
    gic_head *good[2];                  /* of either engine: the last state of a walk that was taken */
    int states, inputs, numbers, whole; /* numbers: of a state with inputs; whole: with all that became of it */
    double *corner;                     /* [LEGS - 1][coordinates] of the walk under way */
    int corners;
    bool astray; /* gic, that did not follow round a corner of the walk */
    Chance chance;
    List worst, unseen;
    long tried, taken, refused, doubted, wrong, lost;
    long leapt[2], blocked[2]; /* kept states, by either engine */
    double largest;
} Attack;

static List list_new(Pool *pool, int room, const Attack *attack)
{
    const size_t corners = (LEGS - 1) * (size_t)(attack->code.code->coordinate_count + 1);
    List list = {.room = room, .trial = pool_alloc(pool, sizeof *list.trial * (size_t)(room + 1))};
    for (int i = 0; i < room; ++i) {
        list.trial[i].number = pool_alloc(pool, sizeof(double) * (size_t)attack->whole);
        list.trial[i].corner = pool_alloc(pool, sizeof(double) * corners);
    }
    return list;
}

/* Keep it where it is among the worst: the list is a heap with the best on top. */
static void keep(List *list, const Attack *attack, const double *number, double score)
{
    if (!list->room || (list->count == list->room && !(score > list->trial[0].score)))
        return;
    int at = list->count < list->room ? list->count++ : 0;
    Trial *trial = list->trial;
    memcpy(trial[at].number, number, sizeof *number * (size_t)attack->whole);
    memcpy(trial[at].corner, attack->corner,
           sizeof *number * (size_t)(attack->corners * attack->code.code->coordinate_count));
    trial[at].corners = attack->corners;
    trial[at].score = score;
    for (int up; at > 0 && trial[up = (at - 1) / 2].score > trial[at].score; at = up) {
        const Trial swap = trial[up];
        trial[up] = trial[at];
        trial[at] = swap;
    }
    for (int down; (down = 2 * at + 1) < list->count; at = down) {
        down += down + 1 < list->count && trial[down + 1].score < trial[down].score;
        if (trial[at].score <= trial[down].score)
            break;
        const Trial swap = trial[down];
        trial[down] = trial[at];
        trial[at] = swap;
    }
}

/* From the instance `from`: its rate and poses behind the numbers. */
static int evaluate(const Attack *attack, const Subject *subject, const gic_head *from, double *number)
{
    const gic_model *code = subject->code;
    double *rate = number + attack->numbers, *pose = rate + attack->states;
    memcpy(subject->self, from, code->size);
    memcpy(instance_array(subject->self, code->state_offset), number, sizeof *number * (size_t)attack->states);
    memcpy(instance_array(subject->self, code->input_offset), number + attack->states,
           sizeof *number * (size_t)attack->inputs);
    const int status = code->rhs(subject->self, 0, number, rate);
    return status == GIC_OK ? code->poses(subject->self, pose) : status;
}

/* Base anywhere, turned in any way, everything in motion. */
static void random_state(Attack *attack, double *number)
{
    const gic_model *code = attack->code.code;
    Chance *chance = &attack->chance;
    static const double beyond[] = {0, 0, 0.1, 0.3, 1, 3};
    const double reach = beyond[(int)uniform(chance, 0, 6)];
    memcpy(number, instance_array(attack->code.fresh, code->state_offset), sizeof *number * (size_t)attack->states);
    memcpy(number + attack->states, instance_array(attack->code.fresh, code->input_offset),
           sizeof *number * (size_t)attack->inputs);
    if (code->free_base) {
        const double turn = uniform(chance, 0, 6.283185307179586);
        number[0] = uniform(chance, -10, 10);
        number[1] = uniform(chance, -10, 10);
        number[2] += uniform(chance, -0.2, 0.2);
        number[3] = cos(turn / 2);
        number[4] = number[5] = 0;
        number[6] = sin(turn / 2);
        for (int i = 0; i < 6; ++i)
            number[code->slow_count / 2 + 1 + i] = uniform(chance, -3, 3);
    }
    for (int c = 0; c < code->coordinate_count; ++c) {
        int rate;
        double *value = coordinate_place(code, c, number, number + attack->states, &rate);
        *value = coordinate_value(chance, code, c, reach);
        value[rate] = uniform(chance, -1, 1);
    }
}

/* Coordinates `share` of the way from one state to another. */
static void mix(const Attack *attack, double *from, double *to, double share, double *out)
{
    const gic_model *code = attack->code.code;
    memmove(out, from, sizeof *out * (size_t)attack->numbers);
    for (int c = 0; c < code->coordinate_count; ++c) {
        int rate;
        const double *start = coordinate_place(code, c, from, from + attack->states, &rate);
        const double *end = coordinate_place(code, c, to, to + attack->states, &rate);
        double *value = coordinate_place(code, c, out, out + attack->states, &rate);
        *value = *start + share * (*end - *start);
    }
}

/* How fast bodies move with the coordinates: a ten-thousand-millionth of the way back towards the first state. */
static double sensitivity(Attack *attack, const gic_head *from, const double *number)
{
    const gic_model *code = attack->code.code;
    const int poses = attack->numbers + attack->states;
    double moved[attack->whole], start[attack->numbers], move = 0;
    const double share = 1e-10;
    memcpy(start, instance_array(attack->code.fresh, code->state_offset), sizeof *start * (size_t)attack->states);
    memcpy(start + attack->states, instance_array(attack->code.fresh, code->input_offset),
           sizeof *start * (size_t)attack->inputs);
    memcpy(moved, number, sizeof moved);
    mix(attack, moved, start, share, moved);
    if (evaluate(attack, &attack->code, from, moved) != GIC_OK)
        return 0;
    for (int i = poses; i < attack->whole; ++i)
        move = fmax(move, fabs(moved[i] - number[i]));
    return move / share;
}

/* A state that generated code takes: how far is gic from it? Accelerations of the base's position and orientation and
 * of each coordinate, relative to their size: of a group that is small by cancellation too much is said. */
static void screen(Attack *attack, gic_head *const from[2], const double *number)
{
    const gic_model *code = attack->code.code;
    const int half = code->slow_count / 2;
    const double *rate = number + attack->numbers;
    double other[attack->whole], *other_rate = other + attack->numbers, worst = 0;
    ++attack->taken;
    attack->wrong += !gic_finite(rate, attack->whole - attack->numbers);
    memcpy(other, number, sizeof other);
    if (attack->astray || evaluate(attack, &attack->other, from[1], other) != GIC_OK) {
        ++attack->doubted;
        keep(&attack->unseen, attack, number, sensitivity(attack, from[0], number));
        return;
    }
    for (int i = code->free_base ? half + 1 : half; i < code->slow_count;) {
        const int count = code->free_base && i < half + 7 ? 3 : 1;
        double size = 0, difference = 0;
        for (int end = i + count; i < end; ++i) {
            size += fabs(other_rate[i]);
            difference += fabs(other_rate[i] - rate[i]);
        }
        worst = fmax(worst, difference / (1 + size));
    }
    attack->largest = fmax(attack->largest, worst);
    keep(&attack->worst, attack, number, worst);
}

/* Is what a refusal left of the instance as good as the one before? The last good state is found again, where it was:
 * `low` of the way from `good` to `target`. Right at the bound rounding may refuse what it took before, from another
 * start: then what is a little before it, on the way that led there, is. That of good itself is the one from `origin`.
 */
static bool goes_on(Attack *attack, double *origin, double *good, double *target, double low, const double *known)
{
    static const double back[] = {0, 1e-9, 1e-6, 1e-3};
    const int poses = attack->numbers + attack->states;
    double number[attack->whole];
    gic_head *left = attack->left;
    memcpy(left, attack->code.self, attack->code.code->size);
    for (int i = 0; i < 4; ++i) {
        if (low > 0)
            mix(attack, good, target, low * (1 - back[i]), number);
        else
            mix(attack, good, origin, back[i], number);
        if (evaluate(attack, &attack->code, left, number) != GIC_OK)
            continue;
        /* poses move as a root at most: 1e-9 before the bound is 3e-5 of the way there */
        return pose_difference(attack->code.code, number + poses, known + poses) < 1e-8 + 2 * sqrt(back[i]);
    }
    return false;
}

/* From the good state of the walk, reached from `origin`, towards another: the last that is taken becomes the good one,
 * and that before it the origin. */
static void creep(Attack *attack, double *origin, double *good, double *target)
{
    const size_t size[] = {attack->code.code->size, attack->other.code->size};
    double number[attack->whole], known[attack->whole], low = 0, high = 1;
    memcpy(known, good, sizeof *known * (size_t)attack->numbers);
    bool any = evaluate(attack, &attack->code, attack->good[0], known) == GIC_OK;
    for (int i = 0; i < 40 && high - low > 1e-13; ++i) {
        const double share = i ? 0.5 * (low + high) : 1;
        mix(attack, good, target, share, number);
        ++attack->tried;
        if (evaluate(attack, &attack->code, attack->good[0], number) != GIC_OK) {
            ++attack->refused;
            attack->lost += any && !goes_on(attack, origin, good, target, low, known);
            high = share;
            continue;
        }
        screen(attack, attack->good, number);
        evaluate(attack, &attack->code, attack->good[0], number);
        memcpy(attack->good[0], attack->code.self, size[0]);
        memcpy(known, number, sizeof known);
        any = true;
        if (evaluate(attack, &attack->other, attack->good[1], number) == GIC_OK)
            memcpy(attack->good[1], attack->other.self, size[1]);
        low = share;
    }
    mix(attack, good, target, low, number);
    if (low > 0)
        memcpy(origin, good, sizeof *good * (size_t)attack->numbers);
    memcpy(good, number, sizeof *good * (size_t)attack->numbers);
}

/* Coordinates of a state. */
static void coordinates_of(const Attack *attack, double *number, double *x)
{
    for (int c = 0, rate; c < attack->code.code->coordinate_count; ++c)
        x[c] = *coordinate_place(attack->code.code, c, number, number + attack->states, &rate);
}

static void walk(Attack *attack, double *target)
{
    double good[attack->whole], origin[attack->whole];
    memcpy(good, instance_array(attack->code.fresh, attack->code.code->state_offset),
           sizeof *good * (size_t)attack->states);
    memcpy(good + attack->states, instance_array(attack->code.fresh, attack->code.code->input_offset),
           sizeof *good * (size_t)attack->inputs);
    memcpy(origin, good, sizeof origin);
    memcpy(attack->good[0], attack->code.fresh, attack->code.code->size);
    memcpy(attack->good[1], attack->other.fresh, attack->other.code->size);
    for (int leg = 0; leg < LEGS; ++leg) {
        creep(attack, origin, good, target);
        random_state(attack, target);
        attack->astray = attack->astray || evaluate(attack, &attack->other, attack->good[1], good) != GIC_OK;
        memcpy(attack->good[1], attack->other.self, attack->other.code->size);
        if (leg + 1 < LEGS)
            coordinates_of(attack, good, attack->corner + attack->corners++ * attack->code.code->coordinate_count);
    }
    attack->corners = 0;
    attack->astray = false;
}

/* The way of a kept state again, in small pieces: does it lead to its poses? */
static void follow(Attack *attack, Trial *trial, int engine, const Follower *follower)
{
    const double same = 1e-6;
    const gic_model *code = follower->code;
    const int coordinates = code->coordinate_count;
    const Subject *subject = engine ? &attack->other : &attack->code;
    double from[coordinates + 1], to[coordinates + 1], pose[7 * code->body_count], number[attack->whole];
    memcpy(follower->slow, subject->fresh, code->size);
    memcpy(number, instance_array(subject->fresh, code->state_offset), sizeof *number * (size_t)attack->states);
    memcpy(number + attack->states, instance_array(subject->fresh, code->input_offset),
           sizeof *number * (size_t)attack->inputs);
    coordinates_of(attack, number, from);
    for (int leg = 0; leg <= trial->corners; ++leg) {
        if (leg < trial->corners)
            memcpy(to, trial->corner + leg * coordinates, sizeof to - sizeof *to);
        else
            coordinates_of(attack, trial->number, to);
        if (!follow_straight(follower, from, to, pose)) {
            ++attack->blocked[engine];
            return;
        }
        memcpy(from, to, sizeof from);
    }
    memcpy(number, trial->number, sizeof number);
    if (evaluate(attack, subject, follower->slow, number) != GIC_OK) {
        ++attack->blocked[engine];
        return;
    }
    const int poses = attack->numbers + attack->states;
    const double apart = pose_difference(code, number + poses, trial->number + poses);
    if (apart < same)
        return;
    ++attack->leapt[engine];
    fprintf(stderr, "%s: off by %g from where small pieces lead, on %d legs to", engine ? "gic" : "code", apart,
            trial->corners + 1);
    for (int c = 0; c < coordinates; ++c)
        fprintf(stderr, " %.17g", to[c]);
    fputc('\n', stderr);
}

static void follow_all(Attack *attack, Pool *pool)
{
    /* less than the distance of modes by an order: no two of them are nearer than the margin in which states are
     * refused; gic, thirty times slower, looks at its steps itself */
    const Follower follower[] = {follower_new(pool, &attack->code, 0.002), follower_new(pool, &attack->other, 0.02)};
    List *const list[] = {&attack->worst, &attack->unseen};
    for (int l = 0; l < 2; ++l)
        for (int i = 0; i < list[l]->count; ++i)
            for (int engine = 0; engine < 2; ++engine)
                follow(attack, &list[l]->trial[i], engine, &follower[engine]);
}

static FILE *open_file(Pool *pool, const char *path, const char *ending)
{
    FILE *out = fopen(pool_print(pool, "%s%s", path, ending), "w");
    if (!out) {
        perror(path);
        exit(1);
    }
    return out;
}

static void write_numbers(FILE *out, const double *number, int count)
{
    for (int i = 0; i < count; ++i)
        fprintf(out, "%.17g%c", number[i], i + 1 < count ? ',' : '\n');
}

static void write_states(const Attack *attack, const Trial *trial, int trials, FILE *out)
{
    const Engine *engine = attack->code.engine;
    for (int i = 0; i < attack->numbers; ++i)
        fprintf(out, "%s%s", i ? "," : "",
                i < attack->states ? engine->standard[i].name : engine->code->input[i - attack->states].name);
    fputc('\n', out);
    for (int t = 0; t < trials; ++t)
        write_numbers(out, trial[t].number, attack->numbers);
}

static void write_results(const Attack *attack, const Trial *trial, int trials, FILE *out)
{
    static const char *const base[] = {"a.x", "a.y", "a.z", "alpha.x", "alpha.y", "alpha.z"};
    static const char *const part[] = {"x", "y", "z", "e0", "e1", "e2", "e3"};
    const gic_model *code = attack->code.code;
    const int half = code->slow_count / 2, first = code->free_base ? 0 : 1;
    for (int i = 0; code->free_base && i < 6; ++i)
        fprintf(out, "%s,", base[i]);
    for (int c = 0; c < code->coordinate_count; ++c)
        if (code->coordinate_state[c] >= 0)
            fprintf(out, "%s.acceleration,", code->coordinate[c].name);
    for (int b = first; b < code->body_count; ++b)
        for (int i = 0; i < 7; ++i)
            fprintf(out, "%s.%s,", code->body_name[b], part[i]);
    fputs("status\n", out);
    for (int t = 0; t < trials; ++t) {
        const double *rate = trial[t].number + attack->numbers, *pose = rate + attack->states;
        for (int i = 0; code->free_base && i < 6; ++i)
            fprintf(out, "%.17g,", rate[half + 1 + i]);
        for (int c = 0; c < code->coordinate_count; ++c)
            if (code->coordinate_state[c] >= 0)
                fprintf(out, "%.17g,", rate[code->coordinate_state[c] + half]);
        for (int i = 7 * first; i < 7 * code->body_count; ++i)
            fprintf(out, "%.17g,", pose[i]);
        fputs("0\n", out);
    }
}

/* Both lists in two files. */
static void write_files(Pool *pool, const Attack *attack, const char *path)
{
    const int trials = attack->worst.count + attack->unseen.count;
    Trial *trial = pool_alloc(pool, sizeof *trial * (size_t)(trials + 1));
    memcpy(trial, attack->worst.trial, sizeof *trial * (size_t)attack->worst.count);
    memcpy(trial + attack->worst.count, attack->unseen.trial, sizeof *trial * (size_t)attack->unseen.count);
    FILE *out[2] = {open_file(pool, path, ".states"), open_file(pool, path, ".results")};
    write_states(attack, trial, trials, out[0]);
    write_results(attack, trial, trials, out[1]);
    if (fclose(out[0]) | fclose(out[1])) {
        perror(path);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    const char *path = NULL, *out = NULL;
    double count = 0, seed = 0, kept = 0;
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
        else if (!strcmp(argv[i], "--keep"))
            kept = atof(value);
        else if (!strcmp(argv[i], "--recovery"))
            recovery = recovery_of(value);
        else if (!strcmp(argv[i], "-o"))
            out = value;
        else
            path = NULL, i = argc;
        ++i;
    }
    if (!path || !out || !(count >= 1 && count <= 1e8) || recovery == RECOVERIES) {
        fputs(usage, stderr);
        return 2;
    }
    Pool *pool = pool_new();
    const Model *model = model_read(pool, path);
    Attack attack = {.code = subject_open(pool, "tcc", model, recovery),
                     .other = subject_open(pool, "gic", model, recovery),
                     .chance = chance_new(seed)};
    attack.states = attack.code.engine->standard_count;
    attack.inputs = attack.code.code->input_count;
    attack.numbers = attack.states + attack.inputs;
    attack.whole = attack.numbers + attack.states + 7 * attack.code.code->body_count;
    attack.worst = list_new(pool, (int)kept, &attack);
    attack.unseen = list_new(pool, (int)kept / 2, &attack);
    attack.corner = pool_alloc(pool, sizeof(double) * (LEGS - 1) * (size_t)(attack.code.code->coordinate_count + 1));
    attack.left = instance_new(pool, attack.code.engine);
    attack.good[0] = instance_new(pool, attack.code.engine);
    attack.good[1] = instance_new(pool, attack.other.engine);
    double number[attack.whole];
    while ((double)attack.tried < count) {
        random_state(&attack, number);
        ++attack.tried;
        if (evaluate(&attack, &attack.code, attack.code.fresh, number) == GIC_OK)
            screen(&attack, (gic_head *[]){attack.code.fresh, attack.other.fresh}, number);
        else if (attack.refused++ % 20 == 0)
            walk(&attack, number);
    }
    write_files(pool, &attack, out);
    follow_all(&attack, pool);
    printf("%ld %ld %ld %ld %.2g %ld %ld %ld %ld %ld %ld\n", attack.tried, attack.taken, attack.refused, attack.doubted,
           attack.largest, attack.wrong, attack.lost, attack.leapt[0], attack.leapt[1], attack.blocked[0],
           attack.blocked[1]);
    engine_close(attack.code.engine);
    engine_close(attack.other.engine);
    pool_free(pool);
    return 0;
}
