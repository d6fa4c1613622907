/* A model from an external code generator, compiled into its own library, which the component contains as bytes. Every
 * instance has a copy of that library, and every run starts with one in its initial state: such models keep data in
 * global variables, and their initialization does not reset them. POSIX only. */
#ifndef DSE_CODED_H
#define DSE_CODED_H

#ifdef _WIN32
#error "components of the kind simulink are built for Linux and macOS"
#endif
#include <dlfcn.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef __linux__
#include <link.h>
#include <sys/syscall.h>
#endif

/* Of POSIX and of Linux, for units that have requested neither. */
int mkstemp(char *path);
long syscall(long number, ...);
int dlinfo(void *library, int request, void *found);

enum {
    DSE_CODED_LONGEST = 400,  /* bytes of an error message */
    DSE_CODED_KEPT = 4,       /* ranges of memory */
    DSE_CODED_LINK_MAP = 2,   /* a request to dlinfo */
};

typedef const char *dse_coded_call(void *model, const double *parameters, const double *inputs, double *outputs);

/* *kept*: initial content of the library's variables, one range of *at* after the other. */
struct dse_coded {
    int file;
    void *library, *model;
    dse_coded_call *first, *start, *step;
    void *(*create)(void);
    void (*end)(void *model);
    unsigned char *kept, *at[DSE_CODED_KEPT];
    size_t sizes[DSE_CODED_KEPT];
};

/* Of the component: its library. */
const unsigned char *dse_component_library(size_t *size);

/* Close the file of an unloaded library. A library that cannot be unloaded (by its own choice, or because of a thread)
 * is identified by this name. A new file must not reuse the name, or the old library would be used for it. */
static void dse_coded_leave(int file) {
    char path[DSE_CODED_LONGEST / 2];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    void *left = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
    if (left) {
        dlclose(left);
    } else {
        close(file);
    }
}

static void dse_coded_end(struct dse_coded *coded) {
    if (coded->library) {
        if (coded->end && coded->model) {
            coded->end(coded->model);
        }
        dlclose(coded->library);
        dse_coded_leave(coded->file);
        free(coded->kept);
    }
    *coded = (struct dse_coded){0};
}

/* Save the content of the library's variables, so that a run needs no new copy. *kept* stays empty if the content is
 * unknown or incomplete: thread-local variables, and C++ objects, which have memory elsewhere. */
static void dse_coded_keep(struct dse_coded *coded, const unsigned char *bytes, size_t size) {
#if defined __linux__ && UINTPTR_MAX == UINT64_MAX
    const bool *is_plain = (const bool *)dlsym(coded->library, "dse_coded_is_plain");
    const Elf64_Ehdr *head = (const Elf64_Ehdr *)(const void *)bytes;
    struct link_map *map = NULL;
    uintptr_t locked = 0;
    size_t count = 0, sum = 0;
    if (!is_plain || !*is_plain || size < sizeof *head || head->e_phentsize != sizeof(Elf64_Phdr)
        || head->e_phoff > size || head->e_phnum * sizeof(Elf64_Phdr) > size - head->e_phoff
        || dlinfo(coded->library, DSE_CODED_LINK_MAP, &map) != 0 || !map) {
        return;
    }
    const Elf64_Phdr *parts = (const Elf64_Phdr *)(const void *)(bytes + head->e_phoff);
    const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
    for (size_t i = 0; i < head->e_phnum; i++) {
        if (parts[i].p_type == PT_TLS) {
            return;
        }
        if (parts[i].p_type == PT_GNU_RELRO) { /* can only be read after loading, in whole pages */
            locked = (map->l_addr + parts[i].p_vaddr + parts[i].p_memsz) / page * page;
        }
    }
    for (size_t i = 0; i < head->e_phnum; i++) {
        const uintptr_t from = map->l_addr + parts[i].p_vaddr, to = from + parts[i].p_memsz;
        const uintptr_t begin = from < locked ? locked : from;
        if (parts[i].p_type != PT_LOAD || !(parts[i].p_flags & PF_W) || begin >= to) {
            continue;
        }
        if (count == DSE_CODED_KEPT) {
            return;
        }
        coded->at[count] = (unsigned char *)begin;
        coded->sizes[count++] = to - begin;
        sum += to - begin;
    }
    coded->kept = malloc(sum + 1);
    for (size_t i = 0, done = 0; coded->kept && i < count; done += coded->sizes[i++]) {
        memcpy(coded->kept + done, coded->at[i], coded->sizes[i]);
    }
#else
    (void)coded, (void)bytes, (void)size;
#endif
}

