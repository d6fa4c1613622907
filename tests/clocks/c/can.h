/* The operations of FMI-LS-BUS 1.0 for CAN (4.4.1) that are used here, as bytes: numbers with the least byte first. */
enum { TRANSMIT = 0x10, CONFIRM = 0x20, ARBITRATION_LOST = 0x30, CONFIGURATION = 0x40 };
enum { BAUDRATE = 1, LOST_BEHAVIOR = 4, BUFFER_AND_RETRANSMIT = 1, DISCARD_AND_NOTIFY = 2 };

static void put(Message *to, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        to->bytes[to->size++] = (uint8_t)(value >> 8 * i);
}

static uint32_t got(const uint8_t *from, int bytes) {
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)from[i] << 8 * i;
    return value;
}

static void put_frame(Message *to, uint32_t id, uint32_t payload) {
    put(to, TRANSMIT, 4), put(to, 16 + 4, 4), put(to, id, 4), put(to, 0, 1), put(to, 0, 1), put(to, 4, 2);
    put(to, payload, 4);
}

static void put_about(Message *to, uint32_t operation, uint32_t id) { put(to, operation, 4), put(to, 12, 4), put(to, id, 4); }

/* The operation at *place*, and the place behind it; NULL at the end or if it does not fit. */
static const uint8_t *operation(const Message *from, size_t *place) {
    const uint8_t *found = from->bytes + *place;
    if (from->size - *place < 8 || got(found + 4, 4) < 8 || got(found + 4, 4) > from->size - *place)
        return NULL;
    *place += got(found + 4, 4);
    return found;
}
