/* SPDX-License-Identifier: MIT
 * What drive.c wants of the machine it runs on. */
#ifndef TARGET_H
#define TARGET_H

void target_print(const char *text);
/* Say what there is to say about the run, and stop: `failed` is 0 or 1. Returns only where main may. */
void target_end(int failed);

#endif
