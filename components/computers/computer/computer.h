/* A computer with a processing delay: the chosen target leaves it *delay* later, in whole steps. */
#ifndef COMPUTER_H
#define COMPUTER_H

#include <stdbool.h>
#include <stdint.h>

#define COMPUTER_STEP 0.01 /* s; the step in every component.yaml that uses this */
#define COMPUTER_DELAY 64  /* stored steps, more than the longest delay */

typedef struct {
    double gap, closing_speed;
    bool detected;
} computer_target;

typedef struct {
    struct {
        computer_target chosen;
    } in;
    struct {
        computer_target target;
    } out;
    struct {
        double delay;
    } par;
    computer_target heard[COMPUTER_DELAY];
    int32_t newest;
} computer;

void computer_init(computer *self);
void computer_step(computer *self);

#endif
