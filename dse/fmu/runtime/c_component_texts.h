/* Texts and binaries of a component written in C: arrays of fixed size in its struct, copied when they are set. */
#ifndef DSE_C_COMPONENT_TEXTS_H
#define DSE_C_COMPONENT_TEXTS_H

#include "value.h"

static bool dse_refuse_size(struct dse_instance *instance, const char *function, uint32_t reference, size_t size) {
    return dse_refuse(instance, function, "'%s' has room for %lu bytes, not for %lu", dse_names[reference],
        (unsigned long)dse_slots[reference].capacity, (unsigned long)size);
}

static bool dse_get_text(struct dse_instance *instance, const char *function, uint32_t reference, const char **value) {
    const struct dse_slot *slot = dse_find(instance, function, reference, DSE_TEXT);
    if (!slot) {
        return false;
    }
    *value = dse_source(instance, slot);
    return memchr(*value, 0, slot->capacity)
           || dse_refuse(instance, function, "the text '%s' has no zero at its end", dse_names[reference]);
}

static bool dse_set_text(struct dse_instance *instance, const char *function, uint32_t reference, const char *value) {
    const struct dse_slot *slot = dse_find_settable(instance, function, reference, DSE_TEXT);
    const size_t size = value ? strlen(value) + 1 : 0;
    if (!slot || !value) {
        return slot && dse_refuse(instance, function, "'%s' is given no text", dse_names[reference]);
    }
    if (size > slot->capacity) {
        return dse_refuse_size(instance, function, reference, size);
    }
    memcpy(dse_target(instance, slot), value, size);
    return true;
}

static inline bool dse_get_bytes(
    struct dse_instance *instance, const char *function, uint32_t reference, const uint8_t **bytes, size_t *size) {
    const struct dse_slot *slot = dse_find(instance, function, reference, DSE_BINARY);
    if (!slot) {
        return false;
    }
    *bytes = (const uint8_t *)dse_source(instance, slot);
    memcpy(size, (const char *)*bytes - slot->offset + slot->size_at, sizeof *size);
    return *size <= slot->capacity || dse_refuse_size(instance, function, reference, *size);
}

static inline bool dse_set_bytes(
    struct dse_instance *instance, const char *function, uint32_t reference, const uint8_t *bytes, size_t size) {
    const struct dse_slot *slot = dse_find_settable(instance, function, reference, DSE_BINARY);
    if (!slot || size > slot->capacity || (size && !bytes)) {
        return slot && dse_refuse_size(instance, function, reference, size);
    }
    char *const to = dse_target(instance, slot);
    if (size) {
        memcpy(to, bytes, size);
    }
    memcpy(to - slot->offset + slot->size_at, &size, sizeof size);
    return true;
}

#endif
