#include "protobuf.h"

#include <string.h>

#define LARGEST_NUMBER 0x1FFFFFFFu /* of a field */

static void put(proto_out *out, uint8_t byte) {
    if (out->size < out->room) out->data[out->size] = byte;
    ++out->size;
}

static void put_varint(proto_out *out, uint64_t value) {
    for (; value > 0x7F; value >>= 7) put(out, (uint8_t)(0x80 | (value & 0x7F)));
    put(out, (uint8_t)value);
}

static void put_head(proto_out *out, uint32_t field, proto_type type) {
    put_varint(out, (uint64_t)field << 3 | (uint64_t)type);
}

void proto_put_whole(proto_out *out, uint32_t field, uint64_t value) {
    put_head(out, field, PROTO_WHOLE);
    put_varint(out, value);
}

void proto_put_real(proto_out *out, uint32_t field, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_head(out, field, PROTO_REAL);
    for (int i = 0; i < 8; ++i) put(out, (uint8_t)(bits >> 8 * i));
}

void proto_put_reals(proto_out *out, uint32_t field, const double *values, uint32_t count) {
    size_t opened = proto_open(out, field);
    for (uint32_t i = 0; i < count; ++i) proto_put_real(out, i + 1, values[i]);
    proto_close(out, opened);
}

void proto_put_bytes(proto_out *out, uint32_t field, const uint8_t *data, size_t size) {
    put_head(out, field, PROTO_BYTES);
    put_varint(out, size);
    if (out->size <= out->room && size <= out->room - out->size) memcpy(out->data + out->size, data, size);
    out->size += size;
}

size_t proto_open(proto_out *out, uint32_t field) {
    put_head(out, field, PROTO_BYTES);
    put(out, 0);
    return out->size;
}

void proto_close(proto_out *out, size_t opened) {
    size_t length = out->size - opened, further = 0;
    for (size_t rest = length >> 7; rest > 0; rest >>= 7) ++further;
    if (out->size + further <= out->room) {
        proto_out head = {out->data, out->room, opened - 1};
        memmove(out->data + opened + further, out->data + opened, length);
        put_varint(&head, length);
    }
    out->size += further;
}

static bool fail(proto_in *in) {
    *in->broken = true;
    return false;
}

static bool get_varint(proto_in *in, uint64_t *value) {
    *value = 0;
    for (unsigned shift = 0; shift < 64 && in->at < in->end; shift += 7) {
        uint8_t byte = *in->at++;
        if (shift == 63 && byte > 1) return false;
        *value |= (uint64_t)(byte & 0x7F) << shift;
        if (byte < 0x80) return true;
    }
    return false;
}

static bool get_fixed(proto_in *in, size_t size, uint64_t *bits) {
    if ((size_t)(in->end - in->at) < size) return false;
    *bits = 0;
    for (size_t i = 0; i < size; ++i) *bits |= (uint64_t)*in->at++ << 8 * i;
    return true;
}

static bool get_bytes(proto_in *in, proto_in *bytes) {
    uint64_t size;
    if (!get_varint(in, &size) || size > (uint64_t)(in->end - in->at)) return false;
    bytes->at = in->at;
    bytes->end = in->at += size;
    bytes->broken = in->broken;
    return true;
}

bool proto_next(proto_in *in, proto_field *field) {
    uint64_t head;
    if (*in->broken || in->at == in->end) return false;
    if (!get_varint(in, &head) || head >> 3 == 0 || head >> 3 > LARGEST_NUMBER) return fail(in);
    memset(field, 0, sizeof *field);
    field->number = (uint32_t)(head >> 3);
    field->type = (proto_type)(head & 7);
    switch (field->type) {
    case PROTO_WHOLE: return get_varint(in, &field->whole) || fail(in);
    case PROTO_BYTES: return get_bytes(in, &field->bytes) || fail(in);
    case PROTO_SHORT: return get_fixed(in, 4, &field->whole) || fail(in);
    case PROTO_REAL:
        if (!get_fixed(in, 8, &field->whole)) return fail(in);
        memcpy(&field->real, &field->whole, sizeof field->real);
        return true;
    }
    return fail(in);
}

bool proto_is(const proto_field *field, uint32_t number, proto_type type) {
    return field->number == number && field->type == type;
}

void proto_reals(proto_in in, double *values, uint32_t count) {
    proto_field field;
    while (proto_next(&in, &field)) {
        if (field.number <= count && field.type == PROTO_REAL) values[field.number - 1] = field.real;
    }
}
