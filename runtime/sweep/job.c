/* SPDX-License-Identifier: MIT
 * A sweep in parts for Slurm: the script of an array of jobs. Slurm decides when and where a part runs and how often it
 * is begun; the part's journal makes that harmless. */
#define _DEFAULT_SOURCE /* realpath */
#include "base/file.h"
#include "base/message.h"
#include "base/text.h"
#include "host/host.h"
#include "sweep/sweep.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A word for the shell. */
static void add_word(Text *text, const char *word)
{
    text_print(text, "'");
    for (; *word; ++word)
        text_print(text, *word == '\'' ? "'\\''" : "%c", *word);
    text_print(text, "'");
}

/* The absolute path of a folder in a line #SBATCH, where % begins a pattern. */
static const char *slurm_path(Pool *pool, const char *folder)
{
    char *full = realpath(folder, NULL);
    if (!full)
        diag_fail(program_place(), file_remedy(errno), "can't find the folder %s: %s", folder, strerror(errno));
    Text text = {.pool = pool};
    bool good = true;
    for (const char *c = full; *c; ++c) {
        good &= (unsigned char)*c >= ' ' && *c != '"' && *c != '\\';
        text_print(&text, *c == '%' ? "%%%%" : "%c", *c);
    }
    free(full);
    if (!good)
        diag_fail(program_place(), "choose another folder",
                  "Slurm takes no path with quotes, backslashes or line ends: %s", text.s);
    return text.s;
}

void job_write(Pool *pool, const char *folder, const char *const *command, int words, int parts, double seconds)
{
    Text text = {.pool = pool};
    const char *logs = slurm_path(pool, folder), *path = pool_print(pool, "%s/job.sh", folder);
    char *here = getcwd(NULL, 0), *full = realpath(folder, NULL);
    if (!here || !full)
        diag_fail(program_place(), file_remedy(errno), "can't find this folder: %s", strerror(errno));
    text_print(&text,
               "#!/bin/sh\n"
               "# A sweep in parts; sbatch starts them, and again by sbatch --array=... those that are missing.\n"
               "# Options of sbatch go before those here: sbatch --partition=... job.sh\n"
               "#SBATCH --job-name=gicsweep\n");
    text_print(&text, "#SBATCH --array=1-%d\n", parts);
    text_print(&text,
               "#SBATCH --ntasks=1\n"
               "#SBATCH --cpus-per-task=1\n"
               "#SBATCH --time=%.0f\n"
               "#SBATCH --requeue\n"
               "#SBATCH --open-mode=append\n"
               "#SBATCH --output=\"%s/part_%%a.log\"\n",
               fmax(10, ceil(seconds / 60)), logs);
    text_print(&text, "cd ");
    add_word(&text, here);
    text_print(&text, " || exit 1\nexport OMP_NUM_THREADS=\"${SLURM_CPUS_PER_TASK:-1}\"\nexec");
    for (int i = 0; i < words; ++i) {
        text_print(&text, " ");
        add_word(&text, command[i]);
    }
    text_print(&text, " \\\n    --shard \"$SLURM_ARRAY_TASK_ID/%d\" -o ", parts);
    add_word(&text, full);
    text_print(&text, "\n");
    free(here);
    free(full);
    file_write(path, text.s, text.size);
    chmod(path, 0755);
}
