/* Messages of a component of the kind udp about its packets: at the end of a run, and after a failure. */
#ifndef DSE_UDP_TOLD_H
#define DSE_UDP_TOLD_H

#include <stdarg.h>

#include "datagram.h"

enum { DSE_UDP_DONE, DSE_UDP_ENDED, DSE_UDP_FAILED };
enum { DSE_UDP_LONGEST = 400 }; /* bytes */

struct dse_udp_text {
    char *at;
    size_t used; /* of DSE_UDP_LONGEST */
};

static void dse_udp_add(struct dse_udp_text *text, const char *format, ...) {
    if (text->used < DSE_UDP_LONGEST) {
        va_list arguments;
        va_start(arguments, format);
        const int more = vsnprintf(text->at + text->used, DSE_UDP_LONGEST - text->used, format, arguments);
        va_end(arguments);
        text->used += more > 0 ? (size_t)more : 0;
    }
}

static double dse_udp_count_ignored(const struct dse_udp *udp, int reasons) {
    double sum = 0.0;
    for (int reason = 0; reason < reasons; reason++) {
        sum += (double)udp->counts.ignored[reason];
    }
    return sum;
}

static void dse_udp_add_ignored(const struct dse_udp *udp, struct dse_udp_text *text) {
    static const char *const reasons[DSE_UDP_REASONS] = {
        "of a wrong size", "of another protocol or version", "torn", "with flags that are wrong here",
        "with values that are none", "of another layout", "of another session", "from elsewhere", "old or doubled"};
    const char *separator = "";
    dse_udp_add(text, "ignored: ");
    for (int reason = 0; reason < DSE_UDP_REASONS; reason++) {
        if (udp->counts.ignored[reason]) {
            dse_udp_add(text, "%s%.0f %s", separator, (double)udp->counts.ignored[reason], reasons[reason]);
            separator = ", ";
        }
    }
    if (udp->counts.ignored[DSE_UDP_WRONG_SIZE]) {
        dse_udp_add(text, " (the last of %lu bytes, right are %lu)", (unsigned long)udp->counts.last_size,
                    (unsigned long)DSE_UDP_HEARD_SIZE);
    }
}

/* Whether there were invalid packets or a missed deadline: then *said* has a message. */
static bool dse_udp_tell_trouble(const struct dse_udp *udp, char said[DSE_UDP_LONGEST + 1]) {
    struct dse_udp_text text = {said, 0};
    const bool has_ignored = dse_udp_count_ignored(udp, DSE_UDP_WRONG_SEQUENCE) > 0.0;
    if (udp->counts.overruns) {
        dse_udp_add(&text, "%.0f deadlines were missed, by %.3g s at most", (double)udp->counts.overruns,
                    udp->counts.latest);
    }
    if (has_ignored) {
        dse_udp_add(&text, udp->counts.overruns ? "; packets " : "packets ");
        dse_udp_add_ignored(udp, &text);
    }
    return has_ignored || udp->counts.overruns;
}

static int dse_udp_fail_silent(const struct dse_udp *udp, double seconds, char *said) {
    struct dse_udp_text text = {said, 0};
    dse_udp_add(&text, "in %g s no packet that can be used came ", seconds);
    if (!DSE_UDP_HOST[0]) {
        dse_udp_add(&text, "from the other side");
    } else {
        dse_udp_add(&text, DSE_UDP_IS_SERVER ? "to %s:%s" : "from %s:%s", DSE_UDP_HOST, DSE_UDP_PORT);
    }
    dse_udp_add(&text, "; ");
    if (dse_udp_count_ignored(udp, DSE_UDP_REASONS) > 0.0) {
        dse_udp_add_ignored(udp, &text);
    } else {
        dse_udp_add(&text, udp->counts.refused ? "nobody listens there"
                           : udp->counts.busy  ? "it is busy with another session"
                                               : "nothing was heard at all");
    }
    return DSE_UDP_FAILED;
}

#endif
