/* SPDX-License-Identifier: MIT
 * The Jacobian of implicit steps, and its factors, in pieces, so that many steps share the work: Style.spread. What one
 * piece leaves to another stands in the instance. */
#include "base/text.h"
#include "emit/emit.h"
#include "emit/emit_private.h"
#include "expression/expression.h"
#include "expression/split.h"
#include "model/model.h"
#include "sequence/sequence.h"
#include "subset/subset.h"
#include "vehicle/columns.h"
#include "vehicle/vehicle.h"

typedef enum PieceKind {
    PIECE_SUBSET,   /* columns of one subset, `first` */
    PIECE_FAST,     /* a block of the fast states */
    PIECE_WHEEL,    /* wheel `end` of class `first` */
    PIECE_DRIVE,    /* the powertrain */
    PIECE_CLEAR,    /* right[] = 0 */
    PIECE_WHOLE,    /* a block of the whole vehicle */
    PIECE_SOLUTION, /* SIDE_BY_SIDE lanes from `first` on of right[] and part[] */
    PIECE_FINITE,   /* are numbers `first` to end - 1 of the Jacobian finite? */
    PIECE_MASSES,   /* are the masses finite? */
    PIECE_FACTORS   /* rows `first` to end - 1 of the factors */
} PieceKind;

typedef struct Piece {
    PieceKind kind;
    int work, first, end;
    const Block *block;
} Piece;

struct Spread {
    int pieces, factors; /* those of the factors come last */
    Piece *piece;
    int kept; /* numbers of factor[] */
};

/* Numbers per unit of work: that are set to 0; that are looked at. */
enum { CLEARED = 8, LOOKED_AT = 2 };
/* Columns that are solved side by side in vectors, and by how much faster than one after another they are then. */
enum { SIDE_BY_SIDE = 8, FASTER = 4 };
/* Pieces that are as good as the whole: about so many, none with less work. */
enum { PIECES = 64, LEAST_WORK = 60 };

static void add(Generation *g, struct Spread *spread, Piece piece)
{
    *POOL_PUSH(g->pool, spread->piece, spread->pieces) = piece;
}

static void add_block(Generation *g, struct Spread *spread, PieceKind kind, const Block *block, int most)
{
    Block *part = NULL;
    const int parts = block_split(block, most, ARRAY_factor, &spread->kept, &part);
    for (int i = 0; i < parts; ++i)
        if (part[i].stores)
            add(g, spread, (Piece){.kind = kind, .work = block_work(&part[i]), .block = &part[i]});
}

static void add_wheels(Generation *g, struct Spread *spread, const RateColumns *columns, int most)
{
    const WheelColumns *w = columns->wheels;
    const Block link = wheel_columns_link(g);
    add_block(g, spread, PIECE_FAST, &link, most);
    if (w->torque.block.stores)
        add(g, spread, (Piece){.kind = PIECE_FAST, .work = block_work(&w->torque.block), .block = &w->torque.block});
    for (int c = 0; c < w->wheels->classes; ++c) {
        const WheelClassColumns *class = &w->class[c];
        const int work =
            block_work(&class->contact.block) + block_work(&class->tire) + block_work(&class->balance.block);
        for (int i = 0; i < w->wheels->class[c].members; ++i)
            add(g, spread, (Piece){.kind = PIECE_WHEEL, .work = work, .first = c, .end = i});
    }
    if (g->model->powertrain)
        add(g, spread, (Piece){.kind = PIECE_DRIVE, .work = block_work(&w->drive.block)});
}

/* Ranges of `count` alike things of that work each. */
static void add_ranges(Generation *g, struct Spread *spread, PieceKind kind, int count, double work, int most)
{
    const int length = 1 + (int)(most / (work + 1e-3));
    for (int first = 0; first < count; first += length) {
        const int end = first + length < count ? first + length : count;
        add(g, spread, (Piece){.kind = kind, .work = (int)((end - first) * work), .first = first, .end = end});
    }
}

static void add_factors(Generation *g, struct Spread *spread, int most)
{
    int *unknown, *position;
    const int n = implicit_unknowns(g, &unknown, &position), before = spread->pieces;
    for (int first = 0, end; first < n; first = end) {
        int work = 0;
        for (end = first; end < n && (end == first || work < most); ++end)
            work += elimination_work(g, n, unknown, position, end);
        add(g, spread, (Piece){.kind = PIECE_FACTORS, .work = work, .first = first, .end = end});
    }
    spread->factors = spread->pieces - before;
}

static int whole_work(const RateColumns *columns)
{
    return block_work(&columns->residuals) + block_work(&columns->block) +
           block_work(&columns->solution) * columns->lanes / FASTER +
           (columns->wheels ? block_work(&columns->wheels->link) : 0);
}

