/* An interposed library (LD_PRELOAD) that sees every call which changes files below one folder,
   writes them to a trace, and makes one of them go wrong. Used by faults.py.

   FAULT_FOLDER  absolute path; only files below it count
   FAULT_TRACE   file to which all these calls are appended, with what was written
   FAULT_AT      number of the call that goes wrong, from 1; others are left alone
   FAULT_OPS     "write,rename": only these are numbered; default: all
   FAULT_NAME    only calls on paths that contain this text are numbered
   FAULT_DO      kill       SIGKILL instead of the call
                 half       half of what is to be written, then SIGKILL
                 ENOSPC, EIO, EDQUOT, EACCES   the call fails (a close closes and fails)
                 full       the disk is full from then on: the first write does half, and then
                            nothing can be written or made
                 SIGTERM, SIGINT, SIGINT2 (twice), SIGHUP, SIGUSR1, SIGXCPU, SIGSTOP
                            the signal, then the call
                 skip       the call does nothing and says that it succeeded: a program that forgets
                            it, to see that the experiments notice

   Calls: open (for writing), write, fsync, truncate, close (of what was opened for writing), rename,
   unlink, mkdir. What the C library writes for stdio (fopen) cannot be seen from here, so opening a
   file below the folder for writing in this way ends the program with a message; the power cut
   experiment also compares the replayed trace with the real files. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))real(#name))

enum { most_descriptors = 4096 };

static char folder[PATH_MAX];
static char *path_of[most_descriptors]; /* of descriptors opened below the folder */
static char writing[most_descriptors];
static int trace = -1;
static long at, numbered;
static const char *ops, *part_of_name, *action;
static int disk_full;
static pthread_mutex_t mutex = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;

static void *real(const char *name)
{
    void *found = dlsym(RTLD_NEXT, name);
    if (!found) abort();
    return found;
}

