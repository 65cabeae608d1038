/* SPDX-License-Identifier: MIT
 * quad_linear DUMP STATES [--matrices FILE] [--modes FILE] [--road ...] [--friction ...] [--tolerance 1e-9]
 *
 * Small motions about the states of a file, by central differences in quadruple precision of the independent solution:
 * a difference of 1e-13 in quad is exact to some 1e-14 also where a tire's slip of 1e-6 matters, so that what is
 * compared is exact to double precision.
 * --matrices: what `linearized` printed for the same states. --modes: what `gicrun --modes -o` wrote, about the first
 * state, eigenvalue by eigenvalue; a zero there is one of less than 1e-4 1/s here, where multiple zeros scatter.
 * Entries of a matrix are compared relative to the largest of their row, eigenvalues relative to their own size. Exit
 * status 1 unless all agree, and half of the states could be compared. */
#include "reference/row.h"
#include "reference/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>

static const char usage[] = "usage: quad_linear DUMP STATES [--matrices FILE] [--modes FILE] [--road ...] [--friction "
                            "...] [--tolerance 1e-9]\n";

/* Numbers of small motions: x y z, rotations about the base's axes, free coordinates; then their rates, those of a free
 * base in its own axes; then fast states, of the wheels one after the other, and the speed of an engine. */
typedef struct Motions {
    const Model *model;
    Solver *solver;
    const State *state; /* the one that they are about */
    State *moved;
    const Road *road;
    int base, places, fast; /* 6 or 0; half of all but the last; fast states */
    int *wheel, *kind;      /* [fast]: a wheel and its state; -1: the engine's speed */
    quad *rate[2];          /* of the motions, on either side */
    quad *A;
} Motions;

/* Free coordinate number i. */
static int coordinate_at(const Motions *m, int i)
{
    for (int c = 0; c < m->model->coordinates; ++c)
        if (!m->model->coordinate[c].driven && i-- == 0)
            return c;
    return -1;
}

static int count_of(const Motions *m)
{
    return 2 * m->places + m->fast;
}

/* Fast state number i in a state. */
static quad *fast_at(const Motions *m, State *state, int i)
{
    if (m->wheel[i] >= 0)
        return &state->fast[m->wheel[i]][m->kind[i]];
    return &state->line.speed;
}

/* And its rate, as the solver has it. */
static quad fast_rate(const Motions *m, int i)
{
    static const int rate[FAST_STATES] = {SPIN_RATE, SLIP_X_RATE, SLIP_Y_RATE, WINDUP_RATE};
    if (m->wheel[i] >= 0)
        return m->solver->wheel[m->wheel[i]].value[rate[m->kind[i]]];
    return m->solver->line.value[SPEED_RATE];
}

/* m->moved: the state with number j displaced by h. */
static void displace(const Motions *m, int j, quad h)
{
    const State *from = m->state;
    State *to = m->moved;
    const size_t coordinates = (size_t)m->model->coordinates * sizeof(quad);
    quad z[12] = {0}, turn[4], u[3];
    memcpy(to->w, from->w, coordinates);
    memcpy(to->w_rate, from->w_rate, coordinates);
    memcpy(to->w_second, from->w_second, coordinates);
    memcpy(to->fast, from->fast, (size_t)m->model->wheels * sizeof *to->fast);
    memcpy(to->r, from->r, sizeof to->r);
    memcpy(to->omega, from->omega, sizeof to->omega);
    memcpy(to->fast, from->fast, (size_t)m->model->wheels * sizeof *to->fast);
    to->line = from->line;
    const int place = j % m->places;
    if (j >= 2 * m->places) {
        *fast_at(m, to, j - 2 * m->places) += h;
    } else if (place >= m->base) {
        (j < m->places ? to->w : to->w_rate)[coordinate_at(m, place - m->base)] += h;
    } else {
        z[j < m->places ? place : 6 + place] = h;
    }
    if (!m->base)
        return;
    /* to second order in h, which a central difference doesn't see */
    quad p[4] = {1, z[3] / 2, z[4] / 2, z[5] / 2}, dr[3];
    quad norm = 1 + quad_dot(p + 1, p + 1, 3);
    for (int i = 0; i < 4; ++i)
        p[i] *= 1 - (norm - 1) / 2;
    euler_product(from->e, p, turn);
    memcpy(to->e, turn, sizeof turn);
    rotate(from->e, z, dr);
    rotate_back(from->e, from->v, u);
    for (int i = 0; i < 3; ++i) {
        to->r[i] += dr[i];
        u[i] += z[6 + i];
        to->omega[i] += z[9 + i];
    }
    rotate(to->e, u, to->v);
}

