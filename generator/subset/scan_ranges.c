/* SPDX-License-Identifier: MIT
 * Finds the places in the coordinates' ranges where independence is lost. Each coordinate is moved alone from its
 * design value to both ends of its range; the place is where a determinant changes its sign or a subset can't be
 * followed. */
#include "base/message.h"
#include "base/text.h"
#include "expression/expression.h"
#include "model/model.h"
#include "sequence/redundant.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "subset/subset_private.h"

#include <math.h>
#include <string.h>

typedef struct Scan {
    Pool *pool;
    const Model *model;
    const Sequence *sequence;
    Work **work;
    const Sampling *sampling;
    int coordinate;
    double **q;          /* [subsets] poses of its bodies at the last good value */
    double (*pose)[12];  /* [bodies] c, A of all bodies at the present value */
    double *determinant; /* [subsets] scaled, at the design */
    double *least;       /* [subsets] share of that below which generated code refuses the subset */
    double near;         /* smallest determinant at the present value, relative to the design */
} Scan;

/* Length of a direction's part perpendicular to the axis of its angle, below which generated code refuses it. */
static const double lost_below = 8e-3;

static bool depends(const Subset *subset, int coordinate)
{
    for (int j = 0; j < subset->deps; ++j)
        if (subset->dep[j] == coordinate)
            return true;
    return false;
}

/* Recover one subset with the scanned coordinate at `value`, starting from q, which is updated. False: it is lost. */
static bool scan_subset(Scan *scan, int s, double value, double *q)
{
    const Subset *subset = &scan->sequence->subset[s];
    Work *w = scan->work[subset->class];
    int sample = subset_index(w, s) * w->configurations;
    for (int j = 0; j < subset->deps; ++j) {
        int dep = subset->dep[j];
        ex_set_sample(w->dag, w->x[j], sample, dep == scan->coordinate ? value : scan->model->coordinate[dep].design);
    }
    for (int i = 0; i < subset->knowns; ++i)
        subset_set_known(w, i, sample, scan->pose[subset->known[i]]);
    if (!subset_converge(w, q, sample, NULL))
        return false;
    subset_get_poses(w, subset, sample, scan->pose);
    for (int r = 0; r < w->n; ++r)
        if (w->connection[w->row_of[r]].measure >= 0 && w->row[r].guard &&
            !(ex_value(w->dag, w->row[r].guard, sample) > lost_below))
            return false; /* the direction that defines the angle is along its axis */
    const double share = subset_determinant(w, sample) / scan->determinant[s];
    scan->near = fmin(scan->near, share);
    return share > scan->least[s];
}

/* Recover all subsets that depend on the coordinate, at `value`; q is updated if all succeed. Returns the lost one, or
 * -1. */
static int scan_value(Scan *scan, double value)
{
    const Sequence *sequence = scan->sequence;
    double *moved[sequence->subsets];
    scan->near = 1;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        moved[s] = NULL;
        if (subset->class < 0 || !depends(subset, scan->coordinate))
            continue;
        size_t size = (size_t)(7 * subset->bodies) * sizeof(double);
        moved[s] = pool_grow(scan->pool, scan->q[s], size, size);
        if (!scan_subset(scan, s, value, moved[s]))
            return s;
    }
    for (int s = 0; s < sequence->subsets; ++s)
        if (moved[s])
            scan->q[s] = moved[s];
    return -1;
}

/* Return every subset that depends on the coordinate to the design. */
static void reset(Scan *scan)
{
    for (int b = 0; b < scan->model->bodies; ++b)
        memcpy(scan->pose[b], sampling_pose(scan->sampling, 0, 0, b), sizeof scan->pose[b]);
    for (int s = 0; s < scan->sequence->subsets; ++s) {
        const Subset *subset = &scan->sequence->subset[s];
        if (subset->class < 0 || !depends(subset, scan->coordinate))
            continue;
        Work *w = scan->work[subset->class];
        int sample = subset_index(w, s) * w->configurations;
        scan->q[s] = pool_alloc(scan->pool, (size_t)(7 * subset->bodies) * sizeof(double));
        subset_to_design(w, scan->sampling, s, scan->q[s]);
        scan->determinant[s] = subset_determinant(w, sample);
        scan->least[s] = subset_singular_share(w, sample);
    }
}

