/* SPDX-License-Identifier: MIT
 *
 * fit_page: a page with numbers that were found, and curves with them: of --identify and --optimize. */
#ifndef RUN_FIT_PAGE_H
#define RUN_FIT_PAGE_H

#include "base/pool.h"
#include "run/panel.h"
#include "run/tangent_run.h"

enum { FIT_COLUMNS = 5 };

typedef struct FitPage {
    const char *name, *number; /* of the model; what was reached, one line */
    const char *curve[2];      /* what both curves of each diagram are */
    int panels;
    const Panel *panel;
    const char *column[FIT_COLUMNS]; /* heads of the table, NULL ends them */
    int variables;
    const RunVariable *variable;
    const double *cell; /* [variables][columns] */
} FitPage;

/* Ends in diag_fail where it can't be written. */
void fit_page_write(Pool *pool, const FitPage *page, const char *path);

#endif