/* Rate of the motions where m->moved is, seen from the base as the state has it moving on. */
static bool evaluate(Motions *m, quad *rate)
{
    Solver *solver = m->solver;
    const State *y = m->moved, *from = m->state;
    if (!solve_positions(solver, y))
        return false;
    solve_velocities(solver, y);
    if (!solve_accelerations(solver, y, m->road))
        return false;
    for (int i = m->base; i < m->places; ++i) {
        rate[i] = y->w_rate[coordinate_at(m, i - m->base)];
        rate[m->places + i] = solver->w_second[coordinate_at(m, i - m->base)];
    }
    for (int i = 0; i < m->fast; ++i)
        rate[2 * m->places + i] = fast_rate(m, i);
    if (!m->base)
        return true;
    quad away[3], rho[3], dv[3], c[3], u[3], a[3], world[3], omega[3];
    for (int i = 0; i < 3; ++i) {
        away[i] = y->r[i] - from->r[i];
        dv[i] = y->v[i] - from->v[i];
    }
    rotate_back(from->e, away, rho);
    rotate_back(from->e, dv, rate);
    quad_cross(from->omega, rho, c);
    for (int i = 0; i < 3; ++i)
        rate[i] -= c[i];
    /* angular velocity relative to the frame that turns as the state does, which is that in the moved axes */
    rotate(from->e, from->omega, world);
    rotate_back(y->e, world, omega);
    for (int i = 0; i < 3; ++i)
        rate[3 + i] = y->omega[i] - omega[i];
    rotate_back(y->e, y->v, u);
    rotate_back(y->e, solver->a, a);
    quad_cross(y->omega, u, c);
    for (int i = 0; i < 3; ++i) {
        rate[m->places + i] = a[i] - c[i];
        rate[m->places + 3 + i] = solver->alpha[i];
    }
    return true;
}

static bool differentiate(Motions *m)
{
    const quad h = 1e-13;
    const int count = count_of(m);
    for (int j = 0; j < count; ++j) {
        for (int side = 0; side < 2; ++side) {
            displace(m, j, side ? -h : h);
            if (!evaluate(m, m->rate[side]))
                return false;
        }
        for (int i = 0; i < count; ++i)
            m->A[i * count + j] = (m->rate[0][i] - m->rate[1][i]) / (2 * h);
    }
    return true;
}

/* Largest deviation of the lines of a matrix from `line` on, relative to the rows' largest entries. */
static double matrix_deviation(const Motions *m, const Table *table, int line)
{
    const int count = count_of(m);
    double worst = 0;
    for (int i = 0; i < count; ++i) {
        double scale = 0, error = 0;
        for (int j = 0; j < count; ++j) {
            scale = fmax(scale, fabs((double)m->A[i * count + j]));
            error = fmax(error, fabs((double)(table_number(table, line + i, j + 1) - m->A[i * count + j])));
        }
        worst = fmax(worst, error / fmax(scale, 1));
    }
    return worst;
}

/* The first line of a row's matrix, -1: it has none. */
static int line_of(const Table *table, int row)
{
    for (int line = 0; line < table->rows; ++line)
        if ((int)table_number(table, line, 0) == row + 1)
            return line;
    return -1;
}

