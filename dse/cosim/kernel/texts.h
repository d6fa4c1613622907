/* Strings and binaries: copied when they are read, since FMI lets an FMU free them at its next call. The receiver of an
 * OSMP binary may use it until its next step is over: its memory is kept until it has changed twice. */
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

/* FNV-1a (Fowler, Noll and Vo) by words of eight bytes, with the upper half mixed in. The result is never 0, which
 * marks a text that was not read yet. */
static uint64_t print_of(const unsigned char *bytes, size_t size)
{
    uint64_t print = 0xCBF29CE484222325u ^ size;
    for (size_t i = 0; i < size; i += 8) {
        uint64_t word = 0;
        memcpy(&word, bytes + i, size - i < 8 ? size - i : 8);
        print = (print ^ word) * 0x100000001B3u;
        print ^= print >> 32;
    }
    return print ? print : 1;
}

static bool keep_text(System *system, Text *text, const void *bytes, size_t size)
{
    if (text->bytes && text->size == size && memcmp(text->bytes, bytes, size) == 0)
        return true;
    char *const before = text->bytes;
    const size_t room_before = text->room;
    text->bytes = text->before, text->room = text->room_before;
    text->before = before, text->room_before = room_before;
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

/* The binary with these three references, as in the OSI Sensor Model Packaging; NULL for one without bytes. */
static int get_osmp(const TextGroup *group, int64_t i, const void **bytes, size_t *size)
{
    int32_t told[3] = {0, 0, 0}; /* base.lo, base.hi, size */
    const int status = ((Fmi2Access)group->access)(group->instance, group->references + 3 * i, 3, told);
    const uint64_t base = (uint64_t)(uint32_t)told[1] << 32 | (uint32_t)told[0];
    *size = told[2] < 0 ? SIZE_MAX : (size_t)told[2];
    *bytes = (const void *)(uintptr_t)base;
    return status;
}

static int set_osmp(const TextGroup *group, int64_t i, const void *bytes, size_t size)
{
    const uint64_t base = size ? (uint64_t)(uintptr_t)bytes : 0;
    int32_t told[3] = {(int32_t)(uint32_t)base, (int32_t)(uint32_t)(base >> 32), (int32_t)size};
    return ((Fmi2Access)group->access)(group->instance, group->references + 3 * i, 3, told);
}

/* Call the accessor for all values, which are in pointers and sizes. */
static int access_texts(const TextGroup *group, bool is_set)
{
    const size_t count = (size_t)group->count, n = (size_t)group->n_values;
    int status = 0, worst = 0;
    switch (group->type) {
    case OSMP:
        for (int64_t i = 0; i < group->n_values && is_good(status); i++) {
            status = is_set ? set_osmp(group, i, group->pointers[i], group->sizes[i])
                            : get_osmp(group, i, &group->pointers[i], &group->sizes[i]);
            worst = status > worst || status < 0 ? status : worst;
        }
        return worst;
    case BINARY:
        return ((Fmi3GetBinary)group->access)(group->instance, group->references, count, group->sizes, group->pointers, n);
    default:
        return group->version == 3
                   ? ((Fmi3Access)group->access)(group->instance, group->references, count, group->pointers, n)
                   : ((Fmi2Access)group->access)(group->instance, group->references, count, group->pointers);
    }
}

static bool read_text_group(System *system, const TextGroup *group)
{
    system->progress->place = group->place;
    memset(group->pointers, 0, (size_t)group->n_values * sizeof *group->pointers);
    const int status = access_texts(group, false);
    if (!accept(system, status))
        return false;
    for (int64_t i = 0; i < group->n_values; i++) {
        const void *bytes = group->pointers[i];
        size_t size = group->type == STRING ? 0 : group->sizes[i];
        if (!bytes && (group->type == STRING || size))
            return fail_text(system, NO_TEXT, group, i);
        if (group->type == STRING) {
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
    for (int64_t i = 0; i < group->n_values; i++) {
        group->pointers[i] = group->texts[i]->bytes ? group->texts[i]->bytes : "";
        group->sizes[i] = group->texts[i]->size;
    }
    system->progress->place = group->place;
    return accept(system, access_texts(group, true));
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
        if (text->room_before)
            free(text->before);
        *text = (Text){0};
    }
}

#endif