__attribute__((constructor)) static void begin(void)
{
    const char *given = getenv("FAULT_FOLDER");
    if (!given) return;
    snprintf(folder, sizeof folder, "%s", given);
    at = getenv("FAULT_AT") ? atol(getenv("FAULT_AT")) : 0;
    ops = getenv("FAULT_OPS");
    part_of_name = getenv("FAULT_NAME");
    action = getenv("FAULT_DO");
    if (!action) action = "";
    const char *trace_name = getenv("FAULT_TRACE");
    if (!trace_name) return;
    const int low = syscall(SYS_openat, AT_FDCWD, trace_name,
                            O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    trace = fcntl(low, F_DUPFD_CLOEXEC, 900); /* out of the way of the program */
    syscall(SYS_close, low);
    if (trace < 0) abort();
}

/* The absolute path without "." and "//" if it lies below the folder (or is it), otherwise 0. */
static int below(int at_folder, const char *path, char *full)
{
    char raw[PATH_MAX * 2];
    if (!folder[0] || !path) return 0;
    if (path[0] == '/') {
        snprintf(raw, sizeof raw, "%s", path);
    } else if (at_folder != AT_FDCWD && at_folder >= 0 && at_folder < most_descriptors &&
               path_of[at_folder]) {
        snprintf(raw, sizeof raw, "%s/%s", path_of[at_folder], path);
    } else {
        char here[PATH_MAX];
        if (syscall(SYS_getcwd, here, sizeof here) < 0) return 0;
        snprintf(raw, sizeof raw, "%s/%s", here, path);
    }
    size_t n = 0;
    for (const char *p = raw; *p && n + 1 < PATH_MAX; ++p) {
        if (*p == '/' && p[1] == '.' && (p[2] == '/' || !p[2])) {
            ++p;
            continue;
        }
        if (*p == '/' && n > 0 && full[n - 1] == '/') continue;
        full[n++] = *p;
    }
    while (n > 1 && full[n - 1] == '/') --n;
    full[n] = 0;
    const size_t length = strlen(folder);
    return strncmp(full, folder, length) == 0 && (full[length] == '/' || !full[length]);
}

static void put(const void *bytes, size_t size)
{
    const char *p = bytes;
    while (size > 0) {
        const long done = syscall(SYS_write, trace, p, size);
        if (done <= 0) abort();
        p += done;
        size -= (size_t)done;
    }
}

/* op, number or 0, offset or flags, size, path, second path; then the bytes */
static void note(const char *op, long number, long offset, size_t size, const char *path,
                 const char *to, const void *bytes)
{
    if (trace < 0) return;
    char line[PATH_MAX * 2 + 100];
    const int n = snprintf(line, sizeof line, "%s\t%ld\t%ld\t%zu\t%s\t%s\n", op, number, offset,
                           bytes ? size : 0, path, to);
    put(line, (size_t)n);
    if (bytes) put(bytes, size);
    if (bytes) put("\n", 1);
}

static int error_named(const char *name)
{
    static const struct {
        const char *name;
        int number;
    } all[] = {{"ENOSPC", ENOSPC}, {"EIO", EIO}, {"EDQUOT", EDQUOT}, {"EACCES", EACCES}};
    for (size_t k = 0; k < sizeof all / sizeof *all; ++k)
        if (!strcmp(all[k].name, name)) return all[k].number;
    return 0;
}

static int signal_named(const char *name)
{
    static const struct {
        const char *name;
        int number;
    } all[] = {{"SIGTERM", SIGTERM}, {"SIGINT", SIGINT},   {"SIGINT2", SIGINT}, {"SIGHUP", SIGHUP},
               {"SIGUSR1", SIGUSR1}, {"SIGXCPU", SIGXCPU}, {"SIGSTOP", SIGSTOP}};
    for (size_t k = 0; k < sizeof all / sizeof *all; ++k)
        if (!strcmp(all[k].name, name)) return all[k].number;
    return 0;
}

static int is_counted(const char *op, const char *path)
{
    if (part_of_name && !strstr(path, part_of_name)) return 0;
    if (!ops) return 1;
    const size_t n = strlen(op);
    for (const char *p = ops; (p = strstr(p, op)); ++p)
        if ((p == ops || p[-1] == ',') && (!p[n] || p[n] == ',')) return 1;
    return 0;
}

enum Verdict { go_on, fail, half_then_kill, half_then_full, do_nothing };

/* What becomes of this call; errno is set if it fails. */
static enum Verdict judge(const char *op, const char *path, long *number)
{
    const int takes_space = !strcmp(op, "write") || !strcmp(op, "mkdir") || !strcmp(op, "open");
    *number = is_counted(op, path) ? ++numbered : 0;
    if (disk_full && takes_space) {
        errno = ENOSPC;
        return fail;
    }
    if (!at || *number != at) return go_on;
    const int error = error_named(action), signal_number = signal_named(action);
    note("FAULT", *number, 0, 0, path, op, NULL);
    if (error) {
        errno = error;
        return fail;
    }
    if (signal_number) {
        raise(signal_number);
        if (!strcmp(action, "SIGINT2")) raise(signal_number);
        return go_on;
    }
    if (!strcmp(action, "full")) {
        disk_full = 1;
        if (!strcmp(op, "write")) return half_then_full;
        errno = ENOSPC;
        return takes_space ? fail : go_on;
    }
    if (!strcmp(action, "skip")) return do_nothing;
    if (!strcmp(action, "half") && !strcmp(op, "write")) return half_then_kill;
    if (!strcmp(action, "kill") || !strcmp(action, "half")) {
        syscall(SYS_kill, getpid(), SIGKILL);
        pause();
    }
    return go_on;
}

#define LOCK pthread_mutex_lock(&mutex)
#define UNLOCK                    \
    do {                          \
        const int kept_ = errno;  \
        pthread_mutex_unlock(&mutex); \
        errno = kept_;            \
    } while (0)

/* ---- open */

static int opened(int at_folder, const char *path, int flags, mode_t mode)
{
    char full[PATH_MAX];
    if (!below(at_folder, path, full))
        return (int)syscall(SYS_openat, at_folder, path, flags, mode);
    const int writes = (flags & O_ACCMODE) != O_RDONLY;
    LOCK;
    long number = 0;
    int result = -1;
    if (writes) {
        const int is_new = (flags & O_CREAT) && syscall(SYS_access, full, F_OK) != 0;
        const int was_full = disk_full && !is_new;  /* an existing file can be opened */
        if (was_full) disk_full = 0;
        const enum Verdict verdict = judge("open", full, &number);
        if (was_full) disk_full = 1;
        if (verdict == fail) {
            UNLOCK;
            return -1;
        }
    }
    result = (int)syscall(SYS_openat, at_folder, path, flags, mode);
    if (result >= 0 && result < most_descriptors) {
        const int kept = errno;
        free(path_of[result]);
        path_of[result] = strdup(full);
        writing[result] = (char)writes;
        if (writes) note("open", number, flags & (O_CREAT | O_TRUNC), 0, full, "", NULL);
        errno = kept;
    }
    UNLOCK;
    return result;
}

static mode_t mode_of(int flags, va_list list)
{
    return flags & (O_CREAT | __O_TMPFILE) ? va_arg(list, mode_t) : 0;
}

#define DEFINE_OPEN(name)                                    \
    int name(const char *path, int flags, ...)               \
    {                                                        \
        va_list list;                                        \
        va_start(list, flags);                               \
        const mode_t mode = mode_of(flags, list);            \
        va_end(list);                                        \
        return opened(AT_FDCWD, path, flags, mode);          \
    }
#define DEFINE_OPENAT(name)                                  \
    int name(int at_folder, const char *path, int flags, ...) \
    {                                                        \
        va_list list;                                        \
        va_start(list, flags);                               \
        const mode_t mode = mode_of(flags, list);            \
        va_end(list);                                        \
        return opened(at_folder, path, flags, mode);         \
    }
DEFINE_OPEN(open)
DEFINE_OPEN(open64)
DEFINE_OPENAT(openat)
DEFINE_OPENAT(openat64)
int __open_2(const char *path, int flags) { return opened(AT_FDCWD, path, flags, 0); }
int __open64_2(const char *path, int flags) { return opened(AT_FDCWD, path, flags, 0); }
int __openat_2(int f, const char *path, int flags) { return opened(f, path, flags, 0); }
int __openat64_2(int f, const char *path, int flags) { return opened(f, path, flags, 0); }
int creat(const char *path, mode_t mode)
{
    return opened(AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, mode);
}
int creat64(const char *path, mode_t mode)
{
    return opened(AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, mode);
}

static void refuse_stdio(const char *path, const char *mode)
{
    char full[PATH_MAX];
    if (strpbrk(mode, "wa+") && below(AT_FDCWD, path, full)) {
        fprintf(stderr, "inject: %s is written by stdio, which faults cannot reach\n", full);
        abort();
    }
}
FILE *fopen(const char *path, const char *mode)
{
    refuse_stdio(path, mode);
    return REAL(fopen)(path, mode);
}
FILE *fopen64(const char *path, const char *mode)
{
    refuse_stdio(path, mode);
    return REAL(fopen64)(path, mode);
}

/* ---- write */

static int is_ours(int descriptor)
{
    return descriptor >= 0 && descriptor < most_descriptors && path_of[descriptor] &&
           writing[descriptor];
}

/* offset < 0: where the file stands */
static ssize_t written(int descriptor, const void *bytes, size_t size, off_t offset)
{
#define WRITE_NOW(length)                                                       \
    (offset < 0 ? syscall(SYS_write, descriptor, bytes, (size_t)(length))       \
                : syscall(SYS_pwrite64, descriptor, bytes, (size_t)(length), offset))
    if (!is_ours(descriptor)) return WRITE_NOW(size);
    LOCK;
    long number = 0;
    const char *path = path_of[descriptor];
    const off_t place = offset < 0 ? (off_t)syscall(SYS_lseek, descriptor, 0, SEEK_CUR) : offset;
    const enum Verdict verdict = judge("write", path, &number);
    ssize_t result = -1;
    if (verdict == go_on) result = WRITE_NOW(size);
    if (verdict == do_nothing) result = (ssize_t)size;
    if (verdict == half_then_full || verdict == half_then_kill) {
        result = size > 1 ? WRITE_NOW(size / 2) : -1;
        if (result < 0) errno = ENOSPC;
    }
    if (verdict != do_nothing && result > 0)
        note("write", number, place, (size_t)result, path, "", bytes);
    if (verdict == half_then_kill) {
        syscall(SYS_kill, getpid(), SIGKILL);
        pause();
    }
    UNLOCK;
    return result;
}

ssize_t write(int descriptor, const void *bytes, size_t size)
{
    return written(descriptor, bytes, size, -1);
}
ssize_t pwrite(int descriptor, const void *bytes, size_t size, off_t offset)
{
    return written(descriptor, bytes, size, offset);
}
ssize_t pwrite64(int descriptor, const void *bytes, size_t size, off64_t offset)
{
    return written(descriptor, bytes, size, offset);
}
ssize_t writev(int descriptor, const struct iovec *parts, int count)
{
    if (!is_ours(descriptor)) return syscall(SYS_writev, descriptor, parts, count);
    size_t size = 0;
    for (int k = 0; k < count; ++k) size += parts[k].iov_len;
    char *all = malloc(size + 1), *p = all;
    if (!all) abort();
    for (int k = 0; k < count; ++k) {
        memcpy(p, parts[k].iov_base, parts[k].iov_len);
        p += parts[k].iov_len;
    }
    const ssize_t result = written(descriptor, all, size, -1);
    free(all);
    return result;
}

/* ---- fsync, ftruncate, close */

static int synced(int descriptor, long system_call)
{
    if (descriptor < 0 || descriptor >= most_descriptors || !path_of[descriptor])
        return (int)syscall(system_call, descriptor);
    LOCK;
    long number = 0;
    const enum Verdict verdict = judge("fsync", path_of[descriptor], &number);
    int result = -1;
    if (verdict == go_on) result = (int)syscall(system_call, descriptor);
    if (verdict == do_nothing) result = 0;
    if (verdict == go_on && result == 0)
        note("fsync", number, 0, 0, path_of[descriptor], "", NULL);
    UNLOCK;
    return result;
}
int fsync(int descriptor) { return synced(descriptor, SYS_fsync); }
int fdatasync(int descriptor) { return synced(descriptor, SYS_fdatasync); }

static int truncated(int descriptor, off_t size)
{
    if (!is_ours(descriptor)) return (int)syscall(SYS_ftruncate, descriptor, size);
    LOCK;
    long number = 0;
    const enum Verdict verdict = judge("truncate", path_of[descriptor], &number);
    int result = -1;
    if (verdict == go_on) result = (int)syscall(SYS_ftruncate, descriptor, size);
    if (verdict == do_nothing) result = 0;
    if (verdict == go_on && result == 0)
        note("truncate", number, size, 0, path_of[descriptor], "", NULL);
    UNLOCK;
    return result;
}
int ftruncate(int descriptor, off_t size) { return truncated(descriptor, size); }
int ftruncate64(int descriptor, off64_t size) { return truncated(descriptor, size); }

int close(int descriptor)
{
    if (descriptor < 0 || descriptor >= most_descriptors || !path_of[descriptor])
        return (int)syscall(SYS_close, descriptor);
    LOCK;
    long number = 0;
    enum Verdict verdict = go_on;
    if (writing[descriptor]) verdict = judge("close", path_of[descriptor], &number);
    const int error = errno;
    int result = (int)syscall(SYS_close, descriptor);
    if (writing[descriptor]) note("close", number, 0, 0, path_of[descriptor], "", NULL);
    free(path_of[descriptor]);
    path_of[descriptor] = NULL;
    if (verdict == fail) {
        result = -1;
        errno = error;
    }
    UNLOCK;
    return result;
}

/* ---- names */

static int named(const char *op, int at_folder, const char *path, const char *to, long system_call,
                 long extra)
{
    char full[PATH_MAX], full_to[PATH_MAX] = "";
    int ours = below(at_folder, path, full);
    if (to) below(at_folder, to, full_to);
    struct stat status;  /* a call that changes nothing is not numbered */
    const int exists = ours && lstat(full, &status) == 0;
    if (exists == !strcmp(op, "mkdir")) ours = 0;
    LOCK;
    long number = 0;
    const enum Verdict verdict = ours ? judge(op, to ? full_to : full, &number) : go_on;
    int result = -1;
    if (verdict == do_nothing) result = 0;
    if (verdict == go_on) {
        if (system_call == SYS_renameat)
            result = (int)syscall(SYS_renameat, at_folder, path, at_folder, to);
        else
            result = (int)syscall(system_call, at_folder, path, extra);
        if (ours && result == 0) {
            const int removes_folder = !strcmp(op, "unlink") && (extra & AT_REMOVEDIR);
            note(removes_folder ? "rmdir" : op, number, 0, 0, full, full_to, NULL);
        }
    }
    UNLOCK;
    return result;
}

int rename(const char *from, const char *to)
{
    return named("rename", AT_FDCWD, from, to, SYS_renameat, 0);
}
int renameat(int f, const char *from, int t, const char *to)
{
    if (f != t) abort();
    return named("rename", f, from, to, SYS_renameat, 0);
}
int unlink(const char *path) { return named("unlink", AT_FDCWD, path, NULL, SYS_unlinkat, 0); }
int unlinkat(int f, const char *path, int flags)
{
    return named("unlink", f, path, NULL, SYS_unlinkat, flags);
}
int rmdir(const char *path)
{
    return named("unlink", AT_FDCWD, path, NULL, SYS_unlinkat, AT_REMOVEDIR);
}
int remove(const char *path)
{
    struct stat status;
    if (lstat(path, &status) == 0 && S_ISDIR(status.st_mode)) return rmdir(path);
    return unlink(path);
}
int mkdir(const char *path, mode_t mode)
{
    return named("mkdir", AT_FDCWD, path, NULL, SYS_mkdirat, (long)mode);
}
int mkdirat(int f, const char *path, mode_t mode)
{
    return named("mkdir", f, path, NULL, SYS_mkdirat, (long)mode);
}
