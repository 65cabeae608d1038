/* SPDX-License-Identifier: MIT
 * Four posts: the vehicle stands, and the road under its wheels is raised and lowered. Responses to posts that move
 * together and against each other, by sweeps and by the linear model; ride on a random road that passes under it. */
#include "base/vec3.h"
#include "gic_runtime.h"
#include "run/engines.h"
#include "run/manoeuvre.h"
#include "scene/scene.h"
#include "tape/engine_tape.h"

#include <math.h>
#include <string.h>

static const double pi = 3.141592653589793;
static const double begin = 4, rest = 4; /* s at rest before a sweep and after it */
static const double first = 0.5;         /* Hz, where it begins; it ends 15 % above the highest that is asked for */
static const double above = 1.15;
static const double sweep = 40;        /* s */
static const double near = 4, far = 8; /* s around where a frequency passes that count whole, beyond which none do */
static const double table[] = {1, 2, 5, 10, 15, 20};  /* Hz in the table */
enum { BESIDE = 1, CURVE = 60 };                      /* lines of the spectrum to each side; points of a curve */
enum { SPEED, CLASS, DURATION, SEED, AMPLITUDE, TO }; /* keys */
enum { ROLL = 3, PITCH = 4 };                         /* small motions */

/* ---- what the posts do ---------------------------------------------------------------------------------- */

/* Which posts go up (1), down (-1) or stay (0), [wheels]; and what is looked at, by the height of a post. */
typedef struct PostMotion {
    const char *name, *title;
    Channel channel;
    const char *what, *unit;
    double *sign;
} PostMotion;

enum { MOTIONS = 4 };
static const PostMotion motion_kind[MOTIONS] = {
    {"heave", "All posts together", TRIAL_AZ, "vertical acceleration by that of the posts", "1", NULL},
    {"pitch", "Front posts against rear ones", TRIAL_PITCH, "pitch by the height", "rad/m", NULL},
    {"roll", "Left posts against right ones", TRIAL_ROLL, "roll by the height", "rad/m", NULL},
    {"warp", "Posts of each axle against each other, front and rear the other way", TRIAL_ROLL, "roll by the height",
     "rad/m", NULL}};

/* The centre of a wheel as the model is drawn. */
static void centre_of(const Model *model, int wheel, double at[3])
{
    const Body *body = &model->body[model->wheel[wheel].body];
    double A[9];
    mat_from_euler(body->euler, A);
    apply3(A, model->wheel[wheel].center, at);
    add_scaled3(1, body->position, at);
}

static double sign_of(double x)
{
    static const double middle = 0.01; /* m */
    return fabs(x) < middle ? 0 : x > 0 ? 1 : -1;
}

/* False: no post would move against another one. */
static bool find_signs(const Model *model, Pool *pool, int kind, PostMotion *motion)
{
    double mean = 0, at[3];
    const double middle = kc_middle_of(model);
    int up = 0, down = 0;
    *motion = motion_kind[kind];
    motion->sign = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof *motion->sign);
    for (int w = 0; w < model->wheels; ++w) {
        centre_of(model, w, at);
        mean += at[0] / model->wheels;
    }
    for (int w = 0; w < model->wheels; ++w) {
        centre_of(model, w, at);
        const double ahead = sign_of(at[0] - mean), left = sign_of(at[1] - middle);
        motion->sign[w] = (const double[MOTIONS]){1, ahead, left, ahead * left}[kind];
        up += motion->sign[w] > 0;
        down += motion->sign[w] < 0;
    }
    return up && (down || kind == 0);
}

/* A scene in which the vehicle stands on posts. A powertrain may creep, against which the brake is pressed. */
static const char *standing(TestCar *car, double duration, const char *posts)
{
    const Model *model = car->model;
    const char *held = model->powertrain && car->brake >= 0 ? "inputs: {brake: 1}\n" : "";
    return car_scene(car, duration, 0, false, pool_print(car->pool, "%sposts:\n%s", held, posts));
}

static const char *sweeping(Manoeuvre *m, const PostMotion *motion)
{
    const Model *model = m->car->model;
    Text posts = {.pool = m->pool};
    for (int w = 0; w < model->wheels; ++w)
        if (motion->sign[w] != 0)
            text_print(&posts,
                       "  %s: {chirp: {amplitude: %.17g, from: %g, to: %.9g, duration: %g, growth: logarithmic, "
                       "start: %g}}\n",
                       model->wheel[w].name, motion->sign[w] * m->value[AMPLITUDE], first, above * m->value[TO], sweep,
                       begin);
        else
            text_print(&posts, "  %s: 0\n", model->wheel[w].name);
    return standing(m->car, begin + sweep + rest, posts.s);
}

