/* SPDX-License-Identifier: MIT
 * The weighted graph: matching of equations to bodies, its diagnosis, strongly connected components.
 *
 * All equations of an edge touch all unknowns of both its ends, so the block triangular form of the
 * structural Jacobian (Dulmage and Mendelsohn) needs no scalar rows: a matching is a number of rows at
 * each end of each edge. Rows move from one end to the other, and a maximum matching is a maximum flow of
 * rows from bodies with too many to bodies with too few (Dinic's algorithm: breadth-first levels, then
 * augmenting paths along them). What stays in excess or in want spans the over- and the under-determined part. */
#include "base/message.h"
#include "base/text.h"
#include "model/model.h"
#include "sequence/graph.h"
#include "sequence/redundant.h"

#include <string.h>

static int moving(int body)
{
    return body > BODY_BASE ? body : -1;
}

static int *ints(Pool *pool, int count)
{
    return pool_alloc(pool, (size_t)count * sizeof(int));
}

Graph *graph_new(Pool *pool, const Model *model)
{
    Graph *graph = pool_alloc(pool, sizeof *graph);
    graph->pool = pool;
    graph->model = model;
    graph->edges = model->joints + model->coordinates;
    graph->edge = pool_alloc(pool, (size_t)graph->edges * sizeof *graph->edge);
    graph->first = ints(pool, model->bodies + 1);
    graph->incident = ints(pool, 2 * graph->edges);
    int *given = ints(pool, model->bodies);
    for (int i = 0; i < graph->edges; ++i) {
        Edge *edge = &graph->edge[i];
        const int *body = i < model->joints ? model->joint[i].body : model->coordinate[i - model->joints].body;
        edge->weight = i < model->joints ? joint_equations[model->joint[i].type] : 1;
        edge->end[0] = moving(body[0]);
        edge->end[1] = moving(body[1]);
        /* to the end that lacks more rows: this is nearly a matching if joints are listed outwards from the base */
        int side = edge->end[0] < 0 || (edge->end[1] >= 0 && given[edge->end[1]] <= given[edge->end[0]]);
        edge->rows[side] = edge->weight;
        if (edge->end[side] >= 0)
            given[edge->end[side]] += edge->weight;
        for (int k = 0; k < 2; ++k)
            if (edge->end[k] >= 0)
                graph->first[edge->end[k] + 1]++;
    }
    for (int i = 0; i < model->bodies; ++i)
        graph->first[i + 1] += graph->first[i];
    int *next = ints(pool, model->bodies);
    memcpy(next, graph->first, (size_t)model->bodies * sizeof *next);
    for (int i = 0; i < graph->edges; ++i)
        for (int k = 0; k < 2; ++k)
            if (graph->edge[i].end[k] >= 0)
                graph->incident[next[graph->edge[i].end[k]]++] = 2 * i + k;
    return graph;
}

/* ---- matching --------------------------------------------------------------------------------- */

typedef struct Flow {
    Graph *graph;
    int *excess; /* [bodies] rows minus unknowns */
    int *level;  /* [bodies] arcs from the nearest body in excess, -1: not reachable */
    int *next;   /* [bodies] first incident end not yet found useless on this level graph */
    int *queue, *path;
} Flow;

/* The body that a row of incident end `i` could move to, or -1. */
static int move_target(const Graph *graph, int i)
{
    const Edge *edge = &graph->edge[graph->incident[i] / 2];
    int side = graph->incident[i] % 2;
    return edge->rows[side] > 0 ? edge->end[1 - side] : -1;
}

/* Levels from all bodies in excess; true if a body that lacks rows is reachable. */
static bool flow_levels(Flow *flow)
{
    const Graph *graph = flow->graph;
    int tail = 0;
    bool reached = false;
    for (int i = 1; i < graph->model->bodies; ++i) {
        flow->level[i] = flow->excess[i] > 0 ? 0 : -1;
        flow->next[i] = graph->first[i];
        if (flow->excess[i] > 0)
            flow->queue[tail++] = i;
    }
    for (int head = 0; head < tail; ++head) {
        int body = flow->queue[head];
        reached |= flow->excess[body] < 0;
        for (int i = graph->first[body]; i < graph->first[body + 1]; ++i) {
            int to = move_target(graph, i);
            if (to >= 0 && flow->level[to] < 0) {
                flow->level[to] = flow->level[body] + 1;
                flow->queue[tail++] = to;
            }
        }
    }
    return reached;
}

