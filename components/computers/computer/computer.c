#include "computer.h"

#include <math.h>

void computer_init(computer *self) {
    /* Before the start there was no target. */
    const computer_target nobody = {0, 0, false};
    for (int32_t i = 0; i < COMPUTER_DELAY; ++i) self->heard[i] = nobody;
    self->newest = 0;
    self->out.target = nobody;
}

void computer_step(computer *self) {
    self->newest = (self->newest + 1) % COMPUTER_DELAY;
    self->heard[self->newest] = self->in.chosen;
    int32_t late = (int32_t)lround(fmin(self->par.delay / COMPUTER_STEP, COMPUTER_DELAY - 1));
    self->out.target = self->heard[(self->newest + COMPUTER_DELAY - late) % COMPUTER_DELAY];
}
