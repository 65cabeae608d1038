/* SPDX-License-Identifier: MIT
 * An FMU: description, sources, binaries, page, picture and licence in one archive. */
#include "base/file.h"
#include "base/yaml.h"
#include "fmu/fmu.h"
#include "emit/emit.h"
#include "engine/engine.h"
#include "fmu/fmu_private.h"
#include "host/host.h"
#include "report/report.h"
#include "sequence/sequence.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What scenes have that an FMU can't start with or do. Inputs, drivers and the time they take are the importer's. */
static void check_scene(const Scene *scene)
{
    if (scene->equilibrium)
        diag_fail(doc_find(doc_find(scene->root, "initial"), "equilibrium")->at,
                  "let `gicrun --equilibrium` find it and write the values under `initial`",
                  "an FMU can't start in static equilibrium by itself yet");
    if (scene->road)
        diag_fail(scene_place(scene, "road"), "leave out `road`: the FMU's road is flat at z = 0",
                  "an FMU can't have a road of its own yet");
    if (scene->rest)
        diag_fail(scene_place(scene, "sleep"), "leave out `sleep`", "a vehicle in an FMU never sleeps");
    if (scene->method >= METHOD_ADAMS)
        diag_fail(
            scene_place(scene, "integrator"),
            "write `integrator: ab3`, `rk4`, `ros2`, `ros3`, `imex` or `exp3` and a `step`; in model exchange the "
            "importer takes steps of its own",
            "co-simulation of an FMU has constant steps, not those of %s", integrator_name(scene->method));
    if (scene->actions)
        diag_fail(scene_place(scene, doc_find(scene->root, "until") ? "until" : "when"),
                  "leave out `until` and `when`: the importer reads outputs, sets inputs and ends the run",
                  "an FMU has no conditions");
}

static const char *embedded_text(const char *name, size_t *size)
{
    for (const Embedded *file = embedded; file->name; ++file)
        if (!strcmp(file->name, name)) {
            *size = file->size;
            return file->bytes;
        }
    fprintf(stderr, "gicgen: error: '%s' is not built in\n", name);
    exit(1);
}

static void add_text(Members *members, const char *name, const Text *text)
{
    member_add(members, name, text->s, text->size);
}

static void add_embedded(Members *members, const char *folder, const char *name)
{
    size_t size;
    const char *bytes = embedded_text(name, &size);
    member_add(members, pool_print(members->pool, "%s%s", folder, name), bytes, size);
}

/* A file of the layer of FMI, the same for all models. */
static void add_layer(Members *members, const char *templates, const char *name)
{
    const Source *source = template_source(members->pool, templates, pool_print(members->pool, "fmu/%s", name));
    member_add(members, pool_print(members->pool, "sources/%s", name), source->bytes, source->size);
}

static void add_runtime(Members *members, const char *templates, const Description *d)
{
    Text header = {.pool = members->pool}, runtime = {.pool = members->pool};
    size_t size;
    const char *bytes = embedded_text("gic_runtime.h", &size);
    text_add(&runtime, bytes, size);
    write_runtime_header(&header, templates, d, &runtime);
    add_text(members, "sources/gic_runtime.h", &header);
    add_embedded(members, "sources/", "gic_runtime.c");
}

/* The drawing as PNG, where Graphviz is there; else empty. */
static Text draw(Pool *pool, const Formulation *f)
{
    Text dot = {.pool = pool}, png = {.pool = pool};
    char *const argv[] = {"dot", "-Tpng", NULL};
    const char *said;
    FILE *output = tmpfile();
    graph_draw(&dot, f->model, f->sequence);
    if (!output)
        return png;
    if (process_run_into(pool, argv, dot.s, fileno(output), &said) == 0) {
        char buffer[1 << 14];
        rewind(output);
        for (size_t n; (n = fread(buffer, 1, sizeof buffer, output)) > 0;)
            text_add(&png, buffer, n);
    }
    fclose(output);
    return png;
}

/* A number of four bytes, the highest first: width and height in the header of a PNG. */
static double png_number(const Text *png, size_t at)
{
    double value = 0;
    for (size_t i = at; i < at + 4; ++i)
        value = 256 * value + (unsigned char)png->s[i];
    return value;
}

static void add_picture(Members *members, int version, const Text *png)
{
    if (png->size)
        add_text(members, version == 2 ? "model.png" : "terminalsAndIcons/icon.png", png);
}

/* Height of the picture relative to its width; 0: there is no picture. */
static double picture_height(const Text *png)
{
    enum { WIDTH_AT = 16, HEIGHT_AT = 20, HEADER = 24 };
    return png->size >= HEADER ? png_number(png, HEIGHT_AT) / png_number(png, WIDTH_AT) : 0;
}

