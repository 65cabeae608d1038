/* SPDX-License-Identifier: MIT
 * Functions for derivatives along a direction: each block of the vehicle differentiated forwards, called as the blocks
 * themselves are. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "emit/tangent.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"
#include <string.h>

/* ---- blocks -------------------------------------------------------------------------------------------------- */

/* True for a number of n[], or of m[], that follows from poses alone. */
static bool is_inertia_of_pose(const Generation *g, int index)
{
    const Sequence *sequence = g->sequence;
    for (int s = 0; s < sequence->subsets; ++s) {
        const Subset *subset = &sequence->subset[s];
        const int own = index - g->plan->inertia_offset[s], along = own - INERTIA_COORDINATE;
        if (subset->class < 0 || own < 0 || own >= g->plan->formula[subset->class]->layout.inertia_size)
            continue;
        return along < 0 ? own < INERTIA_FORCE : along >= 7 * subset->deps || along % 7 < 6;
    }
    return false;
}

static bool is_motion_of_pose(const Generation *g, int index)
{
    const Sequence *sequence = g->sequence;
    for (int b = 1; b < g->model->bodies; ++b) {
        const int class = sequence->subset[sequence->body_subset[b]].class, own = index - g->plan->motion_offset[b];
        if (class >= 0 && own >= 0 && own < g->plan->formula[class]->layout.motion_size)
            return motion_is_pose(own);
    }
    return false;
}

/* What moves along a direction in blocks about the whole vehicle and its wheels; context: the Generation. */
bool tangent_moves(const void *context, Element element)
{
    const Generation *g = context;
    switch (element.array) {
    case ARRAY_time:
    case ARRAY_gear:
    case ARRAY_rest: return false;
    case ARRAY_self_derived: return g->model->tuning;
    case ARRAY_e: return g->model->free_base;
    default: return true;
    }
}

/* The same where no coordinate changes, nor the geometry, so that no body changes its place relative to the base. */
bool tangent_moves_still(const void *context, Element element)
{
    const Generation *g = context;
    switch (element.array) {
    case ARRAY_x:
    case ARRAY_self_derived: return false;
    case ARRAY_m: return !is_motion_of_pose(g, element.index);
    case ARRAY_n: return !is_inertia_of_pose(g, element.index);
    default: return tangent_moves(context, element);
    }
}

const Block *whole_tangent(const Generation *g, const Block *block)
{
    const Seeds seeds = {.moves = tangent_moves, .context = g};
    return block_tangent(block, &seeds, true, NULL);
}

/* In blocks with the arguments of a class: the same, for a wheel's `rate` are those of its fast states. */
static void write_tangent(Generation *g, Text *out, const Block *block, bool both, NamingScope scope,
                          Constants *constants, int indent)
{
    const Seeds seeds = {.moves = tangent_moves, .context = g};
    write_fast_block(g, out, block_tangent(block, &seeds, both, NULL), scope, constants, indent);
}

/* A block about the whole vehicle, which has no constants of members. */
static void write_whole(Generation *g, Text *out, const Block *block, bool both, NamingScope scope, int indent)
{
    Constants none = {0};
    write_tangent(g, out, block, both, scope, &none, indent);
}

static void write_dynamics(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, g->formulation->dynamics, true, SCOPE_WHOLE, indent);
}

static void write_still_dynamics(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Seeds seeds = {.moves = tangent_moves_still, .context = g};
    Constants none = {0};
    write_fast_block(g, out, block_tangent(g->formulation->dynamics, &seeds, true, NULL), SCOPE_WHOLE, &none, indent);
}

static void write_outputs(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, g->formulation->outputs, true, SCOPE_WHOLE, indent);
}

static void write_poses(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, g->formulation->poses, false, SCOPE_WHOLE, indent);
}

static void write_wrenches(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, g->formulation->wrenches, true, SCOPE_WHOLE, indent);
}

static void write_derived(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, derive_block(g->pool, g->plan), false, SCOPE_WHOLE, indent);
}

/* ---- wheels with tires --------------------------------------------------------------------------------------- */

static void write_arrays(void *context, Text *out, int indent)
{
    (void)context;
    line(out, indent, "gic_real contact[%d], dcontact[%d];", CONTACT_NUMBERS, CONTACT_NUMBERS);
    line(out, indent, "gic_real force[%d] = {R(0.0)}, dforce[%d] = {R(0.0)};", TIRE_FORCES, TIRE_FORCES);
}

