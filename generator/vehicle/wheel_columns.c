/* SPDX-License-Identifier: MIT
 * Derivatives of what wheels, own states and the powertrain do: of each block by its own inputs, which are few, where
 * the columns of the jacobian are many; and the sums of products that make columns of them. */
#include "vehicle/wheel_columns.h"
#include "expression/expression.h"
#include "model/model.h"
#include "model/powertrain_numbers.h"
#include "vehicle/vehicle.h"
#include "vehicle/wheel.h"

/* Results of each block that are wanted: derivatives of grip[], and numbers that the powertrain's block reads. */
typedef struct Wanted {
    bool *grip;      /* [GRIP_NUMBERS] a wheel */
    bool *read_grip; /* the same */
    bool *read_rate; /* [fast states] */
} Wanted;

static Ex unit_seed(const void *context, Dag *dag, Element element)
{
    const Element *by = context;
    return ex_literal(dag, element_same(element, *by));
}

static const Ex *roots_of(const Block *block)
{
    Ex *root = pool_alloc(block->dag->pool, ((size_t)block->stores + 1) * sizeof *root);
    for (int i = 0; i < block->stores; ++i)
        root[i] = block->store[i].value;
    return root;
}

/* Derivatives of all nodes of a block by one input. */
static const Ex *slopes_by(const Block *block, Element by)
{
    const Seeds seeds = {.seed = unit_seed, .context = &by};
    return dag_slopes(block->dag, block, roots_of(block), block->stores, &seeds);
}

static void add_local(Locals *l, int *size, Element target, Element by, Ex slope)
{
    Dag *dag = l->block.dag;
    Local local = {.target = target, .by = by, .place = -1};
    if (ex_is(dag, slope, 0))
        return;
    if (dag->node[slope].level == LEVEL_LITERAL) {
        local.value = ex_value(dag, slope, 0);
    } else {
        local.place = (*size)++;
        block_store(&l->block, slope, element_at(ARRAY_local, local.place));
    }
    *POOL_PUSH(dag->pool, l->local, l->count) = local;
}

/* ---- blocks about all wheels ---------------------------------------------------------------------------------- */

typedef struct Collection {
    Pool *pool;
    int count;
    Element *element;
} Collection;

static void add_element(Collection *c, Element e)
{
    for (int i = 0; i < c->count; ++i)
        if (element_same(c->element[i], e))
            return;
    *POOL_PUSH(c->pool, c->element, c->count) = e;
}

/* Inputs that can change along a column; time and gears stand still. */
static void collect(void *context, Element e)
{
    const Array moving[] = {ARRAY_link, ARRAY_fast, ARRAY_torque, ARRAY_rate, ARRAY_grip, ARRAY_u, ARRAY_p};
    for (size_t i = 0; i < sizeof moving / sizeof *moving; ++i)
        if (e.array == moving[i] && !e.slope)
            add_element(context, e);
}

static Collection inputs_of(Pool *pool, const Block *block)
{
    Collection inputs = {.pool = pool};
    block_inputs(block, collect, &inputs);
    return inputs;
}

/* Of a block by all its inputs, from a place of local[] on. values: it stores its results as well. */
static Locals locals_of(Pool *pool, const Block *block, bool values, int first)
{
    Locals l = {.size = first, .block = {.dag = block->dag, .eager = true}};
    if (!block->dag)
        return l;
    dag_section(block->dag, "derivatives by what moves it");
    const Collection inputs = inputs_of(pool, block);
    const Ex *root = roots_of(block);
    for (int i = 0; i < block->stores && values; ++i)
        block_store(&l.block, root[i], block->store[i].target);
    for (int k = 0; k < inputs.count; ++k) {
        const Ex *slope = slopes_by(block, inputs.element[k]);
        for (int i = 0; i < block->stores; ++i)
            add_local(&l, &l.size, block->store[i].target, inputs.element[k], slope[root[i]]);
    }
    return l;
}

/* ---- one class of wheels -------------------------------------------------------------------------------------- */

enum { MOVERS = LINK_NUMBERS + FAST_MOST + 2 };

/* What moves a wheel: link, fast states, torques of drive and brake. */
static Element mover(int i)
{
    if (i < LINK_NUMBERS)
        return element_at(ARRAY_link, i);
    i -= LINK_NUMBERS;
    return i < FAST_MOST ? element_at(ARRAY_fast, i) : element_at(ARRAY_torque, i - FAST_MOST);
}

/* Derivatives of contact and tire by each mover, as the blocks after them read them. */
typedef struct Halves {
    Ex contact[MOVERS][CONTACT_NUMBERS], force[MOVERS][TIRE_FORCES];
    int by; /* the mover by which is differentiated */
} Halves;

