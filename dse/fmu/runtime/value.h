/* Reading and writing an instance's variables. Doubles are copied directly; all other values are converted with a
 * check, so that no number is ever truncated.
 */
#ifndef DSE_VALUE_H
#define DSE_VALUE_H

#include "instance.h"
#ifdef DSE_MODEL
#include "simulation.h"
#define DSE_FIRST_ITEM 1
/* Values set from outside wait for the next step, or the next evaluation. */
#define DSE_IS_SET(slot) ((slot)->settable & DSE_STEPPING)
#define DSE_HAS_ENDED(instance) dse_has_ended(instance)
#else
#include "c_component.h"
#define DSE_FIRST_ITEM 0
#define DSE_IS_SET(slot) 0
#ifdef DSE_UDP
#define DSE_HAS_ENDED(instance) ((instance) && ((const struct dse_instance *)(instance))->udp.has_ended)
#else
#define DSE_HAS_ENDED(instance) false
#endif
#endif

/* The number of values of a reference: in FMI 3.0 those of an array, which are consecutive slots. */
#ifdef DSE_ARRAYS
#define DSE_COUNT(reference) ((reference) < DSE_SLOT_COUNT ? dse_slots[reference].count : 1u)
#else
#define DSE_COUNT(reference) 1u
#endif

static inline const char *dse_source(const struct dse_instance *instance, const struct dse_slot *slot) {
    return (DSE_IS_SET(slot) ? (const char *)&instance->at.start : (const char *)&instance->at.now) + slot->offset;
}

static inline char *dse_target(struct dse_instance *instance, const struct dse_slot *slot) {
    const bool is_now = instance->at.state == DSE_STEPPING && !DSE_IS_SET(slot);
    return (is_now ? (char *)&instance->at.now : (char *)&instance->at.start) + slot->offset;
}

static const char *dse_kind_name(int kinds) {
    return kinds & DSE_REAL      ? "real"
           : kinds & DSE_INTEGER ? "integer"
           : kinds & DSE_BOOLEAN ? "Boolean"
           : kinds & DSE_TEXT    ? "string"
           : kinds & DSE_BINARY  ? "binary"
                                 : "enumeration";
}

/* The slot of *reference*, or NULL after reporting that it is not one of *kinds*. */
static DSE_APART const struct dse_slot *dse_find(
    struct dse_instance *instance, const char *function, uint32_t reference, int kinds) {
    if (DSE_UNLIKELY(reference >= DSE_SLOT_COUNT)) {
        dse_refuse(instance, function, "there is no variable with value reference %lu", (unsigned long)reference);
        return NULL;
    }
    if (DSE_UNLIKELY(!(dse_slots[reference].kind & kinds))) {
        dse_refuse(instance, function, "variable '%s' is of the kind %s", dse_names[reference],
            dse_kind_name(dse_slots[reference].kind));
        return NULL;
    }
    return &dse_slots[reference];
}

/* As dse_find, and the variable may be set now. */
static DSE_APART const struct dse_slot *dse_find_settable(
    struct dse_instance *instance, const char *function, uint32_t reference, int kinds) {
    const struct dse_slot *slot = dse_find(instance, function, reference, kinds);
    if (slot && DSE_UNLIKELY(!(slot->settable & instance->at.state))) {
        dse_refuse(instance, function, "variable '%s' cannot be set %s", dse_names[reference],
            dse_state_name(instance->at.state));
        return NULL;
    }
    return slot;
}

/* Call before any variable is read. */
static inline bool dse_begin_get(struct dse_instance *instance, const char *function) {
    if (DSE_UNLIKELY(!dse_is_allowed(instance, function, DSE_VALUES_KNOWN))) {
        return false;
    }
    return DSE_LIKELY(!instance->at.is_stale) || dse_refresh(instance, function);
}

/* Call before any variable is written. */
static inline bool dse_begin_set(struct dse_instance *instance, const char *function) {
    if (DSE_UNLIKELY(!dse_is_allowed(instance, function, DSE_INPUT))) {
        return false;
    }
#ifdef DSE_MODEL
    instance->at.is_changed = 1;
    instance->at.is_stale = dse_staleness(instance);
#else
    instance->at.is_stale = instance->at.state != DSE_STEPPING;
#endif
    return true;
}