static void write_contact(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    write_tangent(x->g, out, &x->wheel->contact, true, SCOPE_WHEEL, &x->constants, indent);
}

static void write_tire(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    write_tangent(x->g, out, &x->wheel->tire, true, SCOPE_WHEEL, &x->constants, indent);
}

static void write_balance(void *context, Text *out, int indent)
{
    TangentExpansion *x = context;
    write_tangent(x->g, out, &x->wheel->balance, true, SCOPE_WHEEL, &x->constants, indent);
}

static void write_wheel_classes(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    (void)indent;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        TangentExpansion x = {.g = g, .wheel = class};
        Text body = {.pool = g->pool};
        const char *member[class->members];
        for (int i = 0; i < class->members; ++i)
            member[i] = g->model->wheel[class->member[i]].name;
        template_expand(g->pool, &body, g->templates, "tangent_wheel.c.in", g->model->name, class->name,
                        &tangent_class_points, &x);
        write_constants(g, out, pool_print(g->pool, "k_tangent_wheel_%s", class->name), class->contact.dag,
                        &x.constants, member);
        text_add(out, body.s, body.size);
    }
}

static void write_wheel_calls(void *context, Text *out, int indent)
{
    Generation *g = context;
    const Wheels *wheels = g->formulation->wheels;
    const char *name = g->model->name;
    for (int c = 0; c < wheels->classes; ++c)
        for (int i = 0; i < wheels->class[c].members; ++i) {
            const int wheel = wheels->class[c].member[i], place = wheel_rolling(g->model, wheel);
            const char *fast = wheel_place_text(g, "FAST", wheel, g->model->wheel[wheel].fast);
            const char *link = wheel_place_text(g, "LINK", wheel, LINK_NUMBERS * place);
            const char *torque = wheel_place_text(g, "TORQUE", wheel, 2 * place);
            const char *grip = wheel_place_text(g, "GRIP", wheel, GRIP_NUMBERS * place);
            line(out, indent, "if (status == GIC_OK) /* %s */", g->model->wheel[wheel].name);
            line(out, indent + 4, "status = %s_tangent_wheel_%s(self, along, %s_k_tangent_wheel_%s[%d], time,", name,
                 wheels->class[c].name, name, wheels->class[c].name, i);
            line(out, indent + 8, "link + %s, dlink + %s, fast + %s, dfast + %s, torque + %s, dtorque + %s,", link,
                 link, fast, fast, torque, torque);
            line(out, indent + 8, "rate + %s, drate + %s, grip + %s, dgrip + %s);", fast, fast, grip, grip);
        }
}

static void write_link(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, &g->formulation->wheels->link, true, SCOPE_FAST, indent);
}

static void write_torque(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, &g->formulation->wheels->torque, true, SCOPE_FAST, indent);
}

static void write_drive_block(void *context, Text *out, int indent)
{
    Generation *g = context;
    write_whole(g, out, &g->formulation->wheels->drive, true, SCOPE_FAST, indent);
}

/* ---- templates ----------------------------------------------------------------------------------------------- */

static void expand(Generation *g, Text *out, const char *template)
{
    template_expand(g->pool, out, g->templates, template, g->model->name, NULL, &tangent_points, g);
}

static void write_drive_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->powertrain)
        expand(g, out, "tangent_drive.c.in");
}

static void write_wheel_tangents(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->formulation->wheels)
        expand(g, out, wheels_roll(g) ? "tangent_wheels.c.in" : "tangent_states.c.in");
}

static void write_derived_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (g->model->tuning)
        expand(g, out, "tangent_derive.c.in");
}

static void write_reactions_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (formulation_reacts(g->formulation))
        expand(g, out, "tangent_reactions.c.in");
}

static void write_orient_along(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    expand(g, out, g->model->free_base ? "tangent_free.c.in" : "tangent_fixed.c.in");
}

static void write_tangent_rates(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    expand(g, out, balances_bodies(g) ? "tangent_bodies.c.in" : "tangent_dynamics.c.in");
}

/* ---- recovery ------------------------------------------------------------------------------------------------ */

static void write_tangent_recovery(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    expand(g, out, recovers_along(g) ? "tangent_recover_found.c.in" : "tangent_recover.c.in");
}

static void write_tangent_turn(void *context, Text *out, int indent)
{
    const Generation *g = context;
    line(out, indent,
         g->model->free_base ? "const gic_real *const dturn = along->state + %s_TWIST + 3;"
                             : "const gic_real *const dturn = %s_still;",
         g->model->free_base ? g->upper : g->model->name);
}