/* An entry for a coordinate that continues where this one turns back; NULL: none is found. */
static const char *instead(const Scan *scan, int lost, double value, bool *always)
{
    const Model *model = scan->model;
    const Sequence *sequence = scan->sequence;
    bool body[model->bodies + 1], edge[model->joints + model->coordinates + 1], wanted[sequence->subsets];
    memset(body, 0, sizeof body);
    memset(edge, 0, sizeof edge);
    memset(wanted, 0, sizeof wanted);
    wanted[lost] = true;
    for (int s = lost; s >= 0; --s) { /* with the earlier subsets that it depends on */
        const Subset *subset = &sequence->subset[s];
        if (!wanted[s] || subset->class < 0)
            continue;
        for (int i = 0; i < subset->knowns; ++i)
            wanted[sequence->body_subset[subset->known[i]]] = true;
        for (int i = 0; i < subset->bodies; ++i)
            body[subset->body[i]] = true;
        for (int i = 0; i < subset->joints; ++i)
            edge[subset->joint[i]] = true;
        for (int i = 0; i < subset->coordinates; ++i)
            edge[model->joints + subset->coordinate[i]] = true;
    }
    return relax_instead(scan->pool, model, body, edge, scan->coordinate, value, always);
}

static void warn(const Scan *scan, int lost, double value)
{
    const Coordinate *c = &scan->model->coordinate[scan->coordinate];
    const Subset *subset = &scan->sequence->subset[lost];
    Text bodies = {.pool = scan->pool};
    for (int b = 0; b < subset->bodies; ++b)
        text_print(&bodies, "%s'%s'", b ? ", " : "", scan->model->body[subset->body[b]].name);
    bool always;
    const char *other = instead(scan, lost, value, &always), *remedy = "end the range before that value";
    if (other)
        remedy = pool_print(scan->pool, "%s, or make '%s' a coordinate that %s: %s", remedy, c->name,
                            always ? "never turns back" : "does not turn back there", other);
    diag_warn(c->at, remedy,
              "coordinate '%s' stops being independent at %.6g, inside its range [%g, %g]: beyond it the pose of %s is "
              "no longer "
              "determined (the other coordinates at their design values)",
              c->name, value, c->range[0], c->range[1], bodies.s);
}

/* Scan towards one end of the range, in steps that shrink where a subset is lost: the loss is real if the smallest step
 * does not pass it. Steps are short where determinants are small, since these are angles that a step must not skip. */
static void scan_end(Scan *scan, double end)
{
    const int steps_least = 8, steps_most = 400;
    const double turn = 0.1;   /* largest rotation of a body in one step, or move relative to the subset's size */
    const double least = 1e-7; /* smallest step, as a share of the way */
    const double shrink = 2, least_step = 0.01;
    const Coordinate *c = &scan->model->coordinate[scan->coordinate];
    double way = end - c->design, wanted = fabs(way) * scan->sampling->swing[scan->coordinate] / turn;
    int steps = wanted < steps_least ? steps_least : wanted > steps_most ? steps_most : (int)wanted;
    double usual = 1.0 / steps, step = usual, share = 0;
    reset(scan);
    while (share < 1) {
        double next = share + step < 1 ? share + step : 1;
        int lost = scan_value(scan, c->design + way * next);
        if (lost < 0) {
            share = next;
            step = fmin(2 * step, usual * fmax(least_step, fmin(1, shrink * scan->near)));
        } else if ((step /= 2) < least) {
            warn(scan, lost, c->design + way * share);
            return;
        }
    }
}

void subsets_scan(Pool *pool, const Model *model, const Sequence *sequence, Work **work, const Sampling *sampling)
{
    size_t subsets = (size_t)sequence->subsets + 1;
    Scan scan = {.pool = pool,
                 .model = model,
                 .sequence = sequence,
                 .work = work,
                 .sampling = sampling,
                 .q = pool_alloc(pool, subsets * sizeof *scan.q),
                 .pose = pool_alloc(pool, (size_t)model->bodies * sizeof *scan.pose),
                 .determinant = pool_alloc(pool, subsets * sizeof *scan.determinant),
                 .least = pool_alloc(pool, subsets * sizeof *scan.least)};
    for (scan.coordinate = 0; scan.coordinate < model->coordinates; ++scan.coordinate) {
        for (int end = 0; end < 2; ++end)
            scan_end(&scan, model->coordinate[scan.coordinate].range[end]);
        reset(&scan); /* leave the samples at the design */
    }
}