/* Move as many rows as possible along the path of incident ends, from the body in excess to the one that lacks rows. */
static void flow_augment(Flow *flow, int source, int target, int length)
{
    Graph *graph = flow->graph;
    int amount = flow->excess[source] < -flow->excess[target] ? flow->excess[source] : -flow->excess[target];
    for (int i = 0; i < length; ++i) {
        int end = graph->incident[flow->path[i]], rows = graph->edge[end / 2].rows[end % 2];
        amount = rows < amount ? rows : amount;
    }
    for (int i = 0; i < length; ++i) {
        int end = graph->incident[flow->path[i]];
        graph->edge[end / 2].rows[end % 2] -= amount;
        graph->edge[end / 2].rows[1 - end % 2] += amount;
    }
    flow->excess[source] -= amount;
    flow->excess[target] += amount;
}

/* Find and use one augmenting path from `source` along the levels; false if there is none. */
static bool flow_push(Flow *flow, int source)
{
    const Graph *graph = flow->graph;
    int length = 0, body = source;
    while (flow->excess[body] >= 0) {
        int *next = &flow->next[body], to = -1;
        for (; *next < graph->first[body + 1]; ++*next) {
            to = move_target(graph, *next);
            if (to >= 0 && flow->level[to] == flow->level[body] + 1)
                break;
        }
        if (*next < graph->first[body + 1]) {
            flow->path[length++] = *next;
            body = to;
        } else if (length) {
            /* a dead end: step back and skip the arc that led here */
            int end = graph->incident[flow->path[--length]];
            body = graph->edge[end / 2].end[end % 2];
            flow->next[body]++;
        } else {
            return false;
        }
    }
    flow_augment(flow, source, body, length);
    return true;
}

/* ---- diagnosis -------------------------------------------------------------------------------- */

enum { NAMES_SHOWN = 12, NAMES_MOST = 16 };

/* A part of the graph that a message is about. */
typedef struct Part {
    bool *body, *edge;                       /* [bodies], [edges] members */
    int bodies, joints, coordinates, weight; /* counts, and the sum of equations */
    int first;                               /* the first of its bodies in the order of the file */
} Part;

/* The bodies of `set` that are connected with body `first`, and their edges; they are removed from `set`. */
static Part part_take(const Graph *graph, bool *set, int first)
{
    Part part = {.first = first};
    part.body = pool_alloc(graph->pool, (size_t)graph->model->bodies * sizeof *part.body);
    part.edge = pool_alloc(graph->pool, (size_t)graph->edges * sizeof *part.edge);
    int *queue = ints(graph->pool, graph->model->bodies), tail = 0;
    queue[tail++] = first;
    set[first] = false;
    for (int head = 0; head < tail; ++head) {
        part.body[queue[head]] = true;
        for (int i = graph->first[queue[head]]; i < graph->first[queue[head] + 1]; ++i) {
            int e = graph->incident[i] / 2, other = graph->edge[e].end[1 - graph->incident[i] % 2];
            if (other >= 0 && set[other]) {
                set[other] = false;
                queue[tail++] = other;
            }
        }
    }
    part.bodies = tail;
    return part;
}

/* Add the edges whose equations determine bodies of the part: in an over- or under-determined part all edges that take
 * part in the excess or the lack. */
static void part_add_edges(const Graph *graph, Part *part)
{
    for (int i = 0; i < graph->edges; ++i) {
        const Edge *edge = &graph->edge[i];
        for (int k = 0; k < 2; ++k)
            part->edge[i] |= edge->end[k] >= 0 && part->body[edge->end[k]] && edge->rows[k] > 0;
        if (part->edge[i]) {
            part->weight += edge->weight;
            ++*(i < graph->model->joints ? &part->joints : &part->coordinates);
        }
    }
}

/* Append `'a', 'b' and 3 more`. */
static void name_add(Text *text, const char *name, int position, int count)
{
    const int shown = count > NAMES_MOST ? NAMES_SHOWN : count; /* naming a few more is as short as counting them */
    if (position < shown)
        text_print(text, "%s'%s'", position ? ", " : "", name);
    else if (position == shown)
        text_print(text, " and %d more", count - shown);
}

