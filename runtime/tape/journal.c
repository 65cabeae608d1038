/* SPDX-License-Identifier: MIT
 * Backwards through tapes. A tape that gives slots back forgets arguments, so it is played with a slot for each result;
 * the frame then has all that the way back needs. */
#include "tape/journal.h"
#include "gic_runtime.h"
#include "tape/play_private.h"

#include <math.h>
#include <string.h>

/* A tape, and the same with a slot for each result. */
typedef struct Unfolded {
    const Tape *tape;
    Tape wide;
} Unfolded;

/* Numbers that do not move. */
typedef struct Chunk {
    double *number;
    size_t room, used;
} Chunk;

/* A tape that was played, or without one a copy. */
typedef struct Entry {
    const Tape *tape;
    double *frame;
    double **bar; /* [arrays] */
    TapeWorld world;
    double *from, *to;
    int count;
} Entry;

struct TapeJournal {
    Pool *pool;
    Unfolded *unfolded;
    int unfoldeds;
    Chunk *chunk;
    int chunks, now;
    Entry *entry;
    int entries, entry_room;
    double *slope; /* [slots] of the widest tape */
    int slots, infinite;
};

/* ---- tapes that forget nothing ---------------------------------------------------------------------------- */

/* The number of operands of a kind of operation after the result that are slots, and how many there are with the
 * result. */
static int operands_of(int kind, int *slots)
{
    switch (kind) {
    case TAPE_MUL_ADD:
    case TAPE_MUL_SUB:
    case TAPE_SUB_MUL:
    case OP_POSITIVE: return (*slots = 3) + 1;
    case OP_TABLE: return (*slots = 1) + 2;
    case OP_ROAD: return (*slots = 2) + 1;
    default: return (*slots = ex_arity((Op)kind)) + 1;
    }
}

static int operands_in(const Tape *tape)
{
    int count = 0, slots;
    for (int r = 0; r < tape->runs; ++r)
        count += tape->run[r].count * operands_of(tape->run[r].kind, &slots);
    return count;
}

static Tape unfold(Pool *pool, const Tape *tape)
{
    Tape wide = *tape;
    int *place = pool_alloc(pool, (size_t)(tape->slots + 1) * sizeof *place), next = tape->constants, at = 0;
    for (int i = 0; i < tape->loads; ++i)
        next = tape->load[i].slot + tape->load[i].count > next ? tape->load[i].slot + tape->load[i].count : next;
    for (int i = 0; i < tape->slots; ++i)
        place[i] = i; /* constants and what is loaded stay */
    const size_t operands = (size_t)operands_in(tape) + 1;
    wide.operand = pool_alloc(pool, operands * sizeof *wide.operand);
    memcpy(wide.operand, tape->operand, (operands - 1) * sizeof *wide.operand);
    for (int r = 0; r < tape->runs; ++r)
        for (int k = 0, slots, all; k < tape->run[r].count; ++k, at += all) {
            all = operands_of(tape->run[r].kind, &slots);
            for (int i = 1; i <= slots; ++i)
                wide.operand[at + i] = (uint32_t)place[tape->operand[at + i]];
            const int results = tape->run[r].kind == OP_ROAD ? 3 : 1;
            wide.operand[at] = (uint32_t)next;
            for (int i = 0; i < results; ++i)
                place[(int)tape->operand[at] + i] = next++;
        }
    wide.slots = next;
    wide.store = pool_alloc(pool, (size_t)(tape->stores + 1) * sizeof *wide.store);
    wide.check = pool_alloc(pool, (size_t)(tape->checks + 1) * sizeof *wide.check);
    for (int i = 0; i < tape->stores; ++i) {
        wide.store[i] = tape->store[i];
        wide.store[i].slot = place[tape->store[i].slot];
    }
    for (int i = 0; i < tape->checks; ++i) {
        wide.check[i] = tape->check[i];
        wide.check[i].slot = place[tape->check[i].slot];
    }
    return wide;
}

static const Tape *unfolded(TapeJournal *journal, const Tape *tape)
{
    for (int i = 0; i < journal->unfoldeds; ++i)
        if (journal->unfolded[i].tape == tape)
            return &journal->unfolded[i].wide;
    Unfolded *new = POOL_PUSH(journal->pool, journal->unfolded, journal->unfoldeds);
    *new = (Unfolded){tape, unfold(journal->pool, tape)};
    if (new->wide.slots > journal->slots) {
        journal->slots = new->wide.slots;
        journal->slope = pool_alloc(journal->pool, (size_t)journal->slots * sizeof(double));
    }
    return &new->wide;
}

