/* SPDX-License-Identifier: MIT
 *
 * What host programs make of errors of the GNU Scientific Library, which would end the program without a message of
 * ours. */
#ifndef GSL_ERRORS_H
#define GSL_ERRORS_H

/* Errors come back as statuses from now on, but where memory ends so does the program, with the message of all others:
 * the library itself falls over the NULL that its makers of matrices and controls return. */
void gsl_errors_return(void);

#endif
