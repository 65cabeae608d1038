/* SPDX-License-Identifier: MIT
 * deny_exec COMMAND...: runs a command for which the system refuses to make memory executable, as SELinux and systemd's
 * MemoryDenyWriteExecute do: mprotect to executable ends in EACCES. Linux. */
#define _DEFAULT_SOURCE /* syscall numbers */
#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* the low half of the third argument: protection, on a little-endian machine */
enum { PROTECTION = offsetof(struct seccomp_data, args) + 2 * sizeof(__u64) };

int main(int count, char **word)
{
    struct sock_filter rule[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mprotect, 0, 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, PROTECTION),
        BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, PROT_EXEC, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const struct sock_fprog program = {sizeof rule / sizeof *rule, rule};
    if (count < 2 || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program)) {
        perror("deny_exec");
        return 125;
    }
    execvp(word[1], word + 1);
    perror(word[1]);
    return 127;
}