/* A random road that passes under the wheels, each as late as it is behind. */
static const char *passing(Manoeuvre *m)
{
    const Model *model = m->car->model;
    const double speed = m->value[SPEED], duration = m->value[DURATION] + ride_run_in;
    const double middle = kc_middle_of(model);
    double ahead = -INFINITY, wide = 0, at[3];
    Text posts = {.pool = m->pool};
    for (int w = 0; w < model->wheels; ++w) {
        centre_of(model, w, at);
        ahead = fmax(ahead, at[0]);
        wide = fmax(wide, fabs(at[1] - middle));
    }
    for (int w = 0; w < model->wheels; ++w) {
        centre_of(model, w, at);
        text_print(&posts,
                   "  %s: {road: {type: iso8608, class: %c, length: %.9g, seed: %.0f, start: 10, track: %.9g}, "
                   "x: %.9g, y: %.9g, speed: %.17g}\n",
                   model->wheel[w].name, 'A' + (int)m->value[CLASS] - 1, ceil(speed * (duration + 2) + 20),
                   m->value[SEED], wide > 0 ? 2 * wide : 1.5, at[0] - ahead, at[1] - middle, speed);
    }
    return standing(m->car, duration, posts.s);
}

/* ---- responses by the sweep ----------------------------------------------------------------------------- */

/* Numbers that are followed: 0 the height of posts that go up, 1 the channel, then loads of wheels. */
static double number_of(const Trial *trial, const PostMotion *motion, int wheels, int row, int number)
{
    const double *of = trial->wheel + row * wheels * TRIAL_OF_WHEEL;
    if (number == 1)
        return trial->row[row][motion->channel];
    if (number > 1)
        return of[(number - 2) * TRIAL_OF_WHEEL + TRIAL_WHEEL_LOAD];
    int w = 0;
    while (motion->sign[w] <= 0)
        ++w;
    return of[w * TRIAL_OF_WHEEL + TRIAL_WHEEL_ROAD];
}

/* When the sweep has a frequency, s. */
static double passes(const Manoeuvre *m, double frequency)
{
    return begin + sweep * log(frequency / first) / log(above * m->value[TO] / first);
}

/* The weight of a time about when a frequency passes: a vehicle that settles meanwhile, as one does on its brakes, is
 * elsewhere at the end, which would count at all frequencies. Tapers are half periods of a cosine. */
static double weight_at(double t, double at)
{
    const double last = fmin(far, begin + sweep + rest - at), away = fabs(t - at), ends = t < at ? far : last;
    return away <= near ? 1 : away >= ends ? 0 : 0.5 + 0.5 * cos(pi * (away - near) / (ends - near));
}

/* H = sum X* Y / sum X* X over lines 1 / T beside a frequency, T the length of the record; [wheels + 2]. */
static void by_sweep(const Manoeuvre *m, const PostMotion *motion, const Trial *trial, const double *still,
                     double frequency, Response *out)
{
    const int wheels = m->car->model->wheels, numbers = wheels + 2;
    double yy[numbers], xy[numbers][2], sum[numbers][2];
    memset(yy, 0, sizeof yy);
    memset(xy, 0, sizeof xy);
    for (int k = -BESIDE; k <= BESIDE; ++k) {
        const double omega = 2 * pi * (frequency + k / (sweep + rest));
        memset(sum, 0, sizeof sum);
        for (int i = 0; i < trial->rows; ++i) {
            const double t = trial->row[i][TRIAL_TIME], weight = weight_at(t, passes(m, frequency));
            if (weight == 0)
                continue;
            const double c = cos(omega * t), s = sin(omega * t);
            for (int n = 0; n < numbers; ++n) {
                const double y = weight * (number_of(trial, motion, wheels, i, n) - still[n]);
                sum[n][0] += y * c;
                sum[n][1] -= y * s;
            }
        }
        for (int n = 0; n < numbers; ++n) {
            yy[n] += sum[n][0] * sum[n][0] + sum[n][1] * sum[n][1];
            xy[n][0] += sum[0][0] * sum[n][0] + sum[0][1] * sum[n][1];
            xy[n][1] += sum[0][0] * sum[n][1] - sum[0][1] * sum[n][0];
        }
    }
    for (int n = 0; n < numbers; ++n) {
        const double size = hypot(xy[n][0], xy[n][1]);
        out[n] = (Response){size / yy[0], atan2(xy[n][1], xy[n][0]), size * size / (yy[0] * yy[n])};
    }
}

