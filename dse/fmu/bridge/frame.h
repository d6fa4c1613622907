/* What goes over the pipes between a bridge and its host: frames, one at a time. Both are little-endian, of 64 bits. */
#ifndef DSE_FMU_BRIDGE_FRAME_H
#define DSE_FMU_BRIDGE_FRAME_H

#include <stdint.h>

enum { MOST_PARAMETERS = 12, LONGEST_TEXT = 16 << 20 };

/* To the host: a call; what came of an intermediate update. From it: whether the library is there; what a call came to;
 * that it crashes; calls of the callbacks. */
enum { CALL, UPDATED, READY, RETURNED, CRASHED, LOGGED, FINISHED, BETWEEN };

typedef struct {
    uint32_t kind, number; /* of the function, or of the callbacks */
    uint64_t size;         /* in bytes, of what follows */
    uint64_t value;        /* a status, an instance, an error */
} Head;

/* Follows the head of a call; then come the links and the data, both at multiples of 8. */
typedef struct {
    uint64_t parameters[MOST_PARAMETERS];
    uint32_t n_links, data_size;
    uint32_t out_from;              /* the data from here on are sent back */
    uint32_t texts, n_texts, sizes; /* where in the data lie pointers to texts that follow them back, and sizes, or 0 */
    uint32_t reserved[2];
} Call;

/* What has to be made an address: a parameter, or TO_DATA_IN_DATA a word of the data, that counts from the data's beginning;
 * else what the host has in the place of callbacks. */
enum { TO_DATA, TO_DATA_IN_DATA, TO_CALLBACKS, TO_LOGGER, TO_BETWEEN };
typedef struct {
    uint32_t at, to;
} Link;

/* Behind BETWEEN and UPDATED. */
typedef struct {
    double time;
    uint8_t flags[4], returns_early, reserved[3];
} Update;

enum { NO_TEXT = -1 }; /* in the place of a text's size */

/* Behind READY: which functions the library has, and the name of a library that it needs and that is not there. */
enum { LONGEST_NAME = 260 };

#define ROUNDED(size) (((size) + 7) & ~(uint64_t)7)

#endif
