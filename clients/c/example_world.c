/* A point mass on a road, 20 m behind a wall it drives towards: asked for a force, it tells place, speed and gap.
 *
 *     cc -std=c99 -D_DEFAULT_SOURCE -O2 example_world.c -o example_world && ./example_world 5005
 *     dse udp check 127.0.0.1:5005 --out 1 --back 3 --step 0.01 */
#include <stdio.h>

#include "dse_udp.h"

#define MASS 1200.0
#define STEP 0.01

int main(int count, char **words) {
    const unsigned short port = (unsigned short)(count > 1 ? atoi(words[1]) : 5005);
    const int sessions = count > 2 ? atoi(words[2]) : 0; /* 0: for ever */
    dse_udp_world world;
    double force = 0.0, place = 0.0, speed = 0.0;
    if (!dse_udp_open(&world, "127.0.0.1", port, 1, 3)) {
        fprintf(stderr, "port %u cannot be opened\n", port);
        return 1;
    }
    printf("a world at 127.0.0.1:%u\n", port);
    fflush(stdout);
    for (int ended = 0; !sessions || ended < sessions;) {
        double time = 0.0;
        switch (dse_udp_wait(&world, &force, -1.0)) {
        case DSE_UDP_STARTED:
            place = 0.0;
            speed = 0.0;
            time = world.time;
            break;
        case DSE_UDP_STEP: /* half a step with the old speed, half with the new one */
            place += 0.5 * STEP * speed;
            speed += STEP * force / MASS;
            place += 0.5 * STEP * speed;
            time = world.time + STEP;
            break;
        case DSE_UDP_ENDED:
            printf("a session has ended at %g m, %g m/s\n", place, speed);
            fflush(stdout);
            ended++;
            continue;
        default:
            continue;
        }
        const double told[3] = {place, speed, 20.0 - place};
        dse_udp_answer(&world, time, told);
    }
    dse_udp_close(&world);
    return 0;
}
