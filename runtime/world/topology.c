/* SPDX-License-Identifier: MIT
 *
 * The matrix of equations.h, factored as U^T D U by blocks along the mechanism's graph (after Serban, Negrut, Haug and
 * Potra 1997). The bodies go first, which leaves Y Y^T on the constraints: two of them are coupled where they share a
 * body. They follow in the order of least fill, leaves of the graph first. The base goes last: most constraints touch
 * it, and it would couple all of them. That is safe, because turning and moving everything violates no constraint: the
 * columns of the base depend on the others', so that constraints are independent with it exactly when they are without.
 *
 * Y Y^T is positive definite when constraints are independent, so no pivot needs looking for, and a pivot that vanishes
 * tells which constraint repeats those before it. What fills in is known from the start; each body, each constraint
 * and the base has a panel that holds its columns in the rows that are not zero, and there is no other storage. */
#include "model/model.h"
#include "subset/subset.h"
#include "world/equations.h"
#include "world/topology.h"

#include <math.h>
#include <string.h>

/* A pivot below this part of its diagonal is lost: a constraint turned by 1e-6 from those before it. */
static const double LEAST_PIVOT = 1e-12;

/* Rows that stand together in two panels. */
typedef struct Run {
    int from, to, rows;
} Run;

/* What a panel takes from another one further on, `width` columns of it. */
typedef struct Target {
    int column;     /* first number of those columns */
    int stride;     /* from one of them to the next */
    int row, width; /* of the coefficients in this panel */
    int run, runs;
} Target;

/* Columns of a body, a constraint or the base, one after the other. Rows: the columns' own (none in a body's, whose
 * pivots are -1), those coupled with them, right-hand side. */
typedef struct Panel {
    int owner;
    int start, width, rows;
    int own;     /* own rows: width or 0 */
    int unknown; /* first of its own in the solution */
    int row;     /* first of its other rows, without the last, in `row_unknown` */
    int target, targets;
} Panel;

/* Where Y of one constraint and body goes. */
typedef struct Side {
    int body, rows, jacobian;
    int start, row_step, column_step;
    int gamma;
} Side;

typedef struct Topology {
    const Equations *equations;
    int panels, bodies; /* panels of bodies are the first */
    int sides, unknowns;
    size_t numbers, constraint_start; /* of all panels; where those of the bodies end */
    int *order;                       /* [constraints + 1] place of each constraint, then that of the base */
    bool *factor; /* [constraints + 1][constraints + 1] blocks of the factor in that order, b <= a */
    Panel *panel;
    Target *target;
    Run *run;
    Side *side;
    int *row_unknown;
    double *value;    /* [numbers] the panels */
    double *inverse;  /* [unknowns] of the pivots */
    double *solution; /* [unknowns] */
    double *gamma;    /* [rows] */
    Scaling *scaling; /* [bodies of the equations] */
} Topology;

/* ---- numbers ----------------------------------------------------------------------------------------------- */

/* Two neighbours, which every 64-bit machine that gcc or clang knows can treat as one. */
typedef double Pair __attribute__((vector_size(16)));

static inline Pair pair(const double *x)
{
    Pair both;
    memcpy(&both, x, sizeof both);
    return both;
}

static inline void pair_store(double *x, Pair both)
{
    memcpy(x, &both, sizeof both);
}

/* Take from the panels further on what the elimination of this one leaves. `width` is a constant where this is inlined.
 */
static inline __attribute__((always_inline)) void spread(const Topology *topology, const Panel *panel, const int width)
{
    const double *from = topology->value + panel->start, *inverse = topology->inverse + panel->unknown;
    const int rows = panel->rows;
    for (const Target *target = topology->target + panel->target, *end = target + panel->targets; target < end;
         ++target) {
        double *to = topology->value + target->column;
        const Run *run = topology->run + target->run, *last = run + target->runs;
        for (int column = 0; column < target->width; ++column, to += target->stride) {
            double factor[ROWS_MAX];
            for (int k = 0; k < width; ++k)
                factor[k] = from[k * rows + target->row + column] * inverse[k];
            /* the target's own rows come first, and above its diagonal nothing is needed */
            int i = column;
            for (const Run *r = run; r < last; ++r, i = 0) {
                const double *restrict a = from + r->from;
                double *restrict b = to + r->to;
                for (; i + 1 < r->rows; i += 2) {
                    Pair sum = factor[0] * pair(a + i);
                    for (int k = 1; k < width; ++k)
                        sum += factor[k] * pair(a + k * rows + i);
                    pair_store(b + i, pair(b + i) - sum);
                }
                for (; i < r->rows; ++i) {
                    double sum = factor[0] * a[i];
                    for (int k = 1; k < width; ++k)
                        sum += factor[k] * a[k * rows + i];
                    b[i] -= sum;
                }
            }
        }
    }
}