/* ---- notes ------------------------------------------------------------------------------------------------- */

TapeJournal *journal_new(Pool *pool)
{
    TapeJournal *journal = pool_alloc(pool, sizeof *journal);
    journal->pool = pool;
    return journal;
}

void journal_begin(TapeJournal *journal)
{
    for (int i = 0; i < journal->chunks; ++i)
        journal->chunk[i].used = 0;
    journal->now = journal->entries = journal->infinite = 0;
}

/* Room that is not cleared. */
static double *room_for(TapeJournal *journal, int count)
{
    enum { CHUNK = 1 << 14 };
    const size_t wanted = (size_t)count;
    while (journal->now < journal->chunks &&
           journal->chunk[journal->now].room - journal->chunk[journal->now].used < wanted)
        ++journal->now;
    if (journal->now == journal->chunks) {
        const size_t room = wanted > CHUNK ? wanted : CHUNK;
        *POOL_PUSH(journal->pool, journal->chunk, journal->chunks) =
            (Chunk){pool_alloc(journal->pool, room * sizeof(double)), room, 0};
    }
    Chunk *chunk = &journal->chunk[journal->now];
    chunk->used += wanted;
    return chunk->number + chunk->used - wanted;
}

double *journal_room(TapeJournal *journal, int count)
{
    double *room = room_for(journal, count);
    memset(room, 0, (size_t)count * sizeof *room);
    return room;
}

double *journal_numbers(const TapeWorld *world, double *local, int count)
{
    return world->journal ? journal_room(world->journal, count) : local;
}

/* Entries keep their place, and room, from one journal to the next. */
static Entry *next_entry(TapeJournal *journal)
{
    if (journal->entries == journal->entry_room)
        *POOL_PUSH(journal->pool, journal->entry, journal->entry_room) = (Entry){.tape = NULL};
    return &journal->entry[journal->entries++];
}

int journal_play(TapeJournal *journal, const Tape *tape, int member, double *const *array, double *const *bar,
                 const TapeWorld *world)
{
    const Tape *wide = unfolded(journal, tape);
    double *frame = room_for(journal, wide->slots);
    const int status = tape_play(wide, member, array, world, frame);
    if (status != GIC_OK)
        return status;
    double **own = (double **)(void *)room_for(journal, tape->arrays);
    memcpy(own, bar, (size_t)tape->arrays * sizeof *own);
    *next_entry(journal) = (Entry){.tape = wide, .frame = frame, .bar = own, .world = *world};
    return GIC_OK;
}

void journal_copy(TapeJournal *journal, double *from, double *to, int count)
{
    *next_entry(journal) = (Entry){.from = from, .to = to, .count = count};
}

/* ---- and back ---------------------------------------------------------------------------------------------- */

/* A share of a derivative: where the factor is not finite, 0. */
static double share(TapeJournal *journal, double factor, double by)
{
    if (isfinite(factor))
        return factor * by;
    ++journal->infinite;
    return 0;
}

/* By the arguments of a power; exponents that are constants have no derivative. */
static void power_back(TapeJournal *journal, bool constant, double a, double b, double r, double by, double *da,
                       double *db)
{
    *da += share(journal, b * pow(a, b - 1), by);
    if (!constant)
        *db += share(journal, r * log(a), by);
}

static void road_back(const TapeWorld *world, double x, double y, const double road[3], const double by[3], double *dx,
                      double *dy)
{
    double change[2][3];
    tape_road_change(world, x, y, 1, 0, road, change[0]);
    tape_road_change(world, x, y, 0, 1, road, change[1]);
    for (int i = 0; i < 3; ++i) {
        *dx += change[0][i] * by[i];
        *dy += change[1][i] * by[i];
    }
}

#define BACK(operands, shares) \
    for (; left; --left) { \
        at -= (operands); \
        const double by = d[at[0]]; \
        if (by != 0) { \
            shares; \
        } \
    } \
    break
