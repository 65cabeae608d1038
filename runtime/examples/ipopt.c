/* SPDX-License-Identifier: MIT
 * gic_ipopt MODEL.veh SCENE FORMULA [FORMULA=LOW:HIGH ...] NAME=LOW:HIGH ...: the least value of a number of a run,
 * with other numbers of the run and those that are looked for within bounds, by Ipopt and the gradients of libgic.
 * FORMULA is as of gicrun --gradient, or peak(FORMULA), the root of the mean of its 16th power, which is near its
 * largest magnitude.
 *
 *     cc -I/usr/include/coin -I/usr/include/coin-or runtime/examples/ipopt.c -lgic -lipopt -lm
 *
 * Writes CSV: the number, those that were found, then the formulas within bounds. Exit status 1 if a formula is outside
 * of its bounds by more than a thousandth of their width: then no numbers that keep them were found. */
#include <IpStdCInterface.h>
#include <gic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PEAK = 16, NUMBERS = 16, VARIABLES = 256, WORD = 400, PATIENCE = 5 };

typedef struct Bounded {
    char name[WORD]; /* or a formula */
    double low, high;
} Bounded;

typedef struct Problem {
    gicl_library *library;
    gicl_messages *said;
    gicl_handle model;
    const char *scene;
    int numbers, variables;
    Bounded number[NUMBERS]; /* the first has no bounds: it is to be least */
    Bounded variable[VARIABLES];
    double start[VARIABLES], x[VARIABLES];            /* x: where numbers are known, 0 and 1 at the bounds */
    double value[NUMBERS], slope[NUMBERS][VARIABLES]; /* [numbers][variables] */
    int known;
    double last; /* value of the last step of the search */
    int same;    /* steps in which it stayed */
    char word[VARIABLES][WORD + 40];
} Problem;

/* A word ...=LOW:HIGH; 0: it is none. */
static int read_bounded(const char *word, Bounded *bounded)
{
    const char *equals = strrchr(word, '=');
    int size = 0;
    *bounded = (Bounded){.low = -1e20, .high = 1e20};
    snprintf(bounded->name, WORD, "%.*s", equals ? (int)(equals - word) : WORD - 1, word);
    return equals && sscanf(equals + 1, "%lf:%lf%n", &bounded->low, &bounded->high, &size) == 2 && !equals[1 + size];
}

/* The first array of a name. */
static gicl_array array_of(const Problem *problem, gicl_handle result, const char *name)
{
    gicl_array array = {.name = ""};
    for (int i = 0; strcmp(array.name, name) != 0; ++i)
        if (gicl_array_get(problem->library, result, i, &array, sizeof array, problem->said) != GICL_OK)
            exit(1);
    return array;
}

/* Number i of a run, and its derivatives; 0: there is no such run. values: NULL: those of the scene. */
static int evaluate_one(Problem *problem, int i, const double *values)
{
    char text[WORD + 40];
    const char *words[VARIABLES], *formula = problem->number[i].name;
    const size_t size = strlen(formula);
    const int peak = !strncmp(formula, "peak(", 5) && formula[size - 1] == ')';
    gicl_handle result;
    snprintf(text, sizeof text, peak ? "integral((%.*s)^%d)" : "%.*s", peak ? (int)size - 6 : (int)size,
             peak ? formula + 5 : formula, PEAK);
    for (int k = 0; k < problem->variables; ++k) {
        snprintf(problem->word[k], sizeof problem->word[k], values ? "%s=%.17g" : "%s", problem->variable[k].name,
                 values ? values[k] : 0);
        words[k] = problem->word[k];
    }
    if (gicl_gradient(problem->library, problem->model, problem->scene, text, words, problem->variables, &result,
                      problem->said) != GICL_OK)
        return 0;
    const gicl_array derivative = array_of(problem, result, "derivative"),
                     variable = array_of(problem, result, "variable");
    const double number = array_of(problem, result, "number").data[0], time = array_of(problem, result, "time").data[0];
    problem->value[i] = peak ? pow(number / time, 1.0 / PEAK) : number;
    const double factor = peak ? problem->value[i] / (PEAK * number) : 1;
    for (int k = 0; k < problem->variables; ++k)
        for (int j = 0; j < problem->variables; ++j) /* they come in the model's order */
            if (!strcmp(derivative.row_name[j], problem->variable[k].name)) {
                problem->slope[i][k] = factor * derivative.data[j];
                problem->start[k] = values ? problem->start[k] : variable.data[j];
            }
    gicl_free(problem->library, result, NULL);
    return 1;
}

