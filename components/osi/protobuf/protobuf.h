/* Messages in the wire format of Protocol Buffers (protobuf.dev/programming-guides/encoding), written and read in place.
 *
 * Written are varints, doubles and messages within messages, whose length is put before them when they end, in as few
 * bytes as it takes: where fields come in the order of their numbers, the bytes are those of other libraries.
 *
 * Read is what strangers wrote, so nothing in it is believed: a varint ends after ten bytes and within 64 bits, a field
 * within what it is in, a number is one that a field can have, and groups, which nobody writes any more, are an error. What
 * is known under another type is skipped, as what is not known; what says a thing twice means the last of it. */
#ifndef PROTOBUF_H
#define PROTOBUF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t *data;
    size_t room, size; /* more than *room*: it did not fit, and would have needed that */
} proto_out;

void proto_put_whole(proto_out *out, uint32_t field, uint64_t value);
void proto_put_real(proto_out *out, uint32_t field, double value);
void proto_put_reals(proto_out *out, uint32_t field, const double *values, uint32_t count); /* a message of fields 1 ... */
void proto_put_bytes(proto_out *out, uint32_t field, const uint8_t *data, size_t size);

/* Opens a message; what it gives is told when it is closed, after all that is in it. */
size_t proto_open(proto_out *out, uint32_t field);
void proto_close(proto_out *out, size_t opened);

typedef struct {
    const uint8_t *at, *end;
    bool *broken; /* set when the bytes are no message; then there are no more fields in any part of it */
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

/* A message whose fields 1 ... *count* are doubles; values that it does not have stay as they are. */
void proto_reals(proto_in in, double *values, uint32_t count);

#endif
