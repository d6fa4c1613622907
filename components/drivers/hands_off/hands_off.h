/* A driver with constant inputs. */
#ifndef HANDS_OFF_H
#define HANDS_OFF_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    struct {
        double accelerator, brake, steering;
        bool hands_on, cruise;
        double set_speed;
        int32_t gap_setting;
    } out;
    struct {
        double pedal, brake_pedal, wheel;
        bool holds_wheel, wants_cruise;
        double wish;
        int32_t gap_wish;
    } par;
} hands_off;

void hands_off_init(hands_off *self);
void hands_off_step(hands_off *self);

#endif