static Ex halves_seed(const void *context, Dag *dag, Element element)
{
    const Halves *h = context;
    switch (element.array) {
    case ARRAY_contact: return h->contact[h->by][element.index];
    case ARRAY_force: return h->force[h->by][element.index];
    default: return ex_literal(dag, element_same(element, mover(h->by)));
    }
}

static Ex store_half(WheelClassColumns *w, Block *block, Ex slope)
{
    const Element place = element_at(ARRAY_half, w->halves++);
    block_store(block, slope, place);
    return ex_input(block->dag, place, NULL);
}

/* Is the result of one wheel of the class wanted, and read by the powertrain's block? */
static bool is_wanted(const Model *model, const WheelClass *class, const Wanted *wanted, Element e, bool read)
{
    bool any = e.array == ARRAY_rate && !read;
    for (int i = 0; i < class->members; ++i) {
        const int wheel = class->member[i], grip = GRIP_NUMBERS * wheel_rolling(model, wheel) + e.index;
        if (e.array == ARRAY_grip)
            any = any || (read ? wanted->read_grip[grip] : wanted->grip[grip]);
        else if (read)
            any = any || wanted->read_rate[model->wheel[wheel].fast + e.index];
    }
    return any;
}

static void differentiate_contact(const Model *model, const WheelClass *class, const Wanted *wanted,
                                  WheelClassColumns *w, Halves *h)
{
    const Block *block = &class->contact;
    const Ex *root = roots_of(block);
    for (int i = 0; i < block->stores; ++i)
        if (block->store[i].target.array == ARRAY_contact ||
            is_wanted(model, class, wanted, block->store[i].target, true))
            block_store(&w->contact.block, root[i], block->store[i].target);
    for (int m = 0; m < MOVERS; ++m) {
        const Ex *slope = slopes_by(block, mover(m));
        for (int i = 0; i < block->stores; ++i) {
            const Element target = block->store[i].target;
            const Ex e = slope[root[i]];
            if (target.array == ARRAY_contact)
                h->contact[m][target.index] =
                    block->dag->node[e].level < LEVEL_VARIABLE ? e : store_half(w, &w->contact.block, e);
            else if (is_wanted(model, class, wanted, target, false))
                add_local(&w->contact, &w->size, target, mover(m), e);
        }
    }
}

/* By what the contact tells, of which there is less than what moves the wheel; then by the latter. */
static void differentiate_tire(Pool *pool, const WheelClass *class, WheelClassColumns *w, Halves *h)
{
    const Block *block = &class->tire;
    Dag *dag = block->dag;
    const Ex *root = roots_of(block);
    Collection inputs = {.pool = pool};
    block_inputs(block, collect, &inputs);
    for (int k = 0; k < CONTACT_NUMBERS; ++k)
        add_element(&inputs, element_at(ARRAY_contact, k));
    for (int i = 0; i < block->stores; ++i)
        block_store(&w->tire, root[i], block->store[i].target);
    for (int k = 0; k < inputs.count; ++k) {
        const Element by = inputs.element[k];
        const Ex *slope = slopes_by(block, by);
        for (int m = 0; m < MOVERS; ++m) {
            h->by = m;
            for (int i = 0; i < block->stores; ++i) {
                Ex *sum = &h->force[m][block->store[i].target.index];
                *sum = ex_add(dag, *sum, ex_mul(dag, slope[root[i]], halves_seed(h, dag, by)));
            }
        }
    }
    for (int m = 0; m < MOVERS; ++m)
        for (int i = 0; i < TIRE_FORCES; ++i)
            if (!ex_is(dag, h->force[m][i], 0))
                h->force[m][i] = store_half(w, &w->tire, h->force[m][i]);
}

static void differentiate_balance(const Model *model, const WheelClass *class, const Wanted *wanted,
                                  WheelClassColumns *w, Halves *h)
{
    const Block *block = &class->balance;
    const Ex *root = roots_of(block);
    const Seeds seeds = {.seed = halves_seed, .context = h};
    for (int i = 0; i < block->stores; ++i)
        if (is_wanted(model, class, wanted, block->store[i].target, true))
            block_store(&w->balance.block, root[i], block->store[i].target);
    for (h->by = 0; h->by < MOVERS; ++h->by) {
        const Ex *slope = dag_slopes(block->dag, block, root, block->stores, &seeds);
        for (int i = 0; i < block->stores; ++i)
            if (is_wanted(model, class, wanted, block->store[i].target, false))
                add_local(&w->balance, &w->size, block->store[i].target, mover(h->by), slope[root[i]]);
    }
}