/* Every eigenvalue takes the nearest one of the table; the largest deviation. */
static double modes_deviation(const Motions *m, const Table *table)
{
    const size_t count = (size_t)count_of(m);
    gsl_matrix *A = gsl_matrix_alloc(count, count);
    gsl_vector_complex *value = gsl_vector_complex_alloc(count);
    gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(count);
    for (size_t i = 0; i < count * count; ++i)
        gsl_matrix_set(A, i / count, i % count, (double)m->A[i]);
    gsl_eigen_nonsymm_params(0, 1, work);
    gsl_eigen_nonsymm(A, value, work);
    size_t expected = 0;
    double worst = 0;
    for (int row = 0; row < table->rows; ++row) {
        const double real = table_number(table, row, 0), imaginary = table_number(table, row, 1);
        expected += imaginary > 0 ? 2 : 1;
        size_t best = 0;
        double least = INFINITY;
        for (size_t i = 0; i < count; ++i) {
            const gsl_complex z = gsl_vector_complex_get(value, i);
            const double away = hypot(GSL_REAL(z) - real, GSL_IMAG(z) - imaginary);
            if (away < least) {
                least = away;
                best = i;
            }
        }
        gsl_vector_complex_set(value, best, gsl_complex_rect(INFINITY, 0)); /* taken */
        const double size = hypot(real, imaginary);
        worst = fmax(worst, size > 0 ? least / size : least < 1e-4 ? 0 : INFINITY);
    }
    gsl_eigen_nonsymm_free(work);
    gsl_vector_complex_free(value);
    gsl_matrix_free(A);
    return expected == count ? worst : INFINITY;
}

static void name_fast(Motions *m)
{
    const Model *model = m->model;
    m->wheel = grab((size_t)(FAST_STATES * model->wheels + 2), sizeof(int));
    m->kind = grab((size_t)(FAST_STATES * model->wheels + 2), sizeof(int));
    for (int w = 0; w < model->wheels; ++w)
        for (int k = 0; k < FAST_STATES; ++k)
            if (wheel_has(&model->wheel[w], k)) {
                m->wheel[m->fast] = w;
                m->kind[m->fast++] = k;
            }
    if (model->powertrain)
        m->wheel[m->fast++] = -1;
}

static Motions motions_new(const Model *model, const Road *road)
{
    Motions m = {.model = model, .solver = solver_new(model), .moved = state_new(model), .road = road};
    m.places = m.base = model->free_base ? 6 : 0;
    for (int c = 0; c < model->coordinates; ++c)
        m.places += !model->coordinate[c].driven;
    name_fast(&m);
    const size_t count = (size_t)count_of(&m);
    for (int side = 0; side < 2; ++side)
        m.rate[side] = grab(count, sizeof(quad));
    m.A = grab(count * count, sizeof(quad));
    return m;
}

int main(int argc, char **argv)
{
    const char *path[2] = {NULL}, *matrices = NULL, *modes = NULL;
    double tolerance = 1e-9;
    int paths = 0;
    Road road = {0};
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--matrices") && i + 1 < argc)
            matrices = argv[++i];
        else if (!strcmp(argv[i], "--modes") && i + 1 < argc)
            modes = argv[++i];
        else if (!strcmp(argv[i], "--road") && i + 1 < argc)
            road_parse(argv[++i], &road);
        else if (!strcmp(argv[i], "--friction") && i + 1 < argc)
            friction_parse(argv[++i], &road);
        else if (!strcmp(argv[i], "--tolerance") && i + 1 < argc)
            tolerance = number_of(argv[++i], "--tolerance");
        else if (argv[i][0] != '-' && paths < 2)
            path[paths++] = argv[i];
        else
            paths = 3;
    }
    if (paths != 2 || !(matrices || modes)) {
        fputs(usage, stderr);
        return 2;
    }
    Model *model = model_read(path[0]);
    Table *table = table_read(path[1]), *matrix = matrices ? table_read(matrices) : NULL;
    Table *mode = modes ? table_read(modes) : NULL;
    Motions m = motions_new(model, &road);
    State *state = state_new(model);
    m.state = state;
    int compared = 0, failed = 0;
    for (int row = 0; row < (modes ? 1 : table->rows); ++row) {
        const int line = matrix ? line_of(matrix, row) : -1;
        state_read(model, table, row, state);
        if (model->free_base)
            recover_largest(state->e);
        if ((matrix && line < 0) || !differentiate(&m))
            continue;
        const double deviation = matrix ? matrix_deviation(&m, matrix, line) : 0;
        const double off = mode ? modes_deviation(&m, mode) : 0;
        ++compared;
        failed += !(deviation <= tolerance) || !(off <= tolerance);
        printf("row %d:", row + 1);
        if (matrix)
            printf(" matrix %.2e", deviation);
        if (mode)
            printf(" eigenvalues %.2e", off);
        printf("\n");
    }
    printf("%d compared, %d failed\n", compared, failed);
    return failed || 2 * compared < (modes ? 1 : table->rows);
}