static void write_tangent_locate(void *context, Text *out, int indent)
{
    const Generation *g = context;
    const char *name = g->model->name;
    if (!recovers_along(g)) {
        line(out, indent, "status = %s_locate(self, time, y, e);", name);
        return;
    }
    line(out, indent, "status = finite && (!along->still || fast) ? %s_tangent_recovery(self, time, y, e, along)",
         name);
    line(out, indent + 4, ": %s_locate(self, time, y, e);", name);
}

static void write_tangent_recover(void *context, Text *out, int indent)
{
    Generation *g = context;
    if (recovers_along(g))
        return;
    write_flat_call(g, out, indent);
    line(out, indent, "if (!along->still || fast)");
    line(out, indent + 4, "%s_tangent_recover(self, along, %s, dturn);", g->model->name,
         g->model->free_base ? pool_print(g->pool, "y + %s_TWIST + 3", g->upper)
                             : pool_print(g->pool, "%s_still", g->model->name));
}

void write_recovery_along(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (recovers_along(g))
        line(out, indent, "static int %s_tangent_piece(%s *self, %s_links *links, gic_real *start);", g->model->name,
             g->model->name, g->model->name);
}

void write_recovery_call_along(Generation *g, Text *out, int indent)
{
    if (!recovers_along(g))
        return;
    line(out, indent, "if (self->along)");
    line(out, indent + 4, "return %s_tangent_piece(self, links, start);", g->model->name);
}

void write_along_member(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!recovers_along(g))
        return;
    line(out, 0, "#define %s_ALONG 1 /* for code of many vehicles */", g->upper);
    line(out, indent, "struct %s_direction *along; /* that a recovery is differentiated along; NULL: along none */",
         g->model->name);
}

/* ---- calls where a model has these parts --------------------------------------------------------------------- */

static void write_call_derive(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!g->model->tuning)
        return;
    line(out, indent, "%s_tangent_derive(self, along);", g->model->name);
    line(out, indent, "for (i = 0; i < %s_DERIVED; ++i)", g->upper);
    line(out, indent + 4, "along->still = along->still && !(GIC_FABS(along->derived[i]) > R(0.0));");
}

static void write_call_wheels(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->formulation->wheels)
        line(out, indent, "status = %s_tangent_turn_%s(self, time, y, e, de, rate, along);", g->model->name,
             wheels_roll(g) ? "wheels" : "states");
}

static void write_call_react(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (!formulation_reacts(g->formulation))
        return;
    line(out, indent, "if (status == GIC_OK)");
    line(out, indent + 4, "status = %s_tangent_reactions(self, time, self->state, e, de, self->rate, along);",
         g->model->name);
}

static const Insertion class_point[] = {{"tangent knowns", tangent_knowns},
                                        {"tangent solve", tangent_solve},
                                        {"tangent lack", tangent_lack},
                                        {"tangent kept argument", tangent_kept_argument},
                                        {"tangent kept unused", tangent_kept_unused},
                                        {"tangent still lack", tangent_still_lack},

                                        {"tangent still", tangent_still},
                                        {"react knowns", tangent_react_knowns},
                                        {"tangent react block", tangent_react_block},
                                        {"tangent arrays", write_arrays},
                                        {"tangent contact", write_contact},
                                        {"tangent tire", write_tire},
                                        {"tangent balance", write_balance},
                                        {NULL, NULL}};

const Insertions tangent_class_points = {(const char *const[]){"tangent_class.c.in", "tangent_found.c.in",
                                                               "tangent_lack.c.in", "tangent_react.c.in",
                                                               "tangent_wheel.c.in", NULL},
                                         class_point, NULL};

