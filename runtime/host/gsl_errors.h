/* SPDX-License-Identifier: MIT
 *
 * Errors of the GNU Scientific Library, which by default end the program without a message of ours. */
#ifndef HOST_GSL_ERRORS_H
#define HOST_GSL_ERRORS_H

/* From now on errors are returned as statuses. If memory is out the program ends with the usual message: the library's
 * own functions would use the NULL that its allocations return. */
void gsl_errors_return(void);

#endif
