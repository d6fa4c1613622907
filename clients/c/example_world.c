/* A point mass on a road, 20 m behind a wall it drives towards: asked for a force, it tells place, speed and gap.
 *
 *     cc -std=c99 -D_DEFAULT_SOURCE -O2 example_world.c -o example_world && ./example_world 5005
 *     dse udp check 127.0.0.1:5005 --out 1 --back 3 --step 0.01 */
#include <stdio.h>

#include "dse_udp.h"

#define MASS 1200.0
#define STEP 0.01

static double place, speed;

static void advance(double force) { /* half a step with the old speed, half with the new one */
    place += 0.5 * STEP * speed;
    speed += STEP * force / MASS;
    place += 0.5 * STEP * speed;
}

static void answer(dse_udp_world *world, double time) {
    const double told[3] = {place, speed, 20.0 - place};
    dse_udp_answer(world, time, told);
}

/* By a clock of its own: the newest force counts, nobody waits for anybody. */
static void run_free(dse_udp_world *world) {
    double force = 0.0, time = 0.0, deadline = dse_udp_now();
    world->is_free = true;
    for (;;) {
        dse_udp_event event;
        while ((event = dse_udp_wait(world, &force, 0.0)) != DSE_UDP_NOTHING) {
            if (event == DSE_UDP_STARTED) {
                place = speed = 0.0;
                time = world->time;
                answer(world, time);
            }
        }
        deadline = dse_udp_deadline(deadline, STEP, dse_udp_now());
        dse_udp_sleep_until(deadline);
        if (world->session) {
            advance(force);
            time += STEP;
            answer(world, time);
        }
    }
}

int main(int count, char **words) {
    const unsigned short port = (unsigned short)(count > 1 ? atoi(words[1]) : 5005);
    dse_udp_world world;
    double force = 0.0;
    if (!dse_udp_open(&world, "127.0.0.1", port, 1, 3)) {
        fprintf(stderr, "port %u cannot be opened\n", port);
        return 1;
    }
    printf("a world at 127.0.0.1:%u\n", port);
    fflush(stdout);
    if (count > 2 && strcmp(words[2], "free") == 0) {
        run_free(&world);
    }
    for (;;) {
        switch (dse_udp_wait(&world, &force, -1.0)) {
        case DSE_UDP_STARTED:
            place = speed = 0.0;
            answer(&world, world.time);
            break;
        case DSE_UDP_STEP:
            advance(force);
            answer(&world, world.time + STEP);
            break;
        case DSE_UDP_ENDED:
            printf("a session has ended at %g m, %g m/s\n", place, speed);
            fflush(stdout);
            break;
        default:
            break;
        }
    }
}