/* A new file without a name, from which nothing is loaded yet. */
static int dse_coded_file(char *path, size_t size) {
#if defined __linux__ && defined SYS_memfd_create
    const int file = (int)syscall(SYS_memfd_create, "model", 1u);
    if (file >= 0) {
        snprintf(path, size, "/proc/self/fd/%d", file);
        return file;
    }
#endif
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%s/dse-model-XXXXXX", folder && *folder ? folder : "/tmp");
    return mkstemp(path);
}

static bool dse_coded_load(struct dse_coded *coded, char *said) {
    char path[DSE_CODED_LONGEST / 2];
    size_t size = 0, done = 0;
    const unsigned char *bytes = dse_component_library(&size);
    coded->file = dse_coded_file(path, sizeof path);
    while (coded->file >= 0 && done < size) {
        const ssize_t more = write(coded->file, bytes + done, size - done);
        if (more <= 0) {
            break;
        }
        done += (size_t)more;
    }
    coded->library = done == size ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!coded->library) {
        const char *why = done == size ? dlerror() : "no file can be written";
        snprintf(said, DSE_CODED_LONGEST, "a copy of its code cannot be loaded: %.200s", why ? why : "nobody knows why");
    }
    if (path[1] != 'p' && coded->file >= 0) {
        unlink(path);
    }
    if (!coded->library) {
        if (coded->file >= 0) {
            close(coded->file);
        }
        return false;
    }
    coded->create = (void *(*)(void))dlsym(coded->library, "dse_coded_new");
    coded->end = (void (*)(void *))dlsym(coded->library, "dse_coded_end");
    coded->first = (dse_coded_call *)dlsym(coded->library, "dse_coded_first");
    coded->start = (dse_coded_call *)dlsym(coded->library, "dse_coded_start");
    coded->step = (dse_coded_call *)dlsym(coded->library, "dse_coded_step");
    dse_coded_keep(coded, bytes, size);
    return true;
}

/* A model in a library in its initial state; false after a failure, which is reported in *said*. */
static bool dse_coded_renew(struct dse_coded *coded, char *said) {
    if (!coded->kept) {
        dse_coded_end(coded);
        if (!dse_coded_load(coded, said)) {
            *coded = (struct dse_coded){0};
            return false;
        }
    } else {
        if (coded->model) {
            coded->end(coded->model);
        }
        for (size_t i = 0, done = 0; i < DSE_CODED_KEPT && coded->at[i]; done += coded->sizes[i++]) {
            memcpy(coded->at[i], coded->kept + done, coded->sizes[i]);
        }
    }
    coded->model = coded->create();
    if (!coded->model) {
        snprintf(said, DSE_CODED_LONGEST, "out of memory");
    }
    return coded->model != NULL;
}

static bool dse_coded_is_well(const char *error, char *said) {
    if (error && *error) {
        snprintf(said, DSE_CODED_LONGEST, "the model reports '%.300s'", error);
        return false;
    }
    return true;
}

/* Where a run *begins*, the outputs are those of a first step that is then discarded: a model has none before. */
static bool dse_coded_ask(
    struct dse_coded *coded, bool begins, const double *parameters, const double *inputs, double *outputs, char *said) {
    if (!begins) {
        return dse_coded_is_well(coded->step(coded->model, parameters, inputs, outputs), said);
    }
    return dse_coded_renew(coded, said)
        && dse_coded_is_well(coded->first(coded->model, parameters, inputs, outputs), said)
        && dse_coded_renew(coded, said)
        && dse_coded_is_well(coded->start(coded->model, parameters, inputs, NULL), said);
}

#endif