static double width(const Bounded *bounded)
{
    return bounded->high - bounded->low;
}

/* All numbers at x, of which 0 and 1 are the bounds, once. */
static int evaluate(Problem *problem, const double *x)
{
    const size_t size = (size_t)problem->variables * sizeof *x;
    double value[VARIABLES];
    if (problem->known && !memcmp(x, problem->x, size))
        return 1;
    for (int k = 0; k < problem->variables; ++k)
        value[k] = problem->variable[k].low + x[k] * width(&problem->variable[k]);
    problem->known = 1;
    for (int i = 0; i < problem->numbers; ++i) {
        problem->known = problem->known && evaluate_one(problem, i, value);
        for (int k = 0; k < problem->variables; ++k)
            problem->slope[i][k] *= width(&problem->variable[k]);
    }
    memcpy(problem->x, x, size);
    return problem->known;
}

static Bool least(int n, double *x, Bool is_new, double *value, void *data)
{
    (void)n, (void)is_new;
    Problem *problem = data;
    const int good = evaluate(problem, x);
    *value = problem->value[0];
    return good;
}

static Bool least_slope(int n, double *x, Bool is_new, double *slope, void *data)
{
    (void)is_new;
    Problem *problem = data;
    const int good = evaluate(problem, x);
    memcpy(slope, problem->slope[0], (size_t)n * sizeof *slope);
    return good;
}

static Bool within(int n, double *x, Bool is_new, int count, double *value, void *data)
{
    (void)n, (void)is_new;
    Problem *problem = data;
    const int good = evaluate(problem, x);
    memcpy(value, problem->value + 1, (size_t)count * sizeof *value);
    return good;
}

static Bool within_slope(int n, double *x, Bool is_new, int count, int entries, int *row, int *column, double *slope,
                         void *data)
{
    Problem *problem = data;
    (void)is_new, (void)entries;
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < n; ++k)
            if (slope)
                slope[i * n + k] = evaluate(problem, x) ? problem->slope[1 + i][k] : 0;
            else {
                row[i * n + k] = i;
                column[i * n + k] = k;
            }
    return slope ? evaluate(problem, x) : 1;
}

static Bool no_hessian(int n, double *x, Bool new_x, double factor, int m, double *lambda, Bool new_lambda, int entries,
                       int *row, int *column, double *value, void *data)
{
    (void)n, (void)x, (void)new_x, (void)factor, (void)m, (void)lambda, (void)new_lambda, (void)entries, (void)row;
    (void)column, (void)value, (void)data;
    return 0;
}

/* The search goes on until the value has stayed the same for PATIENCE steps, with other numbers within their bounds. */
static Bool go_on(int mode, int step, double value, double outside, double inf_du, double mu, double size,
                  double damping, double alpha_du, double alpha, int trials, void *data)
{
    (void)mode, (void)step, (void)inf_du, (void)mu, (void)size, (void)damping, (void)alpha_du, (void)alpha,
        (void)trials;
    Problem *problem = data;
    const int stays = outside < 1e-6 && fabs(value - problem->last) <= 1e-6 * (fabs(value) + fabs(problem->last));
    problem->same = stays ? problem->same + 1 : 0;
    problem->last = value;
    return problem->same < PATIENCE;
}

static int fail(const Problem *problem)
{
    gicl_message message;
    for (int i = 0; gicl_message_get(problem->said, i, &message); ++i)
        fprintf(stderr, "%s", message.printed);
    return 1;
}

/* Those within bounds, as they were and are. Returns how many are outside, which it says. */
static int write_formulas(const Problem *problem, const double *before)
{
    const double least = 1e-3, rounding = 1e-6;
    int outside = 0;
    for (int i = 1; i < problem->numbers; ++i) {
        const Bounded *b = &problem->number[i];
        const double now = problem->value[i], size = fmax(fabs(b->low), fabs(b->high));
        const double room = fmax(least * fmin(width(b), size), rounding * (1 + size));
        printf("\"%s\",%.17g,%.17g,%.17g,%.17g\n", b->name, before[i], now, b->low, b->high);
        if (now >= b->low - room && now <= b->high + room)
            continue;
        ++outside;
        fprintf(stderr,
                "gic_ipopt: error: %s = %.6g, not %g to %g: no numbers within their bounds were found that keep it\n"
                "  remedy: wider bounds, or another start in the scene\n",
                b->name, now, b->low, b->high);
    }
    return outside;
}

