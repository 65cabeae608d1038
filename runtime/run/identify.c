/* SPDX-License-Identifier: MIT
 * Parameters from measurements: least squares over the outputs that were measured, each in units of its noise, by the
 * method of Levenberg and Marquardt with the exact derivatives of the run. The noise of an output is not known: the
 * first fit takes the spread of what was measured, and further ones what the last left. */
#include "run/identify.h"
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "gic_runtime.h"
#include "host/gsl_errors.h"
#include "host/host.h"
#include "model/limits.h"
#include "run/condition_output.h"
#include "run/fit_page.h"
#include "run/number_place.h"
#include "run/tangent_run.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>

enum { ROUNDS = 4, MOST_STEPS = 100 };

static const double likelihood = 0.95; /* of the intervals */

/* A fit under way. */
typedef struct Fit {
    Pool *pool;
    const Model *model;
    const Scene *scene; /* with the numbers that are tried */
    Scene *running;     /* as a run has it, whose conditions change inputs */
    const CsvTable *table;
    TangentRun *run;
    const RunVariable *variable;
    int variables, columns; /* columns: that were measured */
    int time, *column, *output;
    int64_t *step; /* [rows] of the run at which a row was measured */
    double *noise; /* [columns] */
    bool *counts;  /* [columns] what is looked for changes it, where the fit begins */
    double *taken; /* [columns] degrees of freedom that the variables took of its measurements */
    double *share; /* [columns][variables] of a variable's variance that is due to its noise */
    double *unit;  /* [variables] */
    double *value; /* [outputs], and their derivatives [outputs][variables] */
    double *slope;
    double *rest, *jacobian; /* [rows][columns] model less measured, and [rows][columns][variables] */
    int status;              /* of the last run */
} Fit;

/* ---- what was measured ---------------------------------------------------------------------------------- */

static int output_named(const Model *model, const char *name, const char **unit)
{
    for (int i = 0, at = 0; i < model->outputs; at += model->output[i++].count)
        for (int k = 0; k < model->output[i].count; ++k)
            if (!model->output[i].hidden && !strcmp(model->output[i].component[k], name)) {
                *unit = model->output[i].unit[k];
                return at + k;
            }
    return -1;
}

static void find_columns(Fit *fit)
{
    const CsvTable *table = fit->table;
    fit->time = -1;
    for (int c = 0; c < table->columns; ++c) {
        const char *unit = "s";
        const bool time = !strcmp(table->name[c], "time");
        const int output = time ? 0 : output_named(fit->model, table->name[c], &unit);
        if (output < 0)
            diag_fail(csv_name_place(table, c), "name the columns as those of results: time [s], chassis.z [m]",
                      "the model has no output '%s'", table->name[c]);
        csv_check_unit(fit->pool, table, c, unit);
        if (time) {
            fit->time = c;
            continue;
        }
        int same = fit->columns;
        *POOL_PUSH(fit->pool, fit->column, same) = c;
        *POOL_PUSH(fit->pool, fit->output, fit->columns) = output;
    }
    if (fit->time < 0 || fit->columns == 0)
        diag_fail((Place){table->source, 1, 1}, "begin with a line like: time [s],chassis.z [m]",
                  "measurements need a column `time` and one of an output at least");
    if (fit->columns * table->rows <= fit->variables)
        diag_fail((Place){table->source, 1, 1}, "measure more, or look for less",
                  "%d measurements do not tell %d numbers and their noise", fit->columns * table->rows, fit->variables);
}

static double measured(const Fit *fit, int row, int column)
{
    return fit->table->value[row * fit->table->columns + column];
}

/* Times have to be those of steps. */
static void find_steps(Fit *fit)
{
    const double near = 1e-6; /* of a step */
    const double h = fit->scene->step, end = (double)fit->scene->outputs * (double)fit->scene->per_output;
    fit->step = pool_alloc(fit->pool, ((size_t)fit->table->rows + 1) * sizeof *fit->step);
    for (int r = 0; r < fit->table->rows; ++r) {
        const double t = measured(fit, r, fit->time), k = round(t / h);
        if (!(fabs(t / h - k) <= near) || k < 0 || k > end)
            diag_fail(csv_place(fit->table, r), "choose a `step` of which all times are multiples, and the `duration`",
                      "%.9g s is the end of no step of the scene, which are %.9g s long, up to %.9g s", t, h, h * end);
        fit->step[r] = (int64_t)k;
        if (r > 0 && fit->step[r] <= fit->step[r - 1])
            diag_fail(csv_place(fit->table, r), "sort the lines by time", "%.9g s does not follow %.9g s", t,
                      measured(fit, r - 1, fit->time));
    }
}