/* ---- responses by the linear model ---------------------------------------------------------------------- */

/* dz/dt = A z + B0 u + B1 u', loads C z + D0 u + D1 u', about rest on the posts. */
typedef struct Stand {
    const Linear *linear;
    int n, wheels;
    double *A, *C;          /* [n][n], [wheels][n] */
    double *B[2], *D[2];    /* of one motion: [n], [wheels]; by height and its rate */
    double **column, **out; /* [2 wheels] of a post's height, then of its rate: of dz/dt and of loads */
    double up[3], com[3];   /* the world's z axis and the centre of mass in the base's axes */
    double *work, *rhs;
} Stand;

/* NULL: the vehicle has no linear model there. */
static const Stand *stand_of(TestCar *car, const Model *posted, const Scene *scene)
{
    Pool *pool = car->pool;
    const Equilibrium *found = equilibrium_find(pool, posted, scene, car->request->solve);
    const Linear *linear = found->linear;
    const gic_model *code = found->engine->code;
    const int n = linear->count, wheels = posted->wheels, outputs = equilibrium_wheel(found, wheels - 1) + 1;
    const size_t size = (size_t)n * sizeof(double);
    Stand *s = pool_alloc(pool, sizeof *s);
    double *f = pool_alloc(pool, size), *load = pool_alloc(pool, ((size_t)outputs + 1) * sizeof *load), A[9];
    *s = (Stand){
        .linear = linear,
        .n = n,
        .wheels = wheels,
        .A = pool_alloc(pool, (size_t)n * size),
        .C = pool_alloc(pool, (size_t)wheels * size),
        .B = {pool_alloc(pool, size), pool_alloc(pool, size)},
        .D = {pool_alloc(pool, (size_t)wheels * sizeof(double)), pool_alloc(pool, (size_t)wheels * sizeof(double))},
        .column = pool_alloc(pool, 2 * (size_t)wheels * sizeof(double *)),
        .out = pool_alloc(pool, 2 * (size_t)wheels * sizeof(double *)),
        .work = pool_alloc(pool, 4 * (size_t)n * size),
        .rhs = pool_alloc(pool, 2 * size)};
    copy3(car->com, s->com);
    mat_from_euler(tape_array(found->self, code->state_offset) + 3, A);
    copy3(A + 6, s->up);
    bool jump;
    int status = linear_start(linear, found->self, f);
    for (int j = 0; j < n && status == GIC_OK; ++j) {
        double column[n + 1];
        status = linear_column(linear, found->self, LINEAR_MOTION, j, column, outputs, load, &jump);
        for (int i = 0; i < n; ++i)
            s->A[i * n + j] = column[i];
        for (int w = 0; w < wheels; ++w)
            s->C[w * n + j] = load[equilibrium_wheel(found, w)];
    }
    for (int k = 0; k < 2 * wheels && status == GIC_OK; ++k) {
        s->column[k] = pool_alloc(pool, size);
        s->out[k] = pool_alloc(pool, (size_t)wheels * sizeof(double));
        status = linear_column(linear, found->self, LINEAR_INPUT, posted->wheel[k / 2].post - 1 + k % 2, s->column[k],
                               outputs, load, &jump);
        for (int w = 0; w < wheels; ++w)
            s->out[k][w] = load[equilibrium_wheel(found, w)];
    }
    return status == GIC_OK && gic_finite(s->A, n * n) ? s : NULL;
}

/* The columns of a motion of the posts. */
static void stand_move(const Stand *s, const PostMotion *motion)
{
    for (int k = 0; k < 2; ++k) {
        memset(s->B[k], 0, (size_t)s->n * sizeof(double));
        memset(s->D[k], 0, (size_t)s->wheels * sizeof(double));
        for (int w = 0; w < s->wheels; ++w) {
            for (int i = 0; i < s->n; ++i)
                s->B[k][i] += motion->sign[w] * s->column[2 * w + k][i];
            for (int i = 0; i < s->wheels; ++i)
                s->D[k][i] += motion->sign[w] * s->out[2 * w + k][i];
        }
    }
}