int main(int count, char **word)
{
    if (count < 5) {
        fprintf(stderr, "usage: gic_ipopt MODEL.veh SCENE FORMULA [FORMULA=LOW:HIGH ...] NAME=LOW:HIGH ...\n");
        return 2;
    }
    static Problem all;
    Problem *problem = &all;
    const gicl_options options = {.size = sizeof options, .engine = "tape"};
    problem->library = gicl_open();
    problem->said = gicl_messages_new();
    problem->scene = word[2];
    snprintf(problem->number[problem->numbers++].name, WORD, "%s", word[3]);
    for (int i = 4; i < count; ++i) {
        Bounded *next =
            !strncmp(word[i], "parameter/", 10) || !strncmp(word[i], "initial/", 8) || !strncmp(word[i], "input/", 6)
                ? &problem->variable[problem->variables++]
                : &problem->number[problem->numbers++];
        if (problem->variables == VARIABLES || problem->numbers == NUMBERS || !read_bounded(word[i], next)) {
            fprintf(stderr, "gic_ipopt: '%s' has no bounds, or there are too many\n", word[i]);
            return 2;
        }
    }
    if (gicl_model_open(problem->library, word[1], &options, &problem->model, problem->said) != GICL_OK ||
        !evaluate_one(problem, 0, NULL))
        return fail(problem);
    double at_start[NUMBERS];
    for (int i = 1; i < problem->numbers; ++i)
        if (!evaluate_one(problem, i, NULL))
            return fail(problem);
    memcpy(at_start, problem->value, sizeof at_start);
    const double before = problem->value[0];
    double low[VARIABLES], high[VARIABLES], low_number[NUMBERS], high_number[NUMBERS], x[VARIABLES], value;
    for (int k = 0; k < problem->variables; ++k) {
        low[k] = 0;
        high[k] = 1;
        x[k] = (problem->start[k] - problem->variable[k].low) / width(&problem->variable[k]);
    }
    for (int i = 1; i < problem->numbers; ++i) {
        low_number[i - 1] = problem->number[i].low;
        high_number[i - 1] = problem->number[i].high;
    }
    IpoptProblem ipopt = CreateIpoptProblem(problem->variables, low, high, problem->numbers - 1, low_number,
                                            high_number, problem->variables * (problem->numbers - 1), 0, 0, least,
                                            within, least_slope, within_slope, no_hessian);
    AddIpoptStrOption(ipopt, "hessian_approximation", "limited-memory");
    AddIpoptIntOption(ipopt, "limited_memory_max_history", 30);
    AddIpoptStrOption(ipopt, "mu_strategy", "adaptive");
    AddIpoptStrOption(ipopt, "sb", "yes");
    AddIpoptIntOption(ipopt, "print_level", 0);
    AddIpoptIntOption(ipopt, "max_iter", 100);
    AddIpoptNumOption(ipopt, "tol", 1e-5);
    AddIpoptNumOption(ipopt, "acceptable_tol", 1e-3);
    AddIpoptIntOption(ipopt, "acceptable_iter", 5);
    SetIntermediateCallback(ipopt, go_on);
    const int status = (int)IpoptSolve(ipopt, x, NULL, &value, NULL, NULL, NULL, problem);
    FreeIpoptProblem(ipopt);
    if (status < 0 && status != Maximum_Iterations_Exceeded) {
        fprintf(stderr, "gic_ipopt: status %d\n", status);
        return fail(problem);
    }
    printf("variable,start,value,low,high\n,%.17g,%.17g,,\n", before, value);
    for (int k = 0; k < problem->variables; ++k) {
        const Bounded *v = &problem->variable[k];
        printf("%s,%.17g,%.17g,%.17g,%.17g\n", v->name, problem->start[k], v->low + x[k] * width(v), v->low, v->high);
    }
    if (!evaluate(problem, x))
        return fail(problem);
    const int outside = write_formulas(problem, at_start);
    gicl_messages_free(problem->said);
    gicl_close(problem->library);
    return outside > 0;
}