/* Everything but binaries. The token follows from all that the description and the C files have. */
static void add_files(Members *members, int version, const Formulation *f, const Scene *scene, const Style *style,
                      const char *templates, const char *path, const Text *picture)
{
    Pool *pool = members->pool;
    const char *name = f->model->name, *api = version == 2 ? "fmi2" : "fmi3";
    const char *c_name = pool_print(pool, "%s.c", name), *api_name = pool_print(pool, "%s.c", api);
    const char *const source[] = {c_name,       "gic_runtime.c", "fmu_core.c",
                                  "fmu_road.c", api_name,        style->derivatives ? "fmu_derivative.c" : NULL,
                                  NULL};
    Text c = {.pool = pool}, h = {.pool = pool}, xml = {.pool = pool}, header = {.pool = pool}, page = {.pool = pool};
    const Dependence *rate = dependences_of_rates(pool, f);
    const bool shares = generate(pool, f, style, templates, pool_print(pool, "%s.h", name), &c, &h);
    if (scene && scene->spread && !shares)
        diag_fail(scene_place(scene, "spread_jacobian"), "remove spread_jacobian from the scene",
                  "the Jacobian of this model is not made by shares (models/STIFF.md)");
    Description d = {.pool = pool,
                     .f = f,
                     .variables = variables_make(pool, f, scene, style->implicit, shares),
                     .experiment = experiment_of(scene),
                     .token = "",
                     .source = source,
                     .rate = rate,
                     .out = dependences_of_outputs(pool, f, rate),
                     .place = dependences_of_places(pool, f),
                     .derivatives = style->derivatives,
                     .last_method = style->exponential ? GIC_EXP3
                                    : style->implicit  ? GIC_IMEX
                                                       : GIC_RK4};
    void (*const describe)(Text *, const Description *) = version == 2 ? describe_2 : describe_3;
    Text draft = {.pool = pool};
    describe(&draft, &d);
    write_model_header(&draft, templates, &d);
    const uint64_t code = text_hash(c.s, c.size), description = text_hash(draft.s, draft.size);
    d.token = pool_print(pool, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(code >> 32), (unsigned)(code >> 16) & 0xffff,
                         (unsigned)code & 0xffff, (unsigned)(description >> 48),
                         (unsigned long long)description & 0xffffffffffff);
    describe(&xml, &d);
    write_model_header(&header, templates, &d);
    const CodeMemory memory = code_memory(pool, f->model->name, &c, &h);
    report_print(&page, path, templates, f, &c, &memory);
    add_text(members, "modelDescription.xml", &xml);
    add_text(members, "documentation/index.html", &page);
    add_text(members, pool_print(pool, "sources/%s.c", name), &c);
    add_text(members, pool_print(pool, "sources/%s.h", name), &h);
    add_text(members, "sources/fmu_model.h", &header);
    add_runtime(members, templates, &d);
    const char *const layer[] = {"fmu_core.c", "fmu_core.h", "fmu_road.c", api_name, pool_print(pool, "%s_api.h", api)};
    for (size_t i = 0; i < sizeof layer / sizeof *layer; ++i)
        add_layer(members, templates, layer[i]);
    if (style->derivatives)
        add_layer(members, templates, "fmu_derivative.c");
    add_embedded(members, "documentation/licenses/", "LICENSE");
    if (version == 3) {
        Text build = {.pool = pool}, terminals = {.pool = pool};
        describe_build(&build, &d);
        describe_terminals(&terminals, d.variables, picture_height(picture));
        add_text(members, "sources/buildDescription.xml", &build);
        add_text(members, "terminalsAndIcons/terminalsAndIcons.xml", &terminals);
    }
}

void fmu_write(Pool *pool, int version, const Formulation *f, const Scene *scene, const Style *style,
               const char *templates, const char *path)
{
    Members members = {.pool = pool};
    char *folder = pool_print(pool, "%s/gicgen-XXXXXX", temporary_folder());
    const char *failure = NULL, *bytes = NULL;
    size_t size = 0;
    if (scene)
        check_scene(scene);
    file_check(path);
    interrupt_hold(); /* as programs that are run ask for */
    const Text picture = draw(pool, f);
    interrupt_release();
    add_files(&members, version, f, scene, style, templates, path, &picture);
    interrupt_hold(); /* or the folder would stay */
    if (!mkdtemp(folder))
        diag_fail(program_place(), "set TMPDIR to a folder that can be written", "no folder can be made in %s: %s",
                  temporary_folder(), strerror(errno));
    add_picture(&members, version, &picture);
    failure = binaries_add(&members, version, f->model->name, folder, path);
    rmdir(folder);
    interrupt_release();
    if (failure)
        diag_fail(program_place(), "set CC to a C99 compiler", "%s", failure);
    bytes = archive_bytes(&members, &size);
    if (!bytes)
        diag_fail(program_place(), "set TMPDIR to a folder that can be written, with room",
                  "no archive for %s can be made in %s: %s", path, temporary_folder(), strerror(errno));
    file_write(path, bytes, size);
}