/* The upward velocity of the centre of mass. */
static double rises(const Stand *s, const double *z)
{
    const double *v = z + s->linear->places;
    double swing[3];
    cross3(v + ROLL, s->com, swing);
    return dot3(s->up, v) + dot3(s->up, swing);
}

static Response response(double re, double im)
{
    return (Response){hypot(re, im), atan2(im, re), 1};
}

/* The responses of by_sweep() after the first. False: at its own frequency. */
static bool by_model(const Stand *s, const PostMotion *motion, double frequency, Response *out)
{
    const int n = s->n;
    const double omega = 2 * pi * frequency, *re = s->rhs, *im = s->rhs + n;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const double a = -s->A[i * n + j], turn = i == j ? omega : 0;
            s->work[i * 2 * n + j] = s->work[(n + i) * 2 * n + n + j] = a;
            s->work[i * 2 * n + n + j] = -turn;
            s->work[(n + i) * 2 * n + j] = turn;
        }
        s->rhs[i] = s->B[0][i];
        s->rhs[n + i] = omega * s->B[1][i];
    }
    if (!kc_solve(2 * n, s->work, s->rhs) || !gic_finite(s->rhs, 2 * n))
        return false;
    if (motion->channel == TRIAL_AZ)
        out[1] = response(-omega * rises(s, im), omega * rises(s, re));
    else {
        const int place = motion->channel == TRIAL_PITCH ? PITCH : ROLL;
        out[1] = response(re[place], im[place]);
    }
    for (int w = 0; w < s->wheels; ++w) {
        double load[2] = {s->D[0][w], omega * s->D[1][w]};
        for (int j = 0; j < n; ++j) {
            load[0] += s->C[w * n + j] * re[j];
            load[1] += s->C[w * n + j] * im[j];
        }
        out[2 + w] = response(load[0], load[1]);
    }
    return true;
}

/* ---- the table and the page ----------------------------------------------------------------------------- */

/* By the acceleration of posts in place of their height. */
static void by_acceleration(const PostMotion *motion, double frequency, Response *r)
{
    const double omega = 2 * pi * frequency;
    if (motion->channel != TRIAL_AZ)
        return;
    r->gain /= omega * omega;
    r->phase = remainder(r->phase - pi, 2 * pi);
}

static void both(Manoeuvre *m, const Stand *stand, const PostMotion *motion, const Trial *trial, const double *still,
                 double frequency, Response *run, Response *model)
{
    by_sweep(m, motion, trial, still, frequency, run);
    if (!stand || !by_model(stand, motion, frequency, model))
        for (int n = 0; n < m->car->model->wheels + 2; ++n)
            model[n] = (Response){NAN, NAN, NAN};
    by_acceleration(motion, frequency, &run[1]);
    by_acceleration(motion, frequency, &model[1]);
}

static void add(Manoeuvre *m, const char *section, const char *at, const char *what, const char *unit, double value)
{
    if (!isnan(value))
        sheet_add(m->result, section, at, what, unit, value);
}

static void add_rows(Manoeuvre *m, const Stand *stand, const PostMotion *motion, const Trial *trial,
                     const double *still)
{
    const Model *model = m->car->model;
    Response run[model->wheels + 2], linear[model->wheels + 2];
    for (size_t i = 0; i < sizeof table / sizeof *table && table[i] <= m->value[TO]; ++i) {
        const double f = table[i];
        const char *at = pool_print(m->pool, "%s.%s.at_%g", motion->name, trial_signal[motion->channel].name, f);
        both(m, stand, motion, trial, still, f, run, linear);
        add(m, i ? NULL : motion->title, pool_print(m->pool, "%s.gain", at),
            pool_print(m->pool, "Gain at %g Hz, %s", f, motion->what), motion->unit, run[1].gain);
        add(m, NULL, pool_print(m->pool, "%s.phase", at), "Phase", "rad", run[1].phase);
        add(m, NULL, pool_print(m->pool, "%s.coherence", at), "Coherence", "1", run[1].coherence);
        add(m, NULL, pool_print(m->pool, "%s.linear.gain", at), "Gain by the linear model", motion->unit,
            linear[1].gain);
        add(m, NULL, pool_print(m->pool, "%s.linear.phase", at), "Phase by the linear model", "rad", linear[1].phase);
        for (int w = 0; w < model->wheels; ++w) {
            const char *of = pool_print(m->pool, "%s.%s.load.at_%g", motion->name, model->wheel[w].name, f);
            add(m, NULL, pool_print(m->pool, "%s.gain", of),
                pool_print(m->pool, "Load of %s by the height", model->wheel[w].name), "N/m", run[2 + w].gain);
            add(m, NULL, pool_print(m->pool, "%s.linear.gain", of), "By the linear model", "N/m", linear[2 + w].gain);
        }
    }
}