static WheelClassColumns class_columns(Pool *pool, const Model *model, const WheelClass *class, const Wanted *wanted)
{
    Dag *dag = class->contact.dag;
    Halves *h = pool_alloc(pool, sizeof *h);
    WheelClassColumns w = {.contact.block = {.dag = dag, .eager = true},
                           .tire = {.dag = dag, .eager = true},
                           .balance.block = {.dag = dag, .eager = true}};
    dag_section(dag, "derivatives by what moves the wheel");
    differentiate_contact(model, class, wanted, &w, h);
    differentiate_tire(pool, class, &w, h);
    differentiate_balance(model, class, wanted, &w, h);
    return w;
}

/* ---- all of them ---------------------------------------------------------------------------------------------- */

static void mark(const Collection *inputs, Array array, bool *mark)
{
    for (int i = 0; i < inputs->count; ++i)
        if (inputs->element[i].array == array)
            mark[inputs->element[i].index] = true;
}

static Wanted wanted_of(Pool *pool, const Formulation *f, const Dag *dag, const Ex *b, int n)
{
    const Wheels *wheels = f->wheels;
    const size_t grips = (size_t)(GRIP_NUMBERS * wheels->count + 1);
    const Wanted wanted = {.grip = pool_alloc(pool, grips),
                           .read_grip = pool_alloc(pool, grips),
                           .read_rate = pool_alloc(pool, (size_t)f->model->fast_states + 1)};
    const bool *needed = dag_needed(dag, b, n);
    for (int e = 0; e < dag->nodes; ++e)
        if (needed[e] && dag->node[e].op == OP_INPUT && dag->node[e].element->array == ARRAY_self_grip)
            wanted.grip[dag->node[e].element->index] = true;
    if (f->model->powertrain) {
        const Collection inputs = inputs_of(pool, &wheels->drive);
        mark(&inputs, ARRAY_grip, wanted.grip);
        mark(&inputs, ARRAY_grip, wanted.read_grip);
        mark(&inputs, ARRAY_rate, wanted.read_rate);
    }
    return wanted;
}

/* Where numbers of a wheel stand among those of all, and back: the first number of each array. */
static int first_of(const WheelColumns *w, int wheel, Array array)
{
    const int place = wheel_rolling(w->model, wheel);
    switch (array) {
    case ARRAY_link: return LINK_NUMBERS * place;
    case ARRAY_torque: return 2 * place;
    case ARRAY_grip: return GRIP_NUMBERS * place;
    default: return w->model->wheel[wheel].fast; /* fast, rate */
    }
}

static void add_parts(WheelColumns *w, Collection *parts, const Locals *l, int wheel)
{
    for (int i = 0; i < l->count; ++i) {
        Element by = l->local[i].by;
        if (by.array != ARRAY_link && by.array != ARRAY_fast && by.array != ARRAY_u && by.array != ARRAY_p)
            continue;
        by.index += wheel < 0 ? 0 : first_of(w, wheel, by.array);
        add_element(parts, by);
    }
}

WheelColumns *wheel_columns_new(Pool *pool, const Formulation *f, const Dag *dag, const Ex *b, int n)
{
    const Model *model = f->model;
    const Wheels *wheels = f->wheels;
    WheelColumns *w = pool_alloc(pool, sizeof *w);
    const Wanted wanted = wanted_of(pool, f, dag, b, n);
    Collection parts = {.pool = pool};
    *w = (WheelColumns){.model = model,
                        .wheels = wheels,
                        .torque = locals_of(pool, &wheels->torque, true, 0),
                        .class = pool_alloc(pool, ((size_t)wheels->classes + 1) * sizeof *w->class),
                        .class_of = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof(int)),
                        .offset = pool_alloc(pool, ((size_t)model->wheels + 1) * sizeof(int)),
                        .link = {.dag = wheels->link.dag, .eager = true}};
    w->drive = locals_of(pool, &wheels->drive, false, w->torque.size);
    w->locals = w->drive.size;
    add_parts(w, &parts, &w->torque, -1);
    add_parts(w, &parts, &w->drive, -1);
    for (int i = 0; i < model->wheels; ++i)
        w->class_of[i] = -1;
    for (int c = 0; c < wheels->classes; ++c) {
        const WheelClass *class = &wheels->class[c];
        w->class[c] = class_columns(pool, model, class, &wanted);
        for (int i = 0; i < class->members; ++i) {
            w->class_of[class->member[i]] = c;
            w->offset[class->member[i]] = w->locals;
            w->locals += w->class[c].size;
            add_parts(w, &parts, &w->class[c].contact, class->member[i]);
            add_parts(w, &parts, &w->class[c].balance, class->member[i]);
        }
    }
    w->moving = parts.count;
    for (int i = 0; i < model->fast_states; ++i)
        add_element(&parts, element_at(ARRAY_rate, i));
    w->parts = parts.count;
    w->part = parts.element;
    return w;
}