static const struct Spread *spread_of(Generation *g)
{
    if (g->spread)
        return g->spread;
    const bool before = g->weighing;
    g->weighing = true;
    const RateColumns *columns = columns_of(g);
    const int whole = whole_work(columns) / PIECES, most = whole > LEAST_WORK ? whole : LEAST_WORK;
    struct Spread *spread = g->spread = pool_alloc(g->pool, sizeof *spread);
    *spread = (struct Spread){.kept = columns->factors};
    for (int s = 0; s < g->sequence->subsets; ++s) {
        const int class = g->sequence->subset[s].class;
        if (class >= 0 && columns->motion[class]->size)
            add(g, spread,
                (Piece){.kind = PIECE_SUBSET, .work = block_work(&columns->motion[class]->block), .first = s});
    }
    if (columns->wheels)
        add_wheels(g, spread, columns, most);
    add(g, spread,
        (Piece){.kind = PIECE_CLEAR, .work = room(g->plan->unknowns) * (columns->lanes + 7) / 8 * 8 / CLEARED});
    add_block(g, spread, PIECE_WHOLE, placed_block(g, &columns->residuals), most);
    const int solved = (block_work(&columns->solution) + 1) * SIDE_BY_SIDE / FASTER;
    if (columns->solution.stores)
        for (int first = 0; first < columns->lanes; first += SIDE_BY_SIDE)
            add(g, spread, (Piece){.kind = PIECE_SOLUTION, .work = solved, .first = first});
    add_block(g, spread, PIECE_WHOLE, placed_block(g, &columns->block), most);
    add_ranges(g, spread, PIECE_FINITE, states(g) * jacobian_columns(g), 1.0 / LOOKED_AT, most);
    add(g, spread, (Piece){.kind = PIECE_MASSES, .work = columns->masses / LOOKED_AT});
    add_factors(g, spread, most);
    g->weighing = before;
    return spread;
}

bool is_spread(Generation *g)
{
    return g->style->implicit && g->style->spread && weighed_columns(g) && implicit_is_short(g);
}

/* An array of the work space, of rows of `columns` or, 0, of single numbers, where out is not NULL; returns how many
 * numbers it has. */
static int array(Text *out, int indent, const char *name, int rows, int columns)
{
    if (out && columns)
        line(out, indent, "gic_real %s[%d][%d];", name, room(rows), columns);
    else if (out)
        line(out, indent, "gic_real %s[%d];", name, room(rows));
    return room(rows) * (columns ? columns : 1);
}

static int work_space(Generation *g, Text *out, int indent)
{
    const struct Spread *spread = spread_of(g);
    const RateColumns *columns = weighed_columns(g);
    const WheelColumns *w = columns->wheels;
    const Wheels *wheels = g->formulation->wheels;
    const int lanes = column_lanes(g);
    return array(out, indent, "column", columns->size, 0) + array(out, indent, "factor", spread->kept, 0) +
           array(out, indent, "right", g->plan->unknowns, lanes) + array(out, indent, "local", w ? w->locals : 0, 0) +
           array(out, indent, "part", w ? w->parts : 0, lanes) + array(out, indent, "link", w ? wheels->links : 0, 0) +
           array(out, indent, "rate", w ? g->model->fast_states : 0, 0) +
           array(out, indent, "torque", w ? 2 * wheels->count : 0, 0) +
           array(out, indent, "grip", w ? GRIP_NUMBERS * wheels->count : 0, 0);
}

const char *spread_numbers(Generation *g)
{
    int *unknown, *position;
    const int n = implicit_unknowns(g, &unknown, &position);
    return pool_print(g->pool, " + /* spread over steps: */ %d + %d",
                      states(g) * jacobian_columns(g) + weighed_columns(g)->masses + n * n, work_space(g, NULL, 0));
}

void write_shares_work(void *context, Text *out, int indent)
{
    work_space(context, out, indent);
}

/* The statements of a piece of the columns. */
static void write_piece(Generation *g, Text *out, const Piece *piece)
{
    Constants none = {0};
    switch (piece->kind) {
    case PIECE_SUBSET: write_columns_call(g, out, 4, piece->first); break;
    case PIECE_FAST:
    case PIECE_WHOLE:
        line(out, 4, "{");
        if (piece->kind == PIECE_FAST)
            write_fast_block(g, out, piece->block, SCOPE_FAST, &none, 8);
        else
            block_emit(out, piece->block, g->style, &none, 8);
        line(out, 4, "}");
        break;
    case PIECE_WHEEL: write_wheel_columns_call(g, out, 4, piece->first, piece->end); break;
    case PIECE_DRIVE: write_drive_columns(g, out, 4); break;
    case PIECE_CLEAR: line(out, 4, "memset(right, 0, sizeof work->right);"); break;
    case PIECE_SOLUTION:
        line(out, 4, "%s_side_by_side(factor, local, part, right, %d);", g->model->name, piece->first);
        break;
    case PIECE_FINITE:
        line(out, 4, "%s_without_infinite(jacobian + %d, %d);", g->model->name, piece->first,
             piece->end - piece->first);
        break;
    case PIECE_MASSES:
        line(out, 4, "if (!GIC_FINITE(jacobian + %s_STATES * %s_JACOBIAN_COLUMNS, %s_MASSES))", g->upper, g->upper,
             g->upper);
        line(out, 8, "status = GIC_ERROR_RESULT;");
        break;
    case PIECE_FACTORS: break;
    }
}