/* The spread of what was measured, as long as the noise is not known. */
static void guess_noise(Fit *fit)
{
    for (int c = 0; c < fit->columns; ++c) {
        double mean = 0, square = 0;
        for (int r = 0; r < fit->table->rows; ++r)
            mean += measured(fit, r, fit->column[c]) / fit->table->rows;
        for (int r = 0; r < fit->table->rows; ++r)
            square += pow(measured(fit, r, fit->column[c]) - mean, 2) / fit->table->rows;
        fit->noise[c] = square > 0 ? sqrt(square) : mean != 0 ? fabs(mean) : 1;
    }
}

/* ---- runs ----------------------------------------------------------------------------------------------- */

/* Outputs less what was measured, and their derivatives, with the scene's present numbers. Returns a status. */
static int run_through(Fit *fit)
{
    int status = tangent_begin(fit->run, scene_renewed(fit->scene, fit->running));
    int64_t step = 0;
    for (int r = 0; r < fit->table->rows && status == GIC_OK; ++r) {
        for (; step < fit->step[r] && status == GIC_OK; ++step)
            status = tangent_step(fit->run);
        if (status == GIC_OK)
            status = tangent_look(fit->run, fit->value, fit->slope);
        for (int c = 0; c < fit->columns && status == GIC_OK; ++c) {
            const int at = r * fit->columns + c;
            fit->rest[at] = fit->value[fit->output[c]] - measured(fit, r, fit->column[c]);
            memcpy(fit->jacobian + (size_t)at * (size_t)fit->variables, fit->slope + fit->output[c] * fit->variables,
                   (size_t)fit->variables * sizeof(double));
        }
    }
    return status;
}

/* Run with the numbers x, in their units. */
static int run_with(Fit *fit, const gsl_vector *x)
{
    for (int k = 0; k < fit->variables; ++k)
        *number_place(fit->model, fit->scene, &fit->variable[k]) = gsl_vector_get(x, (size_t)k) * fit->unit[k];
    BrokenLimit broken;
    if (limit_broken(fit->model, fit->scene->parameter, &broken))
        return fit->status = GIC_ERROR_GEOMETRY;
    return fit->status = run_through(fit);
}

/* What is left of a measurement, in units of its noise. */
static double weighed(const Fit *fit, size_t measurement)
{
    return fit->rest[measurement] / fit->noise[measurement % (size_t)fit->columns];
}

/* A run that is not possible is far from all that was measured. Columns that nothing moves are left out: they would
 * hide by how much a step brings the others nearer. */
static int residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    const double far = 1e30;
    Fit *fit = context;
    const int status = run_with(fit, x);
    for (size_t i = 0; i < f->size; ++i)
        gsl_vector_set(f, i, status != GIC_OK ? far : fit->counts[i % (size_t)fit->columns] ? weighed(fit, i) : 0);
    return GSL_SUCCESS;
}

static int derivatives(const gsl_vector *x, void *context, gsl_matrix *J)
{
    Fit *fit = context;
    if (run_with(fit, x) != GIC_OK)
        return GSL_EFAILED;
    for (size_t i = 0; i < J->size1; ++i)
        for (size_t k = 0; k < J->size2; ++k)
            gsl_matrix_set(J, i, k,
                           fit->jacobian[i * J->size2 + k] * fit->unit[k] / fit->noise[i % (size_t)fit->columns]);
    return GSL_SUCCESS;
}

/* Which columns follow what is looked for, by the derivatives of the last run. */
static void find_counting(Fit *fit)
{
    const int n = fit->variables;
    for (int c = 0; c < fit->columns; ++c) {
        fit->counts[c] = false;
        for (int r = 0; r < fit->table->rows && !fit->counts[c]; ++r)
            for (int k = 0; k < n; ++k)
                fit->counts[c] = fit->counts[c] || fit->jacobian[(r * fit->columns + c) * n + k] != 0;
    }
}

static int counting(const Fit *fit)
{
    int columns = 0;
    for (int c = 0; c < fit->columns; ++c)
        columns += fit->counts[c];
    return columns;
}

