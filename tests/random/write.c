/* SPDX-License-Identifier: MIT
 * The files of a vehicle. */
#include "vehicle.h"

#include "../reference/support.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char *const title[KINDS] = {"parameters", "tables", "bodies", "joints", "coordinates", "forces", "wheels",
                                         "outputs",    "points", "inputs", "tires",  "states",      NULL};

/* The entries of a section in random order; a parameter may need what stands before it. */
static void shuffle(Vehicle *v, Kind kind, int order[])
{
    for (int i = 0; i < v->section[kind].count; ++i) {
        int j = pick(v, i + 1);
        if (v->rich && kind == PARAMETER)
            j = i;
        order[i] = order[j];
        order[j] = i;
    }
}

/* Text, names of a part without their prefix where `part` is one that gives it to them. */
static void write_text(FILE *out, const char *text, const Part *part)
{
    const size_t size = part && part->has_prefix ? strlen(part->name) : 0;
    for (const char *s = text; *s; ++s) {
        bool begins = s == text || !(isalnum((unsigned char)s[-1]) || s[-1] == '_');
        if (size && begins && !strncmp(s, part->name, size))
            s += size;
        fputc(*s, out);
    }
}

static void write_entry(FILE *out, const Entry *entry, const char *text, const Part *part)
{
    /* a point is a list, everything else a map */
    const char *open = *text == '[' ? "" : "{", *close = *text == '[' ? "" : "}";
    fputs("  ", out);
    write_text(out, entry->name, part);
    fprintf(out, ": %s", open);
    write_text(out, text, part);
    fprintf(out, "%s\n", close);
}

/* The entries of a part: as a file that is included, or as in one file of the whole, images behind what they are of. */
static bool write_section(Vehicle *v, FILE *out, Kind kind, const int order[], int part, bool plain, bool begun)
{
    const Section *section = &v->section[kind];
    for (int i = 0; i < section->count; ++i) {
        const Entry *entry = &section->entry[order[i]];
        if (entry->dropped || entry->is_image || entry->part != part)
            continue;
        if (!begun)
            fprintf(out, "%s:\n", title[kind]);
        begun = true;
        write_entry(out, entry, plain ? entry->plain : entry->text, plain ? NULL : &v->part[part]);
        if (plain && entry->image != NOTHING)
            write_entry(out, &section->entry[entry->image], section->entry[entry->image].plain, NULL);
    }
    return begun;
}

static void write_head(Vehicle *v, FILE *out, double seed)
{
    fprintf(out, "gicgen: 1\nmodel: random_%.0f\n", seed);
    fprintf(out, "base: %s\n", body_name(v, BASE));
    if (v->gravity)
        fprintf(out, "gravity: %s\n", v->gravity);
}

static void write_tail(const Vehicle *v, FILE *out)
{
    if (*v->powertrain)
        fprintf(out, "powertrain:\n%s", v->powertrain);
}

/* Whole sections, with parts in their order and the vehicle's own entries last, as inclusion joins them. */
static void write_whole(Vehicle *v, FILE *out, double seed, int order[][MOST])
{
    write_head(v, out, seed);
    for (Kind kind = PARAMETER; kind < KINDS; ++kind) {
        bool begun = false;
        for (int part = 1; part <= v->parts && title[kind]; ++part)
            begun = write_section(v, out, kind, order[kind], part, true, begun);
        if (title[kind])
            write_section(v, out, kind, order[kind], 0, true, begun);
    }
    write_tail(v, out);
}

static void shuffle_all(Vehicle *v, int order[][MOST])
{
    for (Kind kind = PARAMETER; kind < KINDS; ++kind)
        shuffle(v, kind, order[kind]);
}

void write_plain(Vehicle *v, FILE *out, double seed)
{
    int order[KINDS][MOST];
    shuffle_all(v, order);
    write_whole(v, out, seed, order);
}

/* Another tire of the same kind: numbers of its coefficients some percent larger or smaller, and another mode. */
static void vary_tire(Vehicle *v, const char *path, FILE *out)
{
    static const char *const exact[] = {"USE_MODE", "FILE_VERSION", "KPUMIN", "KPUMAX", "ALPMIN", "ALPMAX"};
    FILE *in = fopen(path, "r");
    char line[400], key[100];
    double value;
    if (!in)
        fail("can't read %s", path);
    while (fgets(line, sizeof line, in)) {
        bool varies = sscanf(line, "%99[A-Za-z0-9_] = %lf", key, &value) == 2;
        for (size_t i = 0; i < sizeof exact / sizeof *exact; ++i)
            varies = varies && strcmp(key, exact[i]) != 0;
        if (!strncmp(line, "USE_MODE", 8))
            fprintf(out, "USE_MODE = %d\n", chance(v, 0.5) ? 4 : pick(v, 4));
        else if (!strncmp(line, "TYRESIDE", 8))
            fprintf(out, "TYRESIDE = '%s'\n", chance(v, 0.6) ? "LEFT" : chance(v, 0.5) ? "RIGHT" : "SYMMETRIC");
        else if (varies)
            fprintf(out, "%s = %.9g\n", key, value * uniform(v, 0.9, 1.1));
        else
            fputs(line, out);
    }
    fclose(in);
}

static FILE *begin(const char *folder, double seed, const char *end)
{
    char path[1000] = "";
    append(path, sizeof path, "%s/%.0f%s", folder, seed, end);
    FILE *out = fopen(path, "w");
    if (!out)
        fail("can't write %s", path);
    return out;
}

void write_files(Vehicle *v, const char *folder, double seed, const char *tire)
{
    int order[KINDS][MOST];
    char text[40] = "";
    append(text, sizeof text, "file: %.0f.tir", seed);
    for (int i = 0; i < v->section[TIRE].count; ++i) {
        Entry *entry = &v->section[TIRE].entry[i];
        const char *rest = strstr(entry->text, "@TIRE@");
        if (rest) {
            char whole[sizeof entry->text] = "";
            append(whole, sizeof whole, "%s%s", text, rest + 6);
            strcpy(entry->text, whole);
            strcpy(entry->plain, whole);
        }
    }
    shuffle_all(v, order);
    FILE *out = begin(folder, seed, ".tir");
    vary_tire(v, tire, out);
    output_close(out, folder);
    for (int part = 0; part <= v->parts; ++part) {
        char end[20] = ".veh";
        if (part)
            snprintf(end, sizeof end, ".part%d.veh", part);
        out = begin(folder, seed, end);
        if (part)
            fputs("gicgen: 1\n", out);
        else
            write_head(v, out, seed);
        for (int i = 1; i <= v->parts && !part; ++i) {
            const Part *p = &v->part[i];
            fprintf(out, "%s  - {file: %.0f.part%d.veh", i > 1 ? "" : "include:\n", seed, i);
            fprintf(out, ", at: [%.9g, %.9g, %.9g]", p->at.x[0], p->at.x[1], p->at.x[2]);
            fprintf(out, p->has_prefix ? ", prefix: %s}\n" : "}\n", p->name);
        }
        for (Kind kind = PARAMETER; kind < KINDS; ++kind)
            if (title[kind])
                write_section(v, out, kind, order[kind], part, false, false);
        if (!part)
            write_tail(v, out);
        output_close(out, folder);
    }
    out = begin(folder, seed, ".plain.veh");
    write_whole(v, out, seed, order);
    output_close(out, folder);
}