static void eliminate(const Topology *topology, const Panel *panel)
{
    switch (panel->width) {
    case 1: spread(topology, panel, 1); break;
    case 2: spread(topology, panel, 2); break;
    case 3: spread(topology, panel, 3); break;
    case 4: spread(topology, panel, 4); break;
    case 5: spread(topology, panel, 5); break;
    default: spread(topology, panel, 6); break;
    }
}

/* Factor a panel's own columns. Returns false when a pivot is below `least` of what it was before. */
static bool pivots(const Topology *topology, const Panel *panel, const double *before, double least)
{
    double *column = topology->value + panel->start, *inverse = topology->inverse + panel->unknown;
    const int rows = panel->rows;
    for (int k = 0; k < panel->width; ++k) {
        double *restrict b = column + k * rows;
        for (int j = 0; j < k; ++j) {
            const double *restrict a = column + j * rows;
            double coefficient = a[k] * inverse[j];
            int i = k;
            for (; i + 1 < rows; i += 2)
                pair_store(b + i, pair(b + i) - coefficient * pair(a + i));
            for (; i < rows; ++i)
                b[i] -= coefficient * a[i];
        }
        if (!(fabs(b[k]) > least * fabs(before[k])))
            return false;
        inverse[k] = 1 / b[k];
    }
    return true;
}

/* The unknowns of a panel, once those of its other rows are there. */
static void substitute(const Topology *topology, const Panel *panel)
{
    const int rows = panel->rows, others = rows - panel->own - 1;
    const int *unknown = topology->row_unknown + panel->row;
    const double *solution = topology->solution, *inverse = topology->inverse + panel->unknown;
    double *own = topology->solution + panel->unknown;
    for (int k = panel->width - 1; k >= 0; --k) {
        const double *column = topology->value + panel->start + k * rows, *other = column + panel->own;
        double sum = column[rows - 1];
        for (int i = 0; i < others; ++i)
            sum -= other[i] * solution[unknown[i]];
        for (int j = k + 1; j < panel->own; ++j)
            sum -= column[j] * own[j];
        own[k] = sum * inverse[k];
    }
}

/* Fill the panels. */
static void assemble(Topology *topology, const Numbers *numbers)
{
    const Equations *equations = topology->equations;
    memset(topology->value + topology->constraint_start, 0,
           (topology->numbers - topology->constraint_start) * sizeof(double));
    memcpy(topology->gamma, numbers->gamma, (size_t)equations->rows * sizeof(double));
    for (int i = 0; i < topology->panels; ++i) {
        const Panel *panel = &topology->panel[i];
        bool base = i == topology->panels - 1 && equations->free_base;
        if (i >= topology->bodies && !base)
            continue;
        double f[6], *last = topology->value + panel->start + panel->rows - 1;
        equations_body(equations, panel->owner, numbers, &topology->scaling[panel->owner], f);
        for (int k = 0; k < 6; ++k, last += panel->rows)
            *last = f[k];
        for (int k = 0; base && k < 6; ++k)
            topology->value[panel->start + k * (panel->rows + 1)] = -1;
    }
    for (const Side *side = topology->side, *end = side + topology->sides; side < end; ++side)
        equations_side(&topology->scaling[side->body], side->rows, numbers->jacobian + side->jacobian,
                       topology->value + side->start, side->row_step, side->column_step, topology->gamma + side->gamma);
    for (int i = topology->bodies; i < topology->bodies + equations->constraints; ++i) {
        const Panel *panel = &topology->panel[i];
        const double *gamma = topology->gamma + equations->first[panel->owner];
        double *last = topology->value + panel->start + panel->rows - 1;
        for (int k = 0; k < panel->width; ++k, last += panel->rows)
            *last = -gamma[k];
    }
}