/* How much of each column the variables took, and what its noise has to do with each of them: by the derivatives J and
 * the covariance C = (J^T J)^-1, both in units of noise, measurement i takes J_i C J_i^T degrees of freedom, and adds
 * (C J_i^T)_k^2 to the variance of variable k. */
static void share_out(Fit *fit, const gsl_matrix *J, const gsl_matrix *C)
{
    const size_t n = J->size2, columns = (size_t)fit->columns;
    memset(fit->taken, 0, columns * sizeof(double));
    memset(fit->share, 0, columns * n * sizeof(double));
    for (size_t i = 0; i < J->size1; ++i)
        for (size_t k = 0; k < n; ++k) {
            double change = 0;
            for (size_t j = 0; j < n; ++j)
                change += gsl_matrix_get(C, k, j) * gsl_matrix_get(J, i, j);
            fit->taken[i % columns] += gsl_matrix_get(J, i, k) * change;
            fit->share[i % columns * n + k] += change * change / gsl_matrix_get(C, k, k);
        }
}

/* Degrees of freedom by which the noise of a column is known. Where the variables take all of them but rounding, hardly
 * any: an interval that is wide, not one that is no number. */
static double column_freedom(const Fit *fit, int column)
{
    return fmax(fit->table->rows - fit->taken[column], 0.1);
}

/* Degrees of freedom of the deviation of a variable, after Welch and Satterthwaite: its variance is a sum of columns'
 * variances, each known by its own. With one column, measurements less variables. */
static double freedom(const Fit *fit, size_t variable)
{
    double sum = 0;
    for (int c = 0; c < fit->columns; ++c)
        sum += pow(fit->share[(size_t)c * (size_t)fit->variables + variable], 2) / column_freedom(fit, c);
    return 1 / sum;
}

/* The noise of each output, of what is left, less what the variables took of it. */
static void find_noise(Fit *fit)
{
    const double rounding = 1e-13;
    for (int c = 0; c < fit->columns; ++c) {
        double sum = 0, most = 0;
        for (int r = 0; r < fit->table->rows; ++r) {
            sum += pow(fit->rest[r * fit->columns + c], 2);
            most = fmax(most, fabs(measured(fit, r, fit->column[c])));
        }
        fit->noise[c] = fmax(sqrt(sum / column_freedom(fit, c)), rounding * most);
        if (fit->noise[c] == 0)
            fit->noise[c] = rounding;
    }
}

/* False where measurements do not tell variables apart: a combination of them changes nothing. *most: the one with the
 * largest share in it. */
static bool is_told(const gsl_matrix *J, size_t *most)
{
    const double least = 1e-9; /* singular value of columns of length 1 */
    const size_t n = J->size2;
    gsl_matrix *U = gsl_matrix_alloc(J->size1, n), *V = gsl_matrix_alloc(n, n);
    gsl_vector *S = gsl_vector_alloc(n);
    *most = 0;
    gsl_matrix_memcpy(U, J);
    for (size_t k = 0; k < n; ++k) {
        double square = 0;
        for (size_t i = 0; i < J->size1; ++i)
            square += pow(gsl_matrix_get(J, i, k), 2);
        for (size_t i = 0; i < J->size1 && square > 0; ++i)
            gsl_matrix_set(U, i, k, gsl_matrix_get(J, i, k) / sqrt(square));
    }
    gsl_linalg_SV_decomp_jacobi(U, V, S);
    for (size_t k = 0; k < n; ++k)
        if (fabs(gsl_matrix_get(V, k, n - 1)) > fabs(gsl_matrix_get(V, *most, n - 1)))
            *most = k;
    const bool told = gsl_vector_get(S, n - 1) > least * gsl_vector_get(S, 0);
    gsl_vector_free(S);
    gsl_matrix_free(V);
    gsl_matrix_free(U);
    return told;
}

/* ---- the fit -------------------------------------------------------------------------------------------- */

/* True if the step that is left to the least sum of squares is small beside the deviations, or is rounding. */
static bool is_there(const gsl_multifit_nlinear_workspace *work, const gsl_matrix *covariance)
{
    const double share = 1e-3, rounding = 1e-8;
    const gsl_matrix *J = gsl_multifit_nlinear_jac(work);
    const gsl_vector *f = gsl_multifit_nlinear_residual(work), *x = gsl_multifit_nlinear_position(work);
    for (size_t k = 0; k < x->size; ++k) {
        double step = 0;
        for (size_t j = 0; j < x->size; ++j)
            for (size_t i = 0; i < f->size; ++i)
                step += gsl_matrix_get(covariance, k, j) * gsl_matrix_get(J, i, j) * gsl_vector_get(f, i);
        if (!(fabs(step) <=
              fmax(share * sqrt(gsl_matrix_get(covariance, k, k)), rounding * (1 + fabs(gsl_vector_get(x, k))))))
            return false;
    }
    return true;
}

