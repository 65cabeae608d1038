/* SPDX-License-Identifier: MIT
 * Curves that a run of a study leaves: kinematics over travel and steering, channels of trials. */
#include "run/kc.h"
#include "run/kc_joints.h"
#include "run/manoeuvre.h"
#include "sweep/study.h"

#include <math.h>

enum { MOST_ROWS = 300 /* of a curve */, TRIALS = 2 /* of a manoeuvre: usually left and right */ };

static StudyCurve *add(Pool *pool, StudyRun *run, int who, const char *group, const char *key, const char *title,
                       const char *unit, const char *below, int rows)
{
    StudyCurve *curve = POOL_PUSH(pool, run->curve, run->curves);
    *curve = (StudyCurve){.group = pool_print(pool, "%s", group),
                          .key = pool_print(pool, "%s", key),
                          .who = who,
                          .title = pool_print(pool, "%s", title),
                          .unit = pool_print(pool, "%s", unit),
                          .below = pool_print(pool, "%s", below),
                          .rows = rows,
                          .x = pool_alloc(pool, ((size_t)rows + 1) * sizeof *curve->x),
                          .y = pool_alloc(pool, ((size_t)rows + 1) * sizeof *curve->y)};
    return curve;
}

/* A curve without any value is none. */
static void drop_empty(StudyRun *run)
{
    const StudyCurve *curve = &run->curve[run->curves - 1];
    for (int r = 0; r < curve->rows; ++r)
        if (isfinite(curve->y[r]))
            return;
    --run->curves;
}

/* The first left wheel of an axle, or its first one. */
static int left_of(const KcAxle *axle)
{
    for (int i = 0; i < axle->wheels; ++i)
        if (axle->wheel[i].side > 0)
            return i;
    return 0;
}

static void add_motion(Pool *pool, const KcStudy *study, int a, const KcCurve *of, int who, StudyRun *run)
{
    const KcAxle *axle = &study->kc->axle[a];
    const int left = left_of(axle);
    double by, scale;
    const char *below = kc_abscissa(pool, study->kc, axle, of->motion, &by);
    const char *group = pool_print(pool, "%s: %s", axle->name, kc_motion_title[of->motion]);
    for (int q = 0; q < KC_OF_WHEEL; ++q) {
        if (!kc_is_drawn(q, of->motion))
            continue;
        StudyCurve *curve = add(pool, run, who, group, kc_of_wheel[q].name,
                                pool_print(pool, "%s, %s", kc_of_wheel[q].title, axle->wheel[left].name),
                                kc_of_wheel[q].shown, below, of->rows);
        for (int r = 0; r < of->rows; ++r) {
            curve->x[r] = of->row[r].at * by;
            curve->y[r] = of->row[r].wheel[left][q] * kc_of_wheel[q].scale;
        }
        drop_empty(run);
    }
    for (int q = 0; q < KC_OF_AXLE; ++q) {
        const char *unit = kc_shown_unit(study->kc, axle, q, &scale);
        StudyCurve *curve = add(pool, run, who, group, kc_of_axle[q].name, kc_of_axle[q].title, unit, below, of->rows);
        for (int r = 0; r < of->rows; ++r) {
            curve->x[r] = of->row[r].at * by;
            curve->y[r] = of->row[r].axle[q] * scale;
        }
        drop_empty(run);
    }
}

void study_curves_kc(Pool *pool, const KcStudy *study, int who, StudyRun *run)
{
    for (int a = 0; a < study->kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            if (study->curve[a][m])
                add_motion(pool, study, a, study->curve[a][m], who, run);
}

/* A group a motion and load. */
static void add_carried(Pool *pool, const KcStudy *study, const KcCarrying *carrying, int a, KcMotion m, int drawn,
                        int who, StudyRun *run)
{
    const KcCurve *of = study->curve[a][m];
    const char *name, *load, *unit;
    double by, *y = pool_alloc(study->kc->pool, ((size_t)of->rows + 1) * sizeof *y);
    const char *below = kc_abscissa(pool, study->kc, &study->kc->axle[a], m, &by);
    for (int j = 0; (name = kc_carrying_curve(carrying, a, m, drawn, j, y, &load, &unit)); ++j) {
        if (!isfinite(y[of->zero]))
            continue;
        const char *group = pool_print(pool, "%s: %s, by %s", study->kc->axle[a].name, kc_motion_title[m], load);
        StudyCurve *curve = add(pool, run, who, group, name, name, unit, below, of->rows);
        for (int r = 0; r < of->rows; ++r) {
            curve->x[r] = of->row[r].at * by;
            curve->y[r] = y[r];
        }
    }
}

void study_curves_joints(Pool *pool, const KcStudy *study, const KcCarrying *carrying, int who, StudyRun *run)
{
    for (int a = 0; a < study->kc->axles; ++a)
        for (KcMotion m = 0; m < KC_MOTIONS; ++m)
            for (int drawn = 0; study->curve[a][m] && drawn < KC_CASES_DRAWN; ++drawn)
                add_carried(pool, study, carrying, a, m, drawn, who, run);
}

void study_curves_manoeuvre(Pool *pool, const Manoeuvre *m, int who, StudyRun *run)
{
    for (int k = 0; k < m->tables; ++k) {
        const ManoeuvreTable *table = &m->table[k];
        StudyCurve *curve =
            add(pool, run, who, "Over all", table->title, table->title, table->unit, table->below, table->rows);
        for (int r = 0; r < table->rows; ++r) {
            curve->x[r] = table->x[r];
            curve->y[r] = table->y[r];
        }
    }
    for (int t = 0; t < m->trials && t < TRIALS; ++t)
        for (int k = 0; k < m->curves; ++k) {
            const Trial *trial = m->trial[t];
            const Channel x = m->curve[k].x, y = m->curve[k].y;
            const int every = trial->rows / MOST_ROWS + 1;
            double by, scale;
            const char *unit = manoeuvre_shown(y, &scale), *below = manoeuvre_shown(x, &by);
            StudyCurve *curve =
                add(pool, run, who, trial->name,
                    pool_print(pool, "%s over %s", trial_signal[y].name, trial_signal[x].name), trial_signal[y].name,
                    unit, pool_print(pool, "%s, %s", trial_signal[x].name, below), (trial->rows + every - 1) / every);
            for (int r = 0; r < curve->rows; ++r) {
                curve->x[r] = trial->row[r * every][x] * by;
                curve->y[r] = trial->row[r * every][y] * scale;
            }
        }
}