/* Gains over the frequency, by the sweep and beside it by the linear model. */
static void add_curves(Manoeuvre *m, const Stand *stand, const PostMotion *motion, const Trial *trial,
                       const double *still)
{
    const Model *model = m->car->model;
    const int numbers = model->wheels + 2;
    Response run[numbers], linear[numbers];
    double *x = pool_alloc(m->pool, CURVE * sizeof *x);
    double *y = pool_alloc(m->pool, 2 * CURVE * (size_t)numbers * sizeof *y);
    for (int i = 0; i < CURVE; ++i) {
        x[i] = table[0] * pow(m->value[TO] / table[0], (double)i / (CURVE - 1));
        both(m, stand, motion, trial, still, x[i], run, linear);
        for (int n = 1; n < numbers; ++n) {
            y[2 * CURVE * n + i] = run[n].gain;
            y[2 * CURVE * n + CURVE + i] = linear[n].gain;
        }
    }
    for (int n = 1; n < numbers; ++n)
        *POOL_PUSH(m->pool, m->table, m->tables) = (ManoeuvreTable){
            n == 1 ? pool_print(m->pool, "%s: %s", motion->title, motion->what)
                   : pool_print(m->pool, "%s: load of %s by the height", motion->title, model->wheel[n - 2].name),
            n == 1 ? motion->unit : "N/m",
            "frequency, Hz",
            CURVE,
            2,
            x,
            y + 2 * CURVE * n};
}

static void add_motion(Manoeuvre *m, const Stand *stand, const PostMotion *motion)
{
    TestCar *car = m->car;
    const int wheels = car->model->wheels;
    double still[wheels + 2];
    const Trial *trial = trial_run(car, motion->name, sweeping(m, motion), NULL, NULL);
    manoeuvre_whole(m, trial, "does it stand by itself? a smaller amplitude, amplitude=0.0005, moves it less");
    manoeuvre_keep(m, trial);
    for (int n = 0; n < wheels + 2; ++n) {
        int count = 0;
        still[n] = 0;
        for (int i = 0; i < trial->rows; ++i)
            if (trial->row[i][TRIAL_TIME] >= begin - 1 && trial->row[i][TRIAL_TIME] <= begin) {
                still[n] += number_of(trial, motion, wheels, i, n);
                ++count;
            }
        still[n] /= count;
    }
    for (int i = 0; i < trial->rows; ++i)
        if (trial->row[i][TRIAL_LOAD] <= 0) {
            sheet_note(m->result, pool_print(m->pool, "%s: a wheel leaves its post at t = %.4g s", motion->name,
                                             trial->row[i][TRIAL_TIME]));
            break;
        }
    if (stand)
        stand_move(stand, motion);
    add_rows(m, stand, motion, trial, still);
    add_curves(m, stand, motion, trial, still);
}

void manoeuvre_posts(Manoeuvre *m)
{
    static const Channel over[] = {TRIAL_AZ, TRIAL_ROLL, TRIAL_PITCH, TRIAL_LOAD};
    TestCar *car = m->car;
    PostMotion motion;
    car->output_step = ride_sampling;
    find_signs(car->model, m->pool, 0, &motion);
    const Scene *scene;
    const Model *posted = car_stand_on_posts(car, sweeping(m, &motion), &scene);
    const Stand *stand = stand_of(car, posted, scene);
    if (!stand)
        sheet_note(m->result, "there is no linear model of the vehicle at rest");
    for (int k = 0; k < MOTIONS; ++k)
        if (find_signs(car->model, m->pool, k, &motion))
            add_motion(m, stand, &motion);
        else
            sheet_note(m->result, pool_print(m->pool, "%s: the vehicle has no wheels on both sides", motion.name));
    const Trial *trial = trial_run(car, "road", passing(m), NULL, NULL);
    manoeuvre_whole(m, trial, "a smoother road, class=1, or a lower speed");
    manoeuvre_keep(m, trial);
    manoeuvre_ride_numbers(m, trial);
    manoeuvre_draw(m, sizeof over / sizeof *over, over);
}