/* How a fit ends. */
typedef enum End { FOUND, NO_RUN, UNTOLD, FEW, LOST } End;

/* From the present numbers x; *x and the covariance, in units. *untold: a variable that measurements do not tell. */
static End fit_once(Fit *fit, gsl_vector *x, gsl_matrix *covariance, size_t *untold)
{
    const double small = 1e-10;
    const size_t rows = (size_t)(fit->table->rows * fit->columns), n = (size_t)fit->variables;
    gsl_multifit_nlinear_fdf problem = {.f = residuals, .df = derivatives, .n = rows, .p = n, .params = fit};
    const gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_workspace *work = gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, rows, n);
    int why = 0;
    gsl_multifit_nlinear_init(x, &problem, work);
    bool there = fit->status == GIC_OK, told = true;
    if (there) {
        gsl_multifit_nlinear_driver(MOST_STEPS, small, small, 0, NULL, NULL, &why, work);
        gsl_vector_memcpy(x, gsl_multifit_nlinear_position(work));
        told = is_told(gsl_multifit_nlinear_jac(work), untold);
        gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work), 0, covariance);
        share_out(fit, gsl_multifit_nlinear_jac(work), covariance);
        there = is_there(work, covariance);
    }
    gsl_multifit_nlinear_free(work);
    return !told ? UNTOLD : there ? FOUND : fit->status != GIC_OK ? NO_RUN : LOST;
}

static Fit open(Pool *pool, const Model *from, const Scene *scene, const Request *request)
{
    if (request->keys == 0)
        diag_fail_call(program_place(), "parameter/NAME, for one, after the scene",
                       "identification needs names of what is looked for");
    if (scene->equilibrium)
        diag_fail((Place){scene->source, 0, 0}, "give its places, which gicrun --equilibrium prints",
                  "a start in equilibrium follows parameters, and --identify holds the start");
    condition_no_end(scene, "--identify");
    Model *model = pool_alloc(pool, sizeof *model);
    *model = *from;
    model = condition_outputs(pool, model, scene);
    Fit fit = {.pool = pool,
               .model = model,
               .scene = scene_with_numbers(pool, model, scene),
               .running = scene_with_numbers(pool, model, scene)};
    fit.table = csv_read(pool, request->measured, "time [s],chassis.z [m]", NULL);
    fit.run = tangent_open(pool, model, fit.scene, request->solve, request->key, request->keys);
    fit.variables = tangent_variables(fit.run, &fit.variable);
    number_places_check(model, fit.scene, fit.variable, fit.variables, "identification");
    find_columns(&fit);
    find_steps(&fit);
    const size_t outputs = (size_t)model->output_components + 1, n = (size_t)fit.variables;
    const size_t cells = (size_t)(fit.table->rows * fit.columns);
    fit.noise = pool_alloc(pool, ((size_t)fit.columns + 1) * sizeof(double));
    fit.counts = pool_alloc(pool, ((size_t)fit.columns + 1) * sizeof(bool));
    fit.taken = pool_alloc(pool, ((size_t)fit.columns + 1) * sizeof(double));
    fit.share = pool_alloc(pool, ((size_t)fit.columns + 1) * (n + 1) * sizeof(double));
    fit.unit = pool_alloc(pool, (n + 1) * sizeof(double));
    fit.value = pool_alloc(pool, outputs * sizeof(double));
    fit.slope = pool_alloc(pool, outputs * (n + 1) * sizeof(double));
    fit.rest = pool_alloc(pool, (cells + 1) * sizeof(double));
    fit.jacobian = pool_alloc(pool, (cells + 1) * (n + 1) * sizeof(double));
    for (int k = 0; k < fit.variables; ++k)
        fit.unit[k] = fit.variable[k].value != 0 ? fabs(fit.variable[k].value) : 1;
    guess_noise(&fit);
    return fit;
}

/* ---- results -------------------------------------------------------------------------------------------- */

/* A number that was found. */
typedef struct Found {
    double value, deviation, low, high;
} Found;

