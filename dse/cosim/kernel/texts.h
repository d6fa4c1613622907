/* Strings and binaries: copied when they are read, since FMI lets an FMU forget them at its next call. */
#ifndef DSE_COSIM_TEXTS_H
#define DSE_COSIM_TEXTS_H

#include "failing.h"

#include <stdlib.h>
#include <string.h>

RARE static bool fail_text(System *system, int64_t kind, const TextGroup *group, int64_t position)
{
    system->failure = (Failure){kind, 0, *system->progress, group->id, position, 0.0, system->now};
    return false;
}

/* FNV-1a (Fowler, Noll and Vo) by bytes; never the 0 of a text that was not read yet. */
static uint64_t print_of(const unsigned char *bytes, size_t size)
{
    uint64_t print = 0xCBF29CE484222325u;
    for (size_t i = 0; i < size; i++)
        print = (print ^ bytes[i]) * 0x100000001B3u;
    return print ? print : 1;
}

static bool keep_text(System *system, Text *text, const void *bytes, size_t size)
{
    if (text->bytes && text->size == size && memcmp(text->bytes, bytes, size) == 0)
        return true;
    if (text->room <= size) {
        char *room = realloc(text->bytes, 2 * size + 16);
        if (!room)
            return false;
        text->bytes = room;
        text->room = 2 * size + 16;
    }
    if (size)
        memcpy(text->bytes, bytes, size);
    text->bytes[size] = 0;
    text->size = size;
    text->print = print_of(bytes, size);
    system->texts_changed++;
    return true;
}

static bool read_text_group(System *system, const TextGroup *group)
{
    const size_t count = (size_t)group->count, n = (size_t)group->n_values;
    system->progress->place = group->place;
    memset(group->pointers, 0, n * sizeof *group->pointers);
    const int status =
        group->type == BINARY ? ((Fmi3GetBinary)group->access)(group->instance, group->references, count, group->sizes,
                                                               group->pointers, n)
        : group->version == 3 ? ((Fmi3Access)group->access)(group->instance, group->references, count,
                                                            group->pointers, n)
                              : ((Fmi2Access)group->access)(group->instance, group->references, count,
                                                            group->pointers);
    if (!accept(system, status))
        return false;
    for (int64_t i = 0; i < group->n_values; i++) {
        const void *bytes = group->pointers[i];
        size_t size = group->type == BINARY ? group->sizes[i] : 0;
        if (!bytes && (group->type != BINARY || size))
            return fail_text(system, NO_TEXT, group, i);
        if (group->type != BINARY) {
            const char *end = memchr(bytes, 0, LONGEST_TEXT + 1);
            size = end ? (size_t)(end - (const char *)bytes) : LONGEST_TEXT + 1;
        }
        if (size > LONGEST_TEXT || !keep_text(system, group->texts[i], bytes, size))
            return fail_text(system, LONG_TEXT, group, i);
    }
    return true;
}

static bool write_text_group(System *system, const TextGroup *group)
{
    const size_t count = (size_t)group->count, n = (size_t)group->n_values;
    for (int64_t i = 0; i < group->n_values; i++) {
        group->pointers[i] = group->texts[i]->bytes ? group->texts[i]->bytes : "";
        group->sizes[i] = group->texts[i]->size;
    }
    system->progress->place = group->place;
    return accept(system,
                  group->type == BINARY
                      ? ((Fmi3SetBinary)group->access)(group->instance, group->references, count, group->sizes,
                                                       group->pointers, n)
                  : group->version == 3
                      ? ((Fmi3Access)group->access)(group->instance, group->references, count, group->pointers, n)
                      : ((Fmi2Access)group->access)(group->instance, group->references, count, group->pointers));
}

static bool read_texts(System *system, const Groups *groups)
{
    for (const TextGroup *group = groups->texts; group < groups->no_texts; group++)
        if (!read_text_group(system, group))
            return false;
    return true;
}

static bool write_texts(System *system, const Groups *groups)
{
    for (const TextGroup *group = groups->texts; group < groups->no_texts; group++)
        if (!write_text_group(system, group))
            return false;
    return true;
}

static void forget_texts(System *system)
{
    for (Text *text = system->texts; text < system->texts + system->n_texts; text++) {
        if (text->room)
            free(text->bytes);
        *text = (Text){0};
    }
}

#endif