/* The constraint that a panel belongs to, or the first one on the base. */
static int constraint_of(const Equations *equations, const Panel *panel, bool constraint)
{
    int found = constraint ? panel->owner : 0;
    while (!constraint && found + 1 < equations->constraints && equations->constraint[found].body[0] != BODY_BASE &&
           equations->constraint[found].body[1] != BODY_BASE)
        ++found;
    return found;
}

static int topology_solve(void *solver, const Numbers *numbers)
{
    Topology *topology = solver;
    const Equations *equations = topology->equations;
    const Panel *panel = topology->panel;
    assemble(topology, numbers);
    for (int i = 0; i < topology->bodies; ++i)
        eliminate(topology, &panel[i]);
    /* the diagonals of Y Y^T, before constraints are subtracted from each other */
    for (int i = topology->bodies; i < topology->panels; ++i)
        for (int k = 0; k < panel[i].width; ++k)
            topology->solution[panel[i].unknown + k] = topology->value[panel[i].start + k * (panel[i].rows + 1)];
    for (int i = topology->bodies; i < topology->panels; ++i) {
        if (!pivots(topology, &panel[i], topology->solution + panel[i].unknown, LEAST_PIVOT))
            return constraint_of(equations, &panel[i], i < topology->bodies + equations->constraints);
        eliminate(topology, &panel[i]);
    }
    for (int i = topology->panels - 1; i >= 0; --i)
        substitute(topology, &panel[i]);

    for (int i = 0; i < topology->panels; ++i) {
        const double *x = topology->solution + panel[i].unknown;
        if (i >= topology->bodies && i < topology->bodies + equations->constraints)
            memcpy(numbers->multiplier + equations->first[panel[i].owner], x, (size_t)panel[i].width * sizeof(double));
        else
            equations_acceleration(&topology->scaling[panel[i].owner], x, numbers->acceleration + 7 * panel[i].owner);
    }
    if (!equations->free_base)
        memset(numbers->acceleration, 0, 7 * sizeof(double));
    return -1;
}

/* ---- the mechanism: order and storage ------------------------------------------------------------------------- */

/* Which constraints share a body other than the base, [constraints + 1] squared; the last row and column are the base.
 */
static bool *couplings(Pool *pool, const Equations *equations)
{
    const Constraint *constraint = equations->constraint;
    const int n = equations->constraints, size = n + 1;
    bool *coupled = pool_alloc(pool, (size_t)size * (size_t)size * sizeof *coupled);
    for (int a = 0; a < n; ++a)
        for (int end = 0; end < 2; ++end) {
            int body = constraint[a].body[end];
            if (!equations_moves(equations, body))
                continue;
            if (body == BODY_BASE)
                coupled[a * size + n] = coupled[n * size + a] = true;
            for (int b = 0; b < n && body != BODY_BASE; ++b)
                if (b != a && (constraint[b].body[0] == body || constraint[b].body[1] == body))
                    coupled[a * size + b] = true;
        }
    return coupled;
}

/* Numbers that eliminating constraint `a` would fill in, and the rows that it is coupled with. */
static long fill_of(const Equations *equations, const bool *coupled, const bool *done, int a, long *rows)
{
    const int n = equations->constraints, size = n + 1;
    long fill = 0;
    *rows = 0;
    for (int b = 0; b <= n; ++b) {
        if (!coupled[a * size + b] || done[b])
            continue;
        long height = b < n ? equations->constraint[b].rows : 6;
        *rows += height;
        for (int c = 0; c < b; ++c)
            if (coupled[a * size + c] && !done[c] && !coupled[b * size + c])
                fill += height * equations->constraint[c].rows;
    }
    return fill;
}

/* Eliminate the constraints one by one, always the one that fills in least, of those the one coupled with the fewest
 * rows. Finds `order` and, in that order, `factor`. */