static void write_csv(const Fit *fit, const Found *found, const char *path)
{
    static const char *const column[] = {"variable", "unit", "start", "value", "deviation", "low", "high"};
    interrupt_hold();
    Csv csv = csv_open(fit->pool, path);
    for (size_t i = 0; i < sizeof column / sizeof *column; ++i)
        csv_name(&csv, column[i], NULL);
    csv_end_row(&csv);
    for (int k = 0; k < fit->variables; ++k) {
        csv_name(&csv, fit->variable[k].name, NULL);
        csv_name(&csv, fit->variable[k].unit, NULL);
        csv_number(&csv, fit->variable[k].value);
        csv_number(&csv, found[k].value);
        csv_number(&csv, found[k].deviation);
        csv_number(&csv, found[k].low);
        csv_number(&csv, found[k].high);
        csv_end_row(&csv);
    }
    csv_close(&csv);
    interrupt_release();
}

/* What was done, one line. */
static const char *summary(const Fit *fit)
{
    return pool_print(fit->pool, "%d numbers from %d measurements, intervals of %g %%", fit->variables,
                      fit->table->rows * fit->columns, 100 * likelihood);
}

/* A diagram of each output that was measured. */
static void write_page(const Fit *fit, const Found *found, const char *path)
{
    Pool *pool = fit->pool;
    const int rows = fit->table->rows;
    FitPage page = {.name = fit->model->name,
                    .number = summary(fit),
                    .curve = {"found", "measured"},
                    .panels = fit->columns,
                    .column = {"start", "value", "deviation", "low", "high"},
                    .variables = fit->variables,
                    .variable = fit->variable};
    Panel *panel = pool_alloc(pool, (size_t)fit->columns * sizeof *panel);
    double *cell = pool_alloc(pool, FIT_COLUMNS * (size_t)fit->variables * sizeof *cell);
    double *time = pool_alloc(pool, (size_t)rows * sizeof *time);
    page.panel = panel;
    page.cell = cell;
    for (int r = 0; r < rows; ++r)
        time[r] = measured(fit, r, fit->time);
    for (int c = 0; c < fit->columns; ++c) {
        double *y = pool_alloc(pool, 2 * (size_t)rows * sizeof *y);
        const char *unit = fit->table->unit[fit->column[c]];
        for (int r = 0; r < rows; ++r) {
            y[rows + r] = measured(fit, r, fit->column[c]);
            y[r] = fit->rest[r * fit->columns + c] + y[rows + r];
        }
        Text title = {.pool = pool};
        text_html(&title, fit->table->name[fit->column[c]]);
        panel[c] = (Panel){.title = title.s,
                           .unit = unit ? unit : "1",
                           .below = "time, s",
                           .rows = rows,
                           .curves = 2,
                           .x = time,
                           .y = y};
    }
    for (int k = 0; k < fit->variables; ++k) {
        const double number[] = {fit->variable[k].value, found[k].value, found[k].deviation, found[k].low,
                                 found[k].high};
        memcpy(cell + FIT_COLUMNS * k, number, sizeof number);
    }
    fit_page_write(pool, &page, path);
}

static void print(const Fit *fit, const Found *found)
{
    Text text = {.pool = fit->pool}, *out = &text;
    text_print(out, "%s: %s\n\n", fit->model->name, summary(fit));
    text_print(out, "%-32s  %14s  %14s  %12s  %14s  %14s\n", "variable", "start", "value", "deviation", "low", "high");
    for (int k = 0; k < fit->variables; ++k)
        text_print(out, "%-32s  %14.9g  %14.9g  %12.4g  %14.9g  %14.9g %s\n", fit->variable[k].name,
                   fit->variable[k].value, found[k].value, found[k].deviation, found[k].low, found[k].high,
                   fit->variable[k].unit);
    text_print(out, "\n%-32s  %14s\n", "output", "noise left");
    for (int c = 0; c < fit->columns; ++c)
        text_print(out, "%-32s  %14.6g%s\n", fit->table->name[fit->column[c]], fit->noise[c],
                   fit->counts[c] ? "" : "  nothing that is looked for changes it");
    diag_text(text.s);
}