#ifdef DSE_MODEL
static DSE_APART bool dse_refuse_nan(struct dse_instance *instance, const char *function, uint32_t reference) {
    return dse_refuse(instance, function, "at %.12g s: variable '%s' is not a number", instance->at.now.time,
        dse_names[reference]);
}
#endif

/* Access to all variables except doubles of the component; refuses those that are not real. */
static DSE_APART bool dse_get_float(
    struct dse_instance *instance, const char *function, uint32_t reference, double *value) {
    const struct dse_slot *slot;
    float narrow;
#ifdef DSE_TIME
    if (reference == DSE_TIME) {
        *value = instance->at.time;
        return true;
    }
#ifdef DSE_MODEL
    const int64_t relation = (int64_t)reference - (int64_t)DSE_TIME - 1;
    if (relation >= 0 && relation < DSE_INDICATORS) {
        double look[DSE_LOOK];
        if (!dse_see(&instance->at.now, look)) {
            return dse_tell_trouble(instance, function);
        }
        *value = dse_event_indicator(&instance->at.now, (int)relation, look);
        return true;
    }
#endif
#endif
    slot = dse_find(instance, function, reference, DSE_REAL);
    if (!slot) {
        return false;
    }
    memcpy(&narrow, dse_source(instance, slot), sizeof narrow);
    *value = narrow;
    return true;
}

static DSE_APART bool dse_set_float(
    struct dse_instance *instance, const char *function, uint32_t reference, double value) {
    const struct dse_slot *slot = dse_find_settable(instance, function, reference, DSE_REAL);
    if (!slot) {
        return false;
    }
    if (slot->type == DSE_F64) {
        memcpy(dse_target(instance, slot), &value, sizeof value);
        return true;
    }
    if (isfinite(value) && fabs(value) > (double)FLT_MAX) {
        return dse_refuse(instance, function, "variable '%s': %g does not fit a float", dse_names[reference], value);
    }
    const float narrow = (float)value;
    memcpy(dse_target(instance, slot), &narrow, sizeof narrow);
    return true;
}

static inline bool dse_get_reals(
    struct dse_instance *instance, const char *function, const uint32_t references[], size_t count, double values[]) {
    bool is_ok = dse_begin_get(instance, function);
    for (size_t k = 0; is_ok && k < count; k++) {
        const uint32_t end = references[k] + DSE_COUNT(references[k]);
        for (uint32_t reference = references[k]; is_ok && reference != end; reference++, values++) {
            if (reference < DSE_SLOT_COUNT && dse_slots[reference].type == DSE_F64) {
                memcpy(values, dse_source(instance, &dse_slots[reference]), sizeof *values);
#ifdef DSE_MODEL
                is_ok = *values == *values || dse_refuse_nan(instance, function, reference);
#endif
            } else {
                is_ok = dse_get_float(instance, function, reference, values);
            }
        }
    }
    return is_ok;
}

static inline bool dse_set_reals(struct dse_instance *instance, const char *function, const uint32_t references[],
    size_t count, const double values[]) {
    bool is_ok = dse_begin_set(instance, function);
    for (size_t k = 0; is_ok && k < count; k++) {
        const uint32_t end = references[k] + DSE_COUNT(references[k]);
        for (uint32_t reference = references[k]; is_ok && reference != end; reference++, values++) {
            const struct dse_slot *slot = &dse_slots[reference < DSE_SLOT_COUNT ? reference : 0];
            if (reference < DSE_SLOT_COUNT && slot->type == DSE_F64 && (slot->settable & instance->at.state)) {
                memcpy(dse_target(instance, slot), values, sizeof *values);
            } else {
                is_ok = dse_set_float(instance, function, reference, *values);
            }
        }
    }
    return is_ok;
}

#define DSE_LOAD(code, ctype)                                                                                          \
    case code: {                                                                                                       \
        ctype typed;                                                                                                   \
        memcpy(&typed, from, sizeof typed);                                                                            \
        *value = (int64_t)typed;                                                                                       \
        return true;                                                                                                   \
    }
#define DSE_STORE(code, ctype)                                                                                         \
    case code: {                                                                                                       \
        const ctype typed = (ctype)value;                                                                              \
        memcpy(to, &typed, sizeof typed);                                                                              \
        return;                                                                                                        \
    }