#define A f[at[1]]
#define B f[at[2]]
#define C f[at[3]]
#define R f[at[0]]
#define DA d[at[1]]
#define DB d[at[2]]
#define DC d[at[3]]

static void runs_back(TapeJournal *journal, const Tape *tape, const TapeWorld *world, const double *f, double *d)
{
    const uint32_t *at = tape->operand + operands_in(tape);
    for (const TapeRun *run = tape->run + tape->runs; run-- > tape->run;) {
        int left = run->count;
        switch (run->kind) {
        case TAPE_MUL_ADD: BACK(4, DA += B * by; DB += A * by; DC += by);
        case TAPE_MUL_SUB: BACK(4, DA += B * by; DB += A * by; DC -= by);
        case TAPE_SUB_MUL: BACK(4, DA -= B * by; DB -= A * by; DC += by);
        case OP_NEG: BACK(2, DA -= by);
        case OP_ADD: BACK(3, DA += by; DB += by);
        case OP_SUB: BACK(3, DA += by; DB -= by);
        case OP_MUL: BACK(3, DA += B * by; DB += A * by);
        case OP_DIV: BACK(3, DA += by / B; DB -= R * (by / B));
        case OP_SQRT: BACK(2, DA += share(journal, 0.5 / R, by));
        case OP_ABS: BACK(2, DA += A > 0 ? by : A < 0 ? -by : 0);
        case OP_SIN: BACK(2, DA += cos(A) * by);
        case OP_COS: BACK(2, DA -= sin(A) * by);
        case OP_TAN: BACK(2, DA += (1 + R * R) * by);
        case OP_ASIN: BACK(2, DA += share(journal, 1 / sqrt(1 - A * A), by));
        case OP_ACOS: BACK(2, DA += share(journal, -1 / sqrt(1 - A * A), by));
        case OP_ATAN: BACK(2, DA += by / (1 + A * A));
        case OP_EXP: BACK(2, DA += R * by);
        case OP_LOG: BACK(2, DA += share(journal, 1 / A, by));
        case OP_TANH: BACK(2, DA += (1 - R * R) * by);
        case OP_POW: BACK(3, power_back(journal, (int)at[2] < tape->constants, A, B, R, by, &DA, &DB));
        case OP_ATAN2:
            BACK(3, const double square = A * A + B * B; DA += square > 0 ? B / square * by : 0;
                 DB -= square > 0 ? A / square * by : 0);
        case OP_MIN: BACK(3, d[at[A < B ? 1 : 2]] += by);
        case OP_MAX: BACK(3, d[at[A > B ? 1 : 2]] += by);
        case OP_POSITIVE: BACK(4, d[at[A > 0 ? 2 : 3]] += by);
        case OP_FRICTION:
            BACK(3, DA += tape_friction_change(world, A, B, 1, 0) * by;
                 DB += tape_friction_change(world, A, B, 0, 1) * by);
        case OP_TABLE: BACK(3, DA += tape_table_slope(world, &world->table[at[2]], A, 1) * by);
        case OP_ROAD:
            for (; left; --left) {
                at -= 3;
                road_back(world, A, B, f + at[0], d + at[0], &DA, &DB);
            }
            break;
        default: break;
        }
    }
}

static void entry_back(TapeJournal *journal, const Entry *entry)
{
    const Tape *tape = entry->tape;
    double *d = journal->slope;
    memset(d, 0, (size_t)tape->slots * sizeof *d);
    for (int i = tape->stores; i-- > 0;) {
        double *bar = entry->bar[tape->store[i].array] + tape->store[i].offset;
        d[tape->store[i].slot] += *bar;
        *bar = 0;
    }
    runs_back(journal, tape, &entry->world, entry->frame, d);
    for (int i = 0; i < tape->loads; ++i)
        for (int k = 0; k < tape->load[i].count; ++k)
            entry->bar[tape->load[i].array][tape->load[i].offset + k] += d[tape->load[i].slot + k];
}

int journal_back(TapeJournal *journal)
{
    for (int i = journal->entries; i-- > 0;) {
        const Entry *entry = &journal->entry[i];
        if (entry->tape)
            entry_back(journal, entry);
        for (int k = 0; !entry->tape && k < entry->count; ++k) {
            if (entry->from)
                entry->from[k] += entry->to[k];
            entry->to[k] = 0;
        }
    }
    return journal->infinite;
}
