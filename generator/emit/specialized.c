/* SPDX-License-Identifier: MIT
 * What generated files say about the one scene that they are for. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "model/model.h"
#include "specialize/specialize.h"
#include "vehicle/vehicle.h"

#include <string.h>

/* Conditions on geometric parameters stand in front of assumptions. */
static int first_assumption(const Generation *g)
{
    return g->model->tuning ? g->model->tuning->conditions : 0;
}

int conditions(const Generation *g)
{
    return first_assumption(g) + (g->formulation->narrowing ? g->formulation->narrowing->assumptions : 0);
}

void write_assumption_texts(Generation *g, Text *out)
{
    const Narrowing *narrowing = g->formulation->narrowing;
    for (int i = 0; narrowing && i < narrowing->assumptions; ++i)
        line(out, 4, "%s,", quoted(g->pool, narrowing->assumption[i].text));
}

void write_narrowing(Generation *g, Text *out)
{
    const Narrowing *narrowing = g->formulation->narrowing;
    if (!narrowing)
        return;
    text_print(out,
               " * For the scene %s alone. Other calls end with GIC_ERROR_ASSUMPTION; this is taken for granted:\n",
               narrowing->facts->scene);
    for (int i = 0; i < narrowing->assumptions; ++i)
        text_print(out, " *   %s\n", narrowing->assumption[i].text);
    text_print(out, " *\n");
    if (!narrowing->account)
        return;
    text_print(out, " * What that saves, one after the other: operations of a right-hand side and of outputs.\n");
    for (int i = 0; i < narrowing->account->rows; ++i) {
        const AccountRow *row = &narrowing->account->row[i];
        text_print(out, " *   %-48s %6d %6d  %s\n", row->what, count_sum(row->rhs), count_sum(row->outputs), row->why);
    }
    text_print(out, " *\n");
}

static const char *const state_name[] = {[ABOUT_STATE] = "y", [ABOUT_FAST] = "fast"};

typedef struct Checks {
    const Generation *g;
    AssumptionAbout about;
} Checks;

static void write_checks(void *context, Text *out, int indent)
{
    const Checks *checks = context;
    const Narrowing *narrowing = checks->g->formulation->narrowing;
    for (int i = 0; i < narrowing->assumptions; ++i)
        if (narrowing->assumption[i].about == checks->about) {
            line(out, indent, "if (%s)", narrowing->assumption[i].broken);
            line(out, indent + 4, "broken = %d;", first_assumption(checks->g) + i);
        }
}

static const Insertion assumption_point[] = {{"checks", write_checks}, {NULL, NULL}};

const Insertions assumption_points = {(const char *const[]){"assume.c.in", "assume_state.c.in", NULL}, assumption_point,
                                      NULL};

/* True if an assumption of the scene concerns it. */
static bool assumes(const Generation *g, AssumptionAbout about)
{
    const Narrowing *narrowing = g->formulation->narrowing;
    for (int i = 0; narrowing && i < narrowing->assumptions; ++i)
        if (narrowing->assumption[i].about == about)
            return true;
    return false;
}

/* The road of two sides, and its assumption's place among the texts. */
void write_across(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Narrowing *narrowing = g->formulation->narrowing;
    for (int i = 0; i < narrowing->assumptions; ++i)
        if (narrowing->assumption[i].about == ABOUT_ROAD)
            line(out, indent, "((%s *)self)->head.condition = %d;", g->model->name, first_assumption(g) + i);
}

static const Insertion road_point[] = {{"condition", write_across}, {NULL, NULL}};

const Insertions road_points = {(const char *const[]){"road_across.c.in", "road.c.in", NULL}, road_point, NULL};

void write_road(Generation *g, Text *out)
{
    const char *name = assumes(g, ABOUT_ROAD) ? "road_across.c.in" : "road.c.in";
    template_expand(g->pool, out, g->templates, name, g->model->name, NULL, &road_points, g);
}

const char *friction_template(const Generation *g)
{
    return assumes(g, ABOUT_ROAD) ? "friction_across.c.in" : "friction.c.in";
}