typedef struct Expansion {
    Generation *g;
    const Piece *piece;
} Expansion;

static void write_share_statements(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    (void)indent;
    write_piece(x->g, out, x->piece);
}

static void write_share_turn(void *context, Text *out, int indent)
{
    const Expansion *x = context;
    if (x->piece->kind == PIECE_SUBSET)
        write_columns_turn(x->g, out, indent);
}

/* What the step's evaluation left in the instance. */
static void write_share_found(void *context, Text *out, int indent)
{
    const Generation *g = ((const Expansion *)context)->g;
    line(out, indent, "const gic_real *const x = self->x, *const xd = self->xd, *const u = self->input, *const m = %s;",
         found_text(g, "motion"));
    line(out, indent, "const gic_real *const p = self->parameter, *const port = self->port, *const n = %s;",
         found_text(g, "inertia"));
    line(out, indent, "const gic_real *const start = %s, *const fast = y + %s_SLOW;", found_text(g, "start"), g->upper);
}

static const Insertion share_point[] = {{"share found", write_share_found},
                                        {"share turn", write_share_turn},
                                        {"share statements", write_share_statements},
                                        {NULL, NULL}};

const Insertions share_points = {(const char *const[]){"columns_share.c.in", NULL}, share_point, NULL};

void write_shares(void *context, Text *out, int indent)
{
    Generation *g = context;
    const struct Spread *spread = spread_of(g);
    (void)indent;
    for (int i = 0; i < spread->pieces - spread->factors; ++i) {
        Expansion x = {g, &spread->piece[i]};
        template_expand(g->pool, out, g->templates, "columns_share.c.in", g->model->name, pool_print(g->pool, "%d", i),
                        &share_points, &x);
    }
}

static void write_side_statements(void *context, Text *out, int indent)
{
    Generation *g = context;
    Constants none = {0};
    line(out, indent, "for (c = first; c < first + %d; ++c) {", SIDE_BY_SIDE);
    block_emit(out, placed_block(g, &columns_of(g)->solution), g->style, &none, indent + 4);
    line(out, indent, "}");
}

static const Insertion side_point[] = {{"side statements", write_side_statements}, {NULL, NULL}};

const Insertions side_points = {(const char *const[]){"columns_side.c.in", NULL}, side_point, NULL};

void write_side_by_side(void *context, Text *out, int indent)
{
    Generation *g = context;
    (void)indent;
    if (columns_of(g)->solution.stores)
        template_expand(g->pool, out, g->templates, "columns_side.c.in", g->model->name, NULL, &side_points, g);
}

void write_shares_table(void *context, Text *out, int indent)
{
    Generation *g = context;
    const struct Spread *spread = spread_of(g);
    for (int i = 0; i < spread->pieces - spread->factors; ++i)
        line(out, indent, "%s_share_%d,", g->model->name, i);
}

void write_factor_shares(void *context, Text *out, int indent)
{
    Generation *g = context;
    const struct Spread *spread = spread_of(g);
    int *unknown, *position;
    const int n = implicit_unknowns(g, &unknown, &position);
    (void)indent;
    for (int i = spread->pieces - spread->factors; i < spread->pieces; ++i) {
        line(out, 0, "static GIC_APART int %s_factors_%d(const gic_real *GIC_RESTRICT J, gic_real reach, gic_real",
             g->model->name, i);
        line(out, 4, "*GIC_RESTRICT f)");
        line(out, 0, "{");
        line(out, 4,
             "const gic_real least = R(0.01), lightest = sizeof(gic_real) < sizeof(double) ? R(1e-3) : R(1e-6), r = "
             "-reach;");
        line(out, 4, "(void)least, (void)lightest, (void)r;");
        write_elimination_rows(g, out, 4, n, unknown, position, spread->piece[i].first, spread->piece[i].end);
        line(out, 4, "return 1;");
        line(out, 0, "}");
        line(out, 0, "%s", "");
    }
}

void write_factor_table(void *context, Text *out, int indent)
{
    Generation *g = context;
    const struct Spread *spread = spread_of(g);
    for (int i = spread->pieces - spread->factors; i < spread->pieces; ++i)
        line(out, indent, "%s_factors_%d,", g->model->name, i);
}

/* The work of all pieces up to each. */
void write_share_work_table(void *context, Text *out, int indent)
{
    Generation *g = context;
    const struct Spread *spread = spread_of(g);
    int work = 0;
    for (int i = 0; i < spread->pieces; ++i) {
        work += spread->piece[i].work;
        line(out, indent, "%d,", work);
    }
}