static const char *body_names(const Graph *graph, const Part *part)
{
    Text text = {.pool = graph->pool};
    text_print(&text, "%s ", part->bodies > 1 ? "bodies" : "body");
    for (int i = 0, k = 0; i < graph->model->bodies; ++i)
        if (part->body[i])
            name_add(&text, graph->model->body[i].name, k++, part->bodies);
    return text.s;
}

/* `joints 'a', 'b' and dual coordinate 'c'` of a part; "nothing" if it has none. */
static const char *edge_names(const Graph *graph, const Part *part)
{
    const Model *model = graph->model;
    Text text = {.pool = graph->pool};
    if (part->joints)
        text_print(&text, "%s ", part->joints > 1 ? "joints" : "joint");
    for (int i = 0, k = 0; i < model->joints; ++i)
        if (part->edge[i])
            name_add(&text, model->joint[i].name, k++, part->joints);
    if (part->coordinates)
        text_print(&text, "%sdual coordinate%s ", part->joints ? " and " : "", part->coordinates > 1 ? "s" : "");
    for (int i = 0, k = 0; i < model->coordinates; ++i)
        if (part->edge[model->joints + i])
            name_add(&text, model->coordinate[i].name, k++, part->coordinates);
    if (!part->joints && !part->coordinates)
        text_print(&text, "nothing");
    return text.s;
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

/* The strongest type with fewer equations than `type`, at most `most` fewer; -1: none. */
static int weaker_type(JointType type, int most)
{
    int best = -1;
    for (int i = 0; i < JOINT_TYPES; ++i) {
        int drop = joint_equations[type] - joint_equations[i];
        if (drop > 0 && drop <= most && (best < 0 || joint_equations[i] > joint_equations[best]))
            best = i;
    }
    return best;
}

/* First joint of the part that can lose some equations, at most `most`; -1: none. */
static int relaxable_joint(const Graph *graph, const Part *part, int most)
{
    for (int i = 0; i < graph->model->joints; ++i) {
        JointType type = graph->model->joint[i].type;
        if (part->edge[i] && (joint_equations[type] <= most || weaker_type(type, most) >= 0))
            return i;
    }
    return -1;
}

/* Suggest a removal of `excess` equations of the part; returns the place of the first change. */
static Place suggest_relaxing(const Graph *graph, const Part *part, int excess, Text *text)
{
    const Model *model = graph->model;
    bool coordinates_suffice = part->coordinates >= excess;
    int most = excess, joint = relaxable_joint(graph, part, most), coordinate = 0;
    /* no joint can lose so few equations: dual coordinates take up the motions that a weaker one leaves */
    while (joint < 0 && !coordinates_suffice && most < BODY_UNKNOWNS)
        joint = relaxable_joint(graph, part, ++most);
    while (coordinate < model->coordinates && !part->edge[model->joints + coordinate])
        ++coordinate;
    text_print(text, "take away %d equation%s; for example, ", excess, plural(excess));
    Place at;
    const char *relaxed = relax_suggest(graph->pool, model, part->body, part->edge, false, &at);
    if (relaxed) {
        text_print(text, "%s", relaxed);
        return at;
    }
    if (coordinates_suffice)
        text_print(text, "remove dual coordinate '%s'%s", model->coordinate[coordinate].name,
                   joint >= 0 ? ", or " : "");
    if (joint >= 0) {
        JointType type = model->joint[joint].type;
        text_print(text, "%s joint '%s' (%s, %d)", joint_equations[type] <= most ? "remove" : "weaken",
                   model->joint[joint].name, joint_type_name[type], joint_equations[type]);
        int weaker = weaker_type(type, most);
        if (joint_equations[type] > most)
            text_print(text, " to %s (%d)", joint_type_name[weaker], joint_equations[weaker]);
        if (most > excess)
            text_print(text, " and add %d dual coordinate%s", most - excess, plural(most - excess));
    }
    return coordinates_suffice ? model->coordinate[coordinate].at : model->joint[joint].at;
}

static bool *bodies_where(const Graph *graph, const int *excess, int sign)
{
    bool *set = pool_alloc(graph->pool, (size_t)graph->model->bodies * sizeof *set);
    for (int i = 1; i < graph->model->bodies; ++i)
        set[i] = sign * excess[i] > 0;
    return set;
}

/* The bodies by which a set grows: those that rows of its members can move to (an over-determined part), those whose
 * rows can move to its members (an under-determined part), or all that an edge leads to. */
typedef enum Closure { ROWS_OUT, ROWS_IN, ANY_EDGE } Closure;

static void close_set(const Graph *graph, bool *set, Closure closure)
{
    int *queue = ints(graph->pool, graph->model->bodies), tail = 0;
    for (int i = 1; i < graph->model->bodies; ++i)
        if (set[i])
            queue[tail++] = i;
    for (int head = 0; head < tail; ++head)
        for (int i = graph->first[queue[head]]; i < graph->first[queue[head] + 1]; ++i) {
            const Edge *edge = &graph->edge[graph->incident[i] / 2];
            int side = graph->incident[i] % 2, other = edge->end[1 - side];
            if (other < 0 || set[other])
                continue;
            if (closure == ANY_EDGE || edge->rows[closure == ROWS_OUT ? side : 1 - side] > 0) {
                set[other] = true;
                queue[tail++] = other;
            }
        }
}

static int first_body(const Graph *graph, const bool *set)
{
    for (int i = 1; i < graph->model->bodies; ++i)
        if (set[i])
            return i;
    return -1;
}

static _Noreturn void fail_over(const Graph *graph, const Part *part, const char *more)
{
    int unknowns = BODY_UNKNOWNS * part->bodies, excess = part->weight - unknowns;
    Text remedy = {.pool = graph->pool};
    Place at = suggest_relaxing(graph, part, excess, &remedy);
    text_print(&remedy, "%s", more);
    diag_fail(at, remedy.s, "%s impose %d conditions on %s, %d more than the %d degrees of freedom to determine",
              edge_names(graph, part), part->weight, body_names(graph, part), excess, unknowns);
}

/* ` (point_on_line, parallel, ...)`: the joints with `equations` equations; "" if there are none. */
static const char *joints_with(const Graph *graph, int equations)
{
    Text text = {.pool = graph->pool};
    text_add(&text, "", 0);
    for (int i = 0; i < JOINT_TYPES; ++i)
        if (joint_equations[i] == equations)
            text_print(&text, "%s%s", text.size ? ", " : " (", joint_type_name[i]);
    return text.size ? pool_print(graph->pool, "%s)", text.s) : text.s;
}

static _Noreturn void fail_under(const Graph *graph, const Part *part, const char *more)
{
    int want = BODY_UNKNOWNS * part->bodies - part->weight;
    Place at;
    const char *example = relax_suggest(graph->pool, graph->model, part->body, part->edge, false, &at);
    const char *remedy = pool_print(
        graph->pool, "add %s (a spring length, an angle) or a joint with %s%s here%s%s; what determines %s now: %s%s",
        want == 1 ? "a dual coordinate" : pool_print(graph->pool, "%d dual coordinates", want),
        want == 1 ? "one equation" : "as many equations", joints_with(graph, want), example ? "; for example, " : "",
        example ? example : "", part->bodies > 1 ? "them" : "it", edge_names(graph, part), more);
    diag_fail(graph->model->body[part->first].at, remedy,
              "%s %s %d degree%s of freedom more than joints and dual coordinates determine", body_names(graph, part),
              part->bodies > 1 ? "have" : "has", want, plural(want));
}

/* `; and besides: bodies ...` for the parts that remain in the two sets; "" if none remains. */
static const char *other_faults(const Graph *graph, bool *over, bool *under)
{
    Text text = {.pool = graph->pool};
    text_add(&text, "", 0);
    for (int i = first_body(graph, over); i >= 0; i = first_body(graph, over)) {
        Part part = part_take(graph, over, i);
        text_print(&text, "; besides, %s %s over-determined", body_names(graph, &part), part.bodies > 1 ? "are" : "is");
    }
    for (int i = first_body(graph, under); i >= 0; i = first_body(graph, under)) {
        Part part = part_take(graph, under, i);
        text_print(&text, "; besides, %s %s under-determined", body_names(graph, &part),
                   part.bodies > 1 ? "are" : "is");
    }
    return text.s;
}

/* Report excess and lack after a maximum matching. Over-determined parts come first: their surplus is often what
 * another part lacks. */
static _Noreturn void fail_unmatched(const Graph *graph, const int *excess)
{
    bool *over = bodies_where(graph, excess, 1), *under = bodies_where(graph, excess, -1);
    close_set(graph, over, ROWS_OUT);
    close_set(graph, under, ROWS_IN);
    bool is_over = first_body(graph, over) >= 0;
    bool *set = is_over ? over : under;
    Part part = part_take(graph, set, first_body(graph, set));
    part_add_edges(graph, &part);
    const char *more = other_faults(graph, over, under);
    if (is_over)
        fail_over(graph, &part, more);
    fail_under(graph, &part, more);
}

/* Report bodies that no chain of edges connects to the base. */
static void check_connected(const Graph *graph)
{
    const Model *model = graph->model;
    bool *set = pool_alloc(graph->pool, (size_t)model->bodies * sizeof *set);
    for (int i = 0; i < graph->edges; ++i)
        for (int k = 0; k < 2; ++k)
            if (graph->edge[i].end[k] >= 0)
                set[graph->edge[i].end[k]] |= graph->edge[i].end[1 - k] < 0;
    close_set(graph, set, ANY_EDGE);
    for (int i = 1; i < model->bodies; ++i)
        set[i] = !set[i];
    int first = first_body(graph, set);
    if (first < 0)
        return;
    Part part = part_take(graph, set, first);
    const char *base = model->body[BODY_BASE].name;
    Place at = model->body[first].at;
    if (part.bodies == 1)
        diag_fail(at, "add joints and dual coordinates with 6 equations in total, or remove the body",
                  "%s is connected to nothing", body_names(graph, &part));
    diag_fail(at,
              pool_print(graph->pool, "add joints or dual coordinates between them and '%s' or a body that hangs on it",
                         base),
              "%s are not connected to the base '%s'", body_names(graph, &part), base);
}

void graph_match(Graph *graph)
{
    int bodies = graph->model->bodies;
    Pool *pool = graph->pool;
    check_connected(graph);
    Flow flow = {
        graph, ints(pool, bodies), ints(pool, bodies), ints(pool, bodies), ints(pool, bodies), ints(pool, bodies)};
    for (int i = 1; i < bodies; ++i)
        flow.excess[i] = -BODY_UNKNOWNS;
    for (int i = 0; i < graph->edges; ++i)
        for (int k = 0; k < 2; ++k)
            if (graph->edge[i].end[k] >= 0)
                flow.excess[graph->edge[i].end[k]] += graph->edge[i].rows[k];
    while (flow_levels(&flow))
        for (int i = 1; i < bodies; ++i)
            while (flow.excess[i] > 0 && flow_push(&flow, i))
                continue;
    for (int i = 1; i < bodies; ++i)
        if (flow.excess[i])
            fail_unmatched(graph, flow.excess);
}

/* ---- components ------------------------------------------------------------------------------- */

/* Tarjan's algorithm with an explicit stack, so that long chains of bodies don't exhaust the C stack. A component is
 * complete after those it refers to: their order is the computational one. */
int graph_components(const Graph *graph, int *component)
{
    int bodies = graph->model->bodies, count = 0, visited = 0, opened = 0;
    int *number = ints(graph->pool, bodies); /* order of discovery from 1; 0: not yet found */
    int *low = ints(graph->pool, bodies);    /* least number reachable within the open components */
    int *open = ints(graph->pool, bodies);   /* bodies found whose component is not complete */
    int *walk = ints(graph->pool, bodies), *next = ints(graph->pool, bodies);
    memcpy(next, graph->first, (size_t)bodies * sizeof *next);
    for (int i = 0; i < bodies; ++i)
        component[i] = -1;
    for (int root = 1; root < bodies; ++root) {
        int depth = 0;
        if (!number[root])
            walk[depth++] = root;
        while (depth) {
            int body = walk[depth - 1], deeper = -1;
            if (!number[body]) {
                number[body] = low[body] = ++visited;
                open[opened++] = body;
            }
            while (deeper < 0 && next[body] < graph->first[body + 1]) {
                int to = move_target(graph, next[body]);
                if (to >= 0 && !number[to]) {
                    deeper = to;
                } else {
                    if (to >= 0 && component[to] < 0 && low[to] < low[body])
                        low[body] = low[to];
                    next[body]++;
                }
            }
            if (deeper >= 0) {
                walk[depth++] = deeper;
                continue;
            }
            --depth;
            if (low[body] < number[body])
                continue;
            for (int last = -1; last != body; component[last] = count)
                last = open[--opened];
            ++count;
        }
    }
    return count;
}
