/* Messages in the wire format of Protocol Buffers (protobuf.dev/programming-guides/encoding), written and read in place.
 *
 * The writer supports varints, doubles and nested messages. The length of a nested message is put before it when it
 * ends, in the fewest bytes. With fields in the order of their numbers, the bytes equal those of other libraries.
 *
 * Input is not trusted: a varint ends after ten bytes and within 64 bits, a field within its message, a field number is
 * in the valid range, and groups, which are deprecated, are an error. Unknown fields, and fields with another type, are
 * skipped. Of a repeated field the last one counts. */
#ifndef PROTOBUF_H
#define PROTOBUF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t *data;
    size_t room, size; /* if greater than *room*, the message did not fit, and needs this size */
} proto_out;

void proto_put_whole(proto_out *out, uint32_t field, uint64_t value);
void proto_put_real(proto_out *out, uint32_t field, double value);
void proto_put_reals(proto_out *out, uint32_t field, const double *values, uint32_t count); /* a message of fields 1 ... */
void proto_put_bytes(proto_out *out, uint32_t field, const uint8_t *data, size_t size);

/* Opens a message; pass the returned value to proto_close, after all its fields. */
size_t proto_open(proto_out *out, uint32_t field);
void proto_close(proto_out *out, size_t opened);

typedef struct {
    const uint8_t *at, *end;
    bool *broken; /* set when the bytes are not a message; then no part of it has more fields */
} proto_in;

typedef enum { PROTO_WHOLE = 0, PROTO_REAL = 1, PROTO_BYTES = 2, PROTO_SHORT = 5 } proto_type;

typedef struct {
    uint32_t number;
    proto_type type;
    uint64_t whole;
    double real;
    proto_in bytes;
} proto_field;

bool proto_next(proto_in *in, proto_field *field);

bool proto_is(const proto_field *field, uint32_t number, proto_type type);

/* A message whose fields 1 ... *count* are doubles; values of missing fields stay unchanged. */
void proto_reals(proto_in in, double *values, uint32_t count);

#endif
