/* SPDX-License-Identifier: MIT */
#include "base/pool.h"
#include "host/gsl_errors.h"

#include <gsl/gsl_errno.h>

static void end_without_memory(const char *reason, const char *file, int line, int error)
{
    (void)reason, (void)file, (void)line;
    if (error == GSL_ENOMEM)
        out_of_memory();
}

void gsl_errors_return(void)
{
    gsl_set_error_handler(end_without_memory);
}