static void order_find(Pool *pool, Topology *topology)
{
    const Equations *equations = topology->equations;
    const int n = equations->constraints, size = n + 1;
    bool *coupled = couplings(pool, equations), *done = pool_alloc(pool, (size_t)size * sizeof *done);
    for (int place = 0; place < n; ++place) {
        long least = 0, least_rows = 0, rows;
        int chosen = -1;
        for (int a = 0; a < n; ++a) {
            if (done[a])
                continue;
            long fill = fill_of(equations, coupled, done, a, &rows);
            if (chosen < 0 || fill < least || (fill == least && rows < least_rows))
                chosen = a, least = fill, least_rows = rows;
        }
        done[chosen] = true;
        topology->order[chosen] = place;
        for (int b = 0; b <= n; ++b)
            for (int c = 0; c < b; ++c)
                if (!done[b] && !done[c] && coupled[chosen * size + b] && coupled[chosen * size + c])
                    coupled[b * size + c] = coupled[c * size + b] = true;
    }
    topology->order[n] = n;
    for (int a = 0; a <= n; ++a)
        for (int b = 0; b <= n; ++b)
            if (topology->order[b] <= topology->order[a])
                topology->factor[topology->order[a] * size + topology->order[b]] = a == b || coupled[a * size + b];
}

/* One panel after the other: a body's rows are its constraints', the others' are those that `factor` says. row: [panels
 * + 1] squared, where the rows of a panel (or, at the end, the right-hand side) begin in another panel; -1: not. */
static void panels_place(Pool *pool, Topology *topology, const int *by_order, int *row)
{
    const Equations *equations = topology->equations;
    const int n = equations->constraints, bodies = topology->bodies, all = topology->panels + 1;
    int start = 0, row_count = 0;
    for (int i = 0; i < topology->panels; ++i) {
        Panel *panel = &topology->panel[i];
        int place = i - bodies;
        bool constraint = place >= 0 && place < n;
        panel->width = constraint ? equations->constraint[by_order[place]].rows : 6;
        if (place >= 0)
            panel->owner = constraint ? by_order[place] : BODY_BASE;
        panel->own = place < 0 ? 0 : panel->width;
        panel->unknown = topology->unknowns;
        topology->unknowns += panel->width;
    }
    for (int i = 0; i < topology->panels; ++i) {
        Panel *panel = &topology->panel[i];
        int place = i - bodies;
        for (int k = 0; k < all; ++k)
            row[i * all + k] = -1;
        panel->row = row_count;
        for (int k = bodies; k < topology->panels; ++k) {
            int other = k - bodies;
            const int *body = other < n ? equations->constraint[by_order[other]].body : NULL;
            bool coupled = place < 0 ? body && (body[0] == panel->owner || body[1] == panel->owner)
                                     : other >= place && topology->factor[other * (n + 1) + place];
            if (!coupled)
                continue;
            row[i * all + k] = panel->rows;
            panel->rows += topology->panel[k].width;
            for (int j = 0; k != i && j < topology->panel[k].width; ++j)
                *POOL_PUSH(pool, topology->row_unknown, row_count) = topology->panel[k].unknown + j;
        }
        row[i * all + topology->panels] = panel->rows++;
        panel->start = start;
        start += panel->width * panel->rows;
        if (i == bodies - 1)
            topology->constraint_start = (size_t)start;
    }
    topology->numbers = (size_t)start;
}

/* What every panel spreads to which others. */
static void targets_place(Pool *pool, Topology *topology, const int *row)
{
    const int all = topology->panels + 1;
    int targets = 0, runs = 0;
    for (int i = 0; i < topology->panels; ++i) {
        Panel *panel = &topology->panel[i];
        panel->target = targets;
        for (int k = i + 1; k < topology->panels; ++k) {
            if (row[i * all + k] < 0)
                continue;
            const Panel *to = &topology->panel[k];
            int first = runs;
            for (int r = k; r < all; ++r) {
                int from = row[i * all + r], height = r < topology->panels ? topology->panel[r].width : 1;
                const Run *last = runs > first ? &topology->run[runs - 1] : NULL;
                if (from < 0)
                    continue;
                if (last && from == last->from + last->rows && row[k * all + r] == last->to + last->rows)
                    topology->run[runs - 1].rows += height;
                else
                    *POOL_PUSH(pool, topology->run, runs) = (Run){from, row[k * all + r], height};
            }
            *POOL_PUSH(pool, topology->target, targets) =
                (Target){to->start, to->rows, row[i * all + k], to->width, first, runs - first};
        }
        panel->targets = targets - panel->target;
    }
}