const char *vectors_road_template(const Generation *g)
{
    return assumes(g, ABOUT_ROAD) ? "wheel_vectors_road_across.c.in" : "wheel_vectors_road.c.in";
}

void write_assumptions(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    Checks checks = {g, ABOUT_CALLER};
    if (assumes(g, ABOUT_CALLER))
        template_expand(g->pool, out, g->templates, "assume.c.in", g->model->name, NULL, &assumption_points, &checks);
    for (checks.about = ABOUT_STATE; checks.about <= ABOUT_FAST; ++checks.about)
        if (assumes(g, checks.about))
            template_expand(g->pool, out, g->templates, "assume_state.c.in", g->model->name, state_name[checks.about],
                            &assumption_points, &checks);
}

void write_assume(Generation *g, Text *out, int indent, AssumptionAbout about)
{
    if (!assumes(g, about))
        return;
    const char *name = state_name[about];
    if (about == ABOUT_CALLER)
        line(out, indent, "if (%s_assume(self) != GIC_OK)", g->model->name);
    else
        line(out, indent, "if (%s_assume_%s(self, %s) != GIC_OK)", g->model->name, name, name);
    line(out, indent + 4, "return self->head.status;");
}

static void write_image(Text *out, int indent, const char *array, int at, int of, double sign)
{
    line(out, indent, "%s[%d] = %s%s[%d];", array, at, sign < 0 ? "-" : "", array, of);
}

/* The numbers of a wheel from those of its mirror image. */
static void write_wheel_image(const Generation *g, Text *out, int indent, int w)
{
    const Model *model = g->model;
    const int leader = g->formulation->narrowing->wheel[w], at = GRIP_NUMBERS * wheel_rolling(model, w);
    const int of = GRIP_NUMBERS * wheel_rolling(model, leader), link = LINK_NUMBERS * wheel_rolling(model, w);
    for (int i = 0; i < wheel_fast_states(&model->wheel[w]); ++i)
        write_image(out, indent, "rate", model->wheel[w].fast + i, model->wheel[leader].fast + i, wheel_fast_sign(i));
    for (int i = 0; i < GRIP_NUMBERS; ++i)
        if (i != GRIP_POINT + 1)
            write_image(out, indent, "grip", at + i, of + i, wheel_grip_sign(i));
    line(out, indent, "grip[%d] = link[%d] + link[%d] - grip[%d];", at + GRIP_POINT + 1, link + LINK_C + 1,
         LINK_NUMBERS * wheel_rolling(model, leader) + LINK_C + 1, of + GRIP_POINT + 1);
}

void write_images(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Model *model = g->model;
    for (int w = 0; w < model->wheels; ++w) {
        if (!narrowing_wheel_image(g->formulation->narrowing, w))
            continue;
        line(out, indent, "if (status == GIC_OK) { /* %s is the image of %s */", model->wheel[w].name,
             model->wheel[g->formulation->narrowing->wheel[w]].name);
        write_wheel_image(g, out, indent + 4, w);
        line(out, indent, "}");
    }
}

void write_batch_images(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Model *model = g->model;
    for (int w = 0; w < model->wheels; ++w) {
        if (!narrowing_wheel_image(g->formulation->narrowing, w))
            continue;
        line(out, indent, "/* %s is the image of %s */", model->wheel[w].name,
             model->wheel[g->formulation->narrowing->wheel[w]].name);
        write_wheel_image(g, out, indent, w);
    }
}

/* ---- many vehicles at once ------------------------------------------------------------------------------------- */

/* A condition of C that is about one vehicle, for all lanes: each comparison makes a mask. */
static const char *lane_condition(Pool *pool, const char *broken)
{
    static const char or [] = " || ";
    Text text = {.pool = pool};
    for (const char *next = broken, *end; next; next = end ? end + strlen(or) : NULL) {
        end = strstr(next, or);
        text_print(&text, "%s(gic_mask)(%.*s)", next == broken ? "" : " | ",
                   (int)(end ? end - next : (int)strlen(next)), next);
    }
    return text.s;
}