/* False if the number is beyond the range of int64_t. */
static inline bool dse_load(const char *from, int type, int64_t *value) {
    switch (type) {
        DSE_LOAD(DSE_BOOL, bool)
        DSE_LOAD(DSE_I8, int8_t)
        DSE_LOAD(DSE_I16, int16_t)
        DSE_LOAD(DSE_I32, int32_t)
        DSE_LOAD(DSE_I64, int64_t)
        DSE_LOAD(DSE_U8, uint8_t)
        DSE_LOAD(DSE_U16, uint16_t)
        DSE_LOAD(DSE_U32, uint32_t)
    case DSE_WHOLE: {
        double typed;
        memcpy(&typed, from, sizeof typed);
        const bool is_whole = typed >= -0x1p62 && typed <= 0x1p62 && typed == floor(typed);
        *value = is_whole ? (int64_t)typed : 0;
        return is_whole;
    }
    default: {
        uint64_t typed;
        memcpy(&typed, from, sizeof typed);
        *value = (int64_t)typed;
        return typed <= (uint64_t)INT64_MAX;
    }
    }
}

static inline void dse_store(char *to, int type, int64_t value) {
    switch (type) {
        DSE_STORE(DSE_BOOL, bool)
        DSE_STORE(DSE_I8, int8_t)
        DSE_STORE(DSE_I16, int16_t)
        DSE_STORE(DSE_I32, int32_t)
        DSE_STORE(DSE_I64, int64_t)
        DSE_STORE(DSE_U8, uint8_t)
        DSE_STORE(DSE_U16, uint16_t)
        DSE_STORE(DSE_U32, uint32_t)
        DSE_STORE(DSE_U64, uint64_t)
        DSE_STORE(DSE_WHOLE, double)
    default: return;
    }
}

/* One integer, Boolean or item number of an enumeration, which must be within *lowest* … *highest* as well. */
static DSE_APART bool dse_get_whole(struct dse_instance *instance, const char *function, uint32_t reference, int kinds,
    int64_t lowest, int64_t highest, int64_t *value) {
    const struct dse_slot *slot = dse_find(instance, function, reference, kinds);
    if (DSE_UNLIKELY(!slot)) {
        return false;
    }
    if (DSE_UNLIKELY(!dse_load(dse_source(instance, slot), slot->type, value))) {
        return dse_refuse(instance, function,
            slot->type == DSE_WHOLE ? "the value of '%s' is not a whole number"
                                    : "the value of '%s' is beyond 64 bits with sign",
            dse_names[reference]);
    }
    if (slot->kind == DSE_BOOLEAN) {
        *value = *value != 0;
    }
    if (slot->kind == DSE_ENUMERATION) {
        lowest = DSE_FIRST_ITEM;
        highest = DSE_FIRST_ITEM + slot->items - 1;
    }
    if (DSE_UNLIKELY(*value < lowest || *value > highest)) {
        return dse_refuse(instance, function, "the value %lld of '%s' is not in %lld … %lld", (long long)*value,
            dse_names[reference], (long long)lowest, (long long)highest);
    }
    return true;
}

static DSE_APART bool dse_set_whole(
    struct dse_instance *instance, const char *function, uint32_t reference, int kinds, int64_t value) {
    const struct dse_slot *slot = dse_find_settable(instance, function, reference, kinds);
    int64_t lowest, highest;
    if (DSE_UNLIKELY(!slot)) {
        return false;
    }
    lowest = DSE_LOWEST(slot->type);
    highest = DSE_HIGHEST(slot->type);
    if (slot->kind == DSE_BOOLEAN) {
        value = value != 0;
    }
    if (slot->kind == DSE_ENUMERATION) {
        lowest = DSE_FIRST_ITEM;
        highest = DSE_FIRST_ITEM + slot->items - 1;
    }
    if (DSE_UNLIKELY(value < lowest || value > highest)) {
        return dse_refuse(instance, function, "%lld does not fit '%s', which takes %lld … %lld", (long long)value,
            dse_names[reference], (long long)lowest, (long long)highest);
    }
    dse_store(dse_target(instance, slot), slot->type, value);
    return true;
}

#endif