/* Where the blocks of Y go: into the body's columns, or for the base into its rows of the constraint's columns. */
static void sides_place(Pool *pool, Topology *topology, const int *body_panel, const int *row)
{
    const Equations *equations = topology->equations;
    const int all = topology->panels + 1;
    for (int i = 0; i < equations->constraints; ++i)
        for (int end = 0; end < 2; ++end) {
            const Constraint *constraint = &equations->constraint[i];
            int body = constraint->body[end], first = equations->first[i];
            if (!equations_moves(equations, body))
                continue;
            int own = topology->bodies + topology->order[i], other = body_panel[body];
            int from = body == BODY_BASE ? own : other, to = body == BODY_BASE ? other : own;
            int rows = topology->panel[from].rows;
            *POOL_PUSH(pool, topology->side, topology->sides) =
                (Side){.body = body,
                       .rows = constraint->rows,
                       .jacobian = 14 * first + 7 * end * constraint->rows,
                       .start = topology->panel[from].start + row[from * all + to],
                       .row_step = body == BODY_BASE ? rows : 1,
                       .column_step = body == BODY_BASE ? 1 : rows,
                       .gamma = first};
        }
}

static void *topology_open(Pool *pool, const Equations *equations)
{
    Topology *topology = pool_alloc(pool, sizeof *topology);
    const int n = equations->constraints;
    int *body_panel = pool_alloc(pool, (size_t)equations->bodies * sizeof(int));
    topology->equations = equations;
    topology->panel = pool_alloc(pool, (size_t)(n + equations->bodies + 1) * sizeof(Panel));
    for (int i = BODY_BASE + 1; i < equations->bodies; ++i) {
        body_panel[i] = topology->bodies;
        topology->panel[topology->bodies++].owner = i;
    }
    topology->panels = topology->bodies + n + equations->free_base;
    body_panel[BODY_BASE] = topology->bodies + n;

    topology->order = pool_alloc(pool, (size_t)(n + 1) * sizeof(int));
    topology->factor = pool_alloc(pool, (size_t)(n + 1) * (size_t)(n + 1) * sizeof(bool));
    order_find(pool, topology);
    int *by_order = pool_alloc(pool, (size_t)(n + 1) * sizeof(int));
    for (int i = 0; i < n; ++i)
        by_order[topology->order[i]] = i;

    int *row = pool_alloc(pool, (size_t)(topology->panels + 1) * (size_t)(topology->panels + 1) * sizeof(int));
    panels_place(pool, topology, by_order, row);
    targets_place(pool, topology, row);
    sides_place(pool, topology, body_panel, row);

    topology->value = pool_alloc(pool, topology->numbers * sizeof(double));
    topology->inverse = pool_alloc(pool, (size_t)topology->unknowns * sizeof(double));
    topology->solution = pool_alloc(pool, (size_t)topology->unknowns * sizeof(double));
    topology->gamma = pool_alloc(pool, (size_t)equations->rows * sizeof(double));
    topology->scaling = pool_alloc(pool, (size_t)equations->bodies * sizeof(Scaling));
    for (int i = 0; i < 6 * topology->bodies; ++i)
        topology->inverse[i] = -1;
    return topology;
}

static void topology_close(void *solver)
{
    (void)solver; /* all of it is the pool's */
}

const Solver topology_solver = {"topology", topology_open, topology_solve, topology_close};

void topology_pattern(const void *solver, int *order, bool *stored)
{
    const Topology *topology = solver;
    const int n = topology->equations->constraints;
    const Panel *panel = topology->panel + topology->bodies;
    for (int b = 0; b < n; ++b) {
        order[b] = topology->order[b];
        const int *unknown = topology->row_unknown + panel[b].row;
        int others = panel[b].rows - panel[b].own - 1;
        for (int a = 0; a < n; ++a) {
            stored[a * n + b] = a == b;
            for (int i = 0; i < others && a != b; ++i)
                stored[a * n + b] |= unknown[i] >= panel[a].unknown && unknown[i] < panel[a].unknown + panel[a].width;
        }
    }
}