/* All rounds; *covariance: in units. */
static End fit_all(Fit *fit, gsl_vector *x, gsl_matrix *covariance, size_t *untold)
{
    End end = FOUND;
    for (size_t k = 0; k < x->size; ++k)
        gsl_vector_set(x, k, fit->variable[k].value / fit->unit[k]);
    if (run_with(fit, x) != GIC_OK)
        return NO_RUN;
    for (int round = 0; round < ROUNDS && end == FOUND; ++round) {
        if (round > 0)
            find_noise(fit);
        find_counting(fit);
        if (counting(fit) > 0 && counting(fit) * fit->table->rows <= fit->variables)
            return FEW;
        end = fit_once(fit, x, covariance, untold);
        if (end == FOUND && run_with(fit, x) != GIC_OK) /* what is left there */
            end = NO_RUN;
    }
    return end;
}

/* End with a message unless it was found. */
static void check_end(const Fit *fit, End end, size_t untold)
{
    BrokenLimit broken;
    if (end != FOUND && limit_broken(fit->model, fit->scene->parameter, &broken))
        diag_fail(
            (Place){fit->table->source, 1, 1},
            "leave it out, start elsewhere by values in the scene, or give the model what these measurements show",
            "these measurements lead out of what the model allows: %s", broken.text);
    if (end == NO_RUN)
        tangent_fail(fit->run, fit->status);
    if (end == UNTOLD)
        diag_fail((Place){fit->table->source, 1, 1}, "leave it out, or measure something that it changes by itself",
                  "these measurements do not tell %s: a combination of what is looked for changes nothing",
                  fit->variable[untold].name);
    if (end == FEW)
        diag_fail((Place){fit->table->source, 1, 1}, "measure more, or look for less",
                  "%d measurements that change with what is looked for do not tell %d numbers and their noise",
                  counting(fit) * fit->table->rows, fit->variables);
    if (end == LOST)
        diag_fail((Place){fit->scene->source, 0, 0}, "start nearer: other values in the scene",
                  "the least sum of squares was not found: after %d steps at most it still moves", MOST_STEPS);
}

/* Warn of columns that the model does not follow at all: what is left is far more than what a straight line through
 * their mean would leave. Some place is always found, at the end of where a formula has a value for one. */
static void check_fit(const Fit *fit)
{
    for (int c = 0; c < fit->columns; ++c) {
        double mean = 0, spread = 0, size = 0, left = 0;
        for (int r = 0; r < fit->table->rows; ++r)
            mean += measured(fit, r, fit->column[c]) / fit->table->rows;
        for (int r = 0; r < fit->table->rows; ++r) {
            const double number = measured(fit, r, fit->column[c]), rest = fit->rest[r * fit->columns + c];
            spread += (number - mean) * (number - mean);
            size += number * number;
            left += rest * rest;
        }
        if (left > 4 * spread && left > 0.01 * size && left > 1e-24 * fit->table->rows)
            diag_warn(
                csv_name_place(fit->table, fit->column[c]),
                "look at its unit, at the model's output, and at what is looked for; start nearer",
                "the model does not follow '%s': it leaves %.3g (rms), the measurements differ by %.3g from their "
                "mean",
                fit->table->name[fit->column[c]], sqrt(left / fit->table->rows), sqrt(spread / fit->table->rows));
    }
}

void identify_report(Pool *pool, const Model *model, const Scene *scene, const Request *request)
{
    Fit fit = open(pool, model, scene, request);
    const size_t n = (size_t)fit.variables;
    size_t untold = 0;
    gsl_errors_return();
    gsl_vector *x = gsl_vector_alloc(n);
    gsl_matrix *covariance = gsl_matrix_alloc(n, n);
    Found *found = pool_alloc(pool, (n + 1) * sizeof *found);
    const End end = fit_all(&fit, x, covariance, &untold);
    for (size_t k = 0; k < n && end == FOUND; ++k) {
        const double reach = gsl_cdf_tdist_Pinv((1 + likelihood) / 2, freedom(&fit, k));
        const double value = gsl_vector_get(x, k) * fit.unit[k];
        const double deviation = sqrt(gsl_matrix_get(covariance, k, k)) * fit.unit[k];
        found[k] = (Found){value, deviation, value - reach * deviation, value + reach * deviation};
    }
    gsl_matrix_free(covariance);
    gsl_vector_free(x);
    check_end(&fit, end, untold);
    check_fit(&fit);
    if (request->results && path_ends(request->results, ".html"))
        write_page(&fit, found, request->results);
    else if (request->results)
        write_csv(&fit, found, request->results);
    if (!request->results || strcmp(request->results, "-") != 0)
        print(&fit, found);
}