static const Insertion tangent_point[] = {{"tangent motions", write_found_motions},
                                          {"tangent inertias", write_found_inertias},
                                          {"tangent start", write_found_start},
                                          {"flat", write_flat},
                                          {"class tangents", tangent_classes},
                                          {"wheel tangents", write_wheel_tangents},
                                          {"derived tangent", write_derived_along},
                                          {"gather", write_gathered},
                                          {"tangent calls", tangent_calls},
                                          {"tangent recovery", write_tangent_recovery},
                                          {"tangent rates", write_tangent_rates},
                                          {"tangent base", tangent_base},
                                          {"tangent lacks", tangent_lacks},
                                          {"tangent factors", tangent_factors},
                                          {"tangent forces", tangent_forces},
                                          {"tangent still forces", tangent_still_forces},
                                          {"tangent solution", tangent_solution},
                                          {"tangent still solution", tangent_still_solution},
                                          {"tangent turn", write_tangent_turn},
                                          {"tangent locate", write_tangent_locate},
                                          {"tangent recover", write_tangent_recover},
                                          {"tangent dynamics", write_dynamics},
                                          {"tangent still dynamics", write_still_dynamics},
                                          {"tangent reactions", write_reactions_along},
                                          {"tangent outputs", write_outputs},
                                          {"tangent poses", write_poses},
                                          {"tangent orient", write_orient_along},
                                          {"tangent derive", write_call_derive},
                                          {"tangent wheels", write_call_wheels},
                                          {"tangent react", write_call_react},
                                          {"tangent derived", write_derived},
                                          {"tangent wrenches", write_wrenches},
                                          {"tangent react calls", tangent_react_calls},
                                          {"wheel class tangents", write_wheel_classes},
                                          {"tangent link", write_link},
                                          {"tangent torque", write_torque},
                                          {"tangent wheel calls", write_wheel_calls},
                                          {"tangent drive", write_drive_along},
                                          {"tangent drive block", write_drive_block},
                                          {"columns", write_jacobian_columns},
                                          {"jacobian rows", write_jacobian_rows},
                                          {"jacobian starts", write_jacobian_starts},
                                          {NULL, NULL}};

const Insertions tangent_points = {
    (const char *const[]){"tangent.c.in", "tangent_dynamics.c.in", "tangent_bodies.c.in", "tangent_recover.c.in",
                          "tangent_recover_found.c.in", "tangent_table.c.in", "tangent_road.c.in",
                          "tangent_friction.c.in", "tangent_derive.c.in", "tangent_reactions.c.in", "tangent_free.c.in",
                          "tangent_fixed.c.in", "tangent_wheels.c.in", "tangent_states.c.in", "tangent_drive.c.in",
                          NULL},
    tangent_point, NULL};

bool has_tangents(Generation *g)
{
    return g->style->derivatives || (g->style->implicit && !weighed_columns(g));
}

/* Slopes of tables, and how road and friction change with the place, as far as `code` calls these functions: what
 * blocks read is not always differentiated (a wheel on a vertical guide keeps its point of the road). */
static void write_called_slopes(Generation *g, Text *out, const Text *code)
{
    static const struct {
        const char *function, *template;
    } slope[] = {{"table_slope", "tangent_table.c.in"},
                 {"road_change", "tangent_road.c.in"},
                 {"friction_change", "tangent_friction.c.in"}};
    for (size_t i = 0; i < sizeof slope / sizeof *slope; ++i)
        if (code->size && strstr(code->s, pool_print(g->pool, "%s_%s(", g->model->name, slope[i].function)))
            expand(g, out, slope[i].template);
}

void write_derivative_code(void *context, Text *out, int indent)
{
    Generation *g = one_by_one(context);
    Text code = {.pool = g->pool};
    (void)indent;
    if (has_tangents(g))
        expand(g, &code, "tangent.c.in");
    write_implicit_code(g, &code);
    write_called_slopes(g, out, &code);
    text_add(out, code.s, code.size);
}

/* ---- header -------------------------------------------------------------------------------------------------- */

static void write_direction_members(void *context, Text *out, int indent)
{
    const Generation *g = context;
    if (g->model->tuning)
        line(out, indent, "gic_real derived[%s_DERIVED];", g->upper);
    if (has_tangents(one_by_one(context)) && balances_bodies(g))
        line(out, indent, "gic_real kept[%d];", room(tangent_kept_offset(g, g->sequence->subsets)));
    if (wheels_roll(g))
        line(out, indent, "gic_real grip[%s_GRIP * %s_ROLLING];", g->upper, g->upper);
    if (g->model->powertrain)
        line(out, indent, "gic_real watch[%d];", WATCH_NUMBERS);
}

static const Insertion tangent_header_point[] = {{"direction", write_direction_members},
                                                 {"jacobian sizes", write_jacobian_sizes},
                                                 {"jacobian picture", write_jacobian_picture},
                                                 {NULL, NULL}};

const Insertions tangent_header_points = {(const char *const[]){"tangent.h.in", NULL}, tangent_header_point, NULL};

void write_tangent_header(void *context, Text *out, int indent)
{
    Generation *g = one_by_one(context);
    (void)indent;
    if (has_tangents(g))
        template_expand(g->pool, out, g->templates, "tangent.h.in", g->model->name, NULL, &tangent_header_points, g);
}