static void write_lane_checks(void *context, Text *out, int indent)
{
    static const char head[] = "self->head.";
    const Checks *checks = context;
    const Narrowing *narrowing = checks->g->formulation->narrowing;
    for (int i = 0; i < narrowing->assumptions; ++i) {
        const Assumption *assumption = &narrowing->assumption[i];
        const int condition = first_assumption(checks->g) + i;
        if (assumption->about != checks->about)
            continue;
        if (strncmp(assumption->broken, head, strlen(head)) != 0) {
            line(out, indent, "%s_break(self, work, &broken, %s, %d);", checks->g->model->name,
                 lane_condition(checks->g->pool, assumption->broken), condition);
            continue;
        }
        line(out, indent, "FOR_LANES(l)");
        line(out, indent + 4, "one[l] = -(self->head[l].%s);", assumption->broken + strlen(head));
        line(out, indent, "%s_break(self, work, &broken, one, %d);", checks->g->model->name, condition);
    }
}

static const Insertion lane_assumption_point[] = {{"checks", write_lane_checks}, {NULL, NULL}};

const Insertions lane_assumption_points = {(const char *const[]){"batch_assume.c.in", "batch_assume_state.c.in", NULL},
                                           lane_assumption_point, NULL};

void write_batch_assumptions(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    Checks checks = {g, ABOUT_CALLER};
    if (!g->formulation->narrowing)
        return;
    template_expand(g->pool, out, g->templates, "batch_assume.c.in", g->model->name, NULL, &lane_assumption_points,
                    &checks);
    for (checks.about = ABOUT_STATE; checks.about <= ABOUT_FAST; ++checks.about)
        if (assumes(g, checks.about))
            template_expand(g->pool, out, g->templates, "batch_assume_state.c.in", g->model->name,
                            state_name[checks.about], &lane_assumption_points, &checks);
}

void write_batch_assume(Generation *g, Text *out, int indent, AssumptionAbout about)
{
    if (about == ABOUT_CALLER && g->formulation->narrowing)
        line(out, indent, "%s_assume(self, work);", g->model->name);
    else if (assumes(g, about))
        line(out, indent, "%s_assume_%s(self, work, %s);", g->model->name, state_name[about], state_name[about]);
}

/* As write_across, in a lane. */
void write_across_lane(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const Narrowing *narrowing = g->formulation->narrowing;
    for (int i = 0; i < narrowing->assumptions; ++i)
        if (narrowing->assumption[i].about == ABOUT_ROAD)
            line(out, indent, "((%s_block *)self)->head[l].condition = %d;", g->model->name, first_assumption(g) + i);
}

static const Insertion lane_road_point[] = {{"condition", write_across_lane}, {NULL, NULL}};

const Insertions lane_road_points = {(const char *const[]){"batch_road_across.c.in", "batch_road.c.in", NULL},
                                     lane_road_point, NULL};

void write_batch_road(Generation *g, Text *out)
{
    const char *name = assumes(g, ABOUT_ROAD) ? "batch_road_across.c.in" : "batch_road.c.in";
    template_expand(g->pool, out, g->templates, name, g->model->name, NULL, &lane_road_points, g);
}

const char *batch_friction_template(const Generation *g)
{
    return assumes(g, ABOUT_ROAD) ? "batch_friction_across.c.in" : "batch_friction.c.in";
}

void write_batch_assumed(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Narrowing *narrowing = g->formulation->narrowing;
    line(out, indent, "if (%s_model.condition_count != %d)", g->model->name, conditions(g));
    line(out, indent + 4, "return GIC_ERROR_ABI;");
    for (int i = 0; narrowing && i < narrowing->assumptions; ++i) {
        line(out, indent, "if (strcmp(%s_model.condition_text[%d], %s) != 0)", g->model->name, first_assumption(g) + i,
             quoted(g->pool, narrowing->assumption[i].text));
        line(out, indent + 4, "return GIC_ERROR_ABI;");
    }
}

void write_condition(void *context, Text *out, int indent)
{
    Generation *g = context;
    const char *also = g->formulation->narrowing ? " || self->head.status == GIC_ERROR_ASSUMPTION" : "";
    line(out, indent,
         "const int32_t condition = self->head.status == GIC_ERROR_GEOMETRY%s ? self->head.condition : -1;", also);
}
