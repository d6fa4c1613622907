/* Binaries of a component written in C over FMI 2.0, which has none. As in the OSI Sensor Model Packaging (OSMP), each
 * is three integers for the lower and upper half of its address and for its size. They follow the component's own
 * variables, in groups of three. The binary of an input is copied when it is used: at the next step, or in the
 * initialization. An address of an output remains valid during the next step: outputs are copied to two buffers
 * alternately.
 */
#ifndef DSE_C_COMPONENT_OSMP_H
#define DSE_C_COMPONENT_OSMP_H

#include "instance.h"

static inline bool dse_is_osmp(uint32_t reference, int kinds) {
    return (kinds & DSE_INTEGER) && reference >= DSE_SLOT_COUNT && reference - DSE_SLOT_COUNT < 3u * DSE_BINARIES;
}

static bool dse_take_binaries(struct dse_instance *instance, const char *function) {
    const bool is_now = instance->at.state == DSE_STEPPING;
    char *const component = is_now ? (char *)&instance->at.now : (char *)&instance->at.start;
    for (size_t number = 0; number < DSE_BINARIES; number++) {
        const struct dse_slot *slot = &dse_slots[dse_binaries[number]];
        const int32_t *told = instance->osmp.told[number];
        const size_t size = (size_t)told[2];
        const char *const from = (const char *)(uintptr_t)((uint64_t)(uint32_t)told[1] << 32 | (uint32_t)told[0]);
        if (!instance->osmp.is_told[number]) {
            continue;
        }
        if (told[2] < 0 || size > slot->capacity) {
            return dse_refuse(instance, function, "'%s' has room for %lu bytes, not for %ld",
                dse_names[dse_binaries[number]], (unsigned long)slot->capacity, (long)told[2]);
        }
        if (size && !from) {
            return dse_refuse(instance, function, "'%s' is told %ld bytes, but not where they are",
                dse_names[dse_binaries[number]], (long)told[2]);
        }
        if (size) {
            memcpy(component + slot->offset, from, size);
        }
        memcpy(component + slot->size_at, &size, sizeof size);
        instance->osmp.is_told[number] = false;
    }
    return true;
}

/* Copy all outputs to the other buffer, if they have changed. */
static bool dse_show_binaries(struct dse_instance *instance, const char *function) {
    struct dse_osmp *osmp = &instance->osmp;
    const char *const component = (const char *)&instance->at.now;
    if (osmp->is_shown) {
        return true;
    }
    osmp->side ^= 1u;
    for (size_t number = 0; number < DSE_BINARIES; number++) {
        const struct dse_slot *slot = &dse_slots[dse_binaries[number]];
        size_t size;
        memcpy(&size, component + slot->size_at, sizeof size);
        if (slot->settable != DSE_OUTPUT) {
            continue;
        }
        if (size > slot->capacity || size > INT32_MAX) {
            return dse_refuse(instance, function, "'%s' has a size of %lu bytes, but room for %lu",
                dse_names[dse_binaries[number]], (unsigned long)size, (unsigned long)slot->capacity);
        }
        memcpy((char *)&osmp->shown[osmp->side] + dse_binary_places[number], component + slot->offset, size);
        osmp->sizes[osmp->side][number] = size;
    }
    osmp->is_shown = true;
    return true;
}

static bool dse_get_osmp(struct dse_instance *instance, const char *function, uint32_t reference, int64_t *value) {
    const uint32_t number = (reference - DSE_SLOT_COUNT) / 3u, part = (reference - DSE_SLOT_COUNT) % 3u;
    const struct dse_osmp *osmp = &instance->osmp;
    if (dse_slots[dse_binaries[number]].settable != DSE_OUTPUT) {
        *value = osmp->told[number][part];
        return true;
    }
    if (!dse_show_binaries(instance, function)) {
        return false;
    }
    const size_t size = osmp->sizes[osmp->side][number];
    const char *const bytes = (const char *)&osmp->shown[osmp->side] + dse_binary_places[number];
    const uint64_t base = size ? (uint64_t)(uintptr_t)bytes : 0u;
    *value = part == 2u ? (int64_t)size : (int64_t)(int32_t)(uint32_t)(part ? base >> 32 : base);
    return true;
}

static bool dse_set_osmp(struct dse_instance *instance, const char *function, uint32_t reference, int64_t value) {
    const uint32_t number = (reference - DSE_SLOT_COUNT) / 3u, part = (reference - DSE_SLOT_COUNT) % 3u;
    if (!(dse_slots[dse_binaries[number]].settable & instance->at.state)) {
        return dse_refuse(instance, function, "variable '%s' cannot be set %s", dse_names[dse_binaries[number]],
            dse_state_name(instance->at.state));
    }
    instance->osmp.told[number][part] = (int32_t)value;
    instance->osmp.is_told[number] = true;
    return true;
}

#endif