int wheel_columns_part(const WheelColumns *w, Element e)
{
    for (int i = 0; i < w->parts; ++i)
        if (element_same(w->part[i], e))
            return i;
    return -1;
}

/* ---- products ------------------------------------------------------------------------------------------------- */

/* The locals that have a result as their target: at most two lists; of one wheel its number, else -1. */
typedef struct Results {
    const Locals *list[2];
    int wheel, offset;
    bool before; /* what they read of rate[] and grip[] is what wheels do without the powertrain */
} Results;

static bool block_has(const Block *block, Element target)
{
    for (int i = 0; i < block->stores; ++i)
        if (element_same(block->store[i].target, target))
            return true;
    return false;
}

static Results results_of(const WheelColumns *w, Element e, bool before)
{
    const Model *model = w->model;
    if (e.array == ARRAY_torque || block_has(&w->wheels->torque, e))
        return (Results){.list = {&w->torque}, .wheel = -1};
    if (!before && model->powertrain && block_has(&w->wheels->drive, e))
        return (Results){.list = {&w->drive}, .wheel = -1, .before = true};
    for (int i = 0; i < model->wheels; ++i) {
        const int count = e.array == ARRAY_grip ? GRIP_NUMBERS : wheel_fast_states(&model->wheel[i]);
        const int own = w->class_of[i] < 0 ? -1 : e.index - first_of(w, i, e.array);
        if (own >= 0 && own < count && e.array != ARRAY_watch) {
            const WheelClassColumns *class = &w->class[w->class_of[i]];
            return (Results){.list = {&class->contact, &class->balance}, .wheel = i, .offset = w->offset[i]};
        }
    }
    return (Results){.wheel = -1};
}

/* Does it stand in part[], and not in what blocks make of that? */
static bool is_part(Element e)
{
    return e.array == ARRAY_link || e.array == ARRAY_fast || e.array == ARRAY_u || e.array == ARRAY_p;
}

/* What a local is differentiated by, and whether a local is one of a result; as elements of all wheels. */
static Element by_of(const WheelColumns *w, const Results *s, const Local *l)
{
    Element by = l->by;
    if (s->wheel >= 0)
        by.index += first_of(w, s->wheel, by.array);
    return by;
}

static bool is_of(const WheelColumns *w, const Results *s, const Local *l, Element e)
{
    if (s->wheel >= 0)
        e.index -= first_of(w, s->wheel, e.array);
    return element_same(l->target, e);
}

static Ex change(const WheelColumns *w, Dag *dag, Element e, bool before)
{
    if (is_part(e))
        return ex_input(dag, element_of(ARRAY_part, -1, wheel_columns_part(w, e)), NULL);
    const Results s = results_of(w, e, before);
    Ex sum = 0;
    for (int k = 0; k < 2 && s.list[k]; ++k)
        for (int i = 0; i < s.list[k]->count; ++i) {
            const Local *l = &s.list[k]->local[i];
            if (!is_of(w, &s, l, e))
                continue;
            const Ex factor = l->place < 0 ? ex_literal(dag, l->value)
                                           : ex_input(dag, element_at(ARRAY_local, s.offset + l->place), NULL);
            sum = ex_add(dag, sum, ex_mul(dag, factor, change(w, dag, by_of(w, &s, l), s.before)));
        }
    return sum;
}

Ex wheel_columns_change(const WheelColumns *w, Dag *dag, Element e)
{
    return change(w, dag, e, false);
}

static bool moves(const WheelColumns *w, Element e, bool before, const bool *moved)
{
    if (is_part(e))
        return moved[wheel_columns_part(w, e)];
    const Results s = results_of(w, e, before);
    for (int k = 0; k < 2 && s.list[k]; ++k)
        for (int i = 0; i < s.list[k]->count; ++i) {
            const Local *l = &s.list[k]->local[i];
            if (is_of(w, &s, l, e) && moves(w, by_of(w, &s, l), s.before, moved))
                return true;
        }
    return false;
}

bool wheel_columns_moves(const WheelColumns *w, Element e, const bool *moved)
{
    return moves(w, e, false, moved);
}
